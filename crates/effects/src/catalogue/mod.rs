//! The catalogue of effects that a base model lacks, one file per group.
//!
//! An effect says where it enters, which covariates it needs, and what it adds to the measured
//! streams, with its derivative. The registry at the end of this file is the only list of them:
//! adding one is a file (or a struct in its group's file) and a line there.

mod cable;
mod drift;
mod events;
mod history;
mod lag;
mod load;
mod shape;
mod structure;

pub use events::under_load;

use std::fmt::Debug;

use haptical_model::{Device, JointType, TransmissionKind};

use crate::context::{Context, Stream};
use crate::signal::Signal;

/// Where an effect enters the chain from motor encoder to measured streams (docs/diagnosis.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hook {
    /// Between motor encoder and external encoder of a joint: that encoder and the chain see it.
    Transmission,
    /// An external encoder: nothing else sees it.
    ExternalEncoder,
    /// A joint behind its external encoder: the chain alone sees it.
    Joint,
    /// Links, base or handle: the chain alone sees it.
    Structure,
    /// The cable encoder: the cable alone sees it.
    CableSensor,
    /// The sampling of all motor encoders: everything sees it.
    Timing,
}

/// Effects of one kind: of each kind a place shows at most one, because what a second one explains there
/// is what the first one's law gets wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Functions of the joint's own angle.
    Shape,
    /// Loops over reversals.
    Loop,
    /// Steps.
    Step,
    Lag,
    /// Proportional to a load.
    Load,
    /// Slow changes.
    Drift,
    Coupling,
    /// Where the cable leaves its guide.
    Exit,
    Wobble,
    Tool,
}

impl Family {
    /// Share of an effect's energy that the law of this kind may get wrong on a real device: a step and a
    /// delay are what they are, a spring hardens and a loop has no single form.
    pub fn law_error(self) -> f64 {
        match self {
            Self::Step => 0.003,
            Self::Lag => 0.015,
            Self::Shape | Self::Coupling => 0.02,
            Self::Exit | Self::Wobble | Self::Tool => 0.03,
            Self::Loop => 0.05,
            Self::Drift => 0.06,
            Self::Load => 0.09,
        }
    }

    /// Relative standard deviation that the law's error puts on an amplitude.
    pub fn amplitude_error(self) -> f64 {
        match self {
            Self::Step => 0.006,
            Self::Shape | Self::Coupling => 0.01,
            Self::Wobble | Self::Tool | Self::Lag => 0.015,
            Self::Drift | Self::Exit => 0.02,
            Self::Loop => 0.05,
            Self::Load => 0.06,
        }
    }
}

/// What must have been recorded for an effect to be tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    Time,
    /// Rows that follow a motion, so that reversals can be told.
    Motion,
    Torque(usize),
    Force,
    BaseMoment,
    Temperature,
    Output(usize),
    Cable,
    /// Radius of the first cable's drum.
    DrumRadius,
    /// A distance, position or orientation.
    Chain,
    Runs,
    Gravity,
    /// Counts of a motor-side encoder.
    Counts(usize),
}

/// A parameter of an effect, as it is reported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterSpec {
    /// Name, with its unit.
    pub name: &'static str,
    /// Smallest and largest magnitude that a sound device can show; outside the effect is called
    /// implausible. From the ranges of docs/diagnosis.md, a factor of ten wider.
    pub plausible: [f64; 2],
}

pub const fn parameter(name: &'static str, low: f64, high: f64) -> ParameterSpec {
    ParameterSpec {
        name,
        plausible: [low, high],
    }
}

