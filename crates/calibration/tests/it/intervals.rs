//! Intervals that contain what was held or worked out before: step 1's noise, weak parameters, predictions.

use haptical_calibration::{
    CalibrationMethod, Channel, FitRequest, Options, ParameterFit, Weighting, Weights,
    candidate_parameters, fit_device, fit_kinematics, fit_parameters, force_direction,
    predict_distances, predict_positions, with_step_one_noise,
};
use haptical_identification::Status;
use haptical_model::{Device, ParameterId, Recording};
use haptical_simulator::{Noise, true_poses};

use crate::haptic;

const CABLE: [Channel; 1] = [Channel::Cable { index: 0 }];

/// Both steps, the second with the noise of the first.
fn two_steps(nominal: &Device, recording: &Recording, options: &Options) -> [ParameterFit; 2] {
    let fitted = fit_device(nominal, recording, options).unwrap();
    let whole = fitted.whole.unwrap();
    let (steps, weights) = (&fitted.transmissions, &fitted.weights);
    let told = with_step_one_noise(whole.clone(), steps, recording, &CABLE, weights).unwrap();
    [whole, told]
}

/// Root mean square of (estimate - truth) over its standard deviation, over the link parameters.
fn scatter(fit: &ParameterFit, truth: &Device) -> f64 {
    let parameters = fit.parameters.iter().zip(&fit.estimates);
    let squares: Vec<f64> = parameters
        .filter_map(|(parameter, estimate)| {
            let (value, sd) = (estimate.value?, estimate.standard_deviation?);
            Some(((value - parameter.value(truth)) / sd).powi(2))
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// In two steps the kinematic parameters scatter as stated once the noise of step 1 is counted, and by more without.
#[test]
fn two_steps_state_their_scatter() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    for weighting in [Weighting::Stated, Weighting::Estimated] {
        let options = haptic::fixed(CalibrationMethod::TwoStep, weighting);
        let seeds = 24;
        let (mut before, mut after) = (0.0, 0.0);
        for seed in 0..seeds {
            let recording = haptic::record(&truth, 300, 2000 + seed, Noise::Gaussian);
            let [plain, told] = two_steps(&nominal, &recording, &options);
            before += scatter(&plain, &truth).powi(2) / seeds as f64;
            after += scatter(&told, &truth).powi(2) / seeds as f64;
        }
        // 24 recordings of 28 correlated parameters: a mean square within 15 %
        assert!((0.8..1.2).contains(&after), "{weighting:?}: {after}");
        assert!(before > 1.15, "{weighting:?}: {before}");
    }
}

/// The device with direct joints: step 2 alone.
fn direct(mut nominal: Device) -> Device {
    for joint in &mut nominal.joints {
        joint.transmission = haptical_model::TransmissionKind::Direct;
        joint.external_encoder_sd_rad = None;
        joint.external_encoder_counts_per_rev = None;
    }
    haptic::exact_readings(nominal)
}

/// A device whose link parameters deviate by about half their plausible sizes, some of one sign, some of the
/// other.
fn near(nominal: &Device, share: f64, seed: u64) -> Device {
    let mut truth = nominal.clone();
    for (k, parameter) in nominal.link_parameters(false).into_iter().enumerate() {
        let name = parameter.name(nominal);
        if ["alpha0", "theta0", "d0", "alpha7"].contains(&name.as_str()) {
            continue;
        }
        let amount = crate::chain::pseudo_random(seed, k as u64);
        let size = share * parameter.plausible_size(nominal);
        parameter.set(&mut truth, parameter.value(nominal) + size * amount);
    }
    truth
}

fn kinematics(nominal: &Device, recording: &Recording, weighting: Weighting) -> ParameterFit {
    let weights = Weights::stated(nominal, &CABLE);
    let options = haptic::fixed(CalibrationMethod::TwoStep, weighting);
    fit_kinematics(nominal, recording, &CABLE, &weights, &options).unwrap()
}

/// Distances at unseen postures lie within their intervals as often as stated; a coordinate, which a turn about
/// the cable's exit changes, gets none.
#[test]
fn distances_have_intervals_and_coordinates_none() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = direct(nominal);
    let (mut held, mut total) = (0, 0);
    for seed in 0..40 {
        let truth = near(&nominal, 1.0, seed);
        let recording = haptic::record(&truth, 120, 300 + seed, Noise::Gaussian);
        let fit = kinematics(&nominal, &recording, Weighting::Stated);
        let postures = haptic::record(&truth, 20, 900 + seed, Noise::None);
        let poses = true_poses(&truth, &postures).unwrap();
        let predicted = predict_distances(&fit, &postures, [0.0; 3]).unwrap();
        for (prediction, pose) in predicted.iter().zip(&poses) {
            let [low, high] = prediction.ci95.unwrap();
            held += u32::from((low..=high).contains(&pose.position_m.norm()));
            total += 1;
        }
        for prediction in predict_positions(&fit, &postures).unwrap().iter().flatten() {
            assert_eq!(prediction.ci95, None);
            assert!(!prediction.open_through.is_empty());
        }
    }
    // 800 distances, those of one fit correlated
    let share = f64::from(held) / f64::from(total);
    assert!((0.92..0.98).contains(&share), "{share}");
}

/// With a tracker every coordinate has an interval, and the covariance carried to it is that of finite differences.
#[test]
fn coordinates_of_a_tracked_handle_have_intervals() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let mut nominal = direct(nominal);
    let tracker =
        "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 5e-5\n[[joint]]\n";
    nominal.tracker = Device::from_toml(tracker, "t.toml").unwrap().device.tracker;
    let truth = near(&nominal, 1.0, 3);
    let mut recording = haptic::record(&truth, 100, 77, Noise::None);
    let poses = true_poses(&truth, &recording).unwrap();
    let noise = |row: usize, axis: u64| 8e-5 * crate::chain::pseudo_random(axis, row as u64);
    let axis = |axis: usize| {
        let rows = poses.iter().enumerate();
        rows.map(|(row, pose)| pose.position_m[axis] + noise(row, axis as u64))
            .collect()
    };
    recording.position_m = Some([axis(0), axis(1), axis(2)]);
    recording.cable_m = vec![None];
    let channels = [Channel::Position];
    let weights = Weights::stated(&nominal, &channels);
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let fit = fit_kinematics(&nominal, &recording, &channels, &weights, &options).unwrap();
    let predicted = predict_positions(&fit, &recording).unwrap();
    let (parameters, covariance) = fit.uncertain();
    for row in [0, 40, 99] {
        let part = recording.select(&[row]);
        let slopes: Vec<[f64; 3]> = parameters
            .iter()
            .map(|parameter| {
                let at = |sign: f64| {
                    let mut device = fit.device.clone();
                    let value = parameter.value(&fit.device) + sign * 1e-5;
                    parameter.set(&mut device, value);
                    true_poses(&device, &part).unwrap()[0].position_m
                };
                ((at(1.0) - at(-1.0)) / 2e-5).into()
            })
            .collect();
        for axis in 0..3 {
            let mut variance = 0.0;
            for (a, left) in slopes.iter().enumerate() {
                for (b, right) in slopes.iter().enumerate() {
                    variance += left[axis] * covariance[(a, b)] * right[axis];
                }
            }
            let stated = predicted[row][axis].standard_deviation.unwrap();
            assert!((stated / variance.sqrt() - 1.0).abs() < 1e-5, "{stated}");
        }
    }
}

