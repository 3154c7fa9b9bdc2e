//! Joint states of ROS 2 in a bag (MCAP, or the SQLite file of rosbag2) to a recording, through the checks of a CSV log.

#[cfg(feature = "mcap")]
mod decompress;
mod joints;
#[cfg(feature = "mcap")]
mod mcap;
mod messages;
mod rows;
#[cfg(feature = "rosbag2")]
mod sqlite;
mod topics;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

pub use self::joints::{BagJoints, bag_joints};
use self::messages::{JOINT_STATE, JointState, POSE, TRANSFORM, decode, pose};
use self::topics::Topics;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::read::format::Format;
use crate::read::source::{N_FIRST, first_bytes, open_error};
use crate::shape::LogShape;
use crate::size::{MOST_MEMORY_BYTES, NUMBER_BYTES};

/// Largest record, chunk and message \[bytes\]: images are in records, and chunks are a few MiB.
const LARGEST_RECORD_BYTES: usize = 256 << 20;

/// Which messages of a bag are the log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BagOptions {
    /// Names of the joints in the messages, in the order of the device's joints; empty: as the device's.
    pub joint_names: Vec<String>,
    /// Topic of the joint states; none: the only one with all of these joints.
    pub joint_topic: Option<String>,
    /// Topic of a tracker's poses; none: the only one with poses, if there is one.
    pub pose_topic: Option<String>,
    /// Whether an MCAP file is still being written: it ends behind its last whole record, and a part of one is no damage.
    pub is_growing: bool,
}

/// Reads a log from a bag of ROS 2: MCAP, or rosbag2's SQLite (`.db3`), by its first bytes.
///
/// Each `sensor_msgs/msg/JointState` of one topic becomes a row: `position` the columns `theta1_rad`, ..
/// (`theta3_m` where a joint slides), `effort` the columns `torque1_nm`, .. of joints that turn. `t_s` counts
/// from the first row's stamp; where all stamps are zero, the time of recording is taken. Messages of
/// `geometry_msgs/msg/PoseStamped` or `TransformStamped` become `x_m`, `y_m`, `z_m`, `qw`, `qx`, `qy`, `qz` of
/// the row nearest in time, at most half the rows' usual distance away. The first row is line 2 in errors.
///
/// # Errors
/// [`Fault::Damaged`] for a file that does not hold together, [`Fault::NotALog`] where the joints or
/// the topic is not unique, otherwise as [`read_log`](crate::read_log).
pub fn read_bag(
    path: &Path,
    options: &BagOptions,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    read_bag_from(std::io::BufReader::new(file), &name, options, shape)
}

/// Reads a log as [`read_bag`] from a reader that errors call `name`.
///
/// # Errors
/// As [`read_bag`].
///
/// # Examples
/// ```
/// use haptical_data::{BagOptions, JointShape, LogShape, read_bag_from};
///
/// let joint = JointShape { name: "elbow".into(), prismatic: false, lower: -1.0, upper: 1.0 };
/// let shape = LogShape { joints: vec![joint], cable_count: 0, hands: Vec::new() };
/// let table = &b"t_s,elbow\n0,0.1\n"[..];
/// let error = read_bag_from(table, "bag.mcap", &BagOptions::default(), &shape).unwrap_err();
/// assert_eq!(error.kind(), "not-a-log");
/// ```
pub fn read_bag_from(
    reader: impl Read,
    name: &str,
    options: &BagOptions,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    shape.check(name)?;
    let wanted = wanted_names(options, shape, name)?;
    let topics = topics(reader, name, &wanted, options.is_growing)?;
    rows::log_of(&topics, &wanted, name, options, shape)
}

