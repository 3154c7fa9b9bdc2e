//! The moving rows of a path: the fixed parts between them, and the joint that drives each.

pub(crate) mod ends;
pub(crate) mod gaps;
pub(crate) mod gravity;
pub(crate) mod masses;
pub(crate) mod path;
pub(crate) mod tip;

use haptical_model::kinematics::Pose;
use haptical_model::{Drive, JointType, Position};

use crate::UrdfError;
use crate::chain::gaps::gaps;
use crate::chain::path::Path;
use crate::chain::tip::joined;
use crate::robot::{Robot, RobotJoint, RobotJointType};

/// A moving joint of the path.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Joint of the robot, from 0.
    pub(crate) joint: usize,
    /// From the frame behind the row before (its axis along z) to this row's, the axis of the motion as it is
    /// passed along z.
    pub(crate) origin: Pose,
    pub(crate) drive: Drive,
}

/// A path as rows.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub(crate) rows: Vec<Row>,
    /// From the last row's frame, axis along z, to the tip.
    pub(crate) handle: Pose,
    /// Joints of the robot whose variables drive the rows, in the order of the device's joints.
    pub(crate) drivers: Vec<usize>,
}

/// Most mimics one behind another.
const MOST_MIMICS: usize = 32;

/// Splits a path into its moving rows; `at` gives a byte's place.
pub(crate) fn rows(
    robot: &Robot,
    path: &Path,
    at: &dyn Fn(usize) -> Box<Position>,
) -> Result<Rows, UrdfError> {
    let (gaps, handle) = gaps(robot, path);
    let mut split = Rows {
        rows: Vec::new(),
        handle: handle.product(),
        drivers: Vec::new(),
    };
    let moving = path.steps.iter().map(|step| step.joint);
    let moving = moving.filter(|joint| robot.joints[*joint].moves());
    for (index, gap) in moving.zip(&gaps) {
        let joint = &robot.joints[index];
        let motion = match joint.joint_type {
            RobotJointType::Fixed => continue,
            RobotJointType::Revolute | RobotJointType::Continuous => JointType::Revolute,
            RobotJointType::Prismatic => JointType::Prismatic,
            RobotJointType::Other => {
                let message = format!(
                    "joint `{}` is floating or planar: a chain has one variable per joint",
                    joint.name
                );
                return Err(UrdfError::Tree {
                    at: at(joint.place),
                    message,
                });
            }
        };
        let (driver, multiplier, offset) =
            driver(robot, index).map_err(|(place, message)| UrdfError::Tree {
                at: at(place),
                message,
            })?;
        let known = split.drivers.iter().position(|own| *own == driver);
        let number = known.unwrap_or_else(|| {
            split.drivers.push(driver);
            split.drivers.len() - 1
        });
        split.rows.push(Row {
            joint: index,
            origin: gap.product(),
            drive: Drive {
                joint: number,
                motion,
                multiplier,
                offset,
            },
        });
    }
    Ok(split)
}

/// The joint whose variable drives a joint, with multiplier and offset; or which byte is wrong, and why.
pub(crate) fn driver(robot: &Robot, joint: usize) -> Result<(usize, f64, f64), (usize, String)> {
    let (mut driver, mut multiplier, mut offset) = (joint, 1.0, 0.0);
    for _ in 0..MOST_MIMICS {
        let Some(mimic) = &robot.joints[driver].mimic else {
            return Ok((driver, multiplier, offset));
        };
        let name = &robot.joints[driver].name;
        let is_source = |joint: &RobotJoint| joint.name == mimic.joint;
        let source = robot.joints.iter().position(is_source);
        let source = source.filter(|source| match robot.joints[*source].joint_type {
            RobotJointType::Fixed | RobotJointType::Other => false,
            RobotJointType::Revolute | RobotJointType::Continuous | RobotJointType::Prismatic => {
                true
            }
        });
        let Some(source) = source else {
            let message = format!(
                "joint `{name}` follows `{}`, which is no joint with one variable",
                mimic.joint
            );
            return Err((mimic.place, message));
        };
        if mimic.multiplier == 0.0 {
            let message = format!("joint `{name}` follows with the multiplier 0: make it fixed");
            return Err((mimic.place, message));
        }
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        driver = source;
    }
    let name = &robot.joints[joint].name;
    let message = format!("joint `{name}` follows itself, through the joints that it follows");
    Err((robot.joints[joint].place, message))
}

/// What is said where rows follow joints: names of parameters count rows, columns of a log count joints.
pub(crate) fn numbering(robot: &Robot, rows: &Rows, file: &str) -> Option<String> {
    let name = |joint: usize| robot.joints[joint].name.as_str();
    let mut follows = Vec::new();
    let mut apart = Vec::new();
    for (index, row) in rows.rows.iter().enumerate() {
        let driver = rows.drivers[row.drive.joint];
        let unit = robot.joints[driver].unit();
        let column = format!("column theta{}_{unit}", row.drive.joint + 1);
        let own = format!("row {} `{}`", index + 1, name(row.joint));
        if driver != row.joint {
            follows.push(format!("{own} follows `{}` ({column})", name(driver)));
        } else if row.drive.joint != index {
            apart.push(format!("{own} is {column}"));
        }
    }
    if follows.is_empty() {
        return None;
    }
    let mut said = format!(
        "{file}: {}; names of parameters, such as theta{}, count rows, columns of the log count joints",
        joined(&follows),
        rows.rows.len()
    );
    if !apart.is_empty() {
        said = format!("{said}: {}", joined(&apart));
    }
    Some(said)
}
