//! All effects of moving arms, by name: where each can act, what its recording must have, which names are right.

use crate::moving::arms::Arm;
use crate::moving::laws::{Draw, Drawn, contact, drives, friction, masses, sensing, torques};

/// Where a kind can act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Site {
    /// The arm as a whole, its controller or its log.
    Whole,
    /// Any joint.
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

/// A kind of effect.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    /// Label of its trials.
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

/// Kinds, a row each: label, right names, site, law, and what else there is to say of it.
macro_rules! kinds {
    ($($label:literal $right:tt $site:ident $draw:path $(, $further:ident($($value:tt)*))*;)*) => {
        [$(Kind {
            label: $label,
            right: &$right,
            twins: &[],
            site: Site::$site,
            need: Need::Nothing,
            scales: true,
            is_sized: true,
            hides: false,
            draw: $draw,
        }$(.$further($($value)*))*,)*]
    };
}

impl Kind {
    const fn needs(self, need: Need) -> Self {
        Self { need, ..self }
    }

    const fn like(self, twins: &'static [&'static str]) -> Self {
        Self { twins, ..self }
    }

    const fn as_it_is(self) -> Self {
        Self {
            scales: false,
            ..self
        }
    }

    const fn unsized_by_torque(self) -> Self {
        Self {
            is_sized: false,
            ..self
        }
    }

    const fn hidden(self) -> Self {
        Self {
            hides: true,
            scales: false,
            is_sized: false,
            ..self
        }
    }

    /// Joints (from 0) at which it can act on an arm whose drives need `loads`.
    pub(crate) fn joints(&self, arm: &Arm, loads: &[Vec<f64>]) -> Vec<usize> {
        let is_loaded = |joint: usize| {
            let peak = loads[joint]
                .iter()
                .fold(0.0_f64, |most, load| most.max(load.abs()));
            !arm.axes[joint].slides && peak > 0.25 * arm.axes[joint].range
        };
        let fits = |joint: &usize| match self.site {
            Site::Whole => *joint == 0,
            Site::Any => true,
            Site::Loaded => is_loaded(*joint),
            Site::Proximal => *joint < 4 && is_loaded(*joint),
            Site::Link => *joint > 0 && joint + 2 < arm.count() && !arm.axes[*joint].slides,
            Site::Pair => joint + 1 < arm.count() && !arm.axes[*joint].slides,
        };
        (0..arm.count()).filter(fits).collect()
    }
}

/// In the catalogue. What twists between motor and link goes by either name: a log of torques and angles does not say whose
/// spring it is. A constant on a reading, and Coulomb friction that differs by direction, are the same torque while a joint
/// moves.
pub(crate) const NAMED: [Kind; 23] = kinds! {
    "payload" ["payload"] Whole masses::payload, like(&["link-inertia"]);
    "torque-gain" ["torque-gain"] Loaded sensing::gain;
    "stribeck-friction" ["stribeck-friction"] Any friction::stribeck;
    "encoder-latency" ["encoder-latency"] Whole sensing::encoder_latency;
    "contact" ["contact"] Whole contact::wall;
    "motor-cogging" ["motor-cogging"] Any torques::cogging;
    "link-inertia" ["link-inertia"] Link masses::link_inertia;
    "elastic-second-encoder" ["capstan-compliance", "joint-compliance"] Proximal drives::elastic, needs(Need::Outputs), unsized_by_torque();
    "load-friction" ["load-friction"] Loaded friction::load;
    "torque-offset" ["torque-offset", "friction-asymmetry"] Any sensing::offset;
    "gravity-direction" ["gravity-direction"] Whole masses::gravity_direction;
    "friction-asymmetry" ["friction-asymmetry"] Any friction::asymmetry, like(&["torque-offset"]);
    "command-latency" ["command-latency"] Whole sensing::command_latency, needs(Need::Command);
    "armature" ["armature"] Any masses::armature, like(&["link-inertia"]);
    "backlash-second-encoder" ["backlash"] Proximal drives::backlash, like(&["hysteresis"]), needs(Need::Outputs), unsized_by_torque();
    "friction-drift" ["friction-drift"] Any friction::drift;
    "torque-gain-of-four" ["torque-gain"] Loaded sensing::gain_of_four, as_it_is();
    "presliding" ["presliding"] Any friction::presliding;
    "gravity-spring" ["gravity-spring"] Loaded torques::spring, like(&["link-inertia"]);
    "torque-saturation" ["torque-saturation"] Loaded sensing::saturation;
    "sampling-dropped" ["sampling"] Whole sensing::dropped, unsized_by_torque();
    "elastic" ["capstan-compliance", "joint-compliance"] Proximal drives::elastic, needs(Need::NoOutputs), hidden();
    "sampling-repeated" ["sampling"] Whole sensing::repeated, unsized_by_torque();
};

/// In no catalogue.
pub(crate) const FOREIGN: [Kind; 6] = kinds! {
    "dent" [] Any friction::dent;
    "sloshing" [] Whole torques::sloshing;
    "coloured-disturbance" [] Any torques::coloured;
    "controller-mode" [] Whole sensing::controller_mode, needs(Need::Command), hidden();
    "cable-bundle" [] Pair torques::bundle;
    "torque-dead-band" [] Loaded sensing::dead_band;
};
