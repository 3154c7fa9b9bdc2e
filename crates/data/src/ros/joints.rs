//! The joint states of all topics of a bag, without a device.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::topics;
use crate::error::DataError;
use crate::read::source::open_error;

/// Joint states of one topic.
#[derive(Debug, Clone, PartialEq)]
pub struct BagJoints {
    /// Its name.
    pub topic: String,
    /// Names of the joints.
    pub names: Vec<String>,
    /// Stamps of the messages \[ns\]; the times of recording where the messages have none.
    pub time_ns: Vec<i64>,
    /// Positions \[rad\] or \[m\], joint by joint.
    pub position: Vec<Vec<f64>>,
}

/// Reads the joint states of a bag of ROS 2 (MCAP or `.db3`), topic by topic: those messages that have all joints of the topic's first.
///
/// # Errors
/// As [`read_bag`](super::read_bag).
pub fn bag_joints(path: &Path) -> Result<Vec<BagJoints>, DataError> {
    let name = path.display().to_string();
    let read = |wanted: &[String]| {
        let file = File::open(path).map_err(|source| open_error(&name, source))?;
        topics(BufReader::new(file), &name, wanted, false)
    };
    let named = read(&[])?.joints.into_iter();
    named
        .map(|(topic, found)| {
            let mut all = read(&found.names)?.joints;
            let joints = all.remove(&topic).unwrap_or_default();
            let has_stamps = joints.stamps_ns.iter().any(|stamp| *stamp != 0);
            Ok(BagJoints {
                topic,
                names: found.names,
                time_ns: if has_stamps {
                    joints.stamps_ns
                } else {
                    joints.recorded_ns
                },
                position: joints.position,
            })
        })
        .collect()
}
