//! Refusals of URDFs, and of devices that no robot description can hold.

use haptical_model::kinematics::KinematicsError;
use haptical_model::{DeviceFileError, ModelError, Position};

/// What was wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The file cannot be read as text.
    #[error(transparent)]
    File(#[from] DeviceFileError),
    /// The text is not well-formed XML.
    #[error("{at}: not XML that is read: {message}")]
    Xml {
        /// Where.
        at: Box<Position>,
        /// What the parser said.
        message: String,
    },
    /// The text is XML of another kind.
    #[error("{at}: the outermost element is <{found}>, not <robot>: {advice}")]
    NotUrdf {
        /// Where.
        at: Box<Position>,
        /// Outermost element.
        found: String,
        /// What it probably is and what to do.
        advice: &'static str,
    },
    /// The text is XML of another kind than MJCF.
    #[error("{at}: the outermost element is <{found}>, not <mujoco>: {advice}")]
    NotMjcf {
        /// Where.
        at: Box<Position>,
        /// Outermost element.
        found: String,
        /// What it probably is and what to do.
        advice: &'static str,
    },
    /// An attribute or element that must be there is not.
    #[error("{at}: {place} has no {what}")]
    Missing {
        /// Where.
        at: Box<Position>,
        /// Element, in words.
        place: String,
        /// What is missing.
        what: &'static str,
    },
    /// A value that cannot be used.
    #[error("{at}: {place}: {what} is {found}, but {allowed}")]
    Value {
        /// Where.
        at: Box<Position>,
        /// Element, in words.
        place: String,
        /// Which value.
        what: &'static str,
        /// What is there.
        found: String,
        /// What may be there.
        allowed: String,
    },
    /// Links and joints that make no tree, or too many of them.
    #[error("{at}: {message}")]
    Tree {
        /// Where.
        at: Box<Position>,
        /// What does not fit.
        message: String,
    },
    /// An MJCF of several files, into which nothing can be written.
    #[error(
        "{at}: the model includes other files, and a corrected one is written into one file: write a new MJCF without --mjcf, or \
         save the model as one file, as MuJoCo's mj_saveLastXML does"
    )]
    Includes {
        /// Where.
        at: Box<Position>,
    },
    /// A base or a tip that is not there.
    #[error("{file}: there is no link `{link}`; the links are {links}")]
    UnknownLink {
        /// File.
        file: String,
        /// Name that was given.
        link: String,
        /// Names of links, in a sentence.
        links: String,
    },
    /// A base without a tip.
    #[error(
        "{file}: the base `{base}` was named without a tip: name the tip too, with --tip; branches end at {ends}"
    )]
    TipMissing {
        /// File.
        file: String,
        /// Link that was given.
        base: String,
        /// Names of links at which branches end, in a sentence.
        ends: String,
    },
    /// One link as base and tip.
    #[error("{file}: `{link}` is base and tip: name two links with joints that move between them")]
    SameLink {
        /// File.
        file: String,
        /// Link that was given.
        link: String,
    },
    /// Two links that are fixed to each other.
    #[error("{file}: no joint between {} and `{tip}` moves: name another --tip", base_name(base.as_deref()))]
    Unmoved {
        /// File.
        file: String,
        /// Base; none for the root link where it was not named.
        base: Option<String>,
        /// Tip.
        tip: String,
    },
    /// No chain from the base to the tip that were asked for, or too long a one.
    #[error("{file}: {message}")]
    Chain {
        /// File.
        file: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// A device that this URDF does not describe, or that no robot description can.
    #[error("the device `{device}`: {message}")]
    Device {
        /// Device name.
        device: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// The device's chain has no value.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// The device has no chain of moving rows.
    #[error(transparent)]
    Model(#[from] ModelError),
}

fn base_name(base: Option<&str>) -> String {
    base.map_or_else(|| "the root".to_owned(), |base| format!("`{base}`"))
}

impl UrdfError {
    /// The place in the file, where there is one.
    pub fn position(&self) -> Option<&Position> {
        match self {
            Self::File(error) => error.position(),
            Self::Xml { at, .. }
            | Self::NotUrdf { at, .. }
            | Self::NotMjcf { at, .. }
            | Self::Missing { at, .. }
            | Self::Value { at, .. }
            | Self::Tree { at, .. }
            | Self::Includes { at } => Some(at),
            Self::UnknownLink { .. }
            | Self::TipMissing { .. }
            | Self::SameLink { .. }
            | Self::Unmoved { .. }
            | Self::Chain { .. }
            | Self::Device { .. }
            | Self::Kinematics(_)
            | Self::Model(_) => None,
        }
    }
}
