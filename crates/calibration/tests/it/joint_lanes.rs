//! The joint problem in lanes against the same problem row by row, and against the best dense path.

use haptical_calibration::{Channel, DeviceProblem, ReducedProblem, Weights, channels};
use haptical_identification::{Matrix, Problem, Settings, evaluate_jacobian, solve};
use haptical_model::kinematics::Convention;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, JointType, ParameterId, Recording, TransmissionError};
use haptical_simulator::Noise;

use crate::chain::{Rig, cable_at, measure, pseudo_random};
use crate::dense::Dense;
use crate::haptic;

/// The bar: relative, of parameters (of 1e-3 at least, in m, rad or 1) and of the cost.
const SAME_ANSWER: f64 = 1e-9;
/// Products of columns, relative to the columns' sizes: a distance of half a metre is rounded by 1e-16 m, its
/// standard deviation is 1e-5 m.
const ROUNDING: f64 = 2e-11;

/// 60 s at 100 rows a second, from the two-step solution.
#[test]
fn ours_and_the_dense_path_give_the_same_answer() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), 6000, 7, Noise::Gaussian);
    let joint = haptic::joint_problem(&nominal, &recording);
    let (device, channels) = (&joint.device, &joint.channels);
    let problem = DeviceProblem::new(
        device,
        &recording,
        channels,
        &joint.parameters,
        &joint.weights,
    );
    let problem = problem.unwrap();
    let ours = ReducedProblem::new(&problem);
    let (start, settings) = (problem.start(), Settings::default());
    let found = solve(&ours, &start, &joint.free, &settings).unwrap();
    let dense = solve(&Dense(&ours), &start, &joint.free, &settings).unwrap();
    assert!(found.convergence.was_successful() && dense.convergence.was_successful());
    assert!(found.iterations > 0);
    assert!((found.cost / dense.cost - 1.0).abs() < SAME_ANSWER);
    for (a, b) in found.parameters.iter().zip(&dense.parameters) {
        assert!((a - b).abs() < SAME_ANSWER * b.abs().max(1e-3), "{a} {b}");
    }
    // and what is left is that of the device row by row
    let mut residuals = vec![0.0; problem.residual_count()];
    problem
        .evaluate(&found.parameters, &mut residuals, None)
        .unwrap();
    let square: f64 = residuals.iter().map(|each| each * each).sum();
    assert!((square / found.cost - 1.0).abs() < SAME_ANSWER);
}

/// `[A r]^T [A r]` of a problem's derivatives A and residuals r.
fn products(problem: &dyn Problem, values: &[f64], free: &[usize]) -> Matrix {
    let (jacobian, residuals) = evaluate_jacobian(problem, values, free).unwrap();
    let column = |k: usize| {
        if k == free.len() {
            &residuals
        } else {
            jacobian.column(k)
        }
    };
    Matrix::from_fn(free.len() + 1, free.len() + 1, |a, b| {
        column(a).iter().zip(column(b)).map(|(x, y)| x * y).sum()
    })
}

fn assert_same_products(problem: &DeviceProblem<'_>, values: &[f64], free: &[usize]) {
    let expected = products(problem, values, free);
    let reduced = ReducedProblem::new(problem);
    let anew = products(&reduced, values, free);
    // of all parameters at the same values, the triangle serves those of some
    let all: Vec<usize> = (0..problem.parameter_count()).collect();
    products(&reduced, values, &all);
    let from_all = products(&reduced, values, free);
    for found in [anew, from_all] {
        for a in 0..=free.len() {
            for b in 0..=free.len() {
                let size = (expected[(a, a)] * expected[(b, b)]).sqrt();
                let apart = (expected[(a, b)] - found[(a, b)]).abs();
                assert!(
                    apart <= ROUNDING * size,
                    "{a} and {b}: {apart:e} of {size:e}"
                );
            }
        }
    }
}

/// Four joints, one of them a slide, with every law of a transmission, measured by encoders and two cables.
fn device(convention: Convention) -> Device {
    let link = |row: usize| haptical_model::kinematics::Link {
        a_m: 0.11 + 0.03 * row as f64,
        alpha_rad: [0.7, -1.2, 0.9, 1.3, -0.4][row],
        d_m: 0.2 - 0.02 * row as f64,
        theta_rad: 0.3 * row as f64,
        ..Default::default()
    };
    let mut device = crate::chain::device_of((0..5).map(link).collect());
    device.convention = convention;
    device.cables.push(cable_at([0.4, -0.2, 0.1]));
    let capstan = CapstanError::from_polar(1e-3, 0.07, 4e-4, 0.7, 2e-5, -2.0);
    for (index, joint) in device.joints.iter_mut().enumerate() {
        joint.home_rad = 0.1 * index as f64;
        joint.external_encoder_sd_rad = Some(1e-4);
        joint.transmission_ratio = 8.0;
        joint.drum_distance_m = Some(0.07);
        joint.encoder_counts_per_rev = Some(20_000.0);
        joint.transmission_error = match index {
            0 => TransmissionError::Capstan(capstan),
            // some readings lie beyond, on the tangents
            1 => TransmissionError::Chebyshev {
                range_rad: [-0.9, 1.2],
                coefficients: vec![0.004, -0.011, 0.006, 0.002],
            },
            // nearly off its axis: no series for the small angles
            2 => TransmissionError::Capstan(CapstanError {
                output_drum_xy_m: [0.02, -0.01],
                ..capstan
            }),
            _ => {
                joint.joint_type = JointType::Prismatic;
                TransmissionError::default()
            }
        };
    }
    device
}

