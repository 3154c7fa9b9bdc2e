//! Which rows are held back, and that they stay out of the fit.

use haptical_calibration::{
    CalibrationError, CalibrationMethod, Channel, HeldOut, Options, Weighting, Weights, calibrate,
    channel_residuals, channels, fit_device, split, with_ordered_noise,
};
use haptical_model::{Recording, TransmissionError};
use haptical_simulator::{Noise, true_poses};
use proptest::prelude::*;

use crate::haptic;

fn rows_only(rows: usize) -> Recording {
    Recording {
        line: (2..2 + rows as u64).collect(),
        joint: vec![vec![0.0; rows]],
        ..Recording::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Every row is on one side, and about the share is held out, spread over the recording.
    #[test]
    fn blocks_cover_the_recording(rows in 100..5000_usize, share in 0.01..0.5_f64) {
        let split = split(&rows_only(rows), HeldOut::Share(share)).unwrap();
        let mut all = [split.fit.clone(), split.held_out.clone()].concat();
        all.sort_unstable();
        prop_assert_eq!(all, (0..rows).collect::<Vec<usize>>());
        prop_assert!(split.fit.is_sorted() && split.held_out.is_sorted());
        let held_out = split.held_out.len() as f64 / rows as f64;
        // Whole blocks of a twentieth, or of one row where the share is below a twentieth.
        prop_assert!(held_out > 0.0 && held_out <= 0.55, "{}", held_out);
        prop_assert!((held_out - share).abs() < 0.101, "{} for {}", held_out, share);
    }
}

#[test]
fn a_fifth_is_four_blocks_of_twenty() {
    let split = split(&rows_only(200), HeldOut::default()).unwrap();
    let expected: Vec<usize> = [2, 7, 12, 17]
        .iter()
        .flat_map(|k| 10 * k..10 * k + 10)
        .collect();
    assert_eq!(split.held_out, expected);
    assert_eq!(
        split.description,
        "4 of 20 contiguous blocks held out (40 of 200 rows)"
    );
}

#[test]
fn whole_runs_are_held_out_where_there_are_several() {
    let mut recording = rows_only(100);
    let run = |row: usize| match row {
        0..40 => 5_i64,
        40..70 => 2,
        70..90 => 9,
        _ => 7,
    };
    recording.run = Some((0..100).map(run).collect());
    let out = |share| split(&recording, HeldOut::Share(share)).unwrap().held_out;
    assert_eq!(
        out(0.05),
        (90..100).collect::<Vec<usize>>(),
        "at least one run"
    );
    assert_eq!(out(0.3), (70..100).collect::<Vec<usize>>());
    assert_eq!(out(0.29), (90..100).collect::<Vec<usize>>());
    // The last run has most of the rows: blocks.
    recording.run = Some((0..100).map(|row| i64::from(row >= 20)).collect());
    assert_eq!(out_count(&recording), 20);
    fn out_count(recording: &Recording) -> usize {
        let split = split(recording, HeldOut::Share(0.2)).unwrap();
        assert!(split.description.contains("blocks"));
        split.held_out.len()
    }
}

#[test]
fn shares_have_limits_for_long_and_short_logs() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    for rows in [60, 200] {
        let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), rows, 3, Noise::Gaussian);
        for share in [-0.1, 0.51, f64::NAN, f64::INFINITY] {
            let options = Options {
                held_out: HeldOut::Share(share),
                ..Options::default()
            };
            let refused = calibrate(&nominal, &recording, &options).unwrap_err();
            assert!(
                matches!(
                    refused,
                    CalibrationError::Option {
                        name: "held-out",
                        ..
                    }
                ),
                "{share}"
            );
            assert!(!refused.is_unidentifiable());
        }
    }
    let none = split(&rows_only(10), HeldOut::Share(0.0)).unwrap();
    assert_eq!((none.fit.len(), none.held_out.len()), (10, 0));
}

/// Wrong readings in the held-out rows change what is reported of them, not the fit.
#[test]
fn held_out_rows_do_not_reach_the_fit() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), 300, 3, Noise::Gaussian);
    let options = Options {
        held_out: HeldOut::Share(0.2),
        ..haptic::fixed(CalibrationMethod::Joint, Weighting::Stated)
    };
    let sound = calibrate(&nominal, &recording, &options).unwrap();
    let mut wrong = recording.clone();
    let held_out = split(&recording, options.held_out).unwrap().held_out;
    for &row in &held_out {
        wrong.cable_m[0].as_mut().unwrap()[row] += 0.01;
    }
    let other = calibrate(&nominal, &wrong, &options).unwrap();
    assert_eq!(sound.device, other.device);
    let cable = |calibration: &haptical_calibration::Calibration| {
        calibration
            .held_out_channels
            .iter()
            .find(|c| c.channel == "cable")
            .cloned()
            .unwrap()
    };
    let (sound, other) = (cable(&sound), cable(&other));
    assert_eq!(sound.rows.len() + sound.outside_range, held_out.len());
    assert!(sound.rows.iter().all(|row| held_out.contains(row)));
    assert!(sound.rms_after < 3e-5 && other.rms_after > 9e-3);
    assert!(sound.rms_before > 1e-3);
}

