//! Metamorphic laws: what a change of a log that changes nothing of the device may do to an answer.
//!
//! Where the evidence is ten nats from its threshold: no true name is lost and no false one gained, no gap turns into none or
//! none into one, and numbers stay within their intervals. A further column may turn `unknown` into a true name.

mod broken;
mod changes;
mod columns;
mod job;
mod judge;

pub use job::{LawsArguments, laws};

use anyhow::Result;

use crate::scene::Made;

/// A change of a scene, and what it may do to the answer.
pub(super) struct Law {
    pub(super) name: &'static str,
    /// The scene, changed; none where the change does not apply to it.
    pub(super) change: fn(&Made) -> Result<Option<Made>>,
    pub(super) allows: Allows,
}

/// What a law asks of an answer beyond what all of them ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Allows {
    /// Nothing more.
    Same,
    /// Times of events, which move with the start of the log.
    OtherTimes,
    /// The same bits, on another number of threads.
    SameBits,
    /// Intervals as wide as they were, and the identification is compared too.
    NoNarrowerInterval,
    /// The identification is compared too.
    SameIdentification,
}

/// All laws.
pub(super) static LAWS: [Law; 16] = [
    law("forces-of-nearly-zero", columns::forces, Allows::Same),
    law("encoders-on-links", columns::outputs, Allows::Same),
    law("tracker-on-handle", columns::tracker, Allows::Same),
    law("torques-of-weights", columns::torques, Allows::Same),
    law("commands-that-are-met", columns::commands, Allows::Same),
    law("constant-temperature", columns::temperature, Allows::Same),
    law("velocities", columns::velocities, Allows::Same),
    law("currents-of-sound-motors", columns::currents, Allows::Same),
    law(
        "renamed-joints",
        changes::renamed,
        Allows::SameIdentification,
    ),
    law(
        "other-units",
        changes::other_units,
        Allows::SameIdentification,
    ),
    law("two-runs", changes::two_runs, Allows::Same),
    law("later-start", changes::later_start, Allows::OtherTimes),
    law("three-threads", changes::as_it_is, Allows::SameBits),
    law(
        "other-order",
        changes::other_order,
        Allows::SameIdentification,
    ),
    law(
        "each-row-twice",
        changes::doubled,
        Allows::NoNarrowerInterval,
    ),
    law(
        "second-half-first",
        changes::second_half_first,
        Allows::SameIdentification,
    ),
];

const fn law(name: &'static str, change: fn(&Made) -> Result<Option<Made>>, allows: Allows) -> Law {
    Law {
        name,
        change,
        allows,
    }
}
