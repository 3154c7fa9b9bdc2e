//! The report's words on PI and PD next to the proportional law, with figures from the same loop.

use anyhow::{Context, Result};
use haptical_metrics::rms;
use haptical_model::{Device, Evaluation};
use xtask_output::Output;

use super::closed_loop::{Axis, DAMPING, FIXTURE_N_PER_M, Law};
use super::figure12::SENSOR_SD_N;
use super::figures;
use super::laws::{HELD_S, Instant, Outcome, let_go, noise, outcome, wall_energy_j};
use super::sample::{WALL_FORCE_N, in_each, measured_n, poses, transmission, transverse_n};
use crate::scenario::Scenario;

/// Share of the integral's limit that is shown: at half of it the force still rings when the hand lets go.
const INTEGRAL_SHARE: f64 = 0.25;

/// The loop that other laws are tried in.
struct Case<'a> {
    scenario: &'a Scenario,
    full: &'a Device,
    axis: Axis,
    gain: f64,
    seed: u64,
}

/// PI and PD next to P, and what admittance control does.
pub(crate) fn other_laws(
    output: &mut Output,
    scenario: &Scenario,
    full: &Device,
    posture: &[f64],
    gain: f64,
    seed: u64,
) -> Result<()> {
    let case = Case {
        scenario,
        full,
        axis: Axis::new(FIXTURE_N_PER_M, DAMPING),
        gain,
        seed,
    };
    let derivative_limit_s = case
        .axis
        .largest(1.0, |k_d| case.law().with_derivative(k_d));
    let [proportional, integral] = integral_words(output, &case, posture)?;
    derivative_words(output, &case, derivative_limit_s)?;
    output.grid(
        "laws",
        "P, PI and PD in the loop of Figure 11",
        &figures::laws(&proportional, &integral, gain, derivative_limit_s, seed),
    )?;
    output.words(
        "Admittance control, the other way round (a measured force, a wanted motion), is not built: docs/equations.md, \
         Admittance control, says what it is, when it is preferable and what of the calibrated model it would use.",
    );
    Ok(())
}

impl Case<'_> {
    fn law(&self) -> Law {
        Law::proportional(self.gain)
    }

    /// Transverse RMS over the poses of the seed with the nominal model and with the calibrated one \[mN\].
    fn forces_mn(&self, gain: f64) -> Result<[f64; 2]> {
        let recording = poses(self.scenario, self.seed)?;
        let controllers = [&self.scenario.nominal, self.full];
        let (found, _) = transverse_n(&self.scenario.truth, &controllers, &recording, gain)?;
        Ok([1e3 * rms(&found[0])?, 1e3 * rms(&found[1])?])
    }

    /// Part of the wanted force along z that comes out of the nominal model at a posture, without a loop.
    fn share(&self, posture: &[f64]) -> Result<f64> {
        let mut at_truth = Evaluation::new(&self.scenario.truth);
        let mut at = Evaluation::new(&self.scenario.nominal);
        at_truth.move_to(posture)?;
        at.move_to(posture)?;
        let open = measured_n(&at_truth, &at, 0.0)?.context("a singular posture")?;
        Ok(open.z / WALL_FORCE_N)
    }
}

/// What an integral does; the courses of P and PI.
fn integral_words(
    output: &mut Output,
    case: &Case<'_>,
    posture: &[f64],
) -> Result<[Vec<Instant>; 2]> {
    let limit_per_s = case.axis.largest(1e4, |k_i| case.law().with_integral(k_i));
    let integral_per_s = INTEGRAL_SHARE * limit_per_s;
    let share = case.share(posture)?;
    let proportional = let_go(&case.law(), share);
    let integral = let_go(&case.law().with_integral(integral_per_s), share);
    let of = |course: &[Instant]| outcome(course).context("an empty course of the wall");
    let (p, pi) = (of(&proportional)?, of(&integral)?);
    let open = of(&let_go(&Law::proportional(0.0), share))?;
    let energy = |outcome: &Outcome| match outcome.energy_j {
        Some(energy) => format!("{:.1} times", energy / wall_energy_j()),
        None => "none of".to_owned(),
    };
    let [nominal_mn, full_mn] = case.forces_mn(case.gain)?;
    output.words(format!(
        "Why not an integral (PI). The paper: a user \"may not maintain static contact with an object consistently\". \
         While the handle is held, PI is the better law: with k_i = {integral_per_s:.0} 1/s, a quarter of its limit of \
         {limit_per_s:.0} 1/s at this G, the error of F_z after {:.1} s is {:.0} mN under the nominal model (P: {:.0} mN), \
         and the transverse forces go to zero as far as the sensor's frame is known: if the loop turns the sensor's \
         forces by the controller's own orientation, exactly; if by the true one, as assumed here, to the lean of the \
         wanted direction, {:.1} mN RMS over 100 poses of one seed, where P leaves {nominal_mn:.1} mN with the nominal \
         model and {full_mn:.2} mN with the calibrated one. When the hand lets go, the sensor shows nothing and the \
         integral winds up: the handle leaves the wall with {} the wall's energy (P: {}; G = 0: {}), and outside, where \
         nothing is wanted, {:.1} N go on pushing it (P: {:.1} N), {:.1} m/s at the end of the figure. Clearing the \
         integral where nothing is wanted would stop that push, not the surplus of energy.",
        HELD_S,
        1e3 * pi.rest_error_n.abs(),
        1e3 * p.rest_error_n.abs(),
        lean_mn(case.scenario, case.seed)?,
        energy(&pi),
        energy(&p),
        energy(&open),
        pi.last_n,
        p.last_n.abs(),
        pi.last_mps,
    ));
    Ok([proportional, integral])
}