/// One effect at one place.
pub trait Effect: Debug + Send + Sync {
    /// Name of the contract.
    fn name(&self) -> &'static str;
    /// Joint, from 0.
    fn joint(&self) -> Option<usize> {
        None
    }
    /// Where it enters.
    fn hook(&self) -> Hook;
    /// Kind of effect.
    fn family(&self) -> Family;
    /// Parameters in the order of [`Effect::values`].
    fn parameters(&self) -> &'static [ParameterSpec];
    /// Covariates without which it cannot be tested.
    fn needs(&self) -> Vec<Need>;
    /// Grid of the one parameter that enters nonlinearly (a transition, an order, a time constant).
    fn shapes(&self, _context: &Context<'_>) -> Vec<f64> {
        vec![0.0]
    }
    /// Whether shapes between those of the grid exist.
    fn shape_is_continuous(&self) -> bool {
        false
    }
    /// Whether the shapes are sides that drive it: both are refitted.
    fn has_sides(&self) -> bool {
        false
    }
    /// Whether the shape is the row of an event: it is searched over all rows, and belongs to one
    /// recording.
    fn is_event(&self) -> bool {
        false
    }
    /// Derivative of the contribution with respect to each amplitude, at `amplitudes` (all zero for
    /// the score scan).
    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal>;
    /// What it adds to the measured streams; the derivative times the amplitudes where it is linear.
    fn contribution(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Signal {
        let mut sum = Signal::default();
        for (column, &amplitude) in self
            .derivative(context, amplitudes, shape)
            .iter()
            .zip(amplitudes)
        {
            sum.add(column, amplitude);
        }
        sum
    }
    /// Number of amplitudes.
    fn amplitude_count(&self) -> usize {
        1
    }
    /// The reported parameters; the first amplitude where nothing else is said.
    fn values(&self, _context: &Context<'_>, amplitudes: &[f64], _shape: f64) -> Vec<f64> {
        vec![amplitudes[0]]
    }
    /// Amplitudes and shape that have these values: the inverse of [`Effect::values`].
    fn amplitudes(&self, _context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], 0.0)
    }
    /// Whether the sign of the amplitude is one that nature allows (a stiffness is positive).
    fn is_possible(&self, _amplitudes: &[f64]) -> bool {
        true
    }
    /// Relative uncertainty that a covariate's scale adds to the first parameter.
    fn scale_uncertainty(&self, _context: &Context<'_>) -> f64 {
        0.0
    }
    /// Logarithm of its prior odds against a common effect.
    fn log_prior(&self) -> f64 {
        0.0
    }
}

impl dyn Effect {
    /// `backlash@3`, `cable-latency`.
    pub fn label(&self) -> String {
        match self.joint() {
            Some(joint) => format!("{}@{}", self.name(), joint + 1),
            None => self.name().to_owned(),
        }
    }

    /// Why it cannot be tested on a recording.
    pub fn untestable(&self, context: &Context<'_>) -> Option<String> {
        self.needs()
            .into_iter()
            .find_map(|need| missing(need, context))
            .or_else(|| self.unseen(context))
    }

    /// Why no measured stream can show it.
    fn unseen(&self, context: &Context<'_>) -> Option<String> {
        let joint = self.joint().filter(|_| self.hook() == Hook::Transmission)?;
        let is_seen = |stream: &Stream| stream.joint() == Some(joint) || stream.shows_handle();
        (!context.streams.iter().any(is_seen)).then(|| {
            let unit = context.device.joints[joint].unit();
            format!(
                "no column out{}_{unit}, and no distance, position or orientation, and no touch",
                joint + 1
            )
        })
    }

    /// Whether it cannot be tested for want of the covariate that drives it alone: what it shows on is recorded.
    pub fn lacks_covariate(&self, context: &Context<'_>) -> bool {
        let needs = self.needs();
        let mut lacking = needs
            .iter()
            .filter(|need| missing(**need, context).is_some())
            .peekable();
        lacking.peek().is_some()
            && lacking.all(|need| {
                matches!(
                    need,
                    Need::Time | Need::Temperature | Need::Motion | Need::Torque(_)
                )
            })
    }

    /// Whether another effect is of the same kind at the same place.
    pub fn is_kin_of(&self, other: &dyn Effect) -> bool {
        self.family() == other.family()
            && self.joint() == other.joint()
            && (self.hook() == other.hook() || self.family() == Family::Drift)
            && self.family() != Family::Coupling
    }
}

