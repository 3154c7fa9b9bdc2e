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
        let points = along(0.0, LARGEST_GAIN, |gain| {
            axis.spectral_radius(&Law::proportional(gain))
        });
        radius
            .series
            .push(Series::new(&name, Mark::Line, colour, points));
        let (low, high) = DAMPING_RANGE;
        let points = along(low, high, |damping| {
            Axis::new(stiffness, damping).largest_gain()
        });
        largest
            .series
            .push(Series::new(&name, Mark::Line, colour, points));
        let limit = axis.largest_gain();
        let label = format!("limit {limit:.3}");
        let at_one = vec![(limit, 1.0)];
        radius
            .series
            .push(Series::new(label, Mark::Points, colour, at_one));
        let assumed = vec![(DAMPING, limit)];
        let label = if colour == 0 {
            "damping as assumed"
        } else {
            ""
        };
        largest
            .series
            .push(Series::new(label, Mark::Points, colour, assumed));
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
    for (label, mark, colour, points) in [
        (
            "exerted by the drives, P",
            Mark::Line,
            0,
            course(proportional, |at| at.drives_n),
        ),
        (
            "exerted by the drives, PI",
            Mark::Line,
            1,
            course(integral, |at| at.drives_n),
        ),
        (
            "wanted by the wall, P",
            Mark::DashedLine,
            5,
            course(proportional, |at| at.wanted_n),
        ),
        (
            "wanted by the wall, PI",
            Mark::DashedLine,
            4,
            course(integral, |at| at.wanted_n),
        ),
    ] {
        letting_go
            .series
            .push(Series::new(label, mark, colour, points));
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
    let found: Vec<(f64, f64, f64)> = along(0.0, end_s, |x| x)
        .into_iter()
        .step_by(4)
        .map(|(derivative_s, _)| {
            let law = Law {
                derivative_s,
                ..Law::proportional(gain)
            };
            let found = noise(&axis, &law, seed);
            (
                1e3 * derivative_s,
                1e3 * found.command_n,
                1e3 * found.handle_n,
            )
        })
        .collect();
    let points = |of: fn(&(f64, f64, f64)) -> f64| found.iter().map(|at| (at.0, of(at))).collect();
    noisy.series.push(Series::new(
        "commanded force",
        Mark::Line,
        1,
        points(|at| at.1),
    ));
    noisy.series.push(Series::new(
        "force at the handle",
        Mark::Line,
        0,
        points(|at| at.2),
    ));
    FigureGrid::new("Why the law is proportional", 1, vec![letting_go, noisy])
}
