//! A URDF as it is read: links and joints with their places in the text.

mod limits;
pub(crate) mod parse;

use std::ops::Range;

use haptical_model::kinematics::Pose;

/// Links and joints in the order of the file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<RobotLink>,
    pub(crate) joints: Vec<RobotJoint>,
    /// Byte at which an element can be added: before the closing tag; none for `<robot/>`.
    pub(crate) end: Option<usize>,
}

/// A link.
#[derive(Debug, Clone)]
pub(crate) struct RobotLink {
    pub(crate) name: String,
    /// Byte of its element.
    pub(crate) place: usize,
    /// Mass \[kg\] and centre of mass in the link's frame \[m\].
    pub(crate) mass: Option<(f64, [f64; 3])>,
    /// Joint whose child it is, from 0.
    pub(crate) parent_joint: Option<usize>,
    /// Joints whose parent it is, from 0, in the order of the file.
    pub(crate) child_joints: Vec<usize>,
}

/// What a joint does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RobotJointType {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    /// Floating or planar: more than one variable.
    Other,
}

/// A joint that takes its variable from another one.
#[derive(Debug, Clone)]
pub(crate) struct Mimic {
    pub(crate) joint: String,
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
    pub(crate) place: usize,
}

/// A joint. Lengths in m, angles in rad.
#[derive(Debug, Clone)]
pub(crate) struct RobotJoint {
    pub(crate) name: String,
    pub(crate) place: usize,
    /// Byte behind its opening tag, where an origin can be put; none for an element without content.
    pub(crate) inside: usize,
    pub(crate) joint_type: RobotJointType,
    /// Links, from 0.
    pub(crate) parent: usize,
    pub(crate) child: usize,
    /// Joint frame in the parent link's frame.
    pub(crate) origin: Pose,
    /// Bytes of the element `<origin .../>`.
    pub(crate) origin_range: Option<Range<usize>>,
    /// Unit vector in the joint frame.
    pub(crate) axis: [f64; 3],
    pub(crate) limits: Option<(f64, f64)>,
    pub(crate) mimic: Option<Mimic>,
}

impl RobotJoint {
    /// Whether it has one variable.
    pub(crate) fn moves(&self) -> bool {
        self.joint_type != RobotJointType::Fixed
    }

    /// Unit of its variable.
    pub(crate) fn unit(&self) -> &'static str {
        match self.joint_type {
            RobotJointType::Prismatic => "m",
            _ => "rad",
        }
    }
}
