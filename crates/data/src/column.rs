//! The meaning of each name in the header for a device.

use crate::shape::LogShape;

/// Names of the three parts of a position, four of an orientation, three of a force.
pub(crate) const POSITION: [&str; 3] = ["x_m", "y_m", "z_m"];
/// See [`POSITION`].
pub(crate) const ORIENTATION: [&str; 4] = ["qw", "qx", "qy", "qz"];
/// See [`POSITION`].
pub(crate) const FORCE: [&str; 3] = ["fx_n", "fy_n", "fz_n"];

/// What a column holds; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Time,
    Run,
    Joint(usize),
    Output(usize),
    Cable(usize),
    Position(usize),
    Orientation(usize),
    Hand,
    Contact,
    Plane,
    Tool,
    Torque(usize),
    Force(usize),
    Temperature,
    Covariate,
    Unnamed,
    /// A joint column in metres that should be in radians or the reverse, with the joint's index.
    WrongUnit(usize),
}

impl Role {
    /// What `name` means for a device of this shape.
    pub(crate) fn parse(name: &str, shape: &LogShape) -> Self {
        match name {
            "" => Self::Unnamed,
            "t_s" => Self::Time,
            "run" => Self::Run,
            "hand" => Self::Hand,
            "contact" => Self::Contact,
            "plane" => Self::Plane,
            "tool" => Self::Tool,
            "temp_degc" => Self::Temperature,
            _ => Self::parse_group(name)
                .or_else(|| Self::parse_cable(name, shape))
                .or_else(|| Self::parse_joint(name, shape))
                .unwrap_or(Self::Covariate),
        }
    }

    fn parse_group(name: &str) -> Option<Self> {
        let part = |names: &[&str]| names.iter().position(|&part| part == name);
        part(&POSITION)
            .map(Self::Position)
            .or_else(|| part(&ORIENTATION).map(Self::Orientation))
            .or_else(|| part(&FORCE).map(Self::Force))
    }

    fn parse_cable(name: &str, shape: &LogShape) -> Option<Self> {
        let cable = cable_index(name)?;
        (cable < shape.cable_count).then_some(Self::Cable(cable))
    }

    fn parse_joint(name: &str, shape: &LogShape) -> Option<Self> {
        let (stem, joint, unit) = indexed(name)?;
        let expected = shape.joints.get(joint)?.unit();
        match (stem, unit) {
            ("theta", unit) if unit == expected => Some(Self::Joint(joint)),
            ("out", unit) if unit == expected => Some(Self::Output(joint)),
            ("theta" | "out", "rad" | "m") => Some(Self::WrongUnit(joint)),
            // what a drive exerts on a slide is a force; logs that were written before say `nm` there
            ("torque", "nm") => Some(Self::Torque(joint)),
            ("torque", "n") if expected == "m" => Some(Self::Torque(joint)),
            _ => None,
        }
    }

    /// Name of such a column in a log of a device of this shape; none for those that may have any.
    pub(crate) fn name(self, shape: &LogShape) -> String {
        let part = |names: &[&str], part: usize| names.get(part).copied().unwrap_or("").to_owned();
        let of_joint = |stem: &str, joint: usize| {
            let unit = shape.joints.get(joint).map_or("rad", |joint| joint.unit());
            format!("{stem}{}_{unit}", joint + 1)
        };
        match self {
            Self::Time => "t_s".to_owned(),
            Self::Run => "run".to_owned(),
            Self::Joint(joint) => of_joint("theta", joint),
            Self::Output(joint) => of_joint("out", joint),
            Self::Cable(0) => "cable_m".to_owned(),
            Self::Cable(cable) => format!("cable{}_m", cable + 1),
            Self::Position(axis) => part(&POSITION, axis),
            Self::Orientation(index) => part(&ORIENTATION, index),
            Self::Hand => "hand".to_owned(),
            Self::Contact => "contact".to_owned(),
            Self::Plane => "plane".to_owned(),
            Self::Tool => "tool".to_owned(),
            Self::Torque(joint) => {
                let slides = shape
                    .joints
                    .get(joint)
                    .is_some_and(|joint| joint.unit() == "m");
                format!("torque{}_{}", joint + 1, if slides { "n" } else { "nm" })
            }
            Self::Force(axis) => part(&FORCE, axis),
            Self::Temperature => "temp_degc".to_owned(),
            Self::Covariate | Self::Unnamed | Self::WrongUnit(_) => String::new(),
        }
    }

    /// Whether cells are angles, lengths, torques or forces, which are squared somewhere.
    pub(crate) fn is_measured(self) -> bool {
        matches!(
            self,
            Self::Joint(_)
                | Self::Output(_)
                | Self::Cable(_)
                | Self::Position(_)
                | Self::Torque(_)
                | Self::Force(_)
        )
    }

    /// Whether cells are text identifiers.
    pub(crate) fn is_text(self) -> bool {
        matches!(self, Self::Hand | Self::Contact | Self::Plane | Self::Tool)
    }
}

/// The index from 0 of `cable_m`, `cable2_m`, ...
pub(crate) fn cable_index(name: &str) -> Option<usize> {
    if name == "cable_m" {
        return Some(0);
    }
    match indexed(name)? {
        ("cable", cable, "m") if cable > 0 => Some(cable),
        _ => None,
    }
}

/// Splits `theta12_rad` into `theta`, 11 and `rad`; the number has no leading zero.
pub(crate) fn indexed(name: &str) -> Option<(&str, usize, &str)> {
    let (front, unit) = name.rsplit_once('_')?;
    let stem = front.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let digits = &front[stem.len()..];
    if digits.starts_with('0') {
        return None;
    }
    Some((stem, digits.parse::<usize>().ok()?.checked_sub(1)?, unit))
}
