//! Properties of every log.

use haptical_data::{LogShape, read_log_from, write_log_to};
use haptical_model::Recording;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::support::{device, single};

const N_CASES: u32 = 64;
const LONGEST: usize = 12;

/// Readings of which some are missing and at least one is not.
fn readings(n: usize, values: impl Strategy<Value = f64>) -> impl Strategy<Value = Vec<f64>> {
    (vec(prop_oneof![4 => values, 1 => Just(f64::NAN)], n), 0..n).prop_map(|(mut column, row)| {
        if column[row].is_nan() {
            column[row] = 0.5;
        }
        column
    })
}

fn any_reading() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn texts(n: usize) -> impl Strategy<Value = Vec<String>> {
    vec("[a-z\",;' é]{0,6}", n).prop_map(|mut texts| {
        for text in &mut texts {
            *text = text.trim().to_owned();
        }
        texts[0].push('x');
        texts
    })
}

/// `N` columns, each row complete or missing.
fn vectors<const N: usize>(n: usize) -> impl Strategy<Value = [Vec<f64>; N]> {
    (vec(vec(-2.0..2.0_f64, N), n), vec(any::<bool>(), n)).prop_map(|(rows, given)| {
        std::array::from_fn(|part| {
            let cell = |row: usize| {
                if given[row] || row == 0 {
                    rows[row][part]
                } else {
                    f64::NAN
                }
            };
            (0..rows.len()).map(cell).collect()
        })
    })
}

fn normalised(mut quaternion: [Vec<f64>; 4]) -> [Vec<f64>; 4] {
    for row in 0..quaternion[0].len() {
        let norm = quaternion
            .iter()
            .map(|part| part[row] * part[row])
            .sum::<f64>()
            .sqrt();
        for (index, part) in quaternion.iter_mut().enumerate() {
            part[row] = match norm {
                norm if norm.is_nan() => f64::NAN,
                norm if norm < 1e-3 => f64::from(u8::from(index == 0)),
                norm => part[row] / norm,
            };
        }
    }
    quaternion
}

/// A recording of [`device`] as the reader would give it.
fn recordings() -> impl Strategy<Value = Recording> {
    (2..LONGEST).prop_flat_map(|n| {
        let times = vec(0.001..1.0_f64, n).prop_map(|steps| {
            let mut time_s = -3.0;
            steps
                .iter()
                .map(|step| {
                    time_s += step;
                    time_s
                })
                .collect::<Vec<f64>>()
        });
        let runs = (vec(any::<bool>(), n), any::<i32>()).prop_map(|(next, first)| {
            let mut run = i64::from(first);
            next.iter()
                .map(|&next| {
                    run += i64::from(next);
                    run
                })
                .collect::<Vec<i64>>()
        });
        let optional = proptest::option::of::<BoxedStrategy<Vec<f64>>>;
        let any_column = move || optional(readings(n, any_reading()).boxed());
        let joints = vec(vec(-2.9..2.9_f64, n), 2);
        let slide = vec(0.0..1.0_f64, n);
        let outputs = vec(optional(readings(n, -0.09..1.09_f64).boxed()), 3);
        let cables = vec(optional(readings(n, 0.0..1e9_f64).boxed()), 2);
        let first = (
            proptest::option::of(times),
            proptest::option::of(runs),
            joints,
            slide,
        );
        let torques = vec(optional(readings(n, -1e12..1e12_f64).boxed()), 3);
        let second = (outputs, cables, torques, any_column());
        let third = (
            proptest::option::of(vectors::<3>(n)),
            proptest::option::of(vectors::<4>(n).prop_map(normalised)),
            proptest::option::of(vectors::<3>(n)),
        );
        let fourth = (
            proptest::option::of(texts(n)),
            proptest::option::of(texts(n)),
            proptest::option::of(texts(n)),
            readings(n, any_reading()),
            readings(n, any_reading()),
        );
        (first, second, third, fourth).prop_map(move |(first, second, third, fourth)| {
            let (time_s, run, mut joint, slide) = first;
            joint.push(slide);
            let (output, cable_m, torque_nm, temperature_degc) = second;
            let (position_m, orientation_wxyz, force_n) = third;
            let (contact, plane, tool, covariate, other) = fourth;
            Recording {
                line: (2..2 + n as u64).collect(),
                time_s,
                run,
                joint,
                output,
                cable_m,
                position_m,
                orientation_wxyz,
                torque_nm,
                force_n,
                temperature_degc,
                hand: None,
                contact,
                plane,
                tool,
                covariates: vec![("a \"b\", c".into(), covariate), ("humidity".into(), other)],
                added: Vec::new(),
            }
        })
    })
}

