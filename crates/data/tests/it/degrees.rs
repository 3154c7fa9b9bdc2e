//! Degrees taken for radians, and readings outside the limits.

use std::f64::consts::PI;

use haptical_data::{DataError, JointShape, LoadedLog, LogShape};

use crate::support::{clean, read};

fn shape(lower: f64, upper: f64) -> LogShape {
    let joint = JointShape {
        name: "elbow".into(),
        prismatic: false,
        lower,
        upper,
    };
    LogShape {
        joints: vec![joint],
        cable_count: 0,
        hands: Vec::new(),
    }
}

fn log(readings: impl IntoIterator<Item = f64>) -> String {
    let rows: Vec<String> = readings
        .into_iter()
        .map(|value| format!("{value}\n"))
        .collect();
    format!("theta1_rad\n{}", rows.concat())
}

/// A sweep of `n` readings from `from` to `to`.
fn sweep(from: f64, to: f64, n: u32) -> impl Iterator<Item = f64> {
    (0..n).map(move |k| from + (to - from) * f64::from(k) / f64::from(n - 1))
}

#[track_caller]
fn is_degrees(result: Result<LoadedLog, DataError>) -> DataError {
    let error = result.unwrap_err();
    assert_eq!(error.kind(), "looks-like-degrees", "{error}");
    error
}

#[track_caller]
fn warns(text: &str, shape: &LogShape) -> String {
    let warnings = read(text, shape).unwrap().warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    warnings[0].clone()
}

#[test]
fn degrees_within_the_limits_are_recognised() {
    let error = is_degrees(read(&log([-80.0, 12.0, 85.0]), &shape(-PI / 2.0, PI / 2.0)));
    assert_eq!(
        (error.line(), error.column()),
        (Some(4), Some("theta1_rad"))
    );
    assert_eq!(error.column_number(), Some(1));
    let message = error.to_string();
    assert!(
        message.contains("from -80 to 85") && message.contains("1.57"),
        "{message}"
    );
    // One-sided limits, a small part of the range, a joint that stands still.
    is_degrees(read(&log([-176.0, -90.0, -4.0]), &shape(-3.07, -0.07)));
    is_degrees(read(&log([20.0, 21.0, 22.0]), &shape(-PI / 2.0, PI / 2.0)));
    is_degrees(read(&log([45.0, 45.0]), &shape(-PI / 2.0, PI / 2.0)));
}

#[test]
fn external_encoders_are_judged_too() {
    let text = "theta1_rad,out1_rad\n0.5,28.6\n-0.5,-28.6\n";
    let error = is_degrees(read(text, &shape(-1.5, 1.5)));
    assert_eq!((error.column(), error.line()), (Some("out1_rad"), Some(2)));
}

#[test]
fn several_turns_within_limits_of_several_turns_are_radians() {
    let turns = shape(-6.0 * PI, 6.0 * PI);
    clean(&log(sweep(-18.0, 18.0, 100)), &turns);
    is_degrees(read(&log(sweep(-1000.0, 1000.0, 100)), &turns));
    // A joint without limits cannot be judged.
    clean(
        &log([-1000.0, 1000.0]),
        &shape(f64::NEG_INFINITY, f64::INFINITY),
    );
    clean(&log([-1000.0, 1000.0]), &shape(-1.0, f64::INFINITY));
}

#[test]
fn a_zero_that_is_off_by_a_turn_is_a_warning() {
    let text = log(sweep(2.0 * PI - 0.5, 2.0 * PI + 0.9, 50));
    let warning = warns(&text, &shape(-1.0, 1.0));
    assert!(warning.contains("50 readings of `theta1_rad`"), "{warning}");
}

#[test]
fn a_few_outliers_make_no_degrees() {
    let mut readings: Vec<f64> = sweep(-1.0, 1.0, 200).collect();
    readings[17] = 60.0;
    readings[90] = -55.0;
    let warning = warns(&log(readings), &shape(-1.2, 1.2));
    assert!(
        warning.contains("2 readings") && warning.contains("farthest is 60"),
        "{warning}"
    );
    assert!(
        warning.starts_with("log.csv, line 19, column 1 `theta1_rad`"),
        "{warning}"
    );
}

