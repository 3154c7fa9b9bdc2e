//! Recordings and devices that lack something.

use haptical_calibration::{
    CalibrationMethod, Channel, DeviceProblem, Weighting, Weights, calibrate, candidate_parameters,
    channels, fit_device,
};
use haptical_identification::Status;
use haptical_simulator::Noise;

use crate::haptic;

#[test]
fn a_missing_reading_gives_no_residual_and_no_harm() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let mut recording = haptic::record(&truth, 300, 5, Noise::None);
    for row in (0..300).step_by(7) {
        recording.cable_m[0].as_mut().unwrap()[row] = f64::NAN;
    }
    for row in (3..300).step_by(4) {
        recording.output[1].as_mut().unwrap()[row] = f64::NAN;
    }
    let channels = channels(&nominal, &recording).unwrap();
    let weights = Weights::stated(&nominal, &channels);
    let parameters = candidate_parameters(&nominal);
    let layout = DeviceProblem::new(&nominal, &recording, &channels, &parameters, &weights)
        .unwrap()
        .layout();
    let count = |channel| layout[&channel].1;
    assert_eq!(count(Channel::Cable { index: 0 }), 300 - 43);
    assert_eq!(count(Channel::Output { joint: 1 }), 300 - 75);
    assert_eq!(count(Channel::Output { joint: 0 }), 300);
    for method in [CalibrationMethod::TwoStep, CalibrationMethod::Joint] {
        let options = haptic::fixed(method, Weighting::Stated);
        let fitted = fit_device(&nominal, &recording, &options).unwrap();
        for parameter in nominal.link_parameters(false) {
            let error = parameter.value(&fitted.device) - parameter.value(&truth);
            assert!(
                error.abs() < 1e-9,
                "{method:?}, {}: {error}",
                parameter.name(&nominal)
            );
        }
    }
}

/// Where the external encoder of a polynomial's joint was not read, its angle is only guessed: step 2 takes the other
/// rows alone.
#[test]
fn rows_beyond_a_polynomial_do_not_reach_step_2() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let mut recording = haptic::record(&truth, 400, 5, Noise::None);
    let fourth = recording.joint[3].clone();
    let beyond = |row: usize| fourth[row].abs() > 0.35;
    for row in (0..400).filter(|&row| beyond(row)) {
        recording.output[3].as_mut().unwrap()[row] = f64::NAN;
    }
    let within: Vec<f64> = (0..400)
        .filter(|&row| !beyond(row))
        .map(|row| fourth[row])
        .collect();
    let highest = within.iter().copied().fold(0.0, f64::max);
    let lowest = within.iter().copied().fold(0.0, f64::min);
    let inside = fourth
        .iter()
        .filter(|angle| (lowest..=highest).contains(*angle))
        .count();
    assert!(
        (200..390).contains(&inside),
        "{inside}: the test needs both kinds"
    );
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let fitted = fit_device(&nominal, &recording, &options).unwrap();
    let whole = fitted.whole.unwrap();
    assert_eq!(whole.residuals.len(), inside);
    assert!(whole.cost < 1e-6, "{}", whole.cost);
}

/// Without out2 the distances show what of joint 2's capstan moves with the joint; its constant is
/// the joint's offset.
#[test]
fn a_missing_encoder_is_replaced_as_far_as_the_distances_go() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    let mut recording = haptic::record(&truth, 600, 6, Noise::Gaussian);
    recording.output[1] = None;
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    let calibration = calibrate(&nominal, &recording, &options).unwrap();
    assert!(
        calibration
            .warnings
            .iter()
            .any(|text| text.contains("no out2 column")),
        "{:?}",
        calibration.warnings
    );
    let whole = calibration.fitted.whole.as_ref().unwrap();
    let status = |name: &str| {
        &whole
            .estimates
            .iter()
            .find(|e| e.name == name)
            .unwrap()
            .status
    };
    match status("offset2") {
        Status::Dependent { combination } => {
            assert_eq!(combination.len(), 1);
            assert_eq!(combination[0].name, "theta2");
            assert!((combination[0].coefficient - 1.0).abs() < 1e-6);
        }
        other => panic!("offset2 is {other:?}"),
    }
    assert!(matches!(
        status("output_drum_x2"),
        Status::Identifiable { .. } | Status::Weak { .. }
    ));
    let fitted_of_two = whole.fitted.iter().filter(|&&index| {
        let name = &whole.estimates[index].name;
        name.ends_with('2') && (name.contains("drum") || name.contains("ratio"))
    });
    assert!(
        fitted_of_two.count() >= 2,
        "the distances show the capstan of joint 2"
    );
    // With 28 + 57 parameters at most, 600 distances are fitted to their noise.
    let cable = calibration
        .fit_channels
        .iter()
        .find(|c| c.channel == "cable")
        .unwrap();
    assert!(
        cable.rms_after < 1.05 * cable.noise_floor,
        "{:e}",
        cable.rms_after
    );
    // Two steps have no place for it.
    let steps = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let blind = calibrate(&nominal, &recording, &steps).unwrap();
    let other = blind
        .fit_channels
        .iter()
        .find(|c| c.channel == "cable")
        .unwrap();
    assert!(other.rms_after > 1.5 * cable.rms_after);
}

#[test]
fn a_device_without_links_has_its_transmissions_fitted() {
    let Some(mut nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, 300, 6, Noise::None);
    nominal.links.clear();
    nominal.bodies.clear();
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    let calibration = calibrate(&nominal, &recording, &options).unwrap();
    assert!(
        calibration
            .warnings
            .iter()
            .any(|text| text.contains("no [[link]] rows"))
    );
    assert!(calibration.fitted.whole.is_none());
    assert_eq!(calibration.fitted.transmissions.len(), 4);
    for (joint, reading) in [(0, 0.9), (1, -0.7), (2, 0.5), (3, -0.4)] {
        let have = calibration.device.joints[joint].error_rad(reading).unwrap();
        let want = truth.joints[joint].error_rad(reading).unwrap();
        assert!((have - want).abs() < 1e-9, "joint {}", joint + 1);
    }
}

#[test]
fn a_resting_joint_is_named() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    let mut locked = truth.clone();
    locked.joints[2].sampling_sd_rad = Some(1e-14);
    let recording = haptic::record(&locked, 300, 6, Noise::Gaussian);
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let calibration = calibrate(&nominal, &recording, &options).unwrap();
    assert!(
        calibration
            .warnings
            .iter()
            .any(|text| text.starts_with("joint 3 does not move"))
    );
    let whole = calibration.fitted.whole.as_ref().unwrap();
    assert_eq!(whole.nominal_identifiability.rank, 24);
    // Step 2 takes over the errors of step 1; all at once the distances fall to their noise.
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    let calibration = calibrate(&nominal, &recording, &options).unwrap();
    let cable = calibration
        .fit_channels
        .iter()
        .find(|c| c.channel == "cable")
        .unwrap();
    assert!(cable.rms_after < 1.1 * cable.noise_floor);
}
