//! Forces of the virtual wall at rest, over poses and seeds: what calibration takes off the transverse ones.

use anyhow::{Context, Result, ensure};
use haptical_calibration::{ParameterFit, TransmissionFit};
use haptical_metrics::rms;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, ForceTransmission, Recording, handle_force_n};
use haptical_simulator::Sampling;
use rayon::prelude::*;
use xtask_output::Progress;

use super::closed_loop::Axis;
use super::settling::settles;
use crate::run::{evaluation_readings, step_one, step_two};
use crate::scenario::Scenario;

/// Joint 3 is locked at home, as in the paper.
pub(crate) const FREE: [usize; 6] = [0, 1, 3, 4, 5, 6];
const LOCKED: usize = 2;
/// Wall of 100 N/m moved by 20 mm.
pub(crate) const WALL_FORCE_N: f64 = 2.0;
/// Postures whose Jacobian is worse than this are left out and counted.
const WORST_CONDITION: f64 = 300.0;
/// Poses of the workspace.
pub(crate) const POSES: usize = 100;
/// The joint whose transmission is a polynomial, which knows nothing beyond the readings it was fitted to.
pub(crate) const POLYNOMIAL: usize = 3;

pub(crate) const CONTROLLERS: [&str; 3] = ["nominal", "kinematics alone", "full calibration"];

/// One seed's two calibrations.
#[derive(Debug)]
pub(crate) struct Calibrated {
    seed: u64,
    alone: Device,
    pub(crate) full: Device,
    /// Readings of the polynomial's joint that step 1 saw \[rad\].
    pub(crate) range_rad: [f64; 2],
    /// Rows of step 2 beyond them.
    pub(crate) rows_outside: usize,
    /// Parameters that the two steps of the full calibration fitted, together.
    pub(crate) fitted: usize,
}

/// One seed: every controller on the same poses.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// Transverse force in each pose, controller by controller \[N\].
    pub(crate) transverse_n: [Vec<f64>; 3],
    /// Whether the pose's reading lies beyond those that the polynomial was fitted to.
    pub(crate) outside: Vec<bool>,
    pub(crate) left_out: usize,
    /// Rows of step 2 beyond the readings that the polynomial was fitted to.
    pub(crate) rows_outside: usize,
    pub(crate) fitted: usize,
}

impl Sample {
    /// Ratio of the transverse RMS of a controller to that of the nominal one.
    pub(crate) fn ratio(&self, controller: usize) -> Result<f64> {
        Ok(rms(&self.transverse_n[controller])? / rms(&self.transverse_n[0])?)
    }

    /// The same over the poses that are not left out, `out` in their order.
    pub(crate) fn ratio_without(&self, controller: usize, out: &[bool]) -> Result<f64> {
        let kept = |values: &[f64]| -> Vec<f64> {
            let values = values.iter().zip(out);
            values.filter(|(_, out)| !**out).map(|(v, _)| *v).collect()
        };
        Ok(rms(&kept(&self.transverse_n[controller]))? / rms(&kept(&self.transverse_n[0]))?)
    }
}

/// Poses with joint 3 at home.
pub(crate) fn poses(scenario: &Scenario, seed: u64) -> Result<Recording> {
    let mut scenario = scenario.clone();
    scenario.evaluation_poses = POSES;
    let mut recording = evaluation_readings(&scenario, seed.wrapping_add(1 << 40))?;
    recording.joint[LOCKED].fill(0.0);
    Ok(recording)
}

pub(crate) fn readings(recording: &Recording, row: usize) -> Vec<f64> {
    recording.joint.iter().map(|column| column[row]).collect()
}