#[test]
fn a_joint_that_turns_somewhat_farther_than_its_limits_is_a_warning() {
    // 30 readings are not trimmed. Below twice the limit; below 1.2 pi, which no reading in radians of a wrapped angle exceeds.
    for (limit, reached) in [(4.0, 6.0), (4.0, 7.9), (1.0, 1.5), (1.0, 3.7)] {
        warns(&log(sweep(-reached, reached, 30)), &shape(-limit, limit));
    }
    is_degrees(read(&log(sweep(-8.1, 8.1, 30)), &shape(-4.0, 4.0)));
    is_degrees(read(&log(sweep(-3.8, 3.8, 30)), &shape(-1.0, 1.0)));
}

#[test]
fn readings_that_fit_in_no_unit_are_a_warning() {
    warns(&log(sweep(-500.0, 500.0, 100)), &shape(-1.0, 1.0));
}

#[test]
fn a_tenth_of_the_range_beyond_the_limits_is_tolerated() {
    // The range is 2 rad, the slack 0.2 rad on either side.
    clean(&log([-1.19, 1.19]), &shape(-1.0, 1.0));
    warns(&log([-1.0, 1.21]), &shape(-1.0, 1.0));
    warns(&log([-1.21, 1.0]), &shape(-1.0, 1.0));
}

#[test]
fn a_prismatic_joint_has_no_degrees() {
    let joint = JointShape {
        name: "slide".into(),
        prismatic: true,
        lower: -0.5,
        upper: 0.5,
    };
    let shape = LogShape {
        joints: vec![joint],
        cable_count: 0,
        hands: Vec::new(),
    };
    let warning = warns("theta1_m\n-20\n20\n", &shape);
    assert!(warning.contains("-0.5 to 0.5 m"), "{warning}");
}

#[test]
fn whole_turns_are_named_beside_degrees() {
    // a third of the readings a turn off: nothing else tells them from degrees of a small motion
    let wrapped = sweep(-2.9, 2.9, 60).enumerate();
    let wrapped = wrapped.map(|(row, angle)| {
        if row % 3 == 0 {
            angle - 2.0 * PI
        } else {
            angle
        }
    });
    let error = is_degrees(read(&log(wrapped), &shape(-2.97, 2.97)));
    assert!(error.to_string().contains("take 2 pi off"), "{error}");
    let error = is_degrees(read(&log(sweep(-160.0, 160.0, 60)), &shape(-2.97, 2.97)));
    assert!(!error.to_string().contains("2 pi"), "{error}");
    // a column that is off as a whole is no degrees, but may be a turn
    let warning = warns(
        &log(sweep(2.0 * PI - 0.5, 2.0 * PI + 0.5, 50)),
        &shape(-1.0, 1.0),
    );
    assert!(warning.contains("whole turns (2 pi)"), "{warning}");
    let warning = warns(&log(sweep(1.5, 2.5, 50)), &shape(-1.0, 1.0));
    assert!(!warning.contains("2 pi"), "{warning}");
}

#[test]
fn counts_of_an_encoder_are_refused() {
    let counts = |largest: f64| log(sweep(-largest, largest, 101).map(f64::round));
    let limits = shape(-2.0, 2.0);
    let error = read(&counts(6034.0), &limits).unwrap_err();
    assert_eq!(error.kind(), "looks-like-counts", "{error}");
    assert_eq!(
        (error.line(), error.column()),
        (Some(2), Some("theta1_rad"))
    );
    let said = error.to_string();
    assert!(
        said.contains("-6034 to 6034") && said.contains("-2 to 2 rad"),
        "{said}"
    );
    // what is no whole number is no count, and whole degrees are degrees
    warns(&log(sweep(-500.3, 500.0, 101)), &limits);
    is_degrees(read(&counts(90.0), &limits));
}
