//! Logs that dwell at few postures, repeat rows, or hold a wild reading where the fit does not look.

use haptical_calibration::{
    Calibration, HeldOut, LossChoice, Options, Weighting, calibrate, without_copies,
};
use haptical_model::{Device, Recording, Tracker};

use crate::rig_scene::{normal, plain, readings, table, tracked};

/// A device before a tracker at a known place, and what it truly is.
fn devices() -> (Device, Device) {
    let mut nominal = table(5);
    nominal.tracker = Some(Tracker {
        base_known: true,
        base_per_run: false,
        tool_known: true,
        position_sd_m: Some(1e-4),
        rotation_sd_rad: Some(2e-4),
        scale_sd: Some(0.0),
    });
    let mut truth = nominal.clone();
    for (row, link) in truth.links.iter_mut().enumerate() {
        link.a_m += 1e-3 * normal(1, row as u64);
        link.d_m += 1e-3 * normal(2, row as u64);
        link.theta_rad += 2e-3 * normal(3, row as u64);
    }
    (nominal, truth)
}

/// Positions at so many postures, so many rows at each.
fn dwelling(truth: &Device, postures: usize, rows: usize) -> Recording {
    let columns = readings(truth, postures, 1.4, 5);
    let again = |column: Vec<f64>| {
        let rows = column.into_iter().flat_map(|value| vec![value; rows]);
        rows.collect()
    };
    // a tremor far below the noise
    let mut columns: Vec<Vec<f64>> = columns.into_iter().map(again).collect();
    for (joint, column) in columns.iter_mut().enumerate() {
        for (row, value) in column.iter_mut().enumerate() {
            *value += 1e-6 * normal(40 + joint as u64, row as u64);
        }
    }
    let mut recording = plain(columns);
    tracked(truth, &mut recording, 1.0, 9);
    recording.orientation_wxyz = None;
    recording
}

fn calibrated(device: &Device, recording: &Recording) -> Calibration {
    let options = Options {
        weighting: Weighting::Stated,
        loss: LossChoice::Auto,
        ..Options::default()
    };
    calibrate(device, recording, &options).unwrap()
}

fn says(result: &Calibration, words: &str) -> bool {
    result
        .warnings
        .iter()
        .any(|warning| warning.contains(words))
}

#[test]
fn whole_postures_are_held_out_where_the_device_dwells() {
    let (nominal, truth) = devices();
    let result = calibrated(&nominal, &dwelling(&truth, 6, 50));
    assert!(
        result.held_out.contains("6 folds of whole postures"),
        "{}",
        result.held_out
    );
    assert!(
        says(&result, "at 6 different postures"),
        "{:?}",
        result.warnings
    );
    // five postures do not tell the sixth: blocks of rows would have claimed the noise
    let held_out = &result.held_out_channels[0];
    assert!(held_out.rms_after > 5e-4, "{}", held_out.rms_after);
    assert!(result.fit_channels[0].rms_after < 1.2e-4);
}

#[test]
fn blocks_are_held_out_where_every_row_is_a_posture() {
    let (nominal, truth) = devices();
    let result = calibrated(&nominal, &dwelling(&truth, 300, 1));
    assert!(
        result.held_out.contains("contiguous blocks"),
        "{}",
        result.held_out
    );
    assert!(result.held_out_channels[0].rms_after < 1.3e-4);
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}

#[test]
fn joints_that_move_together_are_told() {
    let (nominal, truth) = devices();
    let mut recording = dwelling(&truth, 300, 1);
    let first = recording.joint[0].clone();
    for (joint, column) in recording.joint.iter_mut().enumerate() {
        let share = 1.0 - 0.3 * joint as f64;
        column.clone_from(&first.iter().map(|value| share * value).collect());
    }
    tracked(&truth, &mut recording, 1.0, 9);
    let result = calibrated(&nominal, &recording);
    assert!(
        says(&result, "in 1 independent directions"),
        "{:?}",
        result.warnings
    );
}

#[test]
fn copied_rows_count_once() {
    let (_, truth) = devices();
    let once = dwelling(&truth, 60, 1);
    let copies: Vec<usize> = (0..600).map(|row| row % 60).collect();
    let copied = once.select(&copies);
    let (found, warning) = without_copies(&copied);
    assert_eq!(*found, once);
    assert!(warning.unwrap().starts_with("540 of 600 rows repeat"));
    let (same, silent) = without_copies(&once);
    assert_eq!((&*same, silent), (&once, None));
}

#[test]
fn a_wild_reading_that_is_held_out_is_named() {
    let (nominal, truth) = devices();
    let mut recording = dwelling(&truth, 300, 1);
    let clean = calibrated(&nominal, &recording);
    let row = clean.held_out_channels[0].rows[10];
    recording.position_m.as_mut().unwrap()[0][row] += 0.3;
    let result = calibrated(&nominal, &recording);
    let lines: Vec<u64> = result.outliers.iter().map(|outlier| outlier.line).collect();
    assert_eq!(lines, [recording.line[row]]);
    assert!(result.held_out_channels[0].rms_after_good < 1.3e-4);
    assert!(
        says(&result, "held-out rows farther"),
        "{:?}",
        result.warnings
    );
    assert!(!says(&result, "lacks an effect"), "{:?}", result.warnings);
}

#[test]
fn a_floor_that_is_far_too_high_is_told() {
    let (mut nominal, truth) = devices();
    let recording = dwelling(&truth, 300, 1);
    nominal.tracker.as_mut().unwrap().position_sd_m = Some(1e-3);
    let options = Options {
        weighting: Weighting::Estimated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    let result = calibrate(&nominal, &recording, &options).unwrap();
    assert!(
        says(&result, "far below the noise floor"),
        "{:?}",
        result.warnings
    );
}