/// Equality of debug texts: `NaN` equals `NaN`, -0 differs from 0, digits are shortest.
fn same(one: &Recording, other: &Recording) -> bool {
    format!("{one:?}") == format!("{other:?}")
}

fn written(recording: &Recording, shape: &LogShape) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, recording, shape).unwrap();
    bytes
}

/// The log with its columns in the order of `keys`.
fn reordered(bytes: &[u8], keys: &[u32]) -> Vec<u8> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(bytes);
    let mut writer = csv::Writer::from_writer(Vec::new());
    for record in reader.records() {
        let record = record.unwrap();
        let mut cells: Vec<(u32, usize, &str)> = record
            .iter()
            .enumerate()
            .map(|(index, cell)| (keys[index], index, cell))
            .collect();
        cells.sort_unstable();
        writer
            .write_record(cells.iter().map(|(_, _, cell)| cell))
            .unwrap();
    }
    writer.into_inner().unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(N_CASES) })]

    #[test]
    fn what_is_written_is_read_again(recording in recordings()) {
        let bytes = written(&recording, &device());
        let log = read_log_from(bytes.as_slice(), "log.csv", &device()).unwrap();
        prop_assert_eq!(log.warnings, Vec::<String>::new());
        prop_assert!(same(&log.recording, &recording), "{:?}\n{:?}", log.recording, recording);
    }

    #[test]
    fn the_order_of_columns_changes_nothing(recording in recordings(), keys in vec(any::<u32>(), 40)) {
        let bytes = reordered(&written(&recording, &device()), &keys);
        let log = read_log_from(bytes.as_slice(), "log.csv", &device()).unwrap();
        prop_assert!(same(&log.recording, &recording), "{:?}\n{:?}", log.recording, recording);
    }

    #[test]
    fn bytes_are_read_or_refused(bytes in vec(any::<u8>(), 0..200)) {
        let _ = read_log_from(bytes.as_slice(), "log.csv", &single());
    }

    #[test]
    fn gzip_headers_with_any_bytes_are_refused(rest in vec(any::<u8>(), 0..200)) {
        let bytes = [&[0x1f, 0x8b, 0x08][..], &rest].concat();
        prop_assert!(read_log_from(bytes.as_slice(), "log.csv", &single()).is_err());
    }

    #[test]
    fn text_like_a_log_is_finite_or_refused(rows in "([-0-9.,e\"a \r\n]{0,12}[,\n]){0,30}") {
        let text = format!("t_s,theta1_rad,run,cable_m,qw,qx,qy,qz,contact\n{rows}");
        if let Ok(log) = read_log_from(text.as_bytes(), "log.csv", &single()) {
            prop_assert!(log.recording.len() >= 2);
            prop_assert!(log.recording.joint[0].iter().all(|value| value.is_finite()));
        }
    }

    #[test]
    fn one_faulty_cell_is_named(
        recording in recordings(), row in any::<prop::sample::Index>(), joint in 0..3_usize,
    ) {
        let text = String::from_utf8(written(&recording, &device())).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        let mut records: Vec<Vec<String>> = reader
            .records()
            .map(|record| record.unwrap().iter().map(str::to_owned).collect())
            .collect();
        let name = ["theta1_rad", "theta2_rad", "theta3_m"][joint];
        let column = records[0].iter().position(|column| column == name).unwrap();
        let line = 1 + row.index(recording.len());
        records[line][column] = "abc".into();
        let mut writer = csv::Writer::from_writer(Vec::new());
        for record in &records {
            writer.write_record(record).unwrap();
        }
        let bytes = writer.into_inner().unwrap();
        let error = read_log_from(bytes.as_slice(), "log.csv", &device()).unwrap_err();
        prop_assert_eq!(error.kind(), "not-a-number");
        prop_assert_eq!(error.line(), Some(line as u64 + 1));
        prop_assert_eq!(error.column(), Some(name));
        prop_assert_eq!(error.column_number(), Some(column + 1));
    }
}
