//! What a user is told of a result that cannot be right.

use haptical_calibration::{Calibration, CalibrationMethod, Options, calibrate};
use haptical_model::Recording;
use haptical_simulator::{Settings, simulate};

use crate::haptic;

const ROWS: usize = 300;

fn result(method: CalibrationMethod, spoil: impl Fn(&mut Recording)) -> Option<Calibration> {
    let nominal = haptic::haptic7()?;
    let mut recording = simulate(&nominal, &Settings::real_encoders(), ROWS, 1).unwrap();
    spoil(&mut recording);
    let options = Options {
        method,
        ..Options::default()
    };
    Some(calibrate(&nominal, &recording, &options).unwrap())
}

fn says(calibration: &Calibration, words: &str) -> bool {
    calibration
        .warnings
        .iter()
        .any(|warning| warning.contains(words))
}

#[test]
fn a_clean_recording_has_no_warning() {
    let Some(clean) = result(CalibrationMethod::Joint, |_| {}) else {
        return;
    };
    // on this device a turn about the cable's exit is never seen
    assert_eq!(clean.warnings.len(), 1, "{:?}", clean.warnings);
    assert!(clean.warnings[0].starts_with("fixed only in a combination"));
}

#[test]
fn distances_in_half_their_unit_are_implausible() {
    let Some(spoilt) = result(CalibrationMethod::Joint, |recording| {
        for distance in recording.cable_m[0].as_mut().unwrap() {
            *distance *= 2.0;
        }
    }) else {
        return;
    };
    assert!(
        says(&spoilt, "implausible") && says(&spoilt, "check units"),
        "{:?}",
        spoilt.warnings
    );
}

#[test]
fn an_effect_that_the_model_lacks_leaves_a_residual_above_the_floor() {
    let Some(spoilt) = result(CalibrationMethod::Joint, |recording| {
        for (row, distance) in recording.cable_m[0]
            .as_mut()
            .unwrap()
            .iter_mut()
            .enumerate()
        {
            *distance += if row % 2 == 0 { 1e-4 } else { -1e-4 };
        }
    }) else {
        return;
    };
    assert!(
        says(&spoilt, "cable: the residual left"),
        "{:?}",
        spoilt.warnings
    );
    assert!(!says(&spoilt, "implausible"), "{:?}", spoilt.warnings);
}
