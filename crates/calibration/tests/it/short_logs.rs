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
