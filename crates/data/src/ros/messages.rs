//! Messages of ROS 2 in Common Data Representation (CDR): joint states and poses with their stamps.
//!
//! Fields as in `sensor_msgs/msg/JointState`, `geometry_msgs/msg/PoseStamped` and
//! `geometry_msgs/msg/TransformStamped` of ROS 2; encoding by OMG DDS-RTPS 2.5, section 10.

use byteorder::{BigEndian, LittleEndian};
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// Names of the schemas that are read.
pub(super) const JOINT_STATE: &str = "sensor_msgs/msg/JointState";
/// See [`JOINT_STATE`].
pub(super) const POSE: &str = "geometry_msgs/msg/PoseStamped";
/// See [`JOINT_STATE`].
pub(super) const TRANSFORM: &str = "geometry_msgs/msg/TransformStamped";

/// `std_msgs/msg/Header`.
#[derive(Debug, Deserialize)]
pub(super) struct Header {
    sec: i32,
    nanosec: u32,
    #[expect(dead_code, reason = "a field of the message")]
    frame_id: String,
}

impl Header {
    /// Time since the clock's zero \[ns\].
    pub(super) fn stamp_ns(&self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// Angles and efforts of named joints.
#[derive(Debug, Deserialize)]
pub(super) struct JointState {
    pub(super) header: Header,
    pub(super) name: Vec<String>,
    pub(super) position: Vec<f64>,
    #[expect(dead_code, reason = "a field of the message")]
    velocity: Vec<f64>,
    pub(super) effort: Vec<f64>,
}

/// A position and a quaternion x, y, z, w.
#[derive(Debug, Deserialize)]
pub(super) struct PoseStamped {
    pub(super) header: Header,
    pub(super) position_m: [f64; 3],
    pub(super) orientation_xyzw: [f64; 4],
}

/// See [`PoseStamped`].
#[derive(Debug, Deserialize)]
struct TransformStamped {
    header: Header,
    #[expect(dead_code, reason = "a field of the message")]
    child_frame_id: String,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
}

/// A pose from a message of the schema [`POSE`] or [`TRANSFORM`].
pub(super) fn pose(schema: &str, message: &[u8]) -> Result<PoseStamped, String> {
    if schema == POSE {
        return decode(message);
    }
    let transform: TransformStamped = decode(message)?;
    Ok(PoseStamped {
        header: transform.header,
        position_m: transform.position_m,
        orientation_xyzw: transform.orientation_xyzw,
    })
}

/// A message with the four bytes before it that name its encoding.
pub(super) fn decode<T: DeserializeOwned>(message: &[u8]) -> Result<T, String> {
    let Some(([_, kind, _, _], body)) = message.split_first_chunk() else {
        return Err(format!("a message of {} bytes", message.len()));
    };
    let decoded = match kind {
        0 => cdr_encoding::from_bytes::<T, BigEndian>(body),
        1 => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        other => return Err(format!("encoding {other}, where plain CDR is 0 or 1")),
    };
    decoded
        .map(|(message, _)| message)
        .map_err(|error| error.to_string())
}
