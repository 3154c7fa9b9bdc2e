//! Logs of calibration measurements: comma-separated text in and out, plain or gzip, with errors
//! that name the line and the column; columns in memory, JSON lines, Parquet and bags of ROS 2 in.
//!
//! Feature `parquet` reads Parquet files; `mcap` and `rosbag2` read joint states of ROS 2 from MCAP and from rosbag2's SQLite.
//!
//! ```
//! use haptical_data::{JointShape, LogShape, read_log_from, write_log_to};
//!
//! let shape = LogShape {
//!     joints: vec![JointShape { name: "1".into(), prismatic: false, lower: -1.5, upper: 1.5 }],
//!     cable_count: 1,
//!     hands: Vec::new(),
//! };
//! let text = "t_s,theta1_rad,cable_m\n0.00,0.1,0.25\n0.01,0.2,\n";
//! let log = read_log_from(text.as_bytes(), "log.csv", &shape)?;
//! assert_eq!(log.recording.joint[0], [0.1, 0.2]);
//! assert!(log.recording.cable_m[0].as_ref().is_some_and(|cable| cable[1].is_nan()));
//!
//! let mut copy = Vec::new();
//! write_log_to(&mut copy, &log.recording, &shape)?;
//! assert_eq!(copy, b"t_s,theta1_rad,cable_m\n0,0.1,0.25\n0.01,0.2,\n");
//! # Ok::<(), haptical_data::DataError>(())
//! ```

mod column;
mod edit;
mod error;
mod json_lines;
mod nearest;
#[cfg(feature = "parquet")]
mod parquet_lists;
#[cfg(feature = "parquet")]
mod parquet_log;
mod read;
#[cfg(any(feature = "mcap", feature = "rosbag2"))]
mod ros;
mod shape;
mod size;
#[cfg(feature = "rosbag2")]
mod sqlite;
mod write;

pub use edit::{LogColumn, LogEdits, edit_log};
pub use error::near_miss::NearMiss;
pub use error::place::Place;
pub use error::{DataError, Fault};
pub use json_lines::{JsonCell, JsonColumns, JsonRefusal};
pub use nearest::{Nearest, nearest, usual_distance_ns};
#[cfg(feature = "parquet")]
pub use parquet_lists::{
    ParquetColumns, ParquetTable, parquet_names, parquet_table, read_parquet_columns,
};
pub use read::known::known_file;
pub use read::table::{Cells, log_from_columns};
pub use read::{LoadedLog, read_log, read_log_from};
#[cfg(any(feature = "mcap", feature = "rosbag2"))]
pub use ros::{BagJoints, BagOptions, bag_joints, read_bag, read_bag_from};
pub use shape::{JointShape, LogShape};
pub use size::{MOST_COLUMNS, MOST_MEMORY_BYTES};
pub use write::LogWriter;
pub use write::log_file::LogFile;
pub use write::whole::{write_log, write_log_to};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
