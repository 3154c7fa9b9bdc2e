//! Effects that a device has beside its geometry and its drives: a play, a spring, a drift.

use std::collections::BTreeMap;

use super::drive::JOINT_FRICTION;

/// An effect of a device, a table `[[effect]]` of its file.
///
/// What its name and its numbers mean is the business of `haptical-effects`; here it is a name with numbers. A
/// `joint-compliance` is no such entry: it is a number of the base model ([`crate::JointCompliance`]).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DeviceEffect {
    /// Name in the catalogue: `backlash`.
    pub name: String,
    /// Joint, from 0, where it has one.
    pub joint: Option<usize>,
    /// Parameters by name, each name ending with its unit: `width_rad`.
    pub numbers: BTreeMap<String, f64>,
    /// Parameters that are lists, by name: the coefficients of a curve, `coefficients_rad`.
    pub lists: BTreeMap<String, Vec<f64>>,
    /// 95 % intervals of parameters; an end that the data leave open is none.
    pub intervals: BTreeMap<String, [Option<f64>; 2]>,
    /// Effects that the data could not tell from it.
    pub confusable_with: Vec<String>,
    /// Whether a calibration fits it.
    pub fit: bool,
    /// What a calibration fits of it; empty where nothing is fitted, or until `haptical-effects` has looked at it.
    pub fitted: Vec<FitNumber>,
}

/// A number of an effect in the form in which a calibration fits it: a compliance for a stiffness, two parts for an
/// amplitude with a phase.
#[derive(Debug, Clone, PartialEq)]
pub struct FitNumber {
    /// Name of its own: `capstan-compliance@2.rad_per_nm`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Size that it may plausibly have.
    pub plausible_size: f64,
    /// Whether what it adds is a drift: a slow change, as a sensor's own drift is.
    pub is_drift: bool,
}

impl DeviceEffect {
    /// `backlash@3`, `cable-latency`.
    ///
    /// ```
    /// use haptical_model::DeviceEffect;
    /// let play = DeviceEffect { name: "backlash".to_owned(), joint: Some(2), ..DeviceEffect::default() };
    /// assert_eq!(play.label(), "backlash@3");
    /// ```
    pub fn label(&self) -> String {
        match self.joint {
            Some(joint) => format!("{}@{}", self.name, joint + 1),
            None => self.name.clone(),
        }
    }

    /// Whether it is the friction of a joint, whose numbers are [`crate::FrictionNumber`]s.
    pub fn is_friction(&self) -> bool {
        self.name == JOINT_FRICTION
    }

    /// The same as a file holds it.
    #[must_use]
    pub(crate) fn as_written(&self) -> Self {
        Self {
            fitted: Vec::new(),
            ..self.clone()
        }
    }
}
