//! MCAP files with joint states of ROS 2 to a recording, through the checks of a CSV log.

mod decompress;
mod messages;
mod poses;
mod rows;
mod topics;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use mcap::McapError;
use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;

use self::decompress::WholeChunk;
use self::messages::{JOINT_STATE, JointState, POSE, TRANSFORM, decode, pose};
use self::topics::Topics;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::read::source::open_error;
use crate::shape::LogShape;
use crate::size::{MOST_MEMORY_BYTES, NUMBER_BYTES};

/// Largest record and chunk \[bytes\]: images are in records, and chunks are a few MiB.
const LARGEST_RECORD_BYTES: usize = 256 << 20;

/// Which messages of an MCAP file are the log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct McapOptions {
    /// Names of the joints in the messages, in the order of the device's joints; empty: as the device's.
    pub joint_names: Vec<String>,
    /// Topic of the joint states; none: the only one with all of these joints.
    pub joint_topic: Option<String>,
    /// Topic of a tracker's poses; none: the only one with poses, if there is one.
    pub pose_topic: Option<String>,
}

/// Reads a log from an MCAP file.
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
pub fn read_mcap(
    path: &Path,
    options: &McapOptions,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    read_mcap_from(std::io::BufReader::new(file), &name, options, shape)
}

/// Reads a log as [`read_mcap`] from a reader that errors call `name`.
///
/// # Errors
/// As [`read_mcap`].
///
/// # Examples
/// ```
/// use haptical_data::{JointShape, LogShape, McapOptions, read_mcap_from};
///
/// let joint = JointShape { name: "elbow".into(), prismatic: false, lower: -1.0, upper: 1.0 };
/// let shape = LogShape { joints: vec![joint], cable_count: 0, hands: Vec::new() };
/// let cut = &b"\x89MCAP0\r\n\x01"[..];
/// let error = read_mcap_from(cut, "bag.mcap", &McapOptions::default(), &shape).unwrap_err();
/// assert_eq!(error.kind(), "damaged");
/// ```
pub fn read_mcap_from(
    reader: impl Read,
    name: &str,
    options: &McapOptions,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    shape.check(name)?;
    let wanted = wanted_names(options, shape, name)?;
    let topics = read_topics(reader, name, &wanted)?;
    rows::log_of(&topics, &wanted, name, options, shape)
}

/// Names of the device's joints in the messages.
fn wanted_names(
    options: &McapOptions,
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

/// The messages that count, from the first to the last.
fn read_topics(reader: impl Read, name: &str, wanted: &[String]) -> Result<Topics, DataError> {
    let options = LinearReaderOptions::default()
        .with_record_length_limit(LARGEST_RECORD_BYTES)
        .with_validate_chunk_crcs(true);
    let mut messages = MessageReader::new_with_options(reader, options);
    for decompressor in [WholeChunk::lz4(), WholeChunk::zstd()] {
        let added = messages.add_decompressor(decompressor);
        added.map_err(|error| failed(name, error))?;
    }
    let mut topics = Topics::default();
    for message in messages {
        let message = message.map_err(|error| failed(name, error))?;
        let Some(schema) = message.channel.schema.as_deref() else {
            continue;
        };
        let topic = message.channel.topic.as_str();
        let is_joints = schema.name == JOINT_STATE || schema.name == "sensor_msgs/JointState";
        if !is_joints && schema.name != POSE && schema.name != TRANSFORM {
            continue;
        }
        let encoding = message.channel.message_encoding.as_str();
        if encoding != "cdr" {
            let what = format!("topic `{topic}` is encoded as `{encoding}`, not as CDR of ROS 2");
            return Err(not_a_log(name, what, "convert the recording to ROS 2"));
        }
        let refuse = |what: String| {
            Place::file(name).error(Fault::Damaged {
                format: "MCAP",
                what: format!("topic `{topic}`: {what}"),
            })
        };
        if is_joints {
            let recorded_ns = i64::try_from(message.log_time).unwrap_or(i64::MAX);
            let state: JointState = decode(&message.data).map_err(refuse)?;
            let added = topics.add_joints(topic, wanted, recorded_ns, &state);
            added.map_err(refuse)?;
        } else {
            let pose = pose(&schema.name, &message.data).map_err(refuse)?;
            let ([x, y, z], [i, j, k, w]) = (pose.position_m, pose.orientation_xyzw);
            topics.add_pose(topic, pose.header.stamp_ns(), [x, y, z, w, i, j, k]);
        }
        if topics.numbers * NUMBER_BYTES > MOST_MEMORY_BYTES {
            let what = format!(
                "its joint states and poses fill {} GiB of memory, the most that is used",
                MOST_MEMORY_BYTES >> 30
            );
            return Err(not_a_log(name, what, "split the recording"));
        }
    }
    Ok(topics)
}

fn not_a_log(name: &str, what: String, advice: &str) -> DataError {
    Place::file(name).error(Fault::NotALog {
        what,
        advice: advice.to_owned(),
    })
}

fn failed(name: &str, error: McapError) -> DataError {
    let at = Place::file(name);
    match error {
        McapError::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            at.error(Fault::Unreadable { source })
        }
        McapError::UnsupportedCompression(codec) => at.error(Fault::NotALog {
            what: format!("a chunk is compressed with `{codec}`, which is not read"),
            advice: "write the recording with lz4, zstd or no compression".to_owned(),
        }),
        other => at.error(Fault::Damaged {
            format: "MCAP",
            what: other.to_string(),
        }),
    }
}
