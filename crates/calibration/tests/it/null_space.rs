//! Dropping a pruned parameter loses nothing: no prediction changes and no fit gets worse.

use haptical_calibration::DeviceProblem;
use haptical_identification::{Problem, Settings, Status, solve};
use haptical_model::Device;
use proptest::prelude::*;

use crate::chain::{RIGS, ROWS, Rig, columns, generic_chain, judge, measure, pseudo_random};

/// Step along the null space, in the parameters' own units (rad and m).
const STEP: f64 = 1e-4;
/// A central difference leaves the third order: STEP^2 times derivatives of at most 1e3.
const SHARE: f64 = 1e-5;
/// Both fits end at the same minimum, which the stopping rule finds to 1e-16 of the cost; the
/// linearised gauge leaves its second order.
const COST_TOLERANCE: f64 = 1e-9;

fn evaluate(problem: &DeviceProblem<'_>, values: &[f64]) -> Vec<f64> {
    let mut residuals = vec![0.0; problem.residual_count()];
    problem.evaluate(values, &mut residuals, None).unwrap();
    residuals
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A random mixture of the pruned parameters, each with its combination undone, moves nothing.
    #[test]
    fn the_null_space_changes_no_prediction(device in generic_chain(2..=5), rig in 0..2_usize, seed: u64) {
        let recording = measure(&device, RIGS[rig], ROWS, seed);
        let judged = judge(&device, &recording);
        let found = columns(&device, &recording);
        let problem = DeviceProblem::new(
            &device, &recording, &found.channels, &found.parameters, &found.weights).unwrap();
        let (mut direction, mut alone) = (vec![0.0; found.parameters.len()], 0.0_f64);
        for (index, status) in judged.statuses.iter().enumerate() {
            let amount = pseudo_random(seed, index as u64);
            match status {
                Status::Invisible => direction[index] += amount,
                Status::Dependent { combination } => {
                    direction[index] += amount;
                    for term in combination {
                        direction[term.parameter] -= amount * term.coefficient;
                    }
                    alone = alone.max(amount.abs() * norm(found.jacobian.column(index)));
                }
                _ => {}
            }
        }
        let at = |factor: f64| {
            let start = problem.start();
            let values: Vec<f64> = start.iter().zip(&direction).map(|(v, d)| v + factor * STEP * d).collect();
            evaluate(&problem, &values)
        };
        let slope: Vec<f64> = at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        // Positions have nothing but an invisible twist: compare with what any column does.
        let size = if alone > 0.0 { alone } else { norm(found.jacobian.column(0)) };
        let length = norm(&direction).max(1.0);
        prop_assert!(norm(&slope) < SHARE * size * length.powi(3), "{} of {}", norm(&slope), size);
    }

    /// The fit over all parameters reaches no lower cost than the fit over the kept ones.
    #[test]
    fn a_fit_without_the_pruned_is_as_good(device in generic_chain(2..=4), seed: u64) {
        let mut truth: Device = device.clone();
        for (row, link) in truth.links.iter_mut().enumerate() {
            let amount = |k: u64| 2e-3 * pseudo_random(seed ^ 5, 4 * row as u64 + k);
            link.a_m += amount(0);
            link.alpha_rad += amount(1);
            link.d_m += amount(2);
            link.theta_rad += amount(3);
        }
        let mut recording = measure(&truth, Rig::Cable, ROWS, seed);
        for (row, value) in recording.cable_m[0].iter_mut().flatten().enumerate() {
            *value += 2e-5 * pseudo_random(seed ^ 6, row as u64);
        }
        let found = columns(&device, &recording);
        let problem = DeviceProblem::new(
            &device, &recording, &found.channels, &found.parameters, &found.weights).unwrap();
        let kept = judge(&device, &recording).independent;
        let all: Vec<usize> = (0..found.parameters.len()).collect();
        let fit = |free: &[usize]| solve(&problem, &problem.start(), free, &Settings::default()).unwrap();
        let (without, with) = (fit(&kept), fit(&all));
        prop_assert!(without.convergence.was_successful(), "{}", without.convergence);
        prop_assert!(without.cost <= with.cost * (1.0 + COST_TOLERANCE),
            "{} without, {} with ({})", without.cost, with.cost, with.convergence);
    }
}
