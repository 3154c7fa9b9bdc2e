//! A robot description as it is read, URDF or MJCF: links and joints with their places in the text.

mod limits;
pub(crate) mod mjcf;
pub(crate) mod parse;
pub(crate) mod places;
pub(crate) mod prefixes;
mod quaternions;
mod questions;
pub(crate) mod xml;

use std::ops::Range;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Matrix3;

use crate::robot::prefixes::without_prefixes;

/// Links and joints in the order of the file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<RobotLink>,
    pub(crate) joints: Vec<RobotJoint>,
    /// Byte at which an element can be added: before the closing tag; none for `<robot/>`.
    pub(crate) end: Option<usize>,
    /// Gravity in the root's frame \[m/s^2\], where the file states another one than (0, 0, -9.81).
    pub(crate) stated_gravity_mps2: Option<[f64; 3]>,
    /// What was left out.
    pub(crate) notes: Vec<String>,
    /// Attributes of an MJCF's `<compiler>` that change the masses of its bodies.
    pub(crate) mass_rules: Vec<&'static str>,
    /// Joints of an MJCF in the order of its positions, with those that others yield by.
    pub(crate) coordinates: Vec<Coordinates>,
    /// What 1 is in angles of an MJCF \[rad\].
    pub(crate) angle_rad: f64,
    /// Time step of an MJCF \[s\].
    pub(crate) step_s: f64,
}

/// How many numbers a joint of an MJCF has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Coordinates {
    /// Byte of its element.
    pub(crate) place: usize,
    pub(crate) positions: usize,
    pub(crate) velocities: usize,
}

/// Mass of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inertial {
    pub(crate) mass_kg: f64,
    /// Centre of mass in the link's frame \[m\].
    pub(crate) centre_m: [f64; 3],
    /// Inertia about the centre of mass along the axes of the link's frame \[kg m^2\].
    pub(crate) inertia_kgm2: Option<Matrix3<f64>>,
}

/// A link.
#[derive(Debug, Clone)]
pub(crate) struct RobotLink {
    pub(crate) name: String,
    /// Byte of its element.
    pub(crate) place: usize,
    pub(crate) inertial: Option<Inertial>,
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
    /// More than one variable: what it is, in words.
    Other(&'static str),
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
    /// Inertia of rotor and gear, seen at the joint \[kg m^2\], \[kg\].
    pub(crate) armature: Option<f64>,
    /// Coulomb's friction, and friction per speed \[N m\], \[N m s/rad\]; of a slide \[N\], \[N s/m\].
    pub(crate) friction: [f64; 2],
    /// Largest torque of its drive \[N m\], \[N\].
    pub(crate) effort: Option<f64>,
    pub(crate) mimic: Option<Mimic>,
    /// Element of an MJCF that places it; none in a URDF, and for what no single element places.
    pub(crate) placed_by: Option<PlacedBy>,
    /// Whether it is a constant part of the joint before it, which is not placed by itself.
    pub(crate) is_part: bool,
    /// Angle per torque of a spring behind it \[rad/(N m)\], \[m/N\].
    pub(crate) compliance: f64,
    /// Bytes of the elements of these springs.
    pub(crate) springs: Vec<usize>,
}

/// An element of an MJCF with `pos` and an orientation: the origin is `before` its place `behind`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedBy {
    /// Byte of the element.
    pub(crate) place: usize,
    pub(crate) before: Pose,
    pub(crate) behind: Pose,
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

impl Robot {
    /// Whether a link, or anything that is fixed behind it, has a mass.
    pub(crate) fn is_heavy_behind(&self, link: usize) -> bool {
        let mut open = vec![link];
        while let Some(link) = open.pop() {
            let own = &self.links[link];
            if own.inertial.is_some_and(|own| own.mass_kg > 0.0) {
                return true;
            }
            let joints = own.child_joints.iter().map(|joint| &self.joints[*joint]);
            open.extend(joints.filter(|own| !own.moves()).map(|own| own.child));
        }
        false
    }
}

/// Reads a URDF or, by its outermost element, an MJCF; `file` names it in errors.
pub(crate) fn read_any(text: &str, file: &str) -> xml::Result<Robot> {
    let plain = without_prefixes(text);
    let document = xml::document(&plain, file)?;
    match document.root_element().tag_name().name() {
        "mujoco" => mjcf::parse(text, file),
        _ => parse::parse(text, file),
    }
}
