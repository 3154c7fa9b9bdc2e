//! Intervals of parameters whose partners were held, and what becomes of a fit that is worse than none.

use haptical_calibration::{
    Calibration, CalibrationMethod, Channel, Held, HeldOut, Kept, Options, ParameterFit, Weighting,
    Weights, calibrate, fit_kinematics, fit_transmission, with_curvature,
};
use haptical_model::{Device, ParameterId, Recording, TransmissionKind};
use haptical_simulator::{Noise, Settings, apply_deviations, simulate_transmission};

use crate::haptic;

const CABLE: [Channel; 1] = [Channel::Cable { index: 0 }];

/// The device with direct joints: nothing but the chain is to be found.
fn direct(mut nominal: Device) -> Device {
    for joint in &mut nominal.joints {
        joint.transmission = TransmissionKind::Direct;
        joint.external_encoder_sd_rad = None;
        joint.external_encoder_counts_per_rev = None;
    }
    haptic::exact_readings(nominal)
}

fn kinematics(nominal: &Device, recording: &Recording) -> ParameterFit {
    let weights = Weights::stated(nominal, &CABLE);
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let fit = fit_kinematics(nominal, recording, &CABLE, &weights, &options).unwrap();
    with_curvature(fit, recording, &CABLE, &weights).unwrap()
}

fn half_widths_off(fit: &ParameterFit, name: &str, truth: &Device) -> f64 {
    let index = fit
        .estimates
        .iter()
        .position(|estimate| estimate.name == name)
        .unwrap();
    let [low, high] = fit.estimates[index].ci95.unwrap();
    let error = (low + high) / 2.0 - fit.parameters[index].value(truth);
    error / ((high - low) / 2.0)
}

/// d0 and theta1 are one turn about the cable's exit: a d0 of 2.5 mm was a theta1 88 half widths off. What stays
/// fixed is their combination; a0 and d1 move with the second order of that turn.
#[test]
fn a_partner_that_is_off_widens_the_intervals() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = direct(nominal);
    let truth = apply_deviations(&nominal, &[("d0", 2.5e-3), ("alpha0", 0.02)]).unwrap();
    let fit = kinematics(&nominal, &haptic::record(&truth, 200, 11, Noise::Gaussian));
    for name in ["theta1", "a0", "d1", "theta2", "d3"] {
        let off = half_widths_off(&fit, name, &truth);
        assert!(off.abs() < 2.0, "{name}: {off} half widths");
    }
    let sums = fit.combinations();
    assert_eq!(sums.len(), 1);
    let names: Vec<&str> = sums[0]
        .terms
        .iter()
        .map(|term| term.name.as_str())
        .collect();
    assert_eq!(names, ["theta1", "d0"]);
    let actual: f64 = sums[0]
        .terms
        .iter()
        .map(|term| term.coefficient * truth.parameter(&term.name).unwrap().value(&truth))
        .sum();
    let [low, high] = sums[0].ci95;
    assert!(
        (low..=high).contains(&actual),
        "{actual} not in {low}..{high}"
    );
    // the sum is known a hundred times better than theta1 alone
    let theta1 = fit.estimates.iter().find(|e| e.name == "theta1").unwrap();
    assert!(100.0 * sums[0].standard_deviation < theta1.standard_deviation.unwrap());
}

/// Deviations in plausible sizes that few samples do not tell from none.
const SMALL: f64 = 0.03;

