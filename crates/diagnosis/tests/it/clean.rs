//! Recordings without an effect, whatever is done to them.

use std::fmt::Write;

use haptical_data::{JointShape, LogShape, read_log_from, write_log_to};
use haptical_diagnosis::{Options, Verdict, diagnose};
use haptical_model::Recording;

use crate::arm::{
    CABLE_SD_M, Errors, OUTPUT_SD_RAD, STEP_S, Session, device, diagnosed, every, record,
    record_with_noise, record_yielding, summary,
};
use crate::normal::Normal;

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
        hands: Vec::new(),
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
    let mut noise = Normal::new(77);
    for value in recording.output[2].as_mut().unwrap() {
        *value += 3.0_f64.sqrt() * OUTPUT_SD_RAD * noise.next();
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

/// Noise of the stated size whose successive rows agree to 0.95. The arm rests now and then: a rest is one long block, and
/// its mean is as uncertain as the memory makes it.
#[test]
fn noise_with_a_memory_is_no_gap_beside_rests() {
    let session = Session {
        start_s: 10.0,
        runs: 1,
        rows_of_a_run: 4000,
        ..Session::default()
    };
    let still = record_with_noise(&session, 0.0, |_| Errors::default());
    let rests = |row: usize| if row.is_multiple_of(400) { 200 } else { 1 };
    let rows = (0..still.len()).flat_map(|row| std::iter::repeat_n(row, rests(row)));
    let rows: Vec<usize> = rows.collect();
    for seed in 1..=6 {
        let mut recording = still.select(&rows);
        let times = recording.time_s.as_mut().unwrap();
        for (row, time) in times.iter_mut().enumerate() {
            *time = session.start_s + STEP_S * row as f64;
        }
        let mut noise = Normal::new(seed);
        let mut add = |column: &mut Vec<f64>, sd: f64| {
            let mut state = noise.next();
            for value in column {
                state = 0.95 * state + (1.0_f64 - 0.95 * 0.95).sqrt() * noise.next();
                *value += sd * state;
            }
        };
        for column in recording.output.iter_mut().flatten() {
            add(column, OUTPUT_SD_RAD);
        }
        add(recording.cable_m[0].as_mut().unwrap(), CABLE_SD_M);
        let diagnosis = diagnosed(&recording);
        let summary = summary(&diagnosis);
        assert_eq!(diagnosis.verdict, Verdict::NoGap, "seed {seed}: {summary}");
    }
}

#[test]
fn outliers_are_left_out_and_counted() {
    let session = Session::default();
    let mut recording = record(&session, |_| Errors::default());
    // one reading in forty is 40 deviations off
    for value in recording.output[0].as_mut().unwrap().iter_mut().step_by(40) {
        *value += 40.0 * OUTPUT_SD_RAD;
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

/// The named findings are what `--without` leaves out, as the laws of the catalogue are.
#[test]
fn findings_on_the_data_are_left_out_on_request() {
    let mut recording = record(&Session::default(), |_| Errors::default());
    let output = recording.output[0].as_mut().unwrap();
    for value in output.iter_mut().step_by(40) {
        *value += 40.0 * OUTPUT_SD_RAD;
    }
    let mut noise = Normal::new(77);
    for value in recording.output[2].as_mut().unwrap() {
        *value += 3.0_f64.sqrt() * OUTPUT_SD_RAD * noise.next();
    }
    let names = |without: &[&str]| -> Vec<String> {
        let options = Options {
            without: without.iter().map(|name| (*name).to_owned()).collect(),
            ..Options::default()
        };
        let diagnosis = diagnose(&device(), &recording, &options).unwrap();
        let causes = diagnosis.causes.into_iter();
        causes.map(|cause| cause.effect).collect()
    };
    assert_eq!(names(&[]), ["outliers", "noise-level"]);
    assert_eq!(names(&["outliers"]), ["noise-level"]);
    assert_eq!(names(&["noise-level"]), ["outliers"]);
}

/// A thousandth of the counts makes a noise floor below which everything would pass for noise.
#[test]
fn counts_that_the_log_refutes_hide_no_gap() {
    let mut typo = device();
    for joint in &mut typo.joints {
        joint.encoder_counts_per_rev = Some(20.0);
    }
    let recording = record_yielding(&Session::default());
    let diagnosis = diagnose(&typo, &recording, &Options::default()).unwrap();
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
    assert_eq!(
        diagnosis.causes[0].effect, "capstan-compliance",
        "{summary}"
    );
    let said = |text: &str| diagnosis.warnings.iter().any(|said| said.contains(text));
    assert!(
        said("encoder_counts_per_rev = 20 "),
        "{:?}",
        diagnosis.warnings
    );
    let level = diagnosis
        .causes
        .iter()
        .find(|cause| cause.effect == "noise-level");
    let ratio = level.unwrap().parameters["ratio"];
    assert!(ratio.value < 0.5 && ratio.ci95[1] < 1.0, "{ratio:?}");
}

#[test]
fn a_stated_deviation_that_is_far_too_large_is_named() {
    let mut coarse = device();
    coarse.cables[0].distance_sd_m = Some(100.0 * CABLE_SD_M);
    let diagnosis = diagnose(&coarse, &clean(1), &Options::default()).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
    let said = |text: &str| diagnosis.warnings.iter().any(|said| said.contains(text));
    assert!(said("distance_sd_m"), "{:?}", diagnosis.warnings);
    let cable = diagnosis
        .gap
        .channels
        .iter()
        .find(|gap| gap.channel == "cable")
        .unwrap();
    let floor = cable.noise_floor / CABLE_SD_M;
    assert!(floor < 5.0, "{floor}");
    let quiet = diagnose(&device(), &clean(1), &Options::default()).unwrap();
    assert!(quiet.causes.is_empty(), "{}", summary(&quiet));
    // the arm's file has no gravity
    let of_torques = |warning: &&String| warning.contains("torques were not tested");
    let others = quiet.warnings.iter().filter(|warning| !of_torques(warning));
    assert_eq!(others.count(), 0, "{:?}", quiet.warnings);
}

/// Control of false alarms: noise with memory depends on nothing.
#[test]
fn noise_with_memory_has_no_gap() {
    let mut flagged = Vec::new();
    for seed in 0..30 {
        let session = Session {
            seed: 100 + seed,
            runs: 2,
            rows_of_a_run: 3000,
            ..Session::default()
        };
        let mut recording = record(&session, |_| Errors::default());
        let exact = record_with_noise(&session, 0.0, |_| Errors::default());
        // the recorded noise, through a filter of correlation 0.5
        let colour = |noisy: &mut Option<Vec<f64>>, exact: &Option<Vec<f64>>| {
            let mut state = 0.0;
            for (value, exact) in noisy.iter_mut().flatten().zip(exact.iter().flatten()) {
                state = 0.5 * state + 0.75_f64.sqrt() * (*value - exact);
                *value = exact + state;
            }
        };
        for (noisy, exact) in recording.output.iter_mut().zip(&exact.output) {
            colour(noisy, exact);
        }
        colour(&mut recording.cable_m[0], &exact.cable_m[0]);
        let diagnosis = diagnosed(&recording);
        if diagnosis.verdict != Verdict::NoGap {
            flagged.push((seed, summary(&diagnosis), diagnosis.whiteness));
        }
    }
    assert!(flagged.is_empty(), "{flagged:#?}");
}
