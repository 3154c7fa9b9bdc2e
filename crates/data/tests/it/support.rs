//! Devices and shorthands that several tests share.

use haptical_data::{DataError, JointShape, LoadedLog, LogShape, read_log_from};

/// A joint that turns, with limits that readings of the tests stay within.
pub(crate) fn revolute(name: &str) -> JointShape {
    JointShape {
        name: name.to_owned(),
        prismatic: false,
        lower: -3.0,
        upper: 3.0,
    }
}

/// The device of the files in tests/fixtures.
#[cfg(any(feature = "mcap", feature = "parquet", feature = "rosbag2"))]
pub(crate) fn shape() -> LogShape {
    LogShape {
        joints: vec![revolute("shoulder"), revolute("elbow")],
        cable_count: 0,
        hands: Vec::new(),
    }
}

/// A file of tests/fixtures.
#[cfg(any(feature = "mcap", feature = "parquet", feature = "rosbag2"))]
pub(crate) fn fixture(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures")
        .join(name)
}

/// Two revolute joints, a prismatic one, two cables.
pub(crate) fn device() -> LogShape {
    let slide = JointShape {
        name: "slide".into(),
        prismatic: true,
        lower: 0.0,
        upper: 1.0,
    };
    LogShape {
        joints: vec![revolute("base"), revolute("elbow"), slide],
        cable_count: 2,
        hands: Vec::new(),
    }
}

/// One revolute joint and one cable.
pub(crate) fn single() -> LogShape {
    LogShape {
        joints: vec![revolute("base")],
        cable_count: 1,
        hands: Vec::new(),
    }
}

pub(crate) fn read(text: &str, shape: &LogShape) -> Result<LoadedLog, DataError> {
    read_log_from(text.as_bytes(), "log.csv", shape)
}

/// Reads what must be readable without a warning.
pub(crate) fn clean(text: &str, shape: &LogShape) -> LoadedLog {
    let log = read(text, shape).unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    log
}

/// Asserts that `text` is refused: kind, line, column number and column name.
#[track_caller]
pub(crate) fn refused(
    text: &str,
    shape: &LogShape,
    kind: &str,
    line: Option<u64>,
    column: Option<(usize, &str)>,
) -> DataError {
    let error = read(text, shape).unwrap_err();
    assert_eq!(error.kind(), kind, "{error}");
    assert_eq!(error.line(), line, "{error}");
    assert_eq!(
        error.column_number(),
        column.map(|(number, _)| number),
        "{error}"
    );
    assert_eq!(error.column(), column.map(|(_, name)| name), "{error}");
    let message = error.to_string();
    assert!(message.starts_with("log.csv"), "names the file: {message}");
    if let Some(line) = line {
        assert!(
            message.contains(&format!("line {line}")),
            "names the line: {message}"
        );
    }
    if let Some((number, name)) = column {
        assert!(
            message.contains(&format!("column {number} `{name}`")),
            "{message}"
        );
    }
    error
}
