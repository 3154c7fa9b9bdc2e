//! Exact data give the true device back; noisy data give it back to within the stated deviations.

use haptical_calibration::{
    CalibrationMethod, FittedDevice, Options, Weighting, fit_device, fit_kinematics,
};
use haptical_model::kinematics::Convention;
use haptical_model::{Device, JointType, ParameterId};
use haptical_simulator::{Noise, apply_deviations};

use crate::chain::{RIGS, ROWS, Rig, device_of, measure, pseudo_random};
use crate::haptic;

/// Exact data: rounding of residuals (1e-16 m) times the condition of the problem (1e4 to 1e6).
const EXACT_TOLERANCE: f64 = 1e-9;
/// Standard deviations; stated before any fit was made. Of 57 normal numbers one exceeds it in
/// 30 000 recordings.
const SIGMAS: f64 = 5.0;

fn assert_recovered(fitted: &Device, truth: &Device, nominal: &Device, what: &str) {
    for parameter in nominal.link_parameters(false) {
        let (have, want) = (parameter.value(fitted), parameter.value(truth));
        let name = parameter.name(nominal);
        assert!(
            (have - want).abs() < EXACT_TOLERANCE,
            "{what}, {name}: {have} for {want}"
        );
    }
    for (joint, true_joint) in truth.joints.iter().enumerate() {
        for step in -6..=6 {
            let reading = 0.1 * f64::from(step);
            let have = fitted.joints[joint].error_rad(reading).unwrap();
            let want = true_joint.error_rad(reading).unwrap();
            assert!(
                (have - want).abs() < EXACT_TOLERANCE,
                "{what}, error of joint {} at {reading}: {have} for {want}",
                joint + 1
            );
        }
    }
    for joint in 0..3 {
        for parameter in nominal.transmission_parameters(joint) {
            let (have, want) = (parameter.value(fitted), parameter.value(truth));
            let name = parameter.name(nominal);
            assert!(
                (have - want).abs() < EXACT_TOLERANCE,
                "{what}, {name}: {have} for {want}"
            );
        }
    }
}

#[test]
fn exact_data_give_the_truth_back() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    // The second truth is five times as far away as the paper's arms.
    for factor in [1.0, 5.0] {
        let truth = haptic::truth_of(&nominal, factor);
        let recording = haptic::record(&truth, 400, 11, Noise::None);
        for method in [CalibrationMethod::TwoStep, CalibrationMethod::Joint] {
            let options = haptic::fixed(method, Weighting::Stated);
            let fitted = fit_device(&nominal, &recording, &options).unwrap();
            let whole = fitted.whole.as_ref().unwrap();
            assert!(whole.convergence.was_successful());
            let what = format!("{method:?} x {factor}");
            assert_recovered(&fitted.device, &truth, &nominal, &what);
        }
    }
}

/// (estimate - truth) / sd of every parameter that a fit gives a deviation.
pub(crate) fn errors_in_deviations(fitted: &FittedDevice, truth: &Device) -> Vec<(String, f64)> {
    let whole = fitted.whole.as_ref().unwrap();
    let steps = fitted
        .transmissions
        .iter()
        .filter_map(|step| step.fit.as_ref());
    let mut errors = Vec::new();
    for fit in steps.chain([whole]) {
        let combinations = fit.combinations();
        for (parameter, estimate) in fit.parameters.iter().zip(&fit.estimates) {
            // The polynomial's coefficients belong to the recording's range, not to the truth's.
            if matches!(parameter, ParameterId::Transmission { joint: 3, .. }) {
                continue;
            }
            let is_alone = combinations
                .iter()
                .all(|sum| sum.terms[0].name != estimate.name);
            if let (Some(value), Some(sd), true) =
                (estimate.value, estimate.standard_deviation, is_alone)
            {
                errors.push((estimate.name.clone(), (value - parameter.value(truth)) / sd));
            }
        }
        for sum in combinations {
            let terms = sum
                .terms
                .iter()
                .map(|term| term.coefficient * truth.parameter(&term.name).unwrap().value(truth));
            let error = (sum.value - terms.sum::<f64>()) / sum.standard_deviation;
            errors.push((sum.terms[0].name.clone(), error));
        }
    }
    errors
}