#[test]
fn a_short_log_is_checked_by_folds() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let recording = haptic::record(&haptic::truth_of(&nominal, 1.0), 80, 3, Noise::Gaussian);
    let options = Options {
        held_out: HeldOut::Share(0.2),
        ..haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated)
    };
    let calibration = calibrate(&nominal, &recording, &options).unwrap();
    assert!(
        calibration.held_out.contains("10 folds"),
        "{}",
        calibration.held_out
    );
    assert_eq!(
        calibration.held_out_channels.len(),
        5,
        "{:?}",
        calibration.warnings
    );
    for report in &calibration.held_out_channels {
        assert_eq!(
            (report.readings, report.outside_range),
            (80, 0),
            "{}",
            report.channel
        );
        let mut rows = report.rows.clone();
        rows.sort_unstable();
        assert_eq!(rows, (0..80).collect::<Vec<usize>>());
        let fit = calibration
            .fit_channels
            .iter()
            .find(|f| f.channel == report.channel)
            .unwrap();
        assert!(
            report.rms_after > fit.rms_after,
            "{}: unseen rows are worse",
            report.channel
        );
    }
    let all = haptic::fixed(CalibrationMethod::TwoStep, Weighting::Stated);
    let fitted = fit_device(&nominal, &recording, &all).unwrap();
    let fitted = with_ordered_noise(fitted, &recording, all.method).unwrap();
    assert_eq!(
        calibration.device, fitted.device,
        "the reported device saw every row"
    );
}

/// Beyond its range a polynomial says nothing: such rows are left out of both sides and counted.
#[test]
fn rows_outside_a_polynomials_range_are_counted() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, 200, 3, Noise::None);
    let mut narrow = truth.clone();
    narrow.joints[3].transmission_error = TransmissionError::Chebyshev {
        range_rad: [-0.2, 0.3],
        coefficients: vec![0.0],
    };
    let channels = channels(&nominal, &recording).unwrap();
    let weights = Weights::stated(&nominal, &channels);
    let inside: Vec<usize> = (0..200)
        .filter(|&row| (-0.2..=0.3).contains(&recording.joint[3][row]))
        .collect();
    assert!(inside.len() > 50 && inside.len() < 190);
    for channel in channel_residuals(&truth, &narrow, &recording, &channels, &weights).unwrap() {
        let concerned = matches!(
            channel.channel,
            Channel::Output { joint: 3 } | Channel::Cable { .. }
        );
        let kept: Vec<usize> = if concerned {
            inside.clone()
        } else {
            (0..200).collect()
        };
        assert_eq!(
            channel.outside_range,
            200 - kept.len(),
            "{}",
            channel.channel.name()
        );
        assert_eq!(channel.rows, kept);
        assert!(channel.rms().unwrap() < 1e-14);
    }
}

/// So few rows that no fold can be fitted: the residual of the fit is small, and says nothing.
#[test]
fn where_no_fold_can_be_fitted_nothing_is_checked() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let options = Options {
        held_out: HeldOut::Share(0.2),
        ..haptic::fixed(CalibrationMethod::Joint, Weighting::Stated)
    };
    // as few postures as can be fitted at all
    let calibration = (6..30).find_map(|postures| {
        let mut recording = haptic::record(&truth, postures, 3, Noise::Gaussian);
        let poses = true_poses(&truth, &recording).unwrap();
        recording.output = vec![None; 7];
        recording.cable_m = vec![None];
        let axis = |axis: usize| poses.iter().map(|pose| pose.position_m[axis]).collect();
        recording.position_m = Some([axis(0), axis(1), axis(2)]);
        calibrate(&nominal, &recording, &options).ok()
    });
    let calibration = calibration.unwrap();
    assert!(
        calibration.held_out.starts_with("not checked"),
        "{}",
        calibration.held_out
    );
    assert!(calibration.judged_channels().is_empty());
    assert!(!calibration.fit_channels.is_empty());
    let warned = |warning: &String| warning.contains("was not checked");
    assert!(
        calibration.warnings.iter().any(warned),
        "{:?}",
        calibration.warnings
    );
}
