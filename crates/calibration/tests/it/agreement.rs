//! Dense and reduced search end at the same parameters.

use haptical_calibration::{
    CalibrationMethod, DeviceProblem, ReducedProblem, Weighting, fit_device, identifiability_at,
    parameter_infos, preference_order,
};
use haptical_identification::{
    IdentifiabilityRules, Matrix, NoiseScale, Problem, Reduction, Settings, analyse,
    evaluate_jacobian, solve, uncertainty,
};
use haptical_simulator::Noise;

use crate::haptic;

/// The default, 1e-16, leaves up to 1e-8 sqrt(cost) standard deviations of the way.
const SEARCH_TO_ROUNDING: f64 = 1e-21;
/// Of a plausible size, with the search above: 3e-11 sqrt(cost) standard deviations, none of which
/// is above half a plausible size.
const PARAMETER_TOLERANCE: f64 = 1e-9;
/// Relative to the columns' sizes: two ways to a distance of half a metre differ by 1e-16 m, its standard
/// deviation is 1e-5 m.
const PRODUCT_TOLERANCE: f64 = 2e-11;
/// Relative: the cost is flat at the minimum.
const COST_TOLERANCE: f64 = 1e-9;

#[test]
fn dense_and_reduced_search_agree() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    for (rows, seed) in [(200, 1), (2000, 2), (20_000, 3)] {
        let recording = haptic::record(
            &haptic::truth_of(&nominal, 1.0),
            rows,
            seed,
            Noise::Gaussian,
        );
        let joint = haptic::joint_problem(&nominal, &recording);
        assert_eq!(joint.free.len(), 28 + 3 * 6 + 11);
        let problem = DeviceProblem::new(
            &joint.device,
            &recording,
            &joint.channels,
            &joint.parameters,
            &joint.weights,
        )
        .unwrap();
        let start = problem.start();
        let settings = Settings {
            cost_tolerance: SEARCH_TO_ROUNDING,
            ..Settings::default()
        };
        let dense = solve(&problem, &start, &joint.free, &settings).unwrap();
        let reduced = solve(
            &ReducedProblem::new(&problem),
            &start,
            &joint.free,
            &settings,
        )
        .unwrap();
        assert!(dense.convergence.was_successful(), "{}", dense.convergence);
        assert!(reduced.convergence.was_successful());
        assert!(
            (reduced.cost / dense.cost - 1.0).abs() < COST_TOLERANCE,
            "{rows} rows"
        );
        for (index, parameter) in joint.parameters.iter().enumerate() {
            let size = parameter.plausible_size(&joint.device);
            let difference = (reduced.parameters[index] - dense.parameters[index]) / size;
            assert!(
                difference.abs() < PARAMETER_TOLERANCE,
                "{rows} rows, {}: {difference:e} of its size",
                parameter.name(&joint.device)
            );
        }
        let all: Vec<usize> = (0..joint.free.len()).collect();
        let spread = |reduction| uncertainty(reduction, &all, 1.0, NoiseScale::Stated).unwrap();
        let (a, b) = (spread(&dense.reduction), spread(&reduced.reduction));
        for position in all.iter().copied() {
            let ratio = a.standard_deviation(position) / b.standard_deviation(position);
            assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        }
    }
}

