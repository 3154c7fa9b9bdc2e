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

/// Laws, a row each: name, change, what it may do.
macro_rules! laws {
    ($($name:literal $change:path, $allows:ident;)*) => {
        [$(Law { name: $name, change: $change, allows: Allows::$allows },)*]
    };
}

pub(super) static LAWS: [Law; 18] = laws! {
    "forces-of-nearly-zero" columns::forces, Same;
    "encoders-on-links" columns::outputs, Same;
    "coarse-encoders-on-links" columns::coarse_outputs, Same;
    "tracker-on-handle" columns::tracker, Same;
    "torques-of-weights" columns::torques, Same;
    "commands-that-are-met" columns::commands, Same;
    "constant-temperature" columns::temperature, Same;
    "velocities" columns::velocities, Same;
    "currents-of-sound-motors" columns::currents, Same;
    "renamed-joints" changes::renamed, SameIdentification;
    "other-units" changes::other_units, SameIdentification;
    "two-runs" changes::two_runs, Same;
    "later-start" changes::later_start, OtherTimes;
    "three-threads" changes::as_it_is, SameBits;
    "other-order" changes::other_order, SameIdentification;
    "each-row-twice" changes::doubled, NoNarrowerInterval;
    "second-half-first" changes::second_half_first, SameIdentification;
    "identified-device" changes::identified, Same;
};
