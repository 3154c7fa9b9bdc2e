//! Few postures and wild readings: what the figures and the warnings of a sound result say.

use std::collections::BTreeSet;

use haptical_calibration::{Calibration, LossChoice, Options, calibrate, candidate_parameters};
use haptical_model::{Device, Recording};

use crate::chain::pseudo_random;
use crate::rig_scene::{placement, plain, readings, table, tracked, unknown_tracker};

/// A six-joint arm as built, and what a tracker at an unknown place sees of it.
fn seen(nominal: &Device, rows: usize, noise: f64, seed: u64) -> Recording {
    let mut truth = nominal.clone();
    for (index, parameter) in candidate_parameters(nominal).into_iter().enumerate() {
        let size = 0.3 * parameter.plausible_size(nominal);
        let value = parameter.value(&truth) + size * pseudo_random(seed, index as u64);
        parameter.set(&mut truth, value);
    }
    truth.surroundings.tracker_base = Some(placement(seed, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(seed + 1, 0.1, 0.0));
    let mut recording = plain(readings(&truth, rows, 1.5, seed + 2));
    tracked(&truth, &mut recording, noise, seed + 3);
    recording.orientation_wxyz = None;
    recording
}

fn arm() -> Device {
    let mut nominal = table(6);
    unknown_tracker(&mut nominal);
    nominal.surroundings.tracker_base = None;
    nominal.surroundings.tracker_tool = None;
    nominal
}

fn calibrated(recording: &Recording) -> Calibration {
    let options = Options {
        loss: LossChoice::Auto,
        ..Options::default()
    };
    calibrate(&arm(), recording, &options).unwrap()
}

fn says_lacks_an_effect(calibration: &Calibration) -> bool {
    let warnings = calibration.warnings.iter();
    let mut own = warnings.filter(|warning| warning.contains("lacks an effect, rows"));
    own.next().is_some()
}

/// Held-out rows of twelve postures are predicted by a fit of eleven: its own error is in them.
#[test]
fn a_short_clean_log_is_not_said_to_lack_an_effect() {
    for rows in [12, 14, 20, 40] {
        let alarms = (0..6).filter(|seed| {
            let recording = seen(&arm(), rows, 1.0, 1000 + 10 * seed);
            says_lacks_an_effect(&calibrated(&recording))
        });
        assert_eq!(alarms.count(), 0, "{rows} rows");
    }
}

#[test]
fn noise_beyond_the_stated_is_told_of_a_short_log_too() {
    for (rows, noise) in [(14, 8.0), (20, 3.0), (150, 2.0)] {
        let recording = seen(&arm(), rows, noise, 2000);
        assert!(says_lacks_an_effect(&calibrated(&recording)), "{rows} rows");
    }
}

/// In 1.2 s a line in time and turns of axes that are nearly parallel leave the same: no such line moves the arm.
#[test]
fn a_short_motion_of_a_planar_arm_is_fitted_to_its_noise() {
    let joint = "[[joint]]\ntransmission = \"direct\"\nlower_rad = -2.0\nupper_rad = 2.0\nexternal_encoder_sd_rad = 1e-4\n";
    let tracker =
        "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 1e-4\nscale_sd = 0.0\n";
    let made = |lengths: [f64; 2]| {
        let link = |a_m: f64| format!("[[link]]\na_m = {a_m}\nalpha_rad = 0.0\nd_m = 0.0\n");
        let links = [0.0, lengths[0], lengths[1]].map(link).concat();
        let text = format!("[device]\nname = \"planar\"\ndof = 2\n{links}{joint}{joint}{tracker}");
        Device::from_toml(&text, "planar.toml").unwrap().device
    };
    let (nominal, truth) = (made([0.3, 0.2]), made([0.3012, 0.1991]));
    for seed in 0..24 {
        let time_s: Vec<f64> = (0..60).map(|row| 0.02 * f64::from(row)).collect();
        let of = |q: &dyn Fn(f64) -> f64| time_s.iter().map(|t| q(*t)).collect::<Vec<f64>>();
        let joints = vec![
            of(&|t| 1.5 * (0.9 * t).sin()),
            of(&|t| 0.2 + 1.4 * (1.7 * t + 0.5).sin()),
        ];
        let mut recording = plain(joints);
        recording.time_s = Some(time_s);
        let mut seeing = truth.clone();
        seeing.tracker.as_mut().unwrap().rotation_sd_rad = Some(1.0);
        tracked(&seeing, &mut recording, 1.0, seed);
        recording.orientation_wxyz = None;
        let found = calibrate(&nominal, &recording, &Options::default()).unwrap();
        let left = found.fit_channels[0].rms_after;
        assert!(left < 1.3e-4, "seed {seed}: {left} m");
    }
}

/// Five readings that are centimetres off: the figures of the good ones are at their noise, and each is listed once.
#[test]
fn wild_readings_are_listed_once_and_left_out_of_the_good_figures() {
    let mut recording = seen(&arm(), 150, 1.0, 3000);
    let wild = [10, 40, 77, 101, 140];
    for (number, row) in wild.into_iter().enumerate() {
        recording.position_m.as_mut().unwrap()[number % 3][row] += 0.02;
    }
    let calibration = calibrated(&recording);
    let lines: BTreeSet<u64> = wild.into_iter().map(|row| recording.line[row]).collect();
    let listed = calibration.outliers.iter().map(|outlier| outlier.line);
    assert_eq!(listed.clone().collect::<BTreeSet<u64>>(), lines);
    assert_eq!(listed.count(), lines.len());
    let report = &calibration.held_out_channels[0];
    assert_eq!(report.outliers, 5);
    assert!(report.rms_after > 10.0 * report.noise_floor);
    assert!(report.rms_after_good < 1.5 * report.noise_floor);
    assert!(report.rms_before_good > 2.0 * report.rms_after_good);
    assert!(report.reduction_percent_good > report.reduction_percent);
}
