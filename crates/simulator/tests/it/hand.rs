//! Shared by the tests of hand-guided recordings: an arm with masses, short settings, columns.

use haptical_simulator::model::{Body, Device, Evaluation, Recording};
use haptical_simulator::{Effect, Effects, HandMotion, MotionSettings, record_motion};

use crate::device::arm;

pub(crate) const SEED: u64 = 7;

/// The arm of the other tests with masses in a field of gravity; the second weighs 2 kg.
pub(crate) fn heavy_arm() -> Device {
    let mut device = arm();
    device.gravity_mps2 = Some([0.3, -9.7, 1.1]);
    let body = |mass_kg, centre_of_mass_m| {
        Some(Body {
            mass_kg,
            centre_of_mass_m,
            inertia_kgm2: None,
        })
    };
    device.bodies = vec![
        None,
        body(0.7, [0.02, -0.03, 0.05]),
        body(2.0, [0.1, 0.01, -0.02]),
        None,
        body(0.2, [0.015, 0.01, 0.03]),
    ];
    device
}

/// Twelve seconds at 200 rows a second, sensors without noise.
pub(crate) fn quiet() -> MotionSettings {
    MotionSettings {
        motion: HandMotion {
            seconds: 12.0,
            rate_hz: 200.0,
            home_rest_s: 0.5,
            rests: 1,
            ..HandMotion::default()
        },
        ..MotionSettings::quiet()
    }
}

/// A quiet recording of the heavy arm.
pub(crate) fn with(effects: Vec<Effect>) -> Recording {
    let effects = Effects::new(effects).expect("effects");
    record_motion(&heavy_arm(), &effects, &quiet(), SEED).expect("a recording")
}

pub(crate) fn output(recording: &Recording, joint: usize) -> &[f64] {
    recording.output[joint].as_ref().expect("an output")
}

pub(crate) fn cable(recording: &Recording) -> &[f64] {
    recording.cable_m[0].as_ref().expect("a cable")
}

pub(crate) fn torque(recording: &Recording, joint: usize) -> &[f64] {
    recording.torque_nm[joint].as_ref().expect("a torque")
}

pub(crate) fn time(recording: &Recording) -> &[f64] {
    recording.time_s.as_ref().expect("times")
}

/// Readings of a row.
pub(crate) fn readings(recording: &Recording, row: usize) -> Vec<f64> {
    recording.joint.iter().map(|column| column[row]).collect()
}

/// The device evaluated at the readings of a row.
pub(crate) fn at_row<'d>(device: &'d Device, recording: &Recording, row: usize) -> Evaluation<'d> {
    let mut evaluation = Evaluation::new(device);
    evaluation
        .move_to(&readings(recording, row))
        .expect("a pose");
    evaluation
}

pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if value.abs() <= most {
            most
        } else {
            value.abs()
        }
    })
}