/// What `of` makes of the true device and a controller in every pose.
pub(crate) fn in_each<T>(
    truth: &Device,
    controller: &Device,
    recording: &Recording,
    mut of: impl FnMut(&Evaluation<'_>, &Evaluation<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    let (mut at_truth, mut at) = (Evaluation::new(truth), Evaluation::new(controller));
    let in_one = |row| {
        let readings = readings(recording, row);
        at_truth.move_to(&readings)?;
        at.move_to(&readings)?;
        of(&at_truth, &at)
    };
    (0..recording.len()).map(in_one).collect()
}

/// How the wall's wrench comes out of the controller's model; none in a posture that is left out.
pub(crate) fn transmission(
    truth: &Evaluation<'_>,
    controller: &Evaluation<'_>,
) -> Option<ForceTransmission> {
    let found = ForceTransmission::new(truth, controller, FREE).ok()?;
    (found.condition <= WORST_CONDITION).then_some(found)
}

/// The force that the sensor in the true handle measures where the controller wants the wall's, at rest in a
/// loop of gain `gain`; none in a posture that is left out.
pub(crate) fn measured_n(
    truth: &Evaluation<'_>,
    controller: &Evaluation<'_>,
    gain: f64,
) -> Result<Option<Vector3<f64>>> {
    let Some(found) = transmission(truth, controller) else {
        return Ok(None);
    };
    let force_n = handle_force_n(&found, truth, controller, WALL_FORCE_N, gain);
    Ok(force_n?)
}

/// Transverse forces \[N\] of several controllers in the poses that none of them leaves out, with the row of
/// each pose.
pub(crate) fn transverse_n(
    truth: &Device,
    controllers: &[&Device],
    recording: &Recording,
    gain: f64,
) -> Result<(Vec<Vec<f64>>, Vec<usize>)> {
    let forces = |controller: &&Device| {
        in_each(truth, controller, recording, |truth, at| {
            let force = measured_n(truth, at, gain)?;
            Ok(force.map(|force| force.x.hypot(force.y)))
        })
    };
    let all: Vec<Vec<Option<f64>>> = controllers.iter().map(forces).collect::<Result<_>>()?;
    let is_kept = |row: &usize| all.iter().all(|forces| forces[*row].is_some());
    let rows: Vec<usize> = (0..recording.len()).filter(is_kept).collect();
    ensure!(!rows.is_empty(), "every posture is singular");
    let kept = |forces: &Vec<Option<f64>>| rows.iter().filter_map(|row| forces[*row]).collect();
    Ok((all.iter().map(kept).collect(), rows))
}

/// Readings of the pose whose transverse force under the nominal controller is nearest to that of all poses
/// (root mean square): a typical one to show.
pub(crate) fn typical_posture(scenario: &Scenario, seed: u64, gain: f64) -> Result<Vec<f64>> {
    let recording = poses(scenario, seed)?;
    let controllers = [&scenario.nominal];
    let (forces, rows) = transverse_n(&scenario.truth, &controllers, &recording, gain)?;
    let typical = rms(&forces[0])?;
    let distance = |size: f64| (size - typical).abs();
    let (_, &row) = forces[0]
        .iter()
        .zip(&rows)
        .min_by(|a, b| distance(*a.0).total_cmp(&distance(*b.0)))
        .context("no posture")?;
    Ok(readings(&recording, row))
}

/// How step 1 samples the transmissions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepOne {
    /// As the scenario draws every pose: normal about home.
    AsScenario,
    /// Uniform from limit to limit.
    WholeRange,
}

/// Two calibrations: with transmissions and without.
pub(crate) fn calibrate(scenario: &Scenario, seed: u64, sampling: StepOne) -> Result<Calibrated> {
    let mut first = scenario.clone();
    if sampling == StepOne::WholeRange {
        first.settings.sampling = Sampling::Uniform;
        first.settings.uniform_share = 1.0;
    }
    let (compensated, transmissions, _) = step_one(&first, seed)?;
    let fourth = transmissions.get(POLYNOMIAL);
    let range_rad = fourth.context("no fourth transmission")?.range_rad;
    let full = step_two(scenario, &compensated, seed)?;
    let alone = step_two(scenario, &scenario.nominal, seed)?.device;
    let rows = scenario.simulate(scenario.poses, seed)?;
    let outside = rows.joint[POLYNOMIAL].iter();
    Ok(Calibrated {
        seed,
        alone,
        range_rad,
        rows_outside: outside.filter(|at| is_outside(**at, range_rad)).count(),
        fitted: fitted(&transmissions, &full),
        full: full.device,
    })
}

fn fitted(transmissions: &[TransmissionFit], kinematics: &ParameterFit) -> usize {
    let fits = transmissions.iter().filter_map(|fit| fit.fit.as_ref());
    kinematics.fitted.len() + fits.map(|fit| fit.fitted.len()).sum::<usize>()
}

fn is_outside(reading: f64, range: [f64; 2]) -> bool {
    !(range[0]..=range[1]).contains(&reading)
}

/// Calibrations of many seeds; those that found no minimum are missing.
pub(crate) fn calibrations(
    scenario: &Scenario,
    first_seed: u64,
    seeds: usize,
    sampling: StepOne,
    progress: &Progress,
) -> Vec<Calibrated> {
    let of_seed = |index| calibrate(scenario, first_seed.wrapping_add(index), sampling);
    let progress = progress.over(seeds, of_seed).into_iter().flatten();
    progress.collect()
}

/// The forces of the three controllers of one seed.
fn sample(scenario: &Scenario, calibrated: &Calibrated, gain: f64) -> Result<Sample> {
    let controllers = [&scenario.nominal, &calibrated.alone, &calibrated.full];
    let recording = poses(scenario, calibrated.seed)?;
    let (forces, rows) = transverse_n(&scenario.truth, &controllers, &recording, gain)?;
    let mut forces = forces.into_iter();
    Ok(Sample {
        transverse_n: std::array::from_fn(|_| forces.next().unwrap_or_default()),
        left_out: recording.len() - rows.len(),
        outside: rows
            .iter()
            .map(|&row| is_outside(recording.joint[POLYNOMIAL][row], calibrated.range_rad))
            .collect(),
        rows_outside: calibrated.rows_outside,
        fitted: calibrated.fitted,
    })
}