/// `[J r]^T [J r]` is what the triangles must keep, over the chunks' edges and for few rows alike.
#[test]
fn triangles_keep_the_products_of_columns() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    for rows in [60, 512, 513, 1100] {
        let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), rows, 4, Noise::Gaussian);
        let joint = haptic::joint_problem(&nominal, &recording);
        let problem = DeviceProblem::new(
            &joint.device,
            &recording,
            &joint.channels,
            &joint.parameters,
            &joint.weights,
        )
        .unwrap();
        let reduced = ReducedProblem::new(&problem);
        let values = problem.start();
        let free = &joint.free[3..40];
        let product = |matrix: &Matrix, residuals: &[f64]| {
            let last = matrix.columns();
            let column = |k: usize| {
                if k == last {
                    residuals.to_vec()
                } else {
                    matrix.column(k).to_vec()
                }
            };
            Matrix::from_fn(last + 1, last + 1, |a, b| {
                column(a).iter().zip(column(b)).map(|(x, y)| x * y).sum()
            })
        };
        let (full, residuals) = evaluate_jacobian(&problem, &values, free).unwrap();
        let (few, rest) = evaluate_jacobian(&reduced, &values, free).unwrap();
        assert_eq!(few.rows(), reduced.residual_count());
        assert_eq!(few.rows(), joint.parameters.len() + 1);
        let (expected, found) = (product(&full, &residuals), product(&few, &rest));
        for a in 0..=free.len() {
            for b in 0..=free.len() {
                let size = (expected[(a, a)] * expected[(b, b)]).sqrt();
                let apart = (expected[(a, b)] - found[(a, b)]).abs() / size;
                assert!(
                    apart < PRODUCT_TOLERANCE,
                    "{rows} rows, {a} and {b}: {apart:e}"
                );
            }
        }
        let mut only = vec![f64::NAN; reduced.residual_count()];
        reduced.evaluate(&values, &mut only, None).unwrap();
        let sum: f64 = only.iter().map(|x| x * x).sum();
        assert!((sum / expected[(free.len(), free.len())] - 1.0).abs() < PRODUCT_TOLERANCE);
    }
}

/// A fit that is large enough for the reduced search counts its readings, not its triangles.
#[test]
fn degrees_of_freedom_count_readings() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    for rows in [40, 300] {
        let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), rows, 5, Noise::Gaussian);
        let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
        let fit = fit_device(&nominal, &recording, &options)
            .unwrap()
            .whole
            .unwrap();
        assert_eq!(fit.residuals.len(), 5 * rows);
        assert_eq!(
            fit.uncertainty.degrees_of_freedom,
            5 * rows - fit.fitted.len()
        );
        let square: f64 = fit.residuals.iter().map(|x| x * x).sum();
        assert!((square / fit.cost - 1.0).abs() < 1e-12);
        let paid: f64 = fit.channel_parameters.values().sum();
        assert!((paid - fit.fitted.len() as f64).abs() < 1e-6, "{paid}");
    }
}

/// The verdict on the triangles is the verdict on the full matrix, indices included.
#[test]
fn verdicts_are_those_of_the_full_matrix() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    for rows in [40, 300] {
        let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), rows, 5, Noise::Gaussian);
        let joint = haptic::joint_problem(&nominal, &recording);
        let (device, parameters) = (&joint.device, &joint.parameters);
        let (channels, weights) = (&joint.channels, &joint.weights);
        let rules = IdentifiabilityRules::default();
        let found =
            identifiability_at(device, &recording, channels, parameters, weights, &rules).unwrap();
        let problem =
            DeviceProblem::new(device, &recording, channels, parameters, weights).unwrap();
        let all: Vec<usize> = (0..parameters.len()).collect();
        let (jacobian, residuals) = evaluate_jacobian(&problem, &problem.start(), &all).unwrap();
        let expected = analyse(
            &Reduction::new(&jacobian, &residuals).unwrap(),
            &parameter_infos(device, parameters),
            &preference_order(parameters),
            &rules,
        )
        .unwrap();
        assert_eq!(found.independent, expected.independent);
        let (found, expected) = (
            found.observability.unwrap(),
            expected.observability.unwrap(),
        );
        for (a, b) in [
            (found.o1, expected.o1),
            (found.o2, expected.o2),
            (found.o3, expected.o3),
            (found.o4, expected.o4),
            (found.o5, expected.o5),
        ] {
            assert!((a / b - 1.0).abs() < 1e-9, "{a} for {b}");
        }
    }
}
