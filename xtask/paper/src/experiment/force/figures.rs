//! Figures of the loop: where it settles, and why the law is proportional.

use haptical_report::{Figure, FigureGrid, Mark, Series};

use super::closed_loop::{Axis, DAMPING, FIXTURE_N_PER_M, Law};
use super::figure12::SENSOR_SD_N;
use super::laws::{Instant, noise};

/// Fixtures that are compared \[N/m\]: softer, as assumed, stiffer.
pub(crate) const FIXTURES_N_PER_M: [f64; 3] = [5e3, FIXTURE_N_PER_M, 80e3];
/// Gains of the horizontal axis reach this.
const LARGEST_GAIN: f64 = 1.6;
/// Damping of the fixture's mode, from to.
const DAMPING_RANGE: (f64, f64) = (0.02, 1.0);
const STEPS: usize = 80;
/// Of the derivative's limit, the part that is drawn: at the limit the noise grows without end.
const DERIVATIVE_SHARE: f64 = 0.98;

fn along(from: f64, to: f64, of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    (0..=STEPS)
        .map(|step| from + (to - from) * step as f64 / STEPS as f64)
        .map(|x| (x, of(x)))
        .collect()
}

/// Spectral radius over the gain, and the largest gain over the damping, for the fixtures.
pub(crate) fn stability() -> FigureGrid {
    let mut radius = Figure::new(
        "The loop settles below 1",
        "gain G [1]",
        "spectral radius of the loop [1]",
    );
    let mut largest = Figure::new(
        "Largest gain that settles",
        "damping ratio of the fixture's mode [1]",
        "largest gain [1]",
    );
    largest.y_log = true;
    for (colour, stiffness) in FIXTURES_N_PER_M.into_iter().enumerate() {
        let name = format!("{:.0} kN/m", 1e-3 * stiffness);
        let axis = Axis::new(stiffness, DAMPING);
        let limit = axis.largest_gain();
        let of_gain = |gain| axis.spectral_radius(&Law::proportional(gain));
        radius.line(&name, colour, along(0.0, LARGEST_GAIN, of_gain));
        radius.points(format!("limit {limit:.3}"), colour, vec![(limit, 1.0)]);
        let (low, high) = DAMPING_RANGE;
        let of_damping = |damping| Axis::new(stiffness, damping).largest_gain();
        largest.line(&name, colour, along(low, high, of_damping));
        let label = ["damping as assumed", "", ""][colour];
        largest.points(label, colour, vec![(DAMPING, limit)]);
    }
    radius.series.push(Series::reference("", 6, 1.0));
    FigureGrid::new(
        "Stability of the proportional loop: 1 kHz, one sample of delay, 200 Hz actuators",
        1,
        vec![radius, largest],
    )
}

/// A hand that lets go under P and PI, and the noise under PD.
pub(crate) fn laws(
    proportional: &[Instant],
    integral: &[Instant],
    gain: f64,
    largest_derivative_s: f64,
    seed: u64,
) -> FigureGrid {
    let mut letting_go = Figure::new(
        "P and PI: held in the wall, then let go",
        "time [s]",
        "force along z [N]",
    );
    let course = |instants: &[Instant], of: fn(&Instant) -> f64| -> Vec<(f64, f64)> {
        instants.iter().map(|at| (at.time_s, of(at))).collect()
    };
    for (name, colour, instants) in [("P", 0, proportional), ("PI", 1, integral)] {
        let drives = course(instants, |at| at.drives_n);
        letting_go.line(format!("exerted by the drives, {name}"), colour, drives);
    }
    for (name, colour, instants) in [("P", 5, proportional), ("PI", 4, integral)] {
        let wanted = course(instants, |at| at.wanted_n);
        let label = format!("wanted by the wall, {name}");
        let series = Series::new(label, Mark::DashedLine, colour, wanted);
        letting_go.series.push(series);
    }
    let mut noisy = Figure::new(
        format!(
            "PD: what the sensor's noise of {:.0} mN becomes (G = {gain:.2}, limit at k_d = {:.1} ms)",
            1e3 * SENSOR_SD_N,
            1e3 * largest_derivative_s,
        ),
        "derivative gain k_d [ms]",
        "RMS [mN]",
    );
    noisy.y_log = true;
    let axis = Axis::new(FIXTURE_N_PER_M, DAMPING);
    let end_s = DERIVATIVE_SHARE * largest_derivative_s;
    let (mut commanded, mut at_handle) = (Vec::new(), Vec::new());
    for (derivative_s, _) in along(0.0, end_s, |x| x).into_iter().step_by(4) {
        let law = Law::proportional(gain).with_derivative(derivative_s);
        let found = noise(&axis, &law, seed);
        commanded.push((1e3 * derivative_s, 1e3 * found.command_n));
        at_handle.push((1e3 * derivative_s, 1e3 * found.handle_n));
    }
    noisy.line("commanded force", 1, commanded);
    noisy.line("force at the handle", 0, at_handle);
    FigureGrid::new("Why the law is proportional", 1, vec![letting_go, noisy])
}
