//! All effects of moving arms, by name: where each can act, what its recording must have, which names are right.

use self::Need::{Command, NoOutputs, Nothing, Outputs};
use self::Site::{Any, Link, Loaded, Pair, Proximal, Whole};
use crate::moving::arms::Arm;
use crate::moving::laws::{Draw, Drawn, contact, drives, friction, masses, sensing, torques};

/// Where a kind can act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Site {
    /// The arm as a whole, its controller or its log.
    Whole,
    Any,
    /// A joint that turns and whose drive needs a quarter of its range at least.
    Loaded,
    /// The same, of the first four joints.
    Proximal,
    /// A body that shows in the torques and is neither the first nor the last: what is bolted there is no payload.
    Link,
    /// A joint with another one behind it.
    Pair,
}

/// What a log must have, or must not have, for a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Need {
    Nothing,
    Command,
    Outputs,
    NoOutputs,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    pub(crate) label: &'static str,
    /// Names of which one must be answered; none for an effect in no catalogue.
    pub(crate) right: &'static [&'static str],
    /// Names of nearly the same torques, that may be answered besides, or where the right ones are withheld.
    pub(crate) twins: &'static [&'static str],
    pub(crate) site: Site,
    pub(crate) need: Need,
    /// Whether it has a weak form, and whether it may be one of two.
    pub(crate) scales: bool,
    /// Whether the change of torque says how strong it is: not of what shows on second encoders or in the rows themselves.
    pub(crate) is_sized: bool,
    /// Whether no gap is as right as a name: the log hardly shows it.
    pub(crate) hides: bool,
    pub(crate) draw: fn(&mut Draw<'_>) -> Drawn,
}

impl Kind {
    /// Joints (from 0) at which it can act on an arm whose drives need `loads`.
    pub(crate) fn joints(&self, arm: &Arm, loads: &[Vec<f64>]) -> Vec<usize> {
        let is_loaded = |joint: usize| {
            let peak = loads[joint]
                .iter()
                .fold(0.0_f64, |most, load| most.max(load.abs()));
            !arm.axes[joint].slides && peak > 0.25 * arm.axes[joint].range
        };
        let fits = |joint: &usize| match self.site {
            Whole => *joint == 0,
            Any => true,
            Loaded => is_loaded(*joint),
            Proximal => *joint < 4 && is_loaded(*joint),
            Link => *joint > 0 && joint + 2 < arm.count() && !arm.axes[*joint].slides,
            Pair => joint + 1 < arm.count() && !arm.axes[*joint].slides,
        };
        (0..arm.count()).filter(fits).collect()
    }
}

/// In the catalogue. What twists between motor and link goes by either name: a log of torques and angles does not say whose
/// spring it is. A constant on a reading, and Coulomb friction that differs by direction, are the same torque while a joint
/// moves.
pub(crate) const NAMED: [Kind; 23] = rows! {
    Kind {label right twins site need scales is_sized hides draw}
    "payload", &["payload"], &["link-inertia"], Whole, Nothing, true, true, false, masses::payload;
    "torque-gain", &["torque-gain"], &[], Loaded, Nothing, true, true, false, sensing::gain;
    "stribeck-friction", &["stribeck-friction"], &[], Any, Nothing, true, true, false, friction::stribeck;
    "encoder-latency", &["encoder-latency"], &[], Whole, Nothing, true, true, false, sensing::encoder_latency;
    "contact", &["contact"], &[], Whole, Nothing, true, true, false, contact::wall;
    "motor-cogging", &["motor-cogging"], &[], Any, Nothing, true, true, false, torques::cogging;
    "link-inertia", &["link-inertia"], &[], Link, Nothing, true, true, false, masses::link_inertia;
    "elastic-second-encoder", &["capstan-compliance", "joint-compliance"], &[],
        Proximal, Outputs, true, false, false, drives::elastic;
    "load-friction", &["load-friction"], &[], Loaded, Nothing, true, true, false, friction::load;
    "torque-offset", &["torque-offset", "friction-asymmetry"], &[],
        Any, Nothing, true, true, false, sensing::offset;
    "gravity-direction", &["gravity-direction"], &[],
        Whole, Nothing, true, true, false, masses::gravity_direction;
    "friction-asymmetry", &["friction-asymmetry"], &["torque-offset"],
        Any, Nothing, true, true, false, friction::asymmetry;
    "command-latency", &["command-latency"], &[], Whole, Command, true, true, false, sensing::command_latency;
    "armature", &["armature"], &["link-inertia"], Any, Nothing, true, true, false, masses::armature;
    "backlash-second-encoder", &["backlash"], &["hysteresis"],
        Proximal, Outputs, true, false, false, drives::backlash;
    "friction-drift", &["friction-drift"], &[], Any, Nothing, true, true, false, friction::drift;
    "torque-gain-of-four", &["torque-gain"], &[], Loaded, Nothing, false, true, false, sensing::gain_of_four;
    "presliding", &["presliding"], &[], Any, Nothing, true, true, false, friction::presliding;
    "gravity-spring", &["gravity-spring"], &["link-inertia"],
        Loaded, Nothing, true, true, false, torques::spring;
    "torque-saturation", &["torque-saturation"], &[], Loaded, Nothing, true, true, false, sensing::saturation;
    "sampling-dropped", &["sampling"], &[], Whole, Nothing, true, false, false, sensing::dropped;
    "elastic", &["capstan-compliance", "joint-compliance"], &[],
        Proximal, NoOutputs, false, false, true, drives::elastic;
    "sampling-repeated", &["sampling"], &[], Whole, Nothing, true, false, false, sensing::repeated;
};

/// In no catalogue.
pub(crate) const FOREIGN: [Kind; 6] = rows! {
    Kind {label right twins site need scales is_sized hides draw}
    "dent", &[], &[], Any, Nothing, true, true, false, friction::dent;
    "sloshing", &[], &[], Whole, Nothing, true, true, false, torques::sloshing;
    "coloured-disturbance", &[], &[], Any, Nothing, true, true, false, torques::coloured;
    "controller-mode", &[], &[], Whole, Command, false, false, true, sensing::controller_mode;
    "cable-bundle", &[], &[], Pair, Nothing, true, true, false, torques::bundle;
    "torque-dead-band", &[], &[], Loaded, Nothing, true, true, false, sensing::dead_band;
};

/// Friction of laws that no catalogue has, beside an effect that it has.
pub(crate) const OWN_FRICTION: [Kind; 3] = rows! {
    Kind {label right twins site need scales is_sized hides draw}
    "friction-waves", &[], &[], Any, Nothing, true, true, false, friction::waves;
    "slow-bristle", &[], &[], Any, Nothing, true, true, false, friction::slow_bristle;
    "shallow-dent", &[], &[], Any, Nothing, true, true, false, friction::shallow_dent;
};
