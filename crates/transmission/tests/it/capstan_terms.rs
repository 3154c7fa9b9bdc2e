//! Each term of eq. (1) alone against its closed form, with explicit signs.

use crate::fixture::{assert_close, difference_quotient};
use core::f64::consts::FRAC_PI_2;
use haptical_transmission::{Capstan, CapstanError, CapstanRows};
use proptest::prelude::*;

/// A few roundings of numbers below 1.
const ROUNDING: f64 = 2e-15;

/// Two denominators that differ, so that exchanged drums are seen.
const DRUM_DISTANCE_M: f64 = 0.1;
const INPUT_DENOMINATOR_M: f64 = 0.02;
const RATIO: f64 = 8.0;

fn drive() -> Capstan {
    Capstan::new(RATIO, DRUM_DISTANCE_M, INPUT_DENOMINATOR_M).unwrap()
}

fn error(p: CapstanError, theta_rad: f64) -> f64 {
    drive().error(&p, theta_rad).unwrap()
}

#[test]
fn no_error_gives_zero() {
    for theta_rad in [-1.5, 0.0, 0.3, 1.5] {
        let all = drive()
            .evaluate(&CapstanError::default(), theta_rad)
            .unwrap();
        assert_eq!((all.value_rad, all.slope), (0.0, 0.0));
    }
}

#[test]
fn offset_is_added() {
    for theta_rad in [-1.5, 0.0, 1.5] {
        let p = CapstanError {
            offset_rad: 0.003,
            ..CapstanError::default()
        };
        assert_eq!(error(p, theta_rad), 0.003);
    }
}

#[test]
fn larger_ratio_turns_the_output_less() {
    let p = CapstanError {
        ratio_deviation: 2.0,
        ..CapstanError::default()
    };
    // -2 / (2 + 8) = -0.2
    assert_close(error(p, 0.5), -0.1, ROUNDING, "positive angle");
    assert_close(error(p, -0.5), 0.1, ROUNDING, "negative angle");
    let q = CapstanError {
        ratio_deviation: -3.0,
        ..CapstanError::default()
    };
    // 3 / (8 - 3) = 0.6
    assert_close(error(q, 0.5), 0.3, ROUNDING, "negative deviation");
}

#[test]
fn output_drum_towards_the_other_axis() {
    // beta = 0: g = atan(r sin t / (D - r cos t)), zero at home; r / D = 1/2
    let p = CapstanError {
        output_drum_xy_m: [0.05, 0.0],
        ..CapstanError::default()
    };
    let t = 0.7f64;
    let want = (0.5 * t.sin() / (1.0 - 0.5 * t.cos())).atan();
    assert_close(error(p, t), want, ROUNDING, "ahead of home");
    assert_close(error(p, -t), -want, ROUNDING, "behind home");
    assert!(
        want > 0.4,
        "the test's own number has lost its sign or size"
    );
}

#[test]
fn output_drum_across_the_line_of_centres() {
    // beta = 90 deg: sin(t + beta) = cos t, cos(t + beta) = -sin t
    let p = CapstanError {
        output_drum_xy_m: [0.0, 0.05],
        ..CapstanError::default()
    };
    let t = 0.7f64;
    let want = (0.5 * t.cos() / (1.0 + 0.5 * t.sin())).atan() - 0.5f64.atan();
    assert_close(error(p, t), want, ROUNDING, "beta of 90 deg");
    assert!(
        want < -0.1,
        "the test's own number has lost its sign or size"
    );
}

#[test]
fn output_drum_in_general_position() {
    let (r, beta, t) = (0.03f64, -0.6f64, 0.9f64);
    let g = |phi: f64| (r * (phi + beta).sin() / (DRUM_DISTANCE_M - r * (phi + beta).cos())).atan();
    let p = CapstanError::from_polar(0.0, 0.0, r, beta, 0.0, 0.0);
    assert_close(error(p, t), g(t) - g(0.0), ROUNDING, "output drum");
}

#[test]
fn input_drum_turns_with_the_motor_in_the_positive_sense() {
    let (r, beta, t) = (0.006f64, 0.4f64, 0.11f64);
    let g =
        |phi: f64| (r * (phi + beta).sin() / (INPUT_DENOMINATOR_M - r * (phi + beta).cos())).atan();
    let p = CapstanError::from_polar(0.0, 0.0, 0.0, 0.0, r, beta);
    assert_close(
        error(p, t),
        g(RATIO * t) - g(0.0),
        ROUNDING,
        "input drum, forward",
    );
    assert_close(
        error(p, -t),
        g(-RATIO * t) - g(0.0),
        ROUNDING,
        "input drum, backward",
    );
    let gap = (g(RATIO * t) - g(-RATIO * t)).abs();
    assert!(
        gap > 0.1,
        "the test must tell the two senses of rotation apart"
    );
}

