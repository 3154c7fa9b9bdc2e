//! The arm against closed forms that use neither crate.

use haptical_transmission::{Capstan, CapstanError};
use user::{Arm, LENGTHS_M};

/// A dozen roundings of numbers below 1.
const ROUNDING: f64 = 1e-14;
/// Central differences with a step of 1e-6: rounding 1e-16 / 1e-6, truncation below it.
const DIFFERENCE: f64 = 1e-8;

const RATIO: f64 = 8.0;
const DISTANCE_M: f64 = 0.0675;
const OFFSET_RAD: f64 = 0.002;
const RATIO_DEVIATION: f64 = -0.03;
const ECCENTRICITY_M: f64 = 3e-4;
const DIRECTION_RAD: f64 = 0.7;

fn arm() -> Arm {
    let drive = Capstan::new(RATIO, DISTANCE_M, DISTANCE_M).unwrap();
    let error = CapstanError::from_polar(
        OFFSET_RAD,
        RATIO_DEVIATION,
        ECCENTRICITY_M,
        DIRECTION_RAD,
        0.0,
        0.0,
    );
    Arm { drive, error }
}

/// Eq. (1) as printed, zero at home but for the offset.
fn shoulder_rad(theta: f64) -> f64 {
    let drum = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        (ECCENTRICITY_M * sin / (DISTANCE_M - ECCENTRICITY_M * cos)).atan()
    };
    theta + OFFSET_RAD - RATIO_DEVIATION / (RATIO_DEVIATION + RATIO) * theta
        + drum(theta + DIRECTION_RAD)
        - drum(DIRECTION_RAD)
}

fn closed_form_m(readings: [f64; 2]) -> [f64; 2] {
    let shoulder = shoulder_rad(readings[0]);
    let elbow = shoulder + readings[1];
    [
        LENGTHS_M[0] * shoulder.cos() + LENGTHS_M[1] * elbow.cos(),
        LENGTHS_M[0] * shoulder.sin() + LENGTHS_M[1] * elbow.sin(),
    ]
}

fn readings() -> impl Iterator<Item = [f64; 2]> {
    let steps = || (-6..=6).map(f64::from);
    steps().flat_map(move |first| steps().map(move |second| [0.2 * first, 0.25 * second]))
}

#[test]
fn the_handle_is_where_trigonometry_puts_it() {
    for readings in readings() {
        let (pose, _) = arm().handle(readings).unwrap();
        let [x, y] = closed_form_m(readings);
        assert!((pose.position_m.x - x).abs() < ROUNDING, "{readings:?}");
        assert!((pose.position_m.y - y).abs() < ROUNDING, "{readings:?}");
        assert_eq!(pose.position_m.z, 0.0);
    }
}

#[test]
fn derivatives_with_respect_to_the_encoders() {
    let step = 1e-6;
    for readings in readings() {
        let (_, columns) = arm().handle(readings).unwrap();
        for encoder in 0..2 {
            let (mut plus, mut minus) = (readings, readings);
            plus[encoder] += step;
            minus[encoder] -= step;
            let (plus, minus) = (closed_form_m(plus), closed_form_m(minus));
            for axis in 0..2 {
                let difference = (plus[axis] - minus[axis]) / (2.0 * step);
                let gap = columns[encoder].linear[axis] - difference;
                assert!(
                    gap.abs() < DIFFERENCE,
                    "{readings:?} {encoder} {axis}: {gap:e}"
                );
            }
        }
    }
}

#[test]
fn the_encoder_angle_for_a_wanted_joint_angle() {
    let arm = arm();
    for wanted in [-1.2, -0.3, 0.0, 0.7, 1.3] {
        let reading = arm.drive.invert(&arm.error, wanted, [-2.0, 2.0]).unwrap();
        assert!((shoulder_rad(reading) - wanted).abs() < 1e-12);
    }
}

#[test]
fn a_reading_that_is_not_a_number_is_an_error() {
    assert!(arm().handle([f64::NAN, 0.0]).is_err());
    assert!(arm().handle([0.0, f64::INFINITY]).is_err());
}
