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

const fn kind(
    label: &'static str,
    right: &'static [&'static str],
    site: Site,
    draw: fn(&mut Draw<'_>) -> Drawn,
) -> Kind {
    Kind {
        label,
        right,
        twins: &[],
        site,
        need: Need::Nothing,
        scales: true,
        is_sized: true,
        hides: false,
        draw,
    }
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

/// What twists between motor and link goes by either name: a log of torques and angles does not say whose spring it is.
const TWIST: &[&str] = &["capstan-compliance", "joint-compliance"];

/// In the catalogue.
pub(crate) const NAMED: [Kind; 23] = [
    kind("payload", &["payload"], Site::Whole, masses::payload).like(&["link-inertia"]),
    kind("torque-gain", &["torque-gain"], Site::Loaded, sensing::gain),
    kind(
        "stribeck-friction",
        &["stribeck-friction"],
        Site::Any,
        friction::stribeck,
    ),
    kind(
        "encoder-latency",
        &["encoder-latency"],
        Site::Whole,
        sensing::encoder_latency,
    ),
    kind("contact", &["contact"], Site::Whole, contact::wall),
    kind(
        "motor-cogging",
        &["motor-cogging"],
        Site::Any,
        torques::cogging,
    ),
    kind(
        "link-inertia",
        &["link-inertia"],
        Site::Link,
        masses::link_inertia,
    ),
    kind(
        "elastic-second-encoder",
        TWIST,
        Site::Proximal,
        drives::elastic,
    )
    .needs(Need::Outputs)
    .unsized_by_torque(),
    kind(
        "load-friction",
        &["load-friction"],
        Site::Loaded,
        friction::load,
    ),
    kind("torque-offset", OFFSET, Site::Any, sensing::offset),
    kind(
        "gravity-direction",
        &["gravity-direction"],
        Site::Whole,
        masses::gravity_direction,
    ),
    kind(
        "friction-asymmetry",
        &["friction-asymmetry"],
        Site::Any,
        friction::asymmetry,
    )
    .like(&["torque-offset"]),
    kind(
        "command-latency",
        &["command-latency"],
        Site::Whole,
        sensing::command_latency,
    )
    .needs(Need::Command),
    kind("armature", &["armature"], Site::Any, masses::armature).like(&["link-inertia"]),
    kind(
        "backlash-second-encoder",
        &["backlash"],
        Site::Proximal,
        drives::backlash,
    )
    .like(&["hysteresis"])
    .needs(Need::Outputs)
    .unsized_by_torque(),
    kind(
        "friction-drift",
        &["friction-drift"],
        Site::Any,
        friction::drift,
    ),
    kind(
        "torque-gain-of-four",
        &["torque-gain"],
        Site::Loaded,
        sensing::gain_of_four,
    )
    .as_it_is(),
    kind(
        "presliding",
        &["presliding"],
        Site::Any,
        friction::presliding,
    ),
    kind(
        "gravity-spring",
        &["gravity-spring"],
        Site::Loaded,
        torques::spring,
    )
    .like(&["link-inertia"]),
    kind(
        "torque-saturation",
        &["torque-saturation"],
        Site::Loaded,
        sensing::saturation,
    ),
    kind(
        "sampling-dropped",
        &["sampling"],
        Site::Whole,
        sensing::dropped,
    )
    .unsized_by_torque(),
    kind("elastic", TWIST, Site::Proximal, drives::elastic)
        .needs(Need::NoOutputs)
        .hidden(),
    kind(
        "sampling-repeated",
        &["sampling"],
        Site::Whole,
        sensing::repeated,
    )
    .unsized_by_torque(),
];

/// A constant on a reading, and Coulomb friction that differs by direction, are the same torque while a joint moves.
const OFFSET: &[&str] = &["torque-offset", "friction-asymmetry"];

/// In no catalogue.
pub(crate) const FOREIGN: [Kind; 6] = [
    kind("dent", &[], Site::Any, friction::dent),
    kind("sloshing", &[], Site::Whole, torques::sloshing),
    kind("coloured-disturbance", &[], Site::Any, torques::coloured),
    kind(
        "controller-mode",
        &[],
        Site::Whole,
        sensing::controller_mode,
    )
    .needs(Need::Command)
    .hidden(),
    kind("cable-bundle", &[], Site::Pair, torques::bundle),
    kind("torque-dead-band", &[], Site::Loaded, sensing::dead_band),
];
