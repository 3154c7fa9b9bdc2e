//! Measurement kinds other than cables and encoders: derivatives of each, by rows and reduced.

use haptical_calibration::{Channel, DeviceProblem, Weights, candidate_parameters, channels};
use haptical_identification::{Matrix, Problem, evaluate_jacobian, worst_derivative};
use haptical_model::kinematics::Convention;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, ParameterId, Recording, SurroundingParameter, TransmissionError};

use crate::chain::pseudo_random;
use crate::rig_scene::{general, placement, plain, readings, table, tracked, with_everything};

/// Step of the differences, in rad and m.
const STEP: f64 = 1e-5;
/// Second order of the step times second derivatives of up to 1e3, and rounding over the step.
const TOLERANCE: f64 = 2e-6;

/// Every column that any kind reads, with residuals far from zero.
fn every_column(device: &Device, rows: usize) -> Recording {
    let mut recording = plain(readings(device, rows, 1.2, 5));
    let mut other = device.clone();
    other.surroundings.tracker_base = Some(placement(11, 1.0, 0.0));
    tracked(&other, &mut recording, 0.0, 1);
    recording.cable_m = vec![Some(vec![0.6; rows])];
    let ids = |a: &str, b: &str| {
        (0..rows)
            .map(|row| [a, b, ""][row % 3].to_owned())
            .collect::<Vec<String>>()
    };
    recording.contact = Some(ids("left", "right"));
    recording.plane = Some(ids("wall", "table"));
    for (joint, column) in recording.torque_nm.iter_mut().enumerate() {
        let torque = |row: usize| 10.0 * pseudo_random(joint as u64, row as u64);
        *column = Some((0..rows).map(torque).collect());
    }
    recording.covariates = (1..=device.joints.len())
        .map(|number| (format!("fixture{number}_rad"), vec![0.1; rows]))
        .collect();
    recording
}

#[test]
fn every_kind_has_the_derivatives_of_its_residuals() {
    let mut modified = table(5);
    modified.convention = Convention::Modified;
    let capstan = CapstanError::from_array([0.01, 0.1, 4e-4, -3e-4, 2e-5, 1e-5]);
    for mut device in [table(5), modified, general()] {
        device.joints[1].transmission_error = TransmissionError::Capstan(capstan);
        device.joints[1].transmission_ratio = 8.0;
        device.joints[1].drum_distance_m = Some(0.0675);
        let device = with_everything(device);
        let recording = every_column(&device, 24);
        let mut parameters = candidate_parameters(&device);
        parameters.extend(device.transmission_parameters(1));
        let found = channels(&device, &recording).unwrap();
        assert_eq!(found.len(), 1 + 2 + 2 + 2 + device.joints.len());
        let weights = Weights::stated(&device, &found);
        for channel in found {
            let build = |parameters: &[ParameterId]| -> Vec<bool> {
                let problem =
                    DeviceProblem::new(&device, &recording, &[channel], parameters, &weights);
                let problem = problem.unwrap();
                let all: Vec<usize> = (0..parameters.len()).collect();
                let (jacobian, _) = evaluate_jacobian(&problem, &problem.start(), &all).unwrap();
                let sizes = all.iter().map(|&column| {
                    let entries = jacobian.column(column).iter();
                    entries.fold(0.0_f64, |most, entry| most.max(entry.abs()))
                });
                let sizes: Vec<f64> = sizes.collect();
                let most = sizes.iter().fold(0.0_f64, |most, size| most.max(*size));
                sizes.iter().map(|size| *size > 1e-9 * most).collect()
            };
            // what a channel does not see has rounding for its derivative
            let seen = build(&parameters);
            let effective: Vec<ParameterId> = parameters
                .iter()
                .zip(&seen)
                .filter_map(|(parameter, seen)| seen.then_some(*parameter))
                .collect();
            assert!(!effective.is_empty(), "{} sees nothing", channel.name());
            let problem =
                DeviceProblem::new(&device, &recording, &[channel], &effective, &weights).unwrap();
            let worst = worst_derivative(&problem, &problem.start(), STEP).unwrap();
            assert!(
                worst.relative < TOLERANCE,
                "{}, {}: {} for {}",
                channel.name(),
                effective[worst.parameter].name(&device),
                worst.analytic,
                worst.numeric
            );
            unseen_stay(&device, &recording, channel, &parameters, &seen, &weights);
        }
    }
}

/// A parameter without a derivative changes no residual: whether a channel can see it is not told too narrowly.
fn unseen_stay(
    device: &Device,
    recording: &Recording,
    channel: Channel,
    parameters: &[ParameterId],
    seen: &[bool],
    weights: &Weights,
) {
    let problem = DeviceProblem::new(device, recording, &[channel], parameters, weights).unwrap();
    let start = problem.start();
    let residuals = |values: &[f64]| {
        let mut residuals = vec![0.0; problem.residual_count()];
        problem.evaluate(values, &mut residuals, None).unwrap();
        residuals
    };
    let before = residuals(&start);
    for index in (0..parameters.len()).filter(|index| !seen[*index]) {
        let mut moved = start.clone();
        moved[index] += 1e-3;
        for (a, b) in before.iter().zip(residuals(&moved)) {
            assert!(
                (a - b).abs() <= 1e-9 * (1.0 + a.abs()),
                "{} does move {}",
                parameters[index].name(device),
                channel.name()
            );
        }
    }
}

/// The general form and that reduced channel by channel are the same problem, pairs and touches included.
#[test]
fn reduced_and_row_by_row_forms_agree() {
    let device = with_everything(table(5));
    let recording = every_column(&device, 60);
    let parameters = candidate_parameters(&device);
    let found = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &found);
    let problem = DeviceProblem::new(&device, &recording, &found, &parameters, &weights).unwrap();
    let reduced = haptical_calibration::ReducedProblem::new(&problem);
    let all: Vec<usize> = (0..parameters.len()).collect();
    let square = |jacobian: &Matrix, a: usize, b: usize| -> f64 {
        jacobian
            .column(a)
            .iter()
            .zip(jacobian.column(b))
            .map(|(x, y)| x * y)
            .sum()
    };
    let (whole, residuals) = evaluate_jacobian(&problem, &problem.start(), &all).unwrap();
    let (small, rest) = evaluate_jacobian(&reduced, &problem.start(), &all).unwrap();
    let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
    assert!((norm(&residuals) / norm(&rest) - 1.0).abs() < 1e-12);
    for a in 0..all.len() {
        for b in 0..all.len() {
            let size = (square(&whole, a, a) * square(&whole, b, b)).sqrt();
            let (x, y) = (square(&whole, a, b), square(&small, a, b));
            assert!((x - y).abs() <= 1e-10 * size, "{x} and {y}");
        }
    }
    let of_tracker = ParameterId::Surrounding(SurroundingParameter::TrackerBase { index: 0 });
    assert!(parameters.contains(&of_tracker));
}
