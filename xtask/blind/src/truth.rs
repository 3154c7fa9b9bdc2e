//! The truth of a recording: the hidden effects and the answers that are right.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::gap::ChannelGapTruth;

/// A sudden event of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time \[s\].
    pub time_s: f64,
    /// Size in the effect's unit (counts, rad or m).
    pub size: f64,
}

/// One effect as it was put in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectTruth {
    /// The name in the catalogue, or the name of an effect that is in no catalogue.
    pub effect: String,
    /// Joint, from 1.
    pub joint: Option<usize>,
    /// Size relative to the strong one.
    pub size: f64,
    /// Parameters with the catalogue's names, effective values over the first recording.
    pub parameters: BTreeMap<String, f64>,
    /// Numbers of the true law, for readers.
    pub law: BTreeMap<String, f64>,
    /// Events of each recording.
    pub events: Vec<Vec<Event>>,
}

/// The whole truth of one trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Suite.
    pub suite: String,
    /// Index within the batch.
    pub index: u64,
    /// Seed of the batch.
    pub batch_seed: u64,
    /// The nominal device's name.
    pub device: String,
    /// Label: the effects' names, or the kind of clean recording.
    pub name: String,
    /// What was put in.
    pub effects: Vec<EffectTruth>,
    /// Groups of names: one of every group must be among the causes or their declared twins. Empty:
    /// clean. `[["unknown"]]`: no name is right.
    pub right: Vec<Vec<String>>,
    /// The joint of the first group, from 1.
    pub joint: Option<usize>,
    /// The joint of every group, from 1.
    pub joints: Vec<Option<usize>>,
    /// Names that the catalogue must do without.
    pub without: Vec<String>,
    /// Names that may be answered although they were not put in: twins that the data cannot exclude.
    pub acceptable: Vec<String>,
    /// Stems of the columns on which an effect in no catalogue depends; one of them is a right answer
    /// to what the gap depends on.
    pub depends_on: Vec<String>,
    /// Gap of each channel of the first recording against the true base model.
    pub gap: BTreeMap<String, ChannelGapTruth>,
    /// Whether `no-gap` is as right as a name.
    pub no_gap_is_right: bool,
    /// Whether the answer must flag a magnitude beyond the physical bound.
    pub implausible: bool,
    /// What else is right, or wrong whatever is named.
    #[serde(default, skip_serializing_if = "Besides::is_nothing")]
    pub besides: Besides,
}

/// Answers that are right besides the names, and words that make an answer wrong.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Besides {
    /// A refusal that has one of these words is as right as a name. A refusal is an error, or the verdict `unknown` with a
    /// question of its admission answered with no.
    pub refusals: Vec<String>,
    /// Whether the verdict `unknown` is as right as a name.
    pub unknown: bool,
    /// `no-gap` is as right as a name where the answer says this.
    pub no_gap_with: Option<Said>,
    /// Whether the right name is one of the whole arm: at a joint it is another one.
    pub is_of_whole: bool,
    /// Whether the second recording is of another device: no answer may say that its gap closes there.
    pub second_is_foreign: bool,
}

/// What an answer may say beside its verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Said {
    /// Readings that count for nothing.
    Dropouts,
    /// A number of a body that was adjusted.
    Bodies,
    /// An inertia of the file that no body has.
    Impossible,
}

impl Besides {
    fn is_nothing(&self) -> bool {
        *self == Self::default()
    }
}

impl Truth {
    /// Whether nothing was hidden.
    pub fn is_clean(&self) -> bool {
        self.right.is_empty()
    }

    /// Whether the right answer is that no name is right.
    pub fn is_unknown(&self) -> bool {
        self.right.iter().flatten().any(|name| name == "unknown")
    }
}
