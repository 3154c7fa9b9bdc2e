//! Recordings that fix nothing, and recordings that are wrong.

use haptical_calibration::{
    CalibrationError, CalibrationMethod, Weighting, calibrate, channels, fit_kinematics,
};
use haptical_model::Recording;
use haptical_simulator::Noise;

use crate::chain::{Rig, device_of, measure};
use crate::haptic;

fn sound() -> Option<(haptical_model::Device, Recording)> {
    let nominal = haptic::haptic7()?;
    let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), 200, 8, Noise::Gaussian);
    Some((nominal, recording))
}

#[test]
fn one_pose_fixes_nothing() {
    let Some((nominal, recording)) = sound() else {
        return;
    };
    let one = recording.select(&[5; 200]);
    for method in [CalibrationMethod::TwoStep, CalibrationMethod::Joint] {
        let options = haptic::fixed(method, Weighting::Stated);
        let refused = calibrate(&nominal, &one, &options).unwrap_err();
        assert_eq!(refused, CalibrationError::NoMotion { rows: 200 });
        assert!(refused.is_unidentifiable());
    }
}

#[test]
fn twenty_seven_distances_do_not_fix_twenty_eight_parameters() {
    let Some((nominal, recording)) = sound() else {
        return;
    };
    let few: Vec<usize> = (0..27).collect();
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let refused = calibrate(&nominal, &recording.select(&few), &options).unwrap_err();
    assert!(refused.is_unidentifiable());
    match refused {
        CalibrationError::TooFewRows {
            what,
            rows,
            parameters,
            advised,
        } => {
            assert_eq!(
                (what.as_str(), rows, parameters),
                ("kinematic parameters", 27, 28)
            );
            assert!(advised > 28);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn a_handle_on_the_exit_is_a_wrong_reading() {
    let Some((nominal, mut recording)) = sound() else {
        return;
    };
    recording.cable_m[0].as_mut().unwrap()[17] = 0.0;
    let options = haptic::fixed(CalibrationMethod::Joint, Weighting::Stated);
    let refused = calibrate(&nominal, &recording, &options).unwrap_err();
    assert!(!refused.is_unidentifiable());
    match refused {
        CalibrationError::Reading { line, column, .. } => {
            assert_eq!((line, column.as_str()), (recording.line[17], "cable_m"));
        }
        other => panic!("{other}"),
    }
}

/// A device whose handle is on the exit at some reading has no derivative there.
#[test]
fn a_model_on_the_exit_names_the_line() {
    let mut device = device_of(vec![haptical_model::kinematics::Link::default(); 3]);
    device.links[1].a_m = 0.2;
    device.links[2].a_m = 0.2;
    let mut recording = measure(&device, Rig::Cable, 50, 1);
    recording.joint[1][20] = std::f64::consts::PI;
    let seen = channels(&device, &recording).unwrap();
    let weights = haptical_calibration::Weights::stated(&device, &seen);
    let options = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    // The sum of the sines leaves 2e-17 m: move the links onto the exit exactly.
    device.links[1].a_m = 0.0;
    device.links[2].a_m = 0.0;
    let refused = fit_kinematics(&device, &recording, &seen, &weights, &options).unwrap_err();
    assert!(
        refused.to_string().contains("line 2 of the log"),
        "{refused}"
    );
    assert!(!refused.is_unidentifiable());
}

#[test]
fn nothing_measured_and_unknown_frames_are_bad_input() {
    let Some((mut nominal, mut recording)) = sound() else {
        return;
    };
    let mut device = device_of(nominal.links.clone());
    let poses = measure(&device, Rig::Pose, 60, 1);
    for which in ["base", "tool"] {
        let tracker = device.tracker.as_mut().unwrap();
        (tracker.base_known, tracker.tool_known) = (which != "base", which != "tool");
        assert_eq!(channels(&device, &poses).unwrap().len(), 2);
    }
    recording.output = vec![None; 7];
    nominal.links.clear();
    let refused = channels(&nominal, &recording).unwrap_err();
    assert_eq!(refused, CalibrationError::NoChannel);
    assert!(!refused.is_unidentifiable());
}