#[test]
fn noisy_data_give_the_truth_back_within_five_deviations() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    for seed in 1..=5 {
        let recording = haptic::record(&truth, 400, seed, Noise::Gaussian);
        let fitted = fit_device(&nominal, &recording, &options).unwrap();
        let errors = errors_in_deviations(&fitted, &truth);
        // Step 1 of three capstans, then everything.
        assert_eq!(errors.len(), 18 + 28 + 18);
        for (name, error) in errors {
            assert!(
                error.abs() < SIGMAS,
                "seed {seed}, {name}: {error} deviations off"
            );
        }
    }
}

/// Step 2 takes the transmissions as exact, so its deviations hold where they are.
#[test]
fn two_steps_hold_within_five_deviations_where_transmissions_are_exact() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let nominal = haptic::exact_readings(nominal);
    let truth = haptic::truth_of(&nominal, 1.0);
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    for seed in 1..=5 {
        let mut recording = haptic::record(&truth, 400, seed, Noise::Gaussian);
        recording.output = haptic::record(&truth, 400, seed, Noise::None).output;
        let fitted = fit_device(&nominal, &recording, &options).unwrap();
        for (name, error) in errors_in_deviations(&fitted, &truth) {
            assert!(
                error.abs() < SIGMAS,
                "seed {seed}, {name}: {error} deviations off"
            );
        }
    }
}

/// A chain whose nominal numbers have no special values, and a truth a little off it.
fn off_by_millimetres(convention: Convention, prismatic: Option<usize>) -> (Device, Device) {
    let twists = [0.7, -1.1, 0.9, -0.6, 1.2];
    let links =
        twists
            .iter()
            .enumerate()
            .map(|(row, &alpha_rad)| haptical_model::kinematics::Link {
                a_m: 0.1 + 0.04 * row as f64,
                alpha_rad,
                d_m: 0.3 - 0.05 * row as f64,
                theta_rad: 0.2 * row as f64,
                beta_rad: 0.0,
                b_m: 0.0,
            });
    let mut nominal = device_of(links.collect());
    nominal.convention = convention;
    if let Some(joint) = prismatic {
        nominal.joints[joint].joint_type = JointType::Prismatic;
    }
    let names: Vec<(String, f64)> = nominal
        .link_parameters(false)
        .iter()
        .enumerate()
        .map(|(k, parameter)| (parameter.name(&nominal), 3e-3 * pseudo_random(9, k as u64)))
        .collect();
    let deviations: Vec<(&str, f64)> = names.iter().map(|(name, x)| (name.as_str(), *x)).collect();
    let truth = apply_deviations(&nominal, &deviations).unwrap();
    (nominal, truth)
}

/// What cannot be distinguished differs from the truth, what is measured does not.
#[test]
fn other_joints_conventions_and_rigs_predict_unseen_poses() {
    for convention in [Convention::Standard, Convention::Modified] {
        for prismatic in [None, Some(0), Some(2)] {
            for rig in RIGS {
                let (nominal, truth) = off_by_millimetres(convention, prismatic);
                let seen = measure(&truth, rig, ROWS, 21);
                let unseen = measure(&truth, rig, 40, 22);
                let channels = haptical_calibration::channels(&nominal, &seen).unwrap();
                let weights = haptical_calibration::Weights::stated(&nominal, &channels);
                let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
                let fit =
                    fit_kinematics(&nominal, &seen, &channels, &weights, &Options { ..options })
                        .unwrap();
                let residuals = haptical_calibration::channel_residuals(
                    &fit.device,
                    &fit.device,
                    &unseen,
                    &channels,
                    &weights,
                )
                .unwrap();
                for channel in residuals {
                    let rms = channel.rms().unwrap();
                    let what = format!("{convention:?}, prismatic {prismatic:?}, {rig:?}");
                    assert!(
                        rms < EXACT_TOLERANCE,
                        "{what}, {}: {rms:e}",
                        channel.channel.name()
                    );
                }
                if rig == Rig::Pose && convention == Convention::Standard && prismatic.is_none() {
                    assert_recovered_links(&fit.device, &truth);
                }
            }
        }
    }
}

/// A pose in a known frame fixes every number of a generic table.
fn assert_recovered_links(fitted: &Device, truth: &Device) {
    for parameter in truth.link_parameters(false) {
        let (have, want) = (parameter.value(fitted), parameter.value(truth));
        assert!(
            (have - want).abs() < EXACT_TOLERANCE,
            "{}",
            parameter.name(truth)
        );
    }
}
