//! The way from a base to a tip: up the tree to where their branches meet, then down.

use haptical_model::kinematics::Pose;

use crate::rigid::z_to;
use crate::robot::{Robot, RobotJoint};
use haptical_model::rigid::{inverse, turn};

/// Links between which a chain of a URDF runs. The default is the longest chain from the root.
///
/// ```
/// use haptical_urdf::{BaseAndTip, device_from_urdf};
/// let text = r#"<robot name="two_arms">
///   <link name="trunk"/> <link name="left"/> <link name="right"/>
///   <joint name="left_shoulder" type="continuous">
///     <origin xyz="0 0.2 0"/> <parent link="trunk"/> <child link="left"/> <axis xyz="0 0 1"/>
///   </joint>
///   <joint name="right_shoulder" type="continuous">
///     <origin xyz="0 -0.2 0"/> <parent link="trunk"/> <child link="right"/> <axis xyz="0 0 1"/>
///   </joint>
/// </robot>"#;
/// let across = device_from_urdf(text, "two_arms.urdf", BaseAndTip::between("left", "right"))?;
/// assert_eq!((across.base.as_str(), across.tip.as_str()), ("left", "right"));
/// // the left shoulder is passed upwards: turned by a quarter, the right one, 0.4 m to its side, is along -x
/// let pose = haptical_model::DeviceChain::new(&across.device).pose(&[0.5 * std::f64::consts::PI, 0.0])?;
/// assert!((pose.position_m.x + 0.4).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BaseAndTip<'n> {
    /// Link that is frame (-1); none for the root link. Whoever names it must name the tip too.
    pub base: Option<&'n str>,
    /// Link that is the handle; none for the end of the longest chain.
    pub tip: Option<&'n str>,
    /// Further links that are measured: then the device is the tree of the chains to all tips, and each tip is a hand
    /// ([`haptical_model::Hand`]) of the link's name.
    pub further_tips: &'n [String],
}

impl<'n> BaseAndTip<'n> {
    /// From the root link to `tip`.
    pub const fn to(tip: &'n str) -> Self {
        Self {
            base: None,
            tip: Some(tip),
            further_tips: &[],
        }
    }

    /// From one link to another.
    pub const fn between(base: &'n str, tip: &'n str) -> Self {
        Self {
            base: Some(base),
            tip: Some(tip),
            further_tips: &[],
        }
    }
}

/// A joint as it is passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Step {
    /// Joint of the robot, from 0.
    pub(crate) joint: usize,
    /// From its child to its parent.
    pub(crate) is_upward: bool,
}

/// A path: joints in the order in which they are passed, the upward ones first.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) base: usize,
    pub(crate) tip: usize,
    pub(crate) steps: Vec<Step>,
}

impl Step {
    pub(crate) const fn up(joint: usize) -> Self {
        Self {
            joint,
            is_upward: true,
        }
    }

    pub(crate) const fn down(joint: usize) -> Self {
        Self {
            joint,
            is_upward: false,
        }
    }

    /// The joint's origin as it is passed: before its motion, or inverted and behind it.
    pub(crate) fn origin(self, joint: &RobotJoint) -> Pose {
        match self.is_upward {
            true => inverse(&joint.origin),
            false => joint.origin,
        }
    }

    /// Turns z along the axis of the motion as it is passed: upwards (O M(axis, q))^-1 =
    /// M(-axis, q) O^-1, where a joint O M(axis, q) leads downwards.
    pub(crate) fn along_z(self, joint: &RobotJoint) -> Pose {
        turn(z_to(&match self.is_upward {
            true => joint.axis.map(|part| -part),
            false => joint.axis,
        }))
    }
}

impl Path {
    /// The way between two links; none where they are in separate trees.
    pub(crate) fn between(robot: &Robot, base: usize, tip: usize) -> Option<Self> {
        let (mut up, mut down) = (upwards(robot, base), upwards(robot, tip));
        if up.root != down.root {
            return None;
        }
        // what both pass is passed by neither
        while let (Some(own), Some(other)) = (up.joints.last(), down.joints.last())
            && own == other
        {
            up.joints.pop();
            down.joints.pop();
        }
        let up = up.joints.into_iter().map(Step::up);
        let down = down.joints.into_iter().rev().map(Step::down);
        let steps = up.chain(down).collect();
        Some(Self { base, tip, steps })
    }

    /// From the root that a link is on.
    pub(crate) fn from_root(robot: &Robot, tip: usize) -> Self {
        let Upwards { root, joints } = upwards(robot, tip);
        Self {
            base: root,
            tip,
            steps: joints.into_iter().rev().map(Step::down).collect(),
        }
    }

    /// Joints that move.
    pub(crate) fn moving(&self, robot: &Robot) -> usize {
        let steps = self.steps.iter();
        steps
            .filter(|step| robot.joints[step.joint].moves())
            .count()
    }

    /// Which joints of the robot are passed.
    pub(crate) fn passed(&self, robot: &Robot) -> Vec<bool> {
        let mut passed = vec![false; robot.joints.len()];
        self.steps.iter().for_each(|step| passed[step.joint] = true);
        passed
    }
}

/// Which joints of the robot are passed on any of some paths.
pub(crate) fn passed(robot: &Robot, paths: &[Path]) -> Vec<bool> {
    let own: Vec<Vec<bool>> = paths.iter().map(|path| path.passed(robot)).collect();
    let joints = 0..robot.joints.len();
    joints
        .map(|joint| own.iter().any(|own| own[joint]))
        .collect()
}

/// Joints above a link, the nearest first, and the link where they end.
struct Upwards {
    root: usize,
    joints: Vec<usize>,
}

fn upwards(robot: &Robot, link: usize) -> Upwards {
    let mut joints = Vec::new();
    let mut root = link;
    while let Some(joint) = robot.links[root].parent_joint {
        joints.push(joint);
        root = robot.joints[joint].parent;
    }
    Upwards { root, joints }
}
