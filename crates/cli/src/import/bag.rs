//! Joint states of ROS 2 in a bag to a CSV log, joints and topics chosen by name.

use std::path::PathBuf;

use clap::Args;
use haptical_data::{BagOptions, LogShape, read_bag};

use super::{Imported, Target};
use crate::failure::Failure;
use crate::flags::DeviceOptions;

/// End of the help of `haptical import bag`.
pub(super) const HELP: &str = "\
Example:
  haptical import bag bag.mcap --device device.toml --joints shoulder,elbow,wrist --out log.csv

Without --joints the messages must name the joints as the device does; then identify and diagnose read
bag.mcap itself.";

/// Flags of `haptical import bag`.
#[derive(Debug, Args)]
pub(super) struct BagArguments {
    /// Recording (.mcap, or .db3 of rosbag2, with sensor_msgs/msg/JointState)
    #[arg(value_name = "FILE")]
    recording: PathBuf,
    /// Device file (TOML, URDF or MJCF)
    #[arg(long, value_name = "FILE")]
    device: PathBuf,
    #[command(flatten)]
    device_options: DeviceOptions,
    #[command(flatten)]
    target: Target,
    /// Names of the joints in the messages, in the order of the device's joints
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    joints: Vec<String>,
    /// Topic of the joint states
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Topic of the handle's poses (geometry_msgs/msg/PoseStamped or TransformStamped)
    #[arg(long, value_name = "TOPIC")]
    pose_topic: Option<String>,
}

/// Runs the command.
pub(super) fn run(arguments: &BagArguments) -> Result<(), Failure> {
    let target = &arguments.target;
    target.check(None)?;
    let options = &arguments.device_options;
    let device = options.read_by_path(&arguments.device)?;
    let shape = LogShape::from(&device.model);
    let options = BagOptions {
        joint_names: arguments.joints.clone(),
        joint_topic: arguments.topic.clone(),
        pose_topic: arguments.pose_topic.clone(),
        is_growing: false,
    };
    let read = read_bag(&arguments.recording, &options, &shape)?;
    let mut warnings = device.warnings;
    warnings.extend(read.warnings);
    target.write(Imported::of(&read.recording, &shape, warnings)?)
}