/// Few samples support few terms; those that were kept do not pretend that the others are zero.
#[test]
fn terms_without_support_widen_those_that_are_kept() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let (mut held, mut inside, mut given, mut without) = (0, 0, 0, 0);
    for seed in 0..40 {
        let mut truth = nominal.clone();
        for (k, parameter) in nominal.transmission_parameters(0).into_iter().enumerate() {
            let amount = SMALL * 3.0_f64.sqrt() * crate::chain::pseudo_random(seed, k as u64);
            parameter.set(&mut truth, parameter.plausible_size(&nominal) * amount);
        }
        let recording = simulate_transmission(&truth, &Settings::paper(), 0, 30, seed).unwrap();
        let channels = [Channel::Output { joint: 0 }];
        let weights = Weights::stated(&nominal, &channels);
        let fit = fit_transmission(&nominal, 0, &recording, &weights, &Options::default()).unwrap();
        let fit = fit.fit.unwrap();
        assert_eq!(
            fit.parameters.len(),
            6,
            "all of equation (1) is accounted for"
        );
        let unsupported = fit
            .considered
            .held
            .iter()
            .filter(|held| **held == Held::Unsupported);
        held += usize::from(unsupported.count() > 0);
        for (position, &index) in fit.fitted.iter().enumerate() {
            let estimate = &fit.estimates[index];
            let (Some([low, high]), Some(value)) = (estimate.ci95, estimate.value) else {
                continue;
            };
            let actual = fit.parameters[index].value(&truth);
            given += 1;
            inside += usize::from((low..=high).contains(&actual));
            let by_noise = fit.uncertainty.half_width_95(fit.noise)
                * fit.uncertainty.standard_deviation(position);
            without += usize::from((value - actual).abs() <= by_noise);
        }
    }
    assert!(held > 10, "{held} devices lost a term");
    let [share, before] = [inside, without].map(|count| count as f64 / given as f64);
    assert!((0.92..=1.0).contains(&share), "{share} of {given}");
    assert!(before < 0.85, "without what was held: {before}");
}

/// Two runs of a device; in the first the distances carry 3 mm that come and go with joint 2.
fn disturbed_run(truth: &Device) -> Recording {
    let mut recording = haptic::record(truth, 250, 5, Noise::Gaussian);
    recording.run = Some((0..250).map(|row| i64::from(row >= 200)).collect());
    let joint = recording.joint[1].clone();
    if let Some(distances) = &mut recording.cable_m[0] {
        for (distance, reading) in distances.iter_mut().zip(&joint).take(200) {
            *distance += 3e-3 * (3.0 * reading).sin();
        }
    }
    recording
}

fn calibrated(nominal: &Device, recording: &Recording) -> Calibration {
    let options = Options {
        held_out: HeldOut::Share(0.2),
        ..Options::default()
    };
    calibrate(nominal, recording, &options).unwrap()
}

/// The fit of a device that is as its file says, to a run that is disturbed, is worse on another run than none.
#[test]
fn a_fit_that_is_worse_than_none_is_rejected() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = direct(nominal);
    let found = calibrated(&nominal, &disturbed_run(&nominal));
    let rejected = found.rejected.as_ref().unwrap();
    assert!(rejected.growth.rms_after > 1.1 * rejected.growth.rms_before);
    assert!(
        found.warnings[0].starts_with("the fit is rejected"),
        "{:?}",
        found.warnings
    );
    let moved = |device: &Device, parameter: ParameterId| {
        (parameter.value(device) - parameter.value(&nominal)).abs() > 1e-12
    };
    let changed: Vec<String> = nominal
        .link_parameters(false)
        .into_iter()
        .filter(|parameter| moved(&found.device, *parameter))
        .map(|parameter| parameter.name(&nominal))
        .collect();
    match rejected.kept {
        Kept::Nominal => assert_eq!(changed, Vec::<String>::new()),
        Kept::JointOffsets => assert!(changed.iter().all(|name| name.starts_with("theta"))),
    }
    let full = nominal.link_parameters(false);
    assert!(
        full.into_iter()
            .filter(|p| moved(&rejected.device, *p))
            .count()
            > 10
    );
    // and what is kept is no worse than nothing
    for report in &found.held_out_channels {
        assert!(report.rms_after <= report.rms_before, "{}", report.channel);
    }
}

/// A device that is 5 mm and 14 mrad off gains by its fit, and keeps it.
#[test]
fn a_fit_that_helps_is_kept() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = direct(nominal);
    let truth: Vec<(&str, f64)> = haptic::DEVIATIONS
        .iter()
        .filter(|(name, _)| {
            nominal
                .parameter(name)
                .is_ok_and(|p| matches!(p, ParameterId::Link { .. }))
        })
        .copied()
        .collect();
    let truth = apply_deviations(&nominal, &truth).unwrap();
    let recording = haptic::record(&truth, 200, 6, Noise::Gaussian);
    assert!(calibrated(&nominal, &recording).rejected.is_none());
}
