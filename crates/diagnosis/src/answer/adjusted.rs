//! What was fitted before anything was judged, and how far the device file was off without.

use haptical_effects::Unit;
use serde::Serialize;

use super::ParameterAnswer;

/// A number that was fitted and counts as calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdjustedAnswer {
    /// What it is of: `friction`, `armature`.
    pub name: &'static str,
    /// The number, with its unit: `coulomb_nm`.
    pub number: String,
    /// Joint (from 1).
    pub joint: usize,
    /// Unit.
    pub unit: &'static str,
    /// What the device file has; none where it has no such number.
    pub before: Option<f64>,
    /// As fitted.
    pub after: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// How far the device file as it is was off in one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OwnModel {
    /// Channel.
    pub channel: String,
    /// Unit of both.
    pub unit: String,
    /// Root mean square that the file leaves, nothing adjusted.
    pub rms_before: f64,
    /// What is left once everything is adjusted, and with the causes.
    pub rms_after: f64,
}

impl AdjustedAnswer {
    /// A number of a joint, from 0, by its name with its unit.
    pub(crate) fn new(
        number: &str,
        joint: usize,
        before: Option<f64>,
        after: ParameterAnswer,
    ) -> Self {
        Self {
            name: match number.starts_with("armature") {
                true => "armature",
                false => "friction",
            },
            number: number.to_owned(),
            joint: joint + 1,
            unit: Unit::by_name(number).symbol(),
            before,
            after: after.value,
            ci95: after.ci95,
        }
    }
}
