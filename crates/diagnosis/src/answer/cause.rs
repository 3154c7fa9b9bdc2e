//! A cause, and what a calibration without it had taken up of it.

use std::collections::BTreeMap;

use haptical_effects::Ahead;
use haptical_model::{Device, DeviceEffect, ParameterId};
use serde::Serialize;

use crate::answer::HeldOutAnswer;

/// A cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CauseAnswer {
    /// Name of the effect (docs/diagnosis.md, Catalogue).
    pub effect: String,
    /// Joint (from 1), where it has one.
    pub joint: Option<usize>,
    /// Probability of this name at this place.
    pub probability: f64,
    /// Probability of this name or one of those it is confusable with.
    pub class_probability: f64,
    /// Names (with their joints, where those differ) that refit within ln 100.
    pub confusable_with: Vec<String>,
    /// Parameters with intervals.
    pub parameters: BTreeMap<String, ParameterAnswer>,
    /// Of an effect that the earlier model has with another size: the numbers that it has.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub earlier: BTreeMap<String, f64>,
    /// Of numbers of the base model that changed since the earlier model: what they are now, and what that has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changed: Vec<MovedNumber>,
    /// False where a parameter lies beyond what a sound device can show.
    pub plausible: bool,
    /// The opposite, under the name that a script may look for.
    pub implausible: bool,
    /// Share of the gap's energy that it explains.
    pub share: f64,
    /// Gap before and after on data that the fit did not see.
    pub held_out: Option<HeldOutAnswer>,
}

impl CauseAnswer {
    /// Of motor encoders that are ahead of the other sensors: what that usually means.
    pub fn ahead(&self) -> Option<Ahead> {
        let delay_s = self.parameters.get("delay_s").map(|own| own.value);
        Ahead::of(&self.effect, delay_s, &self.confusable_with)
    }

    /// Whether it came about between two runs of the log.
    pub fn is_of_runs(&self) -> bool {
        self.parameters.contains_key("from_run")
    }

    /// Whether it is an effect at a place, its joint from 0.
    pub fn is_of(&self, effect: &str, joint: Option<usize>) -> bool {
        self.effect == effect && self.joint == joint.map(|joint| joint + 1)
    }

    /// As an effect of a device.
    pub(crate) fn as_effect(&self) -> DeviceEffect {
        let numbers = self.parameters.iter();
        DeviceEffect {
            name: self.effect.clone(),
            joint: self.joint.map(|joint| joint - 1),
            intervals: (numbers.clone())
                .map(|(name, own)| (name.clone(), own.ci95.map(Some)))
                .collect(),
            numbers: numbers
                .map(|(name, own)| (name.clone(), own.value))
                .collect(),
            confusable_with: self.confusable_with.clone(),
            fit: true,
            ..DeviceEffect::default()
        }
    }

    /// Its joint in words, or the device.
    pub fn place(&self) -> String {
        self.joint
            .map_or("the device".to_owned(), |joint| format!("joint {joint}"))
    }
}

/// What a calibration without the causes had taken up of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsorbedAnswer {
    /// Share of the first cause's squared signal that the base model imitates.
    pub share: Option<f64>,
    /// Numbers of the base model that move with the causes, farthest first in standard deviations.
    pub moved: Vec<MovedNumber>,
}

/// A number of the base model that moves once the causes are in the model, or that changed since an earlier one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovedNumber {
    /// Name, as in identified.json.
    pub parameter: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Value of the earlier model.
    pub earlier: f64,
    /// Value now.
    #[serde(flatten)]
    pub value: ParameterAnswer,
}

impl MovedNumber {
    pub(crate) fn new(
        parameter: ParameterId,
        device: &Device,
        earlier: f64,
        value: ParameterAnswer,
    ) -> Self {
        Self {
            parameter: parameter.name(device),
            unit: parameter.unit(device).to_owned(),
            earlier,
            value,
        }
    }
}

/// A parameter of a cause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParameterAnswer {
    /// Value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

impl ParameterAnswer {
    /// A value with a standard deviation.
    pub(crate) fn normal(value: f64, sd: f64) -> Self {
        let half = 1.96 * sd;
        Self {
            value,
            ci95: [value - half, value + half],
        }
    }

    /// With a factor besides, which may be off by exp(+-1.96 `relative`): a law that is wrong by a share of its effect
    /// makes its size wrong, never its sign.
    pub(crate) fn off_by_a_factor(self, relative: f64) -> Self {
        // beyond a million nothing is known, and no end may be infinite
        let factor = (1.96 * relative).exp().min(1e6);
        let ends = [self.value / factor, self.value * factor];
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let [below, above] = [self.value - self.ci95[0], self.ci95[1] - self.value];
        Self {
            ci95: [
                self.value - below.hypot(self.value - low),
                self.value + above.hypot(high - self.value),
            ],
            ..self
        }
    }
}

impl CauseAnswer {
    /// A plausible name that nothing is confused with, without numbers; joints from 0.
    pub(crate) fn named(effect: &str, joint: Option<usize>, probability: f64) -> Self {
        Self {
            effect: effect.to_owned(),
            joint: joint.map(|joint| joint + 1),
            probability,
            class_probability: probability,
            confusable_with: Vec::new(),
            parameters: BTreeMap::new(),
            earlier: BTreeMap::new(),
            changed: Vec::new(),
            plausible: true,
            implausible: false,
            share: 0.0,
            held_out: None,
        }
    }
}