/// The messages of a bag, by its first bytes.
fn topics(
    mut reader: impl Read,
    name: &str,
    wanted: &[String],
    is_growing: bool,
) -> Result<Topics, DataError> {
    let first = first_bytes(&mut reader, N_FIRST)
        .map_err(|source| Place::file(name).error(Fault::Unreadable { source }))?;
    let format = Format::detect(&first);
    let whole = Cursor::new(first).chain(reader);
    let messages = Messages {
        name,
        format: format.names().0,
        wanted,
        topics: Topics::default(),
    };
    match format {
        #[cfg(feature = "mcap")]
        Format::Mcap => mcap::read_topics(whole, messages, is_growing),
        #[cfg(feature = "rosbag2")]
        Format::Sqlite => sqlite::read_topics(whole, messages),
        Format::Text | Format::JsonLines | Format::Parquet => {
            let _ = (whole, messages, is_growing);
            let what = "the file is neither MCAP nor a bag of rosbag2 (.db3)".to_owned();
            Err(not_a_log(name, what, "give the file that was recorded"))
        }
        #[allow(
            unreachable_patterns,
            reason = "a build with every feature reads them all"
        )]
        other => Err(other.not_built_in(name)),
    }
}

/// Names of the device's joints in the messages.
fn wanted_names(
    options: &BagOptions,
    shape: &LogShape,
    name: &str,
) -> Result<Vec<String>, DataError> {
    let wanted = if options.joint_names.is_empty() {
        shape
            .joints
            .iter()
            .map(|joint| joint.name.clone())
            .collect()
    } else {
        options.joint_names.clone()
    };
    if wanted.len() != shape.joints.len() {
        let what = format!(
            "{} names of joints are given, and the device has {} joints",
            wanted.len(),
            shape.joints.len()
        );
        return Err(not_a_log(name, what, "give one name for each joint"));
    }
    for (index, joint) in wanted.iter().enumerate() {
        if wanted[..index].contains(joint) {
            let what = format!("two joints are called `{joint}`");
            return Err(not_a_log(name, what, "give each joint a name of its own"));
        }
    }
    Ok(wanted)
}

/// The messages of a bag while they are read.
struct Messages<'a> {
    name: &'a str,
    /// Name of the format, for errors.
    format: &'static str,
    wanted: &'a [String],
    topics: Topics,
}

/// One message as a bag has it.
struct Message<'m> {
    schema: &'m str,
    encoding: &'m str,
    topic: &'m str,
    recorded_ns: i64,
    data: &'m [u8],
}

/// Whether messages of this schema are joint states.
fn is_joints(schema: &str) -> bool {
    schema == JOINT_STATE || schema == "sensor_msgs/JointState"
}

/// Whether messages of this schema count.
fn is_wanted(schema: &str) -> bool {
    is_joints(schema) || schema == POSE || schema == TRANSFORM
}

impl Messages<'_> {
    /// Adds a message of a schema that counts.
    fn add(&mut self, message: &Message<'_>) -> Result<(), DataError> {
        let (name, format, topic) = (self.name, self.format, message.topic);
        if message.encoding != "cdr" {
            let encoding = message.encoding;
            let what = format!("topic `{topic}` is encoded as `{encoding}`, not as CDR of ROS 2");
            return Err(not_a_log(name, what, "convert the recording to ROS 2"));
        }
        let refuse = |what: String| {
            let what = format!("topic `{topic}`: {what}");
            Place::file(name).error(Fault::Damaged { format, what })
        };
        if is_joints(message.schema) {
            let state: JointState = decode(message.data).map_err(refuse)?;
            let topics = &mut self.topics;
            let added = topics.add_joints(topic, self.wanted, message.recorded_ns, &state);
            added.map_err(refuse)?;
        } else {
            let pose = pose(message.schema, message.data).map_err(refuse)?;
            let ([x, y, z], [i, j, k, w]) = (pose.position_m, pose.orientation_xyzw);
            let stamp_ns = pose.header.stamp_ns();
            self.topics.add_pose(topic, stamp_ns, [x, y, z, w, i, j, k]);
        }
        if self.topics.numbers * NUMBER_BYTES > MOST_MEMORY_BYTES {
            let what = format!(
                "its joint states and poses fill {} GiB of memory, the most that is used",
                MOST_MEMORY_BYTES >> 30
            );
            return Err(not_a_log(name, what, "split the recording"));
        }
        Ok(())
    }
}

fn not_a_log(name: &str, what: String, advice: &str) -> DataError {
    Place::file(name).error(Fault::NotALog {
        what,
        advice: advice.to_owned(),
    })
}
