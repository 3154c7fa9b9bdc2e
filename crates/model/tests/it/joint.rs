//! A joint's own numbers: quantum, standard deviations, errors of its transmission.

use std::f64::consts::TAU;

use haptical_model::transmission::{CapstanError, LawError};
use haptical_model::{Cable, Device, Joint, TransmissionError};
use proptest::prelude::*;

use crate::support::{CASES, device_and_readings};
use haptical_model::kinematics::Convention;

#[test]
fn a_count_of_the_motor_side_over_the_ratio() {
    let joint = Joint {
        encoder_counts_per_rev: Some(20_000.0),
        transmission_ratio: -8.0,
        ..Joint::default()
    };
    // 360 deg / 160 000
    let quantum = joint.reading_quantum_rad().unwrap();
    assert!((quantum - 3.926_990_816_987_241e-5).abs() < 1e-19);
    assert_eq!(Joint::default().reading_quantum_rad(), None);
}

#[test]
fn standard_deviations_stated_and_by_default() {
    let counts = Joint {
        external_encoder_counts_per_rev: Some(20_000.0),
        ..Joint::default()
    };
    // the paper's sigma_e, 1.0472e-4 rad
    assert!((counts.output_sd_rad().unwrap() - 1.047_197_551e-4).abs() < 1e-13);
    let stated = Joint {
        external_encoder_sd_rad: Some(3e-4),
        ..counts
    };
    assert_eq!(stated.output_sd_rad(), Some(3e-4));
    assert_eq!(Joint::default().output_sd_rad(), None);

    let cable = Cable {
        anchor_m: [0.0; 3],
        drum_radius_m: Some(0.015),
        counts_per_rev: Some(20_000.0),
        distance_sd_m: None,
        ..Cable::default()
    };
    let mut device = Device::new(Convention::Standard, Vec::new(), vec![Joint::default()]);
    let no_counts = Cable {
        counts_per_rev: None,
        ..cable
    };
    let stated = Cable {
        distance_sd_m: Some(9.87e-6),
        ..cable
    };
    device.cables = vec![cable, no_counts, stated];
    // 2 pi 15 mm / 20 000 / 3
    assert!((device.cable_sd_m(0).unwrap() - 1.570_796_327e-6).abs() < 1e-15);
    assert_eq!(device.cable_sd_m(1), None);
    assert_eq!(device.cable_sd_m(2), Some(9.87e-6));
    assert_eq!(device.cable_sd_m(3), None);
}

#[test]
fn a_joint_without_drums_takes_eccentricities_as_angles() {
    let joint = Joint {
        transmission_error: TransmissionError::Capstan(CapstanError {
            output_drum_xy_m: [0.0, 1e-6],
            ..CapstanError::default()
        }),
        ..Joint::default()
    };
    // y (cos theta - 1) over a denominator of 1 m, to second order in y
    let error = joint.error_rad(0.5).unwrap();
    assert!(
        (error - 1e-6 * (0.5_f64.cos() - 1.0)).abs() < 1e-11,
        "{error}"
    );
}

#[test]
fn a_polynomial_knows_its_range() {
    let joint = Joint {
        transmission_error: TransmissionError::Chebyshev {
            range_rad: [-0.5, 0.25],
            coefficients: vec![0.1],
        },
        ..Joint::default()
    };
    assert!(joint.error_is_known_at(-0.5) && joint.error_is_known_at(0.25));
    assert!(!joint.error_is_known_at(0.26) && !joint.error_is_known_at(-0.51));
    assert!(Joint::default().error_is_known_at(100.0));
}

#[test]
fn a_parallelogram_without_bars_is_refused() {
    let joint = Joint {
        transmission_error: TransmissionError::Parallelogram {
            capstan: CapstanError::default(),
            length_deviations_m: [0.0; 4],
        },
        ..Joint::default()
    };
    let refused = joint.error_rad(0.1).unwrap_err();
    assert!(matches!(refused, LawError::NonFinite { .. }), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn value_and_evaluation_agree((device, readings) in device_and_readings()) {
        for (joint, reading) in device.joints.iter().zip(readings) {
            let mut derivatives = vec![0.0; joint.error_parameter_count()];
            let (value, _) = joint.evaluate_error(reading, &mut derivatives).unwrap();
            prop_assert_eq!(value, joint.error_rad(reading).unwrap());
        }
    }

    #[test]
    fn readings_that_are_not_finite_are_refused((device, _) in device_and_readings()) {
        for joint in &device.joints {
            let mut derivatives = vec![0.0; joint.error_parameter_count()];
            for reading in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
                // the largest number is finite: an answer must be finite then
                match joint.evaluate_error(reading, &mut derivatives) {
                    Ok((value, slope)) => prop_assert!(
                        reading == f64::MAX && value.is_finite() && slope.is_finite()),
                    Err(_) => prop_assert!(joint.error_rad(reading).is_err()),
                }
            }
        }
    }

    #[test]
    fn the_quantum_times_counts_and_ratio_is_a_turn(ratio in 0.5..20.0, counts in 100.0..1e6) {
        let joint = Joint {
            transmission_ratio: ratio,
            encoder_counts_per_rev: Some(counts),
            ..Joint::default()
        };
        let turn = joint.reading_quantum_rad().unwrap() * counts * ratio;
        prop_assert!((turn - TAU).abs() < 1e-14);
    }
}