fn recording(device: &Device, rows: usize) -> Recording {
    let mut other = device.clone();
    for link in &mut other.links {
        link.alpha_rad += 2e-3;
        link.d_m += 1e-3;
    }
    let mut recording = measure(&other, Rig::Cable, rows, 3);
    recording.output = recording.joint.iter().cloned().map(Some).collect();
    // readings that are not there
    let gap = |column: &mut Vec<f64>, seed: u64| {
        for (row, value) in column.iter_mut().enumerate() {
            if pseudo_random(seed, row as u64) > 0.6 {
                *value = f64::NAN;
            }
        }
    };
    gap(recording.cable_m[1].as_mut().unwrap(), 5);
    gap(recording.output[0].as_mut().unwrap(), 6);
    recording
}

fn parameters(device: &Device) -> Vec<ParameterId> {
    let mut parameters: Vec<ParameterId> = (0..3)
        .flat_map(|joint| device.transmission_parameters(joint))
        .collect();
    parameters.extend(device.link_parameters(false));
    // one that only stands for its joint in the chain rule
    parameters.retain(|id| id.name(device) != "theta1");
    parameters
}

#[test]
fn lanes_keep_the_products_of_rows() {
    for convention in [Convention::Standard, Convention::Modified] {
        let device = device(convention);
        let parameters = parameters(&device);
        for rows in [70, 3072, 3073, 7000] {
            let recording = recording(&device, rows);
            let channels = channels(&device, &recording).unwrap();
            let cables = channels
                .iter()
                .filter(|channel| matches!(channel, Channel::Cable { .. }));
            assert_eq!((channels.len(), cables.count()), (6, 2));
            let weights = Weights::stated(&device, &channels);
            let problem =
                DeviceProblem::new(&device, &recording, &channels, &parameters, &weights).unwrap();
            let mut values = problem.start();
            for (index, value) in values.iter_mut().enumerate() {
                *value += 1e-5 * pseudo_random(8, index as u64);
            }
            // in another order, some held
            let free: Vec<usize> = (0..parameters.len())
                .rev()
                .filter(|index| index % 5 != 2)
                .filter(|&index| has_effect(&problem, &values, index))
                .collect();
            assert_same_products(&problem, &values, &free);
        }
    }
}

/// A turn about an axis through the exit or the handle has none but rounding, which no form shares.
fn has_effect(problem: &DeviceProblem<'_>, values: &[f64], index: usize) -> bool {
    let (jacobian, _) = evaluate_jacobian(problem, values, &[index]).unwrap();
    jacobian.column(0).iter().any(|each| each.abs() > 1e-6)
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let device = device(Convention::Standard);
    let recording = recording(&device, 7000);
    let channels = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &channels);
    let parameters = parameters(&device);
    let free: Vec<usize> = (0..parameters.len()).collect();
    let found: Vec<(Matrix, Vec<f64>)> = [1, 2, 3]
        .into_iter()
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let problem =
                    DeviceProblem::new(&device, &recording, &channels, &parameters, &weights);
                let problem = problem.unwrap();
                let merged = ReducedProblem::new(&problem);
                evaluate_jacobian(&merged, &problem.start(), &free).unwrap()
            })
        })
        .collect();
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
}

/// What the lanes refuse is told with its line of the log.
#[test]
fn a_refused_row_is_named() {
    let device = device(Convention::Standard);
    let recording = recording(&device, 100);
    let channels = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &channels);
    let parameters = parameters(&device);
    let problem = DeviceProblem::new(&device, &recording, &channels, &parameters, &weights);
    let problem = problem.unwrap();
    let merged = ReducedProblem::new(&problem);
    let mut values = problem.start();
    // the drum's centre beyond the other drum's axis
    values[2] = 0.2;
    let error = evaluate_jacobian(&merged, &values, &[0]).unwrap_err();
    assert!(error.to_string().contains("line 2 of the log"), "{error}");
    assert!(merged.visit(&values, &[0], |_| {}).is_err());
}
