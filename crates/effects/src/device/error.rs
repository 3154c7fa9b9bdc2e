//! Errors of the effects of a device.

use crate::{ContextError, Unit};

/// An effect of a device that has no meaning, with what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceEffectError {
    /// Its name is in no catalogue.
    #[error("[[effect]] `{name}` is not known{}", meant(nearest.as_ref()))]
    Unknown {
        /// Name.
        name: String,
        /// The name that is most like it.
        nearest: Option<String>,
    },
    /// It is found by a diagnosis, and no law predicts it.
    #[error("[[effect]] `{name}` is no law that could be added to a device: {why}")]
    NoLaw {
        /// Name.
        name: String,
        /// Why.
        why: &'static str,
    },
    /// It has no joint, or one that cannot have it.
    #[error("[[effect]] `{label}`: {why}")]
    Place {
        /// Name with its joint.
        label: String,
        /// What is wrong.
        why: String,
    },
    /// A key that is no parameter of it.
    #[error("[[effect]] `{label}` has no parameter `{key}`{} parameters are: {known}", instead(key, nearest.as_ref()))]
    Parameter {
        /// Name with its joint.
        label: String,
        /// The key.
        key: String,
        /// The parameter that is most like it.
        nearest: Option<String>,
        /// All parameters.
        known: String,
    },
    /// A parameter is not there.
    #[error(
        "[[effect]] `{label}` has no `{key}`: give it, or `fit = true` without any number; its parameters are: {known}"
    )]
    Missing {
        /// Name with its joint.
        label: String,
        /// The key.
        key: &'static str,
        /// All parameters.
        known: String,
    },
    /// A number that the law cannot have.
    #[error("[[effect]] `{label}`: `{key}` is {value}, but {allowed}")]
    Number {
        /// Name with its joint.
        label: String,
        /// The key.
        key: String,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The same effect stands twice.
    #[error("[[effect]] `{label}` stands twice: delete one")]
    Twice {
        /// Name with its joint.
        label: String,
    },
    /// The recording lacks what the effect is a function of.
    #[error("[[effect]] `{label}` cannot be computed on this log: {why}")]
    Untestable {
        /// Name with its joint.
        label: String,
        /// What is missing.
        why: String,
    },
    /// The device has no value at a row.
    #[error(transparent)]
    Context(#[from] ContextError),
}

fn meant(nearest: Option<&String>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// What a key without a meaning was to be, up to the list of the parameters.
fn instead(key: &str, nearest: Option<&String>) -> String {
    match nearest {
        None => "; its".to_owned(),
        Some(name) if lacks_unit(key, name) => {
            format!(": the name of a number ends in its unit; write `{name}`. Its")
        }
        Some(name) => format!("; did you mean `{name}`? Its"),
    }
}

/// Whether a key is the name of a parameter without its unit.
pub(super) fn lacks_unit(key: &str, name: &str) -> bool {
    let (before, _) = Unit::split(name);
    key == before && key != name
}
