//! Parquet logs: what pyarrow wrote, what the crate's own writer writes, and what is no log.

use std::sync::Arc;

use haptical_data::{DataError, LoadedLog, LogShape, read_log, read_log_from};
use parquet::basic::Compression;
use parquet::data_type::{DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use proptest::prelude::*;

use crate::support::{fixture, shape};

fn read(name: &str) -> Result<LoadedLog, DataError> {
    read_log(&fixture(name), &shape())
}

#[test]
fn files_of_pyarrow_are_read_as_their_csv_log() {
    let csv = read("log.csv").unwrap().recording;
    for name in ["none", "snappy", "gzip", "lz4"] {
        let log = read(&format!("{name}.parquet")).unwrap();
        assert_eq!(log.warnings, Vec::<String>::new(), "{name}");
        let mut recording = log.recording;
        let runs = recording.run.take().unwrap();
        assert_eq!((runs[0], runs[19], runs[20], runs[39]), (0, 0, 1, 1));
        let contacts = recording.contact.take().unwrap();
        assert_eq!((contacts[19].as_str(), contacts[20].as_str()), ("left", ""));
        // NaN is not equal to itself, its text is
        assert_eq!(format!("{recording:?}"), format!("{csv:?}"), "{name}");
    }
}

#[test]
fn a_codec_that_is_not_read_is_named_with_its_column() {
    let error = read("zstd.parquet").unwrap_err();
    assert_eq!((error.kind(), error.column()), ("not-a-log", Some("t_s")));
    let text = error.to_string();
    assert!(text.contains("ZSTD") && text.contains("snappy"), "{text}");
}

/// A file with one row group of this schema; `fill` writes its columns.
fn written(schema: &str, columns: &[Column]) -> Vec<u8> {
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for column in columns {
        let mut open = group.next_column().unwrap().unwrap();
        match column {
            Column::Required(values) => {
                open.typed::<DoubleType>()
                    .write_batch(values, None, None)
                    .unwrap();
            }
            Column::Optional(values) => {
                let levels: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
                let present: Vec<f64> = values.iter().copied().flatten().collect();
                let typed = open.typed::<DoubleType>();
                typed.write_batch(&present, Some(&levels), None).unwrap();
            }
            Column::Integers(values) => {
                open.typed::<Int64Type>()
                    .write_batch(values, None, None)
                    .unwrap();
            }
            Column::Lists(values) => {
                let levels = vec![1; values.len()];
                let typed = open.typed::<DoubleType>();
                let repetitions = vec![0; values.len()];
                typed
                    .write_batch(values, Some(&levels), Some(&repetitions))
                    .unwrap();
            }
        }
        open.close().unwrap();
    }
    group.close().unwrap();
    writer.into_inner().unwrap()
}

enum Column {
    Required(Vec<f64>),
    Optional(Vec<Option<f64>>),
    Integers(Vec<i64>),
    Lists(Vec<f64>),
}

fn read_bytes(content: &[u8], shape: &LogShape) -> Result<LoadedLog, DataError> {
    read_log_from(content, "log.parquet", shape)
}

#[test]
fn what_is_no_flat_table_of_numbers_is_refused() {
    let shape = crate::support::single();
    let refused = |schema: &str, columns: &[Column], column: &str, advice: &str| {
        let error = read_bytes(&written(schema, columns), &shape).unwrap_err();
        let text = error.to_string();
        assert_eq!(
            (error.kind(), error.column()),
            ("not-a-log", Some(column)),
            "{text}"
        );
        assert!(text.contains(advice), "{text}");
    };
    refused(
        "message log { required double theta1_rad; repeated double out1_rad; }",
        &[
            Column::Required(vec![0.1, 0.2]),
            Column::Lists(vec![0.1, 0.2]),
        ],
        "out1_rad",
        "a column of its own",
    );
    refused(
        "message log { required group a { required double theta1_rad; } }",
        &[Column::Required(vec![0.1, 0.2])],
        "a.theta1_rad",
        "a column of its own",
    );
    refused(
        "message log { required double theta1_rad; required int64 t_s (TIMESTAMP(MICROS,true)); }",
        &[
            Column::Required(vec![0.1, 0.2]),
            Column::Integers(vec![1, 2]),
        ],
        "t_s",
        "seconds",
    );
}

#[test]
fn rows_are_refused_where_a_csv_log_would_be() {
    let shape = crate::support::single();
    let schema = "message log { optional double theta1_rad; }";
    let gap = Column::Optional(vec![Some(0.1), None, Some(0.2)]);
    let error = read_bytes(&written(schema, &[gap]), &shape).unwrap_err();
    assert_eq!((error.kind(), error.line()), ("missing-reading", Some(3)));
    let degrees = "message log { required double theta1_deg; }";
    let column = Column::Required(vec![0.1, 0.2]);
    let error = read_bytes(&written(degrees, &[column]), &shape).unwrap_err();
    assert_eq!(error.kind(), "missing-column");
    assert!(error.to_string().contains("theta1_deg"), "{error}");
}

#[test]
fn a_cut_file_is_refused_at_every_length() {
    let whole = std::fs::read(fixture("snappy.parquet")).unwrap();
    for length in 8..whole.len() {
        let error = read_bytes(&whole[..length], &shape()).unwrap_err();
        assert_eq!(error.kind(), "damaged", "{length}: {error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// Cells of any size and any gaps come back bit by bit, across the batches of the reader.
    #[test]
    fn numbers_come_back(cells in prop::collection::vec(prop::option::of(-1e6..1e6_f64), 2..9000)) {
        let schema = "message log { required double theta1_rad; optional double other; }";
        let angles: Vec<f64> = (0..cells.len()).map(|row| (row as f64).sin()).collect();
        let content =
            written(schema, &[Column::Required(angles.clone()), Column::Optional(cells.clone())]);
        let recording = read_bytes(&content, &crate::support::single()).unwrap().recording;
        prop_assert_eq!(&recording.joint[0], &angles);
        let back = recording.covariates.first().map(|(_, numbers)| numbers.clone());
        let back = back.unwrap_or_else(|| vec![f64::NAN; cells.len()]);
        for (back, cell) in back.iter().zip(&cells) {
            prop_assert_eq!(back.to_bits(), cell.unwrap_or(f64::NAN).to_bits());
        }
    }

    /// Damaged files are read or refused: no panic, no endless loop.
    #[test]
    fn damage_is_survived(
        name in prop::sample::select(vec!["none.parquet", "snappy.parquet", "gzip.parquet", "lz4.parquet"]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut content = std::fs::read(fixture(name)).unwrap();
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        let _ = read_bytes(&content, &shape());
    }
}