/// Where a recording fixes a parameter worse than its plausible size, the parameter is held, and the others'
/// intervals contain what it may be: they hold the truth, and without they would not.
#[test]
fn held_weak_parameters_widen_the_others() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let mut nominal = direct(nominal);
    // a distance so coarse that some parameters are lost in it
    nominal.cables[0].distance_sd_m = Some(5e-4);
    let (mut with, mut without, mut count) = (0.0, 0.0, 0);
    for seed in 0..30 {
        let truth = near(&nominal, 1.7, 50 + seed);
        let settings = haptical_simulator::Settings {
            cable_sigma: haptical_simulator::CableSigma::Stated,
            ..haptical_simulator::Settings::paper()
        };
        let recording = haptical_simulator::simulate(&truth, &settings, 60, 40 + seed).unwrap();
        let fit = kinematics(&nominal, &recording, Weighting::Stated);
        assert!(!fit.considered.parameters.is_empty());
        assert!(fit.considered.weak().count() > 0);
        for parameter in fit.considered.weak() {
            let place = fit
                .parameters
                .iter()
                .position(|other| *other == parameter)
                .unwrap();
            assert!(matches!(
                fit.identifiability.statuses[place],
                Status::Weak { .. }
            ));
            assert_eq!(fit.estimates[place].ci95, None);
        }
        for (position, &index) in fit.fitted.iter().enumerate() {
            let estimate = &fit.estimates[index];
            let error = estimate.value.unwrap() - fit.parameters[index].value(&truth);
            with += (error / estimate.standard_deviation.unwrap()).powi(2);
            without += (error / fit.uncertainty.standard_deviation(position)).powi(2);
            count += 1;
        }
    }
    let (with, without) = (with / f64::from(count), without / f64::from(count));
    // pseudo-random deviations are uniform: 1.7 / sqrt(3) is one plausible size
    assert!((0.6..1.4).contains(&with), "{with}");
    assert!(without > 1.5, "{without}");
}

/// What turns the force and shows in no distance is named, and not counted as known.
#[test]
fn the_force_direction_names_what_it_leaves_out() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = direct(nominal);
    let recording = haptic::record(&near(&nominal, 1.0, 8), 200, 5, Noise::Gaussian);
    let fit = kinematics(&nominal, &recording, Weighting::Stated);
    let found = force_direction(&fit, &recording).unwrap().unwrap();
    assert_eq!(found.open_through, ["alpha7"]);
    // alpha7 turns the handle's z about its x: by its plausible size, 20 mrad
    let open = (found.rms_with_open_rad.powi(2) - found.rms_rad.powi(2)).sqrt();
    assert!((open / 0.02 - 1.0).abs() < 0.05, "{open}");
}

/// A fit of nothing but transmissions, or of a device without links, predicts no handle.
#[test]
fn a_device_without_links_has_no_handle() {
    let text = "[[joint]]\nexternal_encoder_sd_rad = 1e-4\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\n\
                transmission = \"capstan\"\n";
    let device = Device::from_toml(text, "one.toml").unwrap().device;
    let reading: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k) - 1.0).collect();
    let recording = Recording {
        line: (2..202).collect(),
        output: vec![Some(reading.clone())],
        joint: vec![reading],
        ..Recording::default()
    };
    let channels = [Channel::Output { joint: 0 }];
    let weights = Weights::stated(&device, &channels);
    let parameters: Vec<ParameterId> = device.transmission_parameters(0);
    let options = Options::default();
    let what = "one joint";
    let fit = fit_parameters(&FitRequest {
        what,
        device: &device,
        recording: &recording,
        channels: &channels,
        parameters: &parameters,
        unsupported: &[],
        weights: &weights,
        options: &options,
        start: None,
        yielded: None,
    })
    .unwrap();
    assert!(candidate_parameters(&device).is_empty());
    assert!(predict_positions(&fit, &recording).is_err());
}
