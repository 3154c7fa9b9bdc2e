//! Columns in memory: the same recording, the same refusals as a CSV log of these cells.

use haptical_data::{Cells, DataError, LoadedLog, LogShape, log_from_columns, read_log_from};
use proptest::prelude::*;

use crate::support::{device, single};

fn taken(columns: &[(&str, Cells<'_>)], shape: &LogShape) -> Result<LoadedLog, DataError> {
    log_from_columns(columns, "log.csv", shape)
}

/// The CSV log of numbers, where `NaN` is an empty cell.
fn csv_of(columns: &[(&str, &[f64])]) -> String {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..columns[0].1.len() {
        let cells = columns.iter().map(|(_, cells)| {
            let cell = cells[row];
            if cell.is_nan() {
                String::new()
            } else {
                format!("{cell:?}")
            }
        });
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

#[test]
fn every_kind_of_column_finds_its_place() {
    let texts = ["left", " left ", ""].map(str::to_owned);
    let log = taken(
        &[
            ("contact", Cells::Texts(&texts)),
            ("run", Cells::Integers(&[1, 1, 2])),
            ("theta2_rad", Cells::Numbers(&[0.1, 0.2, 0.3])),
            ("theta1_rad", Cells::Numbers(&[1.0, 2.0, -0.5])),
            ("theta3_m", Cells::Integers(&[0, 1, 0])),
            ("t_s", Cells::Numbers(&[0.0, 0.5, 0.0])),
            ("cable2_m", Cells::Numbers(&[f64::NAN, 0.25, f64::NAN])),
            ("humidity", Cells::Numbers(&[40.0, f64::NAN, 41.0])),
        ],
        &device(),
    )
    .unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    let recording = log.recording;
    assert_eq!(recording.joint[0], [1.0, 2.0, -0.5]);
    assert_eq!(recording.joint[1], [0.1, 0.2, 0.3]);
    assert_eq!(recording.joint[2], [0.0, 1.0, 0.0]);
    assert_eq!(recording.run.unwrap(), [1, 1, 2]);
    assert_eq!(recording.contact.unwrap(), ["left", "left", ""]);
    assert_eq!(recording.cable_m[0], None);
    assert_eq!(recording.cable_m[1].as_ref().unwrap()[1], 0.25);
    assert_eq!(recording.covariates[0].0, "humidity");
    assert_eq!(recording.line, [2, 3, 4]);
}

#[test]
fn texts_of_numbers_and_numbers_of_contacts_are_read_as_in_a_csv_log() {
    let angles = ["0.25", "1e-3"].map(str::to_owned);
    let columns = [
        ("theta1_rad", Cells::Texts(&angles)),
        ("contact", Cells::Numbers(&[1.0, f64::NAN])),
        ("run", Cells::Numbers(&[3.0, 3.0])),
    ];
    let recording = taken(&columns, &single()).unwrap().recording;
    assert_eq!(recording.joint[0], [0.25, 1e-3]);
    assert_eq!(recording.contact.unwrap(), ["1", ""]);
    assert_eq!(recording.run.unwrap(), [3, 3]);
}

/// What is refused: kind, line, column.
#[track_caller]
fn refused(columns: &[(&str, Cells<'_>)], kind: &str, line: Option<u64>, column: Option<&str>) {
    let error = taken(columns, &single()).unwrap_err();
    assert_eq!(error.kind(), kind, "{error}");
    assert_eq!((error.line(), error.column()), (line, column), "{error}");
}

#[test]
fn what_a_csv_log_may_not_hold_is_refused_with_row_and_column() {
    let angles = Cells::Numbers(&[0.1, 0.2]);
    let theta = ("theta1_rad", angles);
    let word = ["0.1", "nought"].map(str::to_owned);
    let nan = f64::NAN;
    refused(
        &[("theta1_rad", Cells::Numbers(&[0.1, nan]))],
        "missing-reading",
        Some(3),
        Some("theta1_rad"),
    );
    refused(
        &[("theta1_rad", Cells::Numbers(&[f64::INFINITY, 0.1]))],
        "not-finite",
        Some(2),
        Some("theta1_rad"),
    );
    refused(
        &[("theta1_rad", Cells::Numbers(&[0.1, 1e13]))],
        "reading-too-large",
        Some(3),
        Some("theta1_rad"),
    );
    refused(
        &[("theta1_rad", Cells::Texts(&word))],
        "not-a-number",
        Some(3),
        Some("theta1_rad"),
    );
    refused(
        &[("theta1_deg", angles)],
        "missing-column",
        Some(1),
        Some("theta1_rad"),
    );
    refused(
        &[theta, ("run", Cells::Numbers(&[1.0, 1.5]))],
        "run-not-integer",
        Some(3),
        Some("run"),
    );
    refused(
        &[theta, ("run", Cells::Numbers(&[nan, 1.0]))],
        "run-not-integer",
        Some(2),
        Some("run"),
    );
    refused(
        &[theta, ("t_s", Cells::Numbers(&[1.0, 1.0]))],
        "time-order",
        Some(3),
        Some("t_s"),
    );
    refused(
        &[theta, ("cable_m", Cells::Numbers(&[0.1, -0.1]))],
        "negative-distance",
        Some(3),
        Some("cable_m"),
    );
    refused(
        &[theta, ("x_m", angles)],
        "incomplete-group",
        Some(1),
        Some("x_m"),
    );
    refused(
        &[theta, theta],
        "duplicate-column",
        Some(1),
        Some("theta1_rad"),
    );
    refused(
        &[theta, ("out1_rad", Cells::Numbers(&[0.1]))],
        "not-a-log",
        None,
        Some("out1_rad"),
    );
    refused(
        &[("theta1_rad", Cells::Numbers(&[0.1]))],
        "too-few-rows",
        Some(2),
        None,
    );
    refused(
        &[("theta1_rad", Cells::Numbers(&[]))],
        "no-rows",
        Some(1),
        None,
    );
    refused(&[], "no-header", Some(1), None);
    let empty = LogShape::default();
    assert_eq!(taken(&[theta], &empty).unwrap_err().kind(), "invalid-shape");
    let many = vec![theta; 5000];
    assert_eq!(
        taken(&many, &single()).unwrap_err().kind(),
        "too-many-columns"
    );
}

/// Readings as logs have them, with gaps, infinities, sizes beyond any device, and wrong signs.
fn reading() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -1.0..1.0_f64,
        1 => Just(f64::NAN),
        1 => prop_oneof![Just(-0.0), Just(1e13), Just(f64::INFINITY), any::<f64>()],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The recording, the warnings or the refusal of a table are those of its CSV log.
    #[test]
    fn a_table_is_read_as_its_csv_log(
        cells in prop::collection::vec(prop::collection::vec(reading(), 6), 1..6)
    ) {
        // infinities cannot be written as cells but as words that are refused as such
        const NAMES: [&str; 6] = ["theta1_rad", "cable_m", "t_s", "out1_rad", "other", "torque1_nm"];
        let columns: Vec<(&str, Vec<f64>)> = NAMES
            .iter()
            .enumerate()
            .map(|(column, name)| (*name, cells.iter().map(|row| row[column]).collect()))
            .collect();
        let borrowed: Vec<(&str, &[f64])> =
            columns.iter().map(|(name, cells)| (*name, &cells[..])).collect();
        let table: Vec<(&str, Cells<'_>)> =
            borrowed.iter().map(|(name, cells)| (*name, Cells::Numbers(cells))).collect();
        let shape = single();
        let ours = taken(&table, &shape);
        let text = csv_of(&borrowed);
        let theirs = read_log_from(text.as_bytes(), "log.csv", &shape);
        match (ours, theirs) {
            // NaN is not equal to itself, its text is
            (Ok(ours), Ok(theirs)) => prop_assert_eq!(format!("{ours:?}"), format!("{theirs:?}")),
            // a table is read column by column, so another of several faults may come first
            (Err(_), Err(_)) => {}
            (ours, theirs) => prop_assert!(false, "{:?} but {:?}", ours, theirs),
        }
    }
}