/// Whether the loop comes to no rest, pose by pose as in [`Sample`], with the nominal model and with the
/// calibrated one; one entry for each calibration.
pub(crate) fn unsettled(
    scenario: &Scenario,
    calibrated: &[Calibrated],
    axis: &Axis,
    gain: f64,
) -> Result<Vec<[Vec<bool>; 2]>> {
    let of_one = |calibrated: &Calibrated| -> Result<[Vec<bool>; 2]> {
        let recording = poses(scenario, calibrated.seed)?;
        let of = |controller: &Device| -> Result<Vec<bool>> {
            let found = in_each(&scenario.truth, controller, &recording, |truth, at| {
                let known = transmission(truth, at);
                Ok(known.map(|known| !settles(axis, &known.matrix, gain)))
            })?;
            Ok(found.into_iter().flatten().collect())
        };
        Ok([of(&scenario.nominal)?, of(&calibrated.full)?])
    };
    calibrated.par_iter().map(of_one).collect()
}

/// One truth, one loop, one way to calibrate.
#[derive(Debug)]
pub(crate) struct Kind {
    pub(crate) name: String,
    pub(crate) samples: Vec<Sample>,
}

impl Kind {
    pub(crate) fn new(
        name: &str,
        scenario: &Scenario,
        calibrated: &[Calibrated],
        gain: f64,
    ) -> Result<Self> {
        let of_one = |calibrated| sample(scenario, calibrated, gain);
        Ok(Self {
            name: name.to_owned(),
            samples: calibrated.par_iter().map(of_one).collect::<Result<_>>()?,
        })
    }

    pub(crate) fn ratios(&self, ratio: impl Fn(&Sample) -> Result<f64>) -> Result<Vec<f64>> {
        self.samples.iter().map(ratio).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::truth;
    use crate::published::Paper;
    use crate::scenario::nominal_device;

    fn scenario() -> Scenario {
        let paper = Paper::load().unwrap();
        let nominal = truth::nominal(nominal_device(None).unwrap());
        let mut scenario = Scenario::paper(nominal, &paper, false).unwrap();
        scenario.truth = truth::true_device(&scenario.nominal, &paper).unwrap();
        scenario
    }

    /// A controller that knows the device makes the hand feel the wall's force along +z and nothing else, in
    /// every pose and for every gain.
    #[test]
    fn a_known_device_pushes_along_plus_z() {
        let scenario = scenario();
        let recording = poses(&scenario, 1).unwrap();
        let (mut truth, mut same) = (
            Evaluation::new(&scenario.truth),
            Evaluation::new(&scenario.truth),
        );
        let mut seen = 0;
        for row in 0..recording.len() {
            let readings = readings(&recording, row);
            truth.move_to(&readings).unwrap();
            same.move_to(&readings).unwrap();
            for gain in [0.0, 0.5, 5.0] {
                let Some(force) = measured_n(&truth, &same, gain).unwrap() else {
                    continue;
                };
                // lu of a matrix of condition up to 300
                assert!((force - Vector3::new(0.0, 0.0, WALL_FORCE_N)).norm() < 1e-11);
                seen += 1;
            }
        }
        assert!(seen > 250, "{seen}");
    }

    /// What the drives put in comes out at the handle: with torques Jhat^T W of the controller's model, worked
    /// out from its twists, and M W the true wrench, tau^T dq = (M W)^T J dq for the true device and any dq.
    #[test]
    fn the_power_of_the_drives_is_that_of_the_handle() {
        let scenario = scenario();
        let recording = poses(&scenario, 2).unwrap();
        for controller in [&scenario.truth, &scenario.nominal] {
            let (mut truth, mut at) = (
                Evaluation::new(&scenario.truth),
                Evaluation::new(controller),
            );
            for row in 0..recording.len() {
                let readings = readings(&recording, row);
                truth.move_to(&readings).unwrap();
                at.move_to(&readings).unwrap();
                let Some(found) = transmission(&truth, &at) else {
                    continue;
                };
                let wanted = nalgebra::Vector6::new(0.4, -0.7, 2.0, 0.03, 0.05, -0.02);
                let exerted = found.wrench(&wanted);
                let (mut drives_w, mut handle_w) = (0.0, 0.0);
                for (joint, rate) in FREE.into_iter().zip([0.3, -0.8, 0.5, 1.1, -0.6, 0.9]) {
                    let power = |evaluation: &Evaluation<'_>, w: &nalgebra::Vector6<f64>| {
                        let twist = evaluation.reading_twist(joint);
                        rate * (twist.linear.dot(&w.fixed_rows::<3>(0))
                            + twist.angular.dot(&w.fixed_rows::<3>(3)))
                    };
                    drives_w += power(&at, &wanted);
                    handle_w += power(&truth, &exerted);
                }
                assert!((drives_w - handle_w).abs() < 1e-12 * 10.0, "row {row}");
            }
        }
    }

    /// Step 1 over the whole range sees what the poses reach.
    #[test]
    fn a_swept_range_is_wider() {
        let scenario = scenario();
        let drawn = calibrate(&scenario, 3, StepOne::AsScenario).unwrap();
        let swept = calibrate(&scenario, 3, StepOne::WholeRange).unwrap();
        assert!(swept.range_rad[0] < drawn.range_rad[0] && swept.range_rad[1] > drawn.range_rad[1]);
        assert!(swept.rows_outside <= drawn.rows_outside && swept.fitted == drawn.fitted);
    }
}
