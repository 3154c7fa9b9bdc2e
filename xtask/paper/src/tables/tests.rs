//! The reproduction on a few seeds: enough to see a wrong sign, a wrong unit or a lost parameter.

use haptical_metrics::median;

use crate::monte_carlo::MonteCarlo;
use crate::published::Paper;
use crate::scenario::{Scenario, nominal_device};

const RUNS: usize = 12;

fn runs() -> (Paper, MonteCarlo) {
    let paper = Paper::load().unwrap();
    let scenario = Scenario::paper(nominal_device(None).unwrap(), &paper, false).unwrap();
    let assigned: Vec<(String, f64)> = paper
        .table3
        .iter()
        .map(|row| (row.name.clone(), row.assigned))
        .collect();
    let runs = MonteCarlo::new("test", &scenario, &assigned, 1, RUNS).unwrap();
    (paper, runs)
}

#[test]
fn every_run_identifies_the_28_parameters_within_its_own_bounds() {
    let (paper, runs) = runs();
    assert!(runs.failures.is_empty(), "{:?}", runs.failures);
    // Mean of squared normal deviates: 1, with sd sqrt(2 / 28 / RUNS) = 0.077 if all were
    // independent; parameters are correlated, so three times that on either side.
    let squares: Vec<f64> = runs
        .samples
        .iter()
        .flat_map(|sample| sample.errors_known_angles.iter().zip(&sample.bounds))
        .map(|(error, sd)| (error / sd).powi(2))
        .collect();
    assert_eq!(squares.len(), RUNS * paper.table3.len());
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!(
        (0.5..1.6).contains(&mean),
        "errors are {mean} times their stated variance"
    );
}

#[test]
fn distance_position_and_orientation_improve_as_the_geometry_allows() {
    let (_, runs) = runs();
    let middle = |pick: fn(&crate::monte_carlo::PoseSummary) -> f64| {
        median(
            &runs
                .samples
                .iter()
                .map(|sample| pick(&sample.pose))
                .collect::<Vec<f64>>(),
        )
        .unwrap()
    };
    let gain = |before: f64, after: f64| 100.0 * (1.0 - after / before);
    let distance = gain(middle(|p| p.distance_m[0]), middle(|p| p.distance_m[1]));
    assert!(distance > 99.0, "distance {distance} %");
    let before = middle(|p| p.position_m[0]);
    assert!((4e-3..6e-3).contains(&before), "position before {before} m");
    let rest = middle(|p| p.position_m[1]);
    // alpha0's 1.5 mrad turns the handle about x by its distance from that axis, about 0.25 m.
    assert!(
        (0.25e-3..0.45e-3).contains(&rest),
        "position after {rest} m"
    );
    let observable = gain(before, middle(|p| p.position_m[2]));
    assert!(observable > 99.0, "observable part {observable} %");
    let turned = middle(|p| p.orientation_rad[1]);
    // sqrt(1.5^2 + 1.7^2) = 2.3 mrad if alpha0 and alpha7 alone remained, at right angles.
    assert!(
        (1.7e-3..2.7e-3).contains(&turned),
        "orientation after {turned} rad"
    );
}

#[test]
fn published_tables_are_read_with_their_units() {
    let paper = Paper::load().unwrap();
    let row = paper
        .table3
        .iter()
        .find(|row| row.name == "alpha4")
        .unwrap();
    assert_eq!((row.assigned, row.identified), (1.2e-3, 1.424e-3));
    assert_eq!(paper.length_deviations_m, [-5e-4, -7e-4]);
}
