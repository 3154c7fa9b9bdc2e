//! The moving rows of a path: the fixed parts between them, and the joint that drives each.

pub(crate) mod ends;
pub(crate) mod friction;
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
use crate::robot::{Robot, RobotJoint, RobotJointType};
use crate::words::joined;

/// A moving joint of the path.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Joint of the robot, from 0.
    pub(crate) joint: usize,
    /// From the frame behind the row before (its axis along z) to this row's, the axis of the motion as it is
    /// passed along z.
    pub(crate) origin: Pose,
    pub(crate) drive: Drive,
    /// The row before it on its path, from 0; none for the first.
    pub(crate) behind: Option<usize>,
}

/// Where a path ends.
#[derive(Debug, Clone)]
pub(crate) struct End {
    /// Its rows, from 0.
    pub(crate) rows: Vec<usize>,
    /// From the last row's frame, axis along z, to the tip.
    pub(crate) handle: Pose,
}

/// Paths as rows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rows {
    /// Those of the first path, then what the others add.
    pub(crate) rows: Vec<Row>,
    /// Of each path.
    pub(crate) ends: Vec<End>,
    /// Joints of the robot whose variables drive the rows, in the order of the device's joints.
    pub(crate) drivers: Vec<usize>,
}

/// Most mimics one behind another.
const MOST_MIMICS: usize = 32;

/// Splits paths from one base into their moving rows; `at` gives a byte's place. A joint that several paths pass is one
/// row: the way to it from the base is the same.
pub(crate) fn rows(
    robot: &Robot,
    paths: &[Path],
    at: &dyn Fn(usize) -> Box<Position>,
) -> Result<Rows, UrdfError> {
    let mut split = Rows::default();
    for path in paths {
        split.add(robot, path, at)?;
    }
    Ok(split)
}

impl Rows {
    fn add(
        &mut self,
        robot: &Robot,
        path: &Path,
        at: &dyn Fn(usize) -> Box<Position>,
    ) -> Result<(), UrdfError> {
        let (gaps, handle) = gaps(robot, path);
        let mut end = End {
            rows: Vec::new(),
            handle: handle.product(),
        };
        let moving = path.steps.iter().map(|step| step.joint);
        let moving = moving.filter(|joint| robot.joints[*joint].moves());
        for (index, gap) in moving.zip(&gaps) {
            if let Some(known) = self.rows.iter().position(|row| row.joint == index) {
                end.rows.push(known);
                continue;
            }
            let Some(motion) = motion_of(&robot.joints[index], at)? else {
                continue;
            };
            let (driver, multiplier, offset) =
                driver(robot, index).map_err(|(place, message)| UrdfError::Tree {
                    at: at(place),
                    message,
                })?;
            let known = self.drivers.iter().position(|own| *own == driver);
            let number = known.unwrap_or_else(|| {
                self.drivers.push(driver);
                self.drivers.len() - 1
            });
            let behind = end.rows.last().copied();
            end.rows.push(self.rows.len());
            self.rows.push(Row {
                joint: index,
                origin: gap.product(),
                drive: Drive {
                    joint: number,
                    motion,
                    multiplier,
                    offset,
                },
                behind,
            });
        }
        self.ends.push(end);
        Ok(())
    }
}

/// How a joint moves; none for a fixed one.
fn motion_of(
    joint: &RobotJoint,
    at: &dyn Fn(usize) -> Box<Position>,
) -> Result<Option<JointType>, UrdfError> {
    match joint.joint_type {
        RobotJointType::Fixed => Ok(None),
        RobotJointType::Revolute | RobotJointType::Continuous => Ok(Some(JointType::Revolute)),
        RobotJointType::Prismatic => Ok(Some(JointType::Prismatic)),
        RobotJointType::Other(what) => {
            let message = format!(
                "joint `{}` is {what}: a chain has one variable per joint",
                joint.name
            );
            Err(UrdfError::Tree {
                at: at(joint.place),
                message,
            })
        }
    }
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
            RobotJointType::Fixed | RobotJointType::Other(_) => false,
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
