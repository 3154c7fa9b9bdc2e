//! Stated deviations against scatter, and sizes of noise that the device file does not know.

use std::collections::BTreeMap;

use haptical_calibration::{CalibrationMethod, Channel, Weighting, fit_device};
use haptical_model::TransmissionKind;
use haptical_simulator::{CableSigma, Noise, Settings, simulate};

use crate::haptic;
use crate::recovery::errors_in_deviations;

/// Recordings of the Cramer-Rao comparison.
const SEEDS: u64 = 60;
/// The deviation of 60 numbers has a relative deviation of 1 / sqrt(118) = 0.092: five of them.
const SCATTER: [f64; 2] = [0.54, 1.46];
/// The mean of 46 such ratios, few of them independent.
const MEAN_SCATTER: [f64; 2] = [0.85, 1.15];

/// The covariance is the Cramer-Rao bound of normal noise: the scatter must meet it.
#[test]
fn estimates_scatter_as_stated() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    let mut squares: BTreeMap<String, (f64, usize)> = BTreeMap::new();
    for seed in 0..SEEDS {
        let recording = haptic::record(&truth, 200, 1000 + seed, Noise::Gaussian);
        let mut fitted = fit_device(&nominal, &recording, &options).unwrap();
        fitted.transmissions.clear();
        for (name, error) in errors_in_deviations(&fitted, &truth) {
            let (sum, count) = squares.entry(name).or_default();
            *sum += error * error;
            *count += 1;
        }
    }
    assert_eq!(squares.len(), 28 + 18);
    let mut total = 0.0;
    for (name, (sum, count)) in &squares {
        assert_eq!(*count, SEEDS as usize, "{name} was not always fitted");
        let ratio = (sum / *count as f64).sqrt();
        assert!((SCATTER[0]..SCATTER[1]).contains(&ratio), "{name}: {ratio}");
        total += ratio / squares.len() as f64;
    }
    assert!(
        (MEAN_SCATTER[0]..MEAN_SCATTER[1]).contains(&total),
        "{total}"
    );
}

/// 2000 readings give a deviation to 1.6 %, and a factor within 10 % of the last is not refitted.
#[test]
fn a_noisier_channel_is_found() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    for method in [CalibrationMethod::TwoStep, CalibrationMethod::Joint] {
        for noisy in [Channel::Output { joint: 1 }, Channel::Cable { index: 0 }] {
            let mut truth = haptic::truth_of(&nominal, 1.0);
            match noisy {
                Channel::Output { joint } => {
                    let sd = &mut truth.joints[joint].external_encoder_sd_rad;
                    *sd = sd.map(|sd| 5.0 * sd);
                }
                _ => {
                    let sd = &mut truth.cables[0].distance_sd_m;
                    *sd = sd.map(|sd| 5.0 * sd);
                }
            }
            let settings = Settings {
                cable_sigma: CableSigma::Stated,
                ..Settings::paper()
            };
            let recording = simulate(&truth, &settings, 2000, 31).unwrap();
            let options = haptic::fixed(method, Weighting::Estimated);
            let factors = fit_device(&nominal, &recording, &options)
                .unwrap()
                .weights
                .factor;
            assert_eq!(factors.len(), 5);
            for (channel, factor) in factors {
                // Two steps hand the error of step 1 on to the distances.
                if method == CalibrationMethod::TwoStep
                    && channel == (Channel::Cable { index: 0 })
                    && channel != noisy
                {
                    assert!((0.9..5.0).contains(&factor), "{factor}");
                    continue;
                }
                let expected = if channel == noisy { 5.0 } else { 1.0 };
                assert!(
                    (factor / expected - 1.0).abs() < 0.1,
                    "{method:?}, {}: {factor} for {expected}",
                    channel.name()
                );
            }
        }
    }
}

/// 60 distances and 28 parameters: without the correction the size would come out as
/// sqrt(32 / 60) = 0.73 of what it is.
#[test]
fn the_parameters_are_paid_for() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let mut nominal = haptic::exact_readings(nominal);
    for joint in &mut nominal.joints {
        joint.transmission = TransmissionKind::Direct;
        joint.external_encoder_sd_rad = None;
        joint.external_encoder_counts_per_rev = None;
    }
    let mut truth = nominal.clone();
    truth.cables[0].distance_sd_m = nominal.cables[0].distance_sd_m.map(|sd| 3.0 * sd);
    let settings = Settings {
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Estimated);
    let (mut mean_square, count) = (0.0, 60);
    for seed in 0..count {
        let recording = simulate(&truth, &settings, 60, 500 + seed).unwrap();
        let fitted = fit_device(&nominal, &recording, &options).unwrap();
        let factor = fitted.weights.factor[&Channel::Cable { index: 0 }] / 3.0;
        mean_square += factor * factor / count as f64;
    }
    // 60 times 32 degrees of freedom: the mean square has a relative deviation of 0.032.
    assert!((0.85..1.15).contains(&mean_square), "{mean_square}");
}