fn missing(need: Need, context: &Context<'_>) -> Option<String> {
    let recording = context.recording;
    let varies = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high > low
    };
    match need {
        Need::Time if recording.time_s.is_none() => Some("no column t_s".to_owned()),
        Need::Motion if !context.ordered => {
            Some("the rows are single postures, not a motion".to_owned())
        }
        Need::Torque(joint) => match context.torque_nm.get(joint).and_then(Option::as_ref) {
            None => Some(format!(
                "no column torque{}_nm, and no masses with gravity",
                joint + 1
            )),
            Some(values) if !varies(values) => Some(format!("torque{}_nm is constant", joint + 1)),
            Some(_) => None,
        },
        Need::Force => match &recording.force_n {
            None => Some("no columns fx_n, fy_n, fz_n".to_owned()),
            Some(axes) => (!axes.iter().any(|axis| varies(axis)))
                .then(|| "the hand's force is constant".to_owned()),
        },
        Need::BaseMoment => context
            .base_moment_nm
            .is_none()
            .then(|| "neither forces nor masses and gravity are known".to_owned()),
        Need::Temperature => match &context.warming_k {
            None => Some("no column temp_degc".to_owned()),
            Some(values) if !varies(values) => Some("temp_degc is constant".to_owned()),
            Some(_) => None,
        },
        Need::Output(joint) if context.output_stream(joint).is_none() => {
            let unit = context.device.joints[joint].unit();
            Some(format!("no column out{}_{unit}", joint + 1))
        }
        Need::Cable if context.cable.is_none() => Some("no column cable_m".to_owned()),
        Need::DrumRadius
            if context
                .device
                .cables
                .first()
                .is_none_or(|cable| cable.drum_radius_m.is_none()) =>
        {
            Some("no drum_radius_m in the device file".to_owned())
        }
        Need::Chain if !context.streams.iter().any(Stream::shows_handle) => {
            Some("no distance, position or orientation, and no touch".to_owned())
        }
        Need::Runs if context.runs.len() < 2 => Some("one run only".to_owned()),
        Need::Counts(joint)
            if context.device.joints[joint]
                .encoder_counts_per_rev
                .is_none() =>
        {
            Some("no encoder_counts_per_rev in the device file".to_owned())
        }
        Need::Gravity if context.device.gravity_mps2.is_none() => {
            Some("no [gravity] in the device file".to_owned())
        }
        _ => None,
    }
}

/// Every effect at every place of a device where it can occur.
pub fn catalogue(device: &Device) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    for joint in 0..device.joints.len() {
        let has_drums = device.joints[joint].transmission != TransmissionKind::Direct;
        let revolute = device.joints[joint].joint_type == JointType::Revolute;
        effects.extend(load::at_joint(joint, has_drums));
        effects.extend(history::at_joint(joint));
        effects.extend(lag::at_joint(joint));
        effects.extend(events::at_joint(joint, has_drums));
        effects.extend(drift::at_joint(joint));
        if revolute {
            effects.extend(shape::at_joint(device, joint));
            effects.extend(structure::at_joint(joint));
        } else {
            effects.push(shape::of_slide(joint));
        }
    }
    effects.extend(load::of_device());
    effects.extend(history::of_device());
    effects.extend(lag::of_device());
    effects.extend(events::of_device());
    effects.extend(drift::of_device());
    effects.extend(cable::of_device());
    effects.extend(structure::of_device());
    effects
}

/// Names that are tested outside the scan: noise and base terms.
const OTHER_NAMES: [&str; 5] = [
    "noise-level",
    "outliers",
    "parallelogram-error",
    "joint-offset",
    "link-geometry",
];

/// Names of the effects on torques and forces.
pub const FORCE_NAMES: [&str; 9] = [
    "force-bias",
    "force-gain",
    "force-crosstalk",
    "force-hysteresis",
    "joint-friction",
    "motor-cogging",
    "torque-gain",
    "unbalanced-gravity",
    "grip-force",
];

/// Every name of the catalogue, in its order.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    effects.extend(load::at_joint(0, true));
    effects.extend(history::at_joint(0));
    effects.extend(lag::at_joint(0));
    effects.extend(events::at_joint(0, true));
    effects.extend(drift::at_joint(0));
    effects.extend(shape::of_every_kind());
    effects.extend(structure::at_joint(0));
    effects.extend(load::of_device());
    effects.extend(history::of_device());
    effects.extend(lag::of_device());
    effects.extend(events::of_device());
    effects.extend(drift::of_device());
    effects.extend(cable::of_device());
    effects.extend(structure::of_device());
    for name in effects
        .iter()
        .map(|effect| effect.name())
        .chain(OTHER_NAMES)
        .chain(FORCE_NAMES)
    {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
