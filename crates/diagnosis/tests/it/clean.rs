//! Recordings without an effect, whatever is done to them.

use std::fmt::Write;

use haptical_data::{JointShape, LogShape, read_log_from, write_log_to};
use haptical_diagnosis::Verdict;
use haptical_model::Recording;

use crate::arm::{Errors, Session, diagnosed, every, record, record_yielding, summary};

fn clean(seed: u64) -> Recording {
    let session = Session {
        seed,
        ..Session::default()
    };
    record(&session, |_| Errors::default())
}

fn assert_no_gap(recording: &Recording) {
    let diagnosis = diagnosed(recording);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
    assert!(diagnosis.causes.is_empty());
    for channel in &diagnosis.gap.channels {
        let ratio = channel.rms_before / channel.noise_floor;
        // 2400 rows: the ratio scatters by 0.015, and the model takes a hundredth
        assert!(
            (0.93..1.07).contains(&ratio),
            "{}: {ratio}",
            channel.channel
        );
    }
}

#[test]
fn a_clean_recording_has_no_gap() {
    // the false-alarm rate is far below one in eight
    for seed in 1..=8 {
        assert_no_gap(&clean(seed));
    }
}

#[test]
fn half_of_the_rows_of_a_clean_recording_have_no_gap() {
    assert_no_gap(&every(&clean(9), 2));
}

#[test]
fn later_runs_and_another_clock_change_nothing() {
    let session = Session {
        start_s: 86_400.0,
        ..Session::default()
    };
    assert_no_gap(&record(&session, |_| Errors::default()));
    let one = record_yielding(&Session::default());
    let later = record_yielding(&session);
    let (one, later) = (diagnosed(&one), diagnosed(&later));
    assert_eq!(one.verdict, later.verdict);
    for (one, later) in one.causes.iter().zip(&later.causes) {
        assert_eq!((&one.effect, one.joint), (&later.effect, later.joint));
        for (one, later) in one.parameters.values().zip(later.parameters.values()) {
            // times lose a few digits at a day's distance
            assert!(
                (one.value / later.value - 1.0).abs() < 1e-6,
                "{one:?} {later:?}"
            );
        }
    }
}

fn shape() -> LogShape {
    let joint = || JointShape {
        name: "joint".to_owned(),
        prismatic: false,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
    LogShape {
        joints: vec![joint(), joint(), joint()],
        cable_count: 1,
    }
}

/// The same log with its columns in another order.
fn with_columns_reordered(recording: &Recording) -> Recording {
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, recording, &shape()).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let mut reordered = String::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        // 5 and the number of columns have no common divisor
        assert!(!cells.len().is_multiple_of(5), "{}", cells.len());
        let moved: Vec<&str> = (0..cells.len())
            .map(|k| cells[(5 * k + 3) % cells.len()])
            .collect();
        writeln!(reordered, "{}", moved.join(",")).unwrap();
    }
    assert_ne!(text.lines().next(), reordered.lines().next());
    read_log_from(reordered.as_bytes(), "reordered.csv", &shape())
        .unwrap()
        .recording
}

#[test]
fn the_order_of_the_columns_is_of_no_account() {
    let recording = record_yielding(&Session::default());
    let one = serde_json::to_string(&diagnosed(&recording)).unwrap();
    let other = serde_json::to_string(&diagnosed(&with_columns_reordered(&recording))).unwrap();
    assert_eq!(one, other);
}

#[test]
fn louder_noise_than_stated_is_noise_and_is_said() {
    // twice the stated noise on one encoder
    let session = Session::default();
    let mut recording = record(&session, |_| Errors::default());
    let mut noise = crate::normal::Normal::new(77);
    for value in recording.output[2].as_mut().unwrap() {
        *value += 3.0_f64.sqrt() * crate::arm::OUTPUT_SD_RAD * noise.next();
    }
    let diagnosis = diagnosed(&recording);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
    let found = diagnosis
        .noise
        .iter()
        .find(|noise| noise.channel == "out3")
        .unwrap();
    assert!((found.ratio - 2.0).abs() < 0.15, "{found:?}");
    for other in diagnosis
        .noise
        .iter()
        .filter(|noise| noise.channel != "out3")
    {
        assert!((other.ratio - 1.0).abs() < 0.1, "{other:?}");
    }
}

#[test]
fn outliers_are_left_out_and_counted() {
    let session = Session::default();
    let mut recording = record(&session, |_| Errors::default());
    // one reading in forty stands 40 deviations off
    for value in recording.output[0].as_mut().unwrap().iter_mut().step_by(40) {
        *value += 40.0 * crate::arm::OUTPUT_SD_RAD;
    }
    let diagnosis = diagnosed(&recording);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
    let found = diagnosis
        .noise
        .iter()
        .find(|noise| noise.channel == "out1")
        .unwrap();
    assert!((found.outlier_share - 1.0 / 40.0).abs() < 2e-3, "{found:?}");
}
