//! Device files in TOML: reading, checking, writing.

pub(crate) mod device;
pub(crate) mod effect;
pub(crate) mod hand;
pub(crate) mod joint;
pub(crate) mod reader;
pub(crate) mod rig;
pub(crate) mod row;
pub(crate) mod sensors;
pub(crate) mod surroundings;
pub(crate) mod syntax;
pub(crate) mod text;
pub(crate) mod write;

use haptical_kinematics::Convention;

use crate::{JointType, TransmissionKind};

/// Words of a file with what they stand for, for reading and writing.
pub(crate) type Words<T> = [(&'static str, T)];

pub(crate) const CONVENTIONS: &Words<Convention> = &[
    ("standard", Convention::Standard),
    ("modified", Convention::Modified),
];
pub(crate) const JOINT_TYPES: &Words<JointType> = &[
    ("revolute", JointType::Revolute),
    ("prismatic", JointType::Prismatic),
];
pub(crate) const TRANSMISSIONS: &Words<TransmissionKind> = &[
    ("capstan", TransmissionKind::Capstan),
    ("parallelogram", TransmissionKind::Parallelogram),
    ("direct", TransmissionKind::Direct),
];
/// Whether the place of a tracker's tool is known.
pub(crate) const PLACES: &Words<bool> = &[("known", true), ("unknown", false)];
/// Whether the place of a tracker's base is known, and whether each run has one of its own.
pub(crate) const BASES: &Words<(bool, bool)> = &[
    ("known", (true, false)),
    ("unknown", (false, false)),
    ("per-run", (false, true)),
];

/// The word for a value.
pub(crate) fn word_for<T: PartialEq>(words: &Words<T>, value: &T) -> &'static str {
    let mut words = words.iter();
    words
        .find(|(_, known)| known == value)
        .map_or("", |(word, _)| word)
}
