//! Rounding to encoder counts.

use std::f64::consts::TAU;

use haptical_simulator::{Noise, Settings, simulate, simulate_transmission};

use crate::device::arm;
use crate::statistics::{assert_uniform, differences};

const ROWS: usize = 20_000;

/// Readings are up to 3e5 counts, a product and a quotient of them are off by some ulps of that.
const COUNT_TOLERANCE: f64 = 1e-9;

/// Asserts whole counts, and a rounding error that fills half a count to either side.
#[track_caller]
fn assert_counts(rounded: &[f64], exact: &[f64], count: f64) {
    for value in rounded {
        let counts = value / count;
        assert!(
            (counts - counts.round()).abs() < COUNT_TOLERANCE,
            "{counts} counts"
        );
    }
    let shares: Vec<f64> = differences(rounded, exact)
        .iter()
        .map(|error| error / count + 0.5)
        .collect();
    let slack = COUNT_TOLERANCE;
    assert!(
        shares
            .iter()
            .all(|share| (-slack..=1.0 + slack).contains(share))
    );
    let clamped: Vec<f64> = shares.iter().map(|share| share.clamp(0.0, 1.0)).collect();
    assert_uniform(&clamped, "rounding error");
}

#[test]
fn real_encoders_show_whole_counts() {
    let truth = arm();
    let settings = Settings {
        motor_counts: false,
        output_noise: Noise::None,
        cable_noise: Noise::None,
        ..Settings::real_encoders()
    };
    let exact = simulate(&truth, &settings, ROWS, 31).expect("a recording");
    let real = simulate(&truth, &Settings::real_encoders(), ROWS, 31).expect("a recording");
    // counts of the motor over the ratio, whatever the ratio's sign
    let motors = [20000.0 * 8.0, 20000.0 * 12.0, 4000.0 * 300.0, 5000.0];
    for (joint, counts_per_turn) in motors.into_iter().enumerate() {
        assert_counts(
            &real.joint[joint],
            &exact.joint[joint],
            TAU / counts_per_turn,
        );
    }
    for (joint, counts) in [20000.0, 18000.0, 400_000.0].into_iter().enumerate() {
        let [real, exact] = [&real, &exact].map(|r| r.output[joint].as_ref().expect("given"));
        assert_counts(real, exact, TAU / counts);
    }
    for (cable, length_m) in [TAU * 0.015 / 20000.0, TAU * 0.02 / 10000.0]
        .into_iter()
        .enumerate()
    {
        let [real, exact] = [&real, &exact].map(|r| r.cable_m[cable].as_ref().expect("given"));
        assert_counts(real, exact, length_m);
    }
}

#[test]
fn one_transmission_is_rounded_as_the_device() {
    let truth = arm();
    let exact = Settings {
        motor_counts: false,
        output_noise: Noise::None,
        ..Settings::real_encoders()
    };
    let exact = simulate_transmission(&truth, &exact, 0, ROWS, 32).expect("a recording");
    let real = simulate_transmission(&truth, &Settings::real_encoders(), 0, ROWS, 32);
    let real = real.expect("a recording");
    assert_counts(&real.joint[0], &exact.joint[0], TAU / 160_000.0);
    let [real, exact] = [&real, &exact].map(|r| r.output[0].as_ref().expect("given"));
    assert_counts(real, exact, TAU / 20000.0);
}
