//! Analytic derivatives of every channel against central differences.

use haptical_calibration::{Channel, DeviceProblem, Weights, channels};
use haptical_identification::worst_derivative;
use haptical_model::kinematics::{Convention, Link};
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, JointType, ParameterId, TransmissionError};

use crate::chain::{Rig, cable_at, device_of, measure};

/// Step of the differences, in rad and m.
const STEP: f64 = 1e-5;
/// Second order of the step times derivatives of up to 1e4 (eccentricities over 3 cm), and
/// rounding over the step.
const TOLERANCE: f64 = 1e-6;

/// Four joints with every kind of transmission error, one of them prismatic, far from home.
fn device(convention: Convention) -> Device {
    let link = |row: usize| Link {
        a_m: 0.11 + 0.05 * row as f64,
        alpha_rad: [0.7, -1.1, 0.0, 0.9, 0.4][row],
        d_m: 0.2 - 0.06 * row as f64,
        theta_rad: 0.3 * row as f64,
        beta_rad: 0.02 * row as f64,
        b_m: 0.0,
    };
    let mut device = device_of((0..5).map(link).collect());
    device.convention = convention;
    device.cables.push(cable_at([0.4, -0.3, 0.2]));
    device.joints[2].joint_type = JointType::Prismatic;
    let capstan = CapstanError::from_array([0.01, 0.1, 4e-4, -3e-4, 2e-5, 1e-5]);
    for joint in &mut device.joints {
        joint.transmission_ratio = 8.0;
        joint.drum_distance_m = Some(0.0675);
        joint.encoder_counts_per_rev = Some(20_000.0);
        joint.external_encoder_sd_rad = Some(1e-4);
    }
    device.joints[0].transmission_error = TransmissionError::Capstan(capstan);
    device.joints[1].transmission_error = TransmissionError::Chebyshev {
        range_rad: [-1.6, 1.6],
        coefficients: vec![0.01, -0.02, 0.005, 0.003],
    };
    device.joints[3].parallelogram_lengths_m = Some([0.18, 0.076, 0.18, 0.076]);
    device.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan,
        length_deviations_m: [-5e-4, -7e-4, 2e-4, 1e-4],
    };
    device
}

#[test]
fn every_channel_has_the_derivatives_of_its_residuals() {
    for convention in [Convention::Standard, Convention::Modified] {
        let device = device(convention);
        let mut parameters = device.link_parameters(true);
        parameters.extend((0..4).flat_map(|joint| device.transmission_parameters(joint)));
        // Measured on another device, so that no residual is near zero: the turns between the two
        // orientations are up to a radian.
        let mut other = device.clone();
        for link in &mut other.links {
            link.alpha_rad += 0.12;
            link.theta_rad -= 0.15;
            link.d_m += 0.05;
        }
        let mut recording = measure(&other, Rig::Pose, 25, 3);
        recording.cable_m = measure(&other, Rig::Cable, 25, 3).cable_m;
        // The parallelogram's loop closes within +-1 rad.
        recording.joint[3]
            .iter_mut()
            .for_each(|reading| *reading *= 0.5);
        recording.output = recording.joint.iter().cloned().map(Some).collect();
        let found = channels(&device, &recording).unwrap();
        assert_eq!(found.len(), 4 + 2 + 2);
        let weights = Weights::stated(&device, &found);
        for channel in found {
            // Turns about an axis through the exit or the handle: rounding has no relative error.
            let no_effect: Vec<&str> = match (convention, channel) {
                (Convention::Standard, Channel::Cable { index: 0 }) => vec!["theta0"],
                (Convention::Modified, Channel::Cable { index: 0 }) => vec!["alpha0", "theta4"],
                (Convention::Modified, Channel::Cable { .. } | Channel::Position) => vec!["theta4"],
                _ => vec![],
            };
            let parameters: Vec<ParameterId> = parameters
                .iter()
                .copied()
                .filter(|id| match id {
                    ParameterId::Transmission { joint: 3, .. } => !no_effect.contains(&"theta4"),
                    _ => !no_effect.contains(&id.name(&device).as_str()),
                })
                .collect();
            let problem =
                DeviceProblem::new(&device, &recording, &[channel], &parameters, &weights).unwrap();
            let worst = worst_derivative(&problem, &problem.start(), STEP).unwrap();
            assert!(
                worst.relative < TOLERANCE,
                "{}, {}: {} for {}",
                channel.name(),
                parameters[worst.parameter].name(&device),
                worst.analytic,
                worst.numeric
            );
        }
    }
}

/// Each channel's standard deviation holds its own noise and the rounded readings':
/// var = sd^2 + sum (df/dtheta)^2 q^2 / 12, with df/dtheta by differences.
#[test]
fn residual_deviations_hold_the_rounding_of_the_readings() {
    let device = device(Convention::Standard);
    let recording = measure(&device, Rig::Cable, 25, 3);
    let mut readings = recording.joint.clone();
    readings[3].iter_mut().for_each(|reading| *reading *= 0.5);
    let recording = crate::chain::measure_at(&device, Rig::Cable, readings);
    let channel = Channel::Cable { index: 1 };
    let weights = Weights::stated(&device, &[channel]);
    let found = weights.residual_sd(&device, &recording, channel).unwrap();
    let step = 1e-6;
    let mut expected = vec![1e-5_f64.powi(2); 25];
    for joint in 0..4 {
        let moved = |by: f64| {
            let mut readings = recording.joint.clone();
            readings[joint]
                .iter_mut()
                .for_each(|reading| *reading += by);
            crate::chain::measure_at(&device, Rig::Cable, readings).cable_m[1]
                .clone()
                .unwrap()
        };
        let quantum = std::f64::consts::TAU / 20_000.0 / 8.0;
        for (row, (a, b)) in moved(step).into_iter().zip(moved(-step)).enumerate() {
            let slope = (a - b) / (2.0 * step);
            expected[row] += slope * slope * quantum * quantum / 12.0;
        }
    }
    for (have, want) in found.iter().zip(expected) {
        assert!(
            (have / want.sqrt() - 1.0).abs() < 1e-6,
            "{have} for {}",
            want.sqrt()
        );
    }
    let doubled = Weights {
        factor: [(channel, 2.0)].into(),
        ..weights
    };
    let twice = doubled.residual_sd(&device, &recording, channel).unwrap();
    assert!(
        twice
            .iter()
            .zip(&found)
            .all(|(a, b)| (a / b - 2.0).abs() < 1e-12)
    );
}
