//! The 7-joint device of `fixtures/`, a true device near it, and the joint problem of both.

use haptical_calibration::{
    CalibrationMethod, Channel, Degree, HeldOut, Options, Weighting, Weights, candidate_parameters,
    channels, fit_device, identifiability_at,
};
use haptical_identification::Status;
use haptical_model::{Device, ParameterId, Recording, TransmissionError};
use haptical_simulator::{Noise, Settings, apply_deviations, simulate};

/// Deviations of the size of the paper's Tables 4 and 5, chosen by hand; rad and m.
pub(crate) const DEVIATIONS: &[(&str, f64)] = &[
    ("a0", 1.4e-3),
    ("theta1", -8.0e-3),
    ("a1", 0.9e-3),
    ("d1", -1.1e-3),
    ("alpha1", 6.0e-3),
    ("theta2", 11.0e-3),
    ("a2", -0.7e-3),
    ("d2", 1.9e-3),
    ("alpha2", -4.0e-3),
    ("theta3", 5.0e-3),
    ("a3", 1.2e-3),
    ("d3", -2.1e-3),
    ("alpha3", 9.0e-3),
    ("theta4", -13.0e-3),
    ("a4", 0.6e-3),
    ("d4", 1.3e-3),
    ("alpha4", -7.0e-3),
    ("theta5", 4.0e-3),
    ("a5", -1.6e-3),
    ("d5", 2.4e-3),
    ("alpha5", 3.0e-3),
    ("theta6", 12.0e-3),
    ("a6", 0.8e-3),
    ("d6", -0.9e-3),
    ("alpha6", -10.0e-3),
    ("theta7", 14.0e-3),
    ("a7", -1.0e-3),
    ("d7", 1.5e-3),
    ("offset1", 2.0e-3),
    ("ratio_deviation1", 0.11),
    ("output_drum_x1", 4.0e-4),
    ("output_drum_y1", -3.0e-4),
    ("input_drum_x1", 1.0e-5),
    ("input_drum_y1", 2.0e-5),
    ("offset2", -1.0e-3),
    ("ratio_deviation2", -0.07),
    ("output_drum_x2", -2.0e-4),
    ("output_drum_y2", 6.0e-4),
    ("input_drum_x2", -2.0e-5),
    ("input_drum_y2", 1.0e-5),
    ("offset3", 3.0e-3),
    ("ratio_deviation3", 0.05),
    ("output_drum_x3", 5.0e-4),
    ("output_drum_y3", 2.0e-4),
    ("input_drum_x3", 1.5e-5),
    ("input_drum_y3", -1.0e-5),
];

/// The device of the fixtures, its drum known exactly, as simulated ones are; none, with a printed line, where a packaged crate lacks them.
pub(crate) fn haptic7() -> Option<Device> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/devices/haptic7.toml"
    );
    match std::fs::read_to_string(path) {
        Ok(text) => {
            let mut device = Device::from_toml(&text, "haptic7.toml").unwrap().device;
            device.cables[0].scale_sd = Some(0.0);
            Some(device)
        }
        Err(error) => {
            println!("skipped: {path}: {error}");
            None
        }
    }
}

/// A device with [`DEVIATIONS`] times `factor` and a cubic error on joint 4, which a polynomial of
/// degree 3 or more meets exactly.
pub(crate) fn truth_of(nominal: &Device, factor: f64) -> Device {
    let scaled: Vec<(&str, f64)> = DEVIATIONS
        .iter()
        .map(|&(name, size)| (name, factor * size))
        .collect();
    let mut truth = apply_deviations(nominal, &scaled).unwrap();
    truth.joints[3].transmission_error = TransmissionError::Chebyshev {
        range_rad: [-0.8, 0.8],
        coefficients: [0.004, -0.011, 0.006, 0.002].map(|c| factor * c).to_vec(),
    };
    truth
}

/// The paper's simulation, with or without noise.
pub(crate) fn record(truth: &Device, rows: usize, seed: u64, noise: Noise) -> Recording {
    let settings = Settings {
        output_noise: noise,
        cable_noise: noise,
        ..Settings::paper()
    };
    simulate(truth, &settings, rows, seed).unwrap()
}

/// The device as these recordings are made: motor-side readings are exact, so nothing is
/// propagated from them.
pub(crate) fn exact_readings(mut device: Device) -> Device {
    for joint in &mut device.joints {
        joint.encoder_counts_per_rev = None;
    }
    device
}

/// Options that leave nothing to choose.
pub(crate) fn fixed(method: CalibrationMethod, weighting: Weighting) -> Options {
    Options {
        method,
        degree: Degree::Fixed(10),
        weighting,
        held_out: HeldOut::None,
        ..Options::default()
    }
}

/// Everything that a joint fit needs: the device after two steps, and what it frees.
pub(crate) struct Joint {
    pub(crate) device: Device,
    pub(crate) channels: Vec<Channel>,
    pub(crate) parameters: Vec<ParameterId>,
    pub(crate) free: Vec<usize>,
    pub(crate) weights: Weights,
}

/// The joint problem of the deviated device on noisy data, from the two-step solution.
pub(crate) fn joint_problem(nominal: &Device, recording: &Recording) -> Joint {
    let options = fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let fitted = fit_device(nominal, recording, &options).unwrap();
    let channels = channels(nominal, recording).unwrap();
    let weights = Weights::stated(nominal, &channels);
    let mut parameters = candidate_parameters(&fitted.device);
    for fit in &fitted.transmissions {
        let own = fit.terms.free_parameters().into_iter();
        parameters.extend(own.map(|index| ParameterId::Transmission {
            joint: fit.joint,
            index,
        }));
    }
    let device = fitted.device;
    let rules = &options.rules;
    let judged =
        identifiability_at(&device, recording, &channels, &parameters, &weights, rules).unwrap();
    let free = (0..parameters.len())
        .filter(|&index| matches!(judged.statuses[index], Status::Identifiable { .. }))
        .collect();
    Joint {
        device,
        channels,
        parameters,
        free,
        weights,
    }
}