fn derivative_words(output: &mut Output, case: &Case<'_>, limit_s: f64) -> Result<()> {
    let axis = &case.axis;
    let stiff_n_per_m = figures::FIXTURES_N_PER_M[2];
    let stiff = Axis::new(stiff_n_per_m, DAMPING);
    let best_s = best_derivative(axis, limit_s);
    let larger = largest_gain_with(axis, best_s);
    let (quiet, noisy) = (
        noise(axis, &case.law().with_derivative(0.0), case.seed),
        noise(axis, &case.law().with_derivative(best_s), case.seed),
    );
    let stiff_limit = match largest_gain_with(&stiff, best_s) {
        limit if limit > 0.0 => format!("{limit:.2}"),
        _ => "no gain at all".to_owned(),
    };
    output.words(format!(
        "Why not a derivative (PD). The paper: \"the noise of the sensor signal\". At this G the loop settles up to \
         k_d = {:.1} ms. At {:.1} ms, where the largest gain is largest, the noise of {:.0} mN becomes {:.0} mN RMS of \
         commanded force (P: {:.1} mN) and {:.1} mN at the handle (P: {:.1} mN). In this loop the noise alone would not \
         forbid it: the derivative damps the fixture's mode and the largest gain rises from {:.2} to {larger:.2}. But \
         with a fixture of {:.0} kN/m the same k_d leaves {stiff_limit} instead of {:.2}, so it has to be tuned to what \
         holds the handle. And it gains little: half of the larger gain leaves the nominal model's transverse RMS at \
         {:.1} mN instead of {:.1} mN, the calibrated model needs no gain for its {:.2} mN.",
        1e3 * limit_s,
        1e3 * best_s,
        1e3 * SENSOR_SD_N,
        1e3 * noisy.command_n,
        1e3 * quiet.command_n,
        1e3 * noisy.handle_n,
        1e3 * quiet.handle_n,
        axis.largest_gain(),
        1e-3 * stiff_n_per_m,
        stiff.largest_gain(),
        case.forces_mn(0.5 * larger)?[0],
        case.forces_mn(case.gain)?[0],
        case.forces_mn(0.0)?[1],
    ));
    Ok(())
}

fn largest_gain_with(axis: &Axis, derivative_s: f64) -> f64 {
    axis.largest(100.0, |gain| {
        Law::proportional(gain).with_derivative(derivative_s)
    })
}

/// Derivative gain \[s\] for which the largest gain is largest.
fn best_derivative(axis: &Axis, limit_s: f64) -> f64 {
    const STEPS: usize = 100;
    (0..STEPS)
        .map(|step| limit_s * step as f64 / STEPS as f64)
        .map(|derivative_s| (derivative_s, largest_gain_with(axis, derivative_s)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0.0, |(derivative_s, _)| derivative_s)
}

/// RMS over poses of the transverse force \[mN\] where the true sensor shows exactly what the nominal controller
/// wants: the lean of the wanted direction.
fn lean_mn(scenario: &Scenario, seed: u64) -> Result<f64> {
    let recording = poses(scenario, seed)?;
    let leans_mn = in_each(
        &scenario.truth,
        &scenario.nominal,
        &recording,
        |truth, at| {
            let along = truth.pose()?.rotation.transpose() * at.pose()?.rotation.column(2);
            Ok(transmission(truth, at).map(|_| 1e3 * WALL_FORCE_N * along.x.hypot(along.y)))
        },
    )?;
    Ok(rms(&leans_mn.into_iter().flatten().collect::<Vec<f64>>())?)
}