#[test]
fn terms_add_up() {
    let t = -0.8;
    let parts = [
        CapstanError {
            offset_rad: 0.01,
            ..CapstanError::default()
        },
        CapstanError {
            ratio_deviation: -0.3,
            ..CapstanError::default()
        },
        CapstanError::from_polar(0.0, 0.0, 0.004, 2.0, 0.0, 0.0),
        CapstanError::from_polar(0.0, 0.0, 0.0, 0.0, 0.003, -1.2),
    ];
    let all = CapstanError::from_polar(0.01, -0.3, 0.004, 2.0, 0.003, -1.2);
    let sum = parts.into_iter().map(|p| error(p, t)).sum();
    assert_close(error(all, t), sum, ROUNDING, "all four terms");
}

#[test]
fn smooth_at_centred_drums() {
    // To first order in r: [x sin + y (cos - 1)] / D. A polar parametrisation has no such derivative.
    let theta_rad = 0.6;
    let centred = CapstanError::default();
    let all = drive().evaluate(&centred, theta_rad).unwrap();
    let input_rad = RATIO * theta_rad;
    let want = [
        1.0,
        -theta_rad / RATIO,
        theta_rad.sin() / DRUM_DISTANCE_M,
        (theta_rad.cos() - 1.0) / DRUM_DISTANCE_M,
        input_rad.sin() / INPUT_DENOMINATOR_M,
        (input_rad.cos() - 1.0) / INPUT_DENOMINATOR_M,
    ];
    for (index, name) in CapstanError::PARAMETER_NAMES.into_iter().enumerate() {
        assert_close(all.derivatives[index], want[index], 1e-13, name);
        // The quotient passes through r = 0; its truncation is of the order (step / D)^2.
        let moved = |step: f64| {
            let mut parameters = centred.to_array();
            parameters[index] += step;
            error(CapstanError::from_array(parameters), theta_rad)
        };
        let quotient = difference_quotient(moved, 0.0, 1e-6);
        assert_close(
            quotient,
            want[index],
            1e-6 * (1.0 + want[index].abs()),
            name,
        );
    }
}

#[test]
fn polar_form_round_trips_and_has_the_papers_sense() {
    let p = CapstanError::from_polar(0.1, 0.2, 0.003, FRAC_PI_2, 0.004, -2.5);
    assert_eq!(p.to_array()[..2], [0.1, 0.2]);
    assert_close(
        p.output_drum_xy_m[1],
        0.003,
        1e-18,
        "r sin beta is the second component",
    );
    let (r_o, beta_o) = p.output_drum_polar();
    let (r_i, beta_i) = p.input_drum_polar();
    for (got, want) in [
        (r_o, 0.003),
        (beta_o, FRAC_PI_2),
        (r_i, 0.004),
        (beta_i, -2.5),
    ] {
        assert_close(got, want, ROUNDING, "polar form");
    }
    assert_eq!(
        CapstanError::from_array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).to_array(),
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    );
    let centred = CapstanError {
        output_drum_xy_m: [-0.0, 0.0],
        ..CapstanError::default()
    };
    assert_eq!(centred.output_drum_polar(), (0.0, 0.0));
}

proptest! {
    /// The form for many angles against the form for one, on both sides of the series' limit.
    #[test]
    fn rows_agree_with_single_angles(
        xy in [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64],
        part in prop_oneof![Just(0.0), Just(0.02), Just(0.5)],
        offset_rad in -0.1..0.1_f64,
        ratio_deviation in -1.0..1.0_f64,
        angles_rad in prop::array::uniform4(-3.0..3.0_f64),
    ) {
        let capstan = Capstan::new(8.0, 0.07, 0.03).unwrap();
        let p = CapstanError {
            offset_rad,
            ratio_deviation,
            output_drum_xy_m: [xy[0], xy[1]].map(|x| x * part * 0.07),
            input_drum_xy_m: [xy[2], xy[3]].map(|x| x * part * 0.03),
        };
        let [sines, cosines] = [angles_rad.map(f64::sin), angles_rad.map(f64::cos)];
        let input = angles_rad.map(|angle_rad| 8.0 * angle_rad);
        let [input_sines, input_cosines] = [input.map(f64::sin), input.map(f64::cos)];
        let rows = CapstanRows {
            capstan,
            angles_rad: &angles_rad,
            output: [&sines, &cosines],
            input: [&input_sines, &input_cosines],
        };
        let (mut values, mut alone, mut columns) = ([0.0; 4], [0.0; 4], [[0.0; 4]; 6]);
        let into = columns.each_mut().map(|column| &mut column[..]);
        rows.evaluate(&p, &mut values, Some(into)).unwrap();
        rows.evaluate(&p, &mut alone, None).unwrap();
        for ((row, &angle_rad), slope) in angles_rad.iter().enumerate().zip(rows.output_slopes(&p)) {
            let expected = capstan.evaluate(&p, angle_rad).unwrap();
            prop_assert!((values[row] - expected.value_rad).abs() < 1e-15);
            prop_assert_eq!(values[row], alone[row]);
            prop_assert!((slope - 1.0 - expected.slope).abs() < 1e-13);
            for (column, derivative) in columns.iter().zip(expected.derivatives) {
                // per m and over a denominator of 3 cm, of which half is left
                prop_assert!((column[row] - derivative).abs() < 1e-12);
            }
        }
    }
}
