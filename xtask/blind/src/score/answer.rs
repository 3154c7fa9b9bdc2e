//! The answer of a diagnosis, as gap.json has it.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// How sure an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No gap above the noise.
    NoGap,
    /// The causes are named.
    Named,
    /// A cause or one of those it is confused with.
    Ambiguous,
    /// A gap that no name fits.
    Unknown,
}

impl Verdict {
    /// As gap.json writes it.
    pub const fn text(self) -> &'static str {
        match self {
            Self::NoGap => "no-gap",
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
        }
    }
}

/// gap.json; what is not scored is left out, absent fields are empty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// The verdict.
    pub verdict: Verdict,
    /// The gap, channel by channel.
    #[serde(default)]
    pub gap: Gap,
    /// Where it lies.
    #[serde(rename = "where")]
    pub place: Option<Where>,
    /// Causes, strongest first.
    #[serde(default)]
    pub causes: Vec<Cause>,
    /// Probability that no name of the catalogue is right.
    pub probability_unknown: Option<f64>,
    /// Questions that were asked before any verdict.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub admission: BTreeMap<String, Check>,
    /// Numbers that were fitted before anything was judged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub adjusted: Vec<Adjusted>,
    /// What is left of the second recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_recording: Option<SecondRecording>,
    /// Things that a user should know.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// A question before any verdict.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Check {
    /// `yes`, `no` or `unknown`.
    pub answer: String,
    /// What it rests on.
    #[serde(default)]
    pub why: String,
}

/// A number that was fitted before anything was judged.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Adjusted {
    /// What it is of: `friction`, `armature`.
    pub name: String,
}

/// What the model of the log leaves of a second recording.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SecondRecording {
    /// Channels that were predicted.
    #[serde(default)]
    pub channels: Vec<SecondChannel>,
}

/// One channel of a second recording.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SecondChannel {
    /// Channel.
    pub channel: String,
    /// Whether a gap is left in it.
    pub has_gap: bool,
}

/// The gap of all channels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Channels.
    #[serde(default)]
    pub channels: Vec<ChannelGap>,
}

/// The gap of a channel before and after all causes are added.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelGap {
    /// Channel: `out2`, `cable`, ...
    pub channel: String,
    /// Reduction of the gap \[%\].
    pub reduction_percent: Option<f64>,
    /// Its 95 % interval \[%\].
    pub reduction_ci95: Option<[f64; 2]>,
}

/// Where a gap lies.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Where {
    /// Channel.
    pub channel: Option<String>,
    /// Joint, from 1.
    pub joint: Option<usize>,
    /// Columns that it depends on.
    #[serde(default)]
    pub depends_on: Vec<String>,
}

/// A cause.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// Name of the effect.
    pub effect: String,
    /// Joint, from 1.
    pub joint: Option<usize>,
    /// Probability of this name.
    pub probability: Option<f64>,
    /// Names that the data cannot tell from it.
    #[serde(default)]
    pub confusable_with: Vec<String>,
    /// Parameters by name.
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterAnswer>,
    /// False where a magnitude is beyond what is physically possible.
    pub plausible: Option<bool>,
    /// What adding it does to data that the fit did not see.
    pub held_out: Option<HeldOut>,
}

/// A parameter of a cause.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterAnswer {
    /// Value.
    pub value: Option<f64>,
    /// 95 % interval.
    pub ci95: Option<[f64; 2]>,
}

/// Reduction on held-out data.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Channel.
    pub channel: Option<String>,
    /// Reduction of the gap \[%\].
    pub reduction_percent: Option<f64>,
    /// Its 95 % interval \[%\].
    pub reduction_ci95: Option<[f64; 2]>,
}

impl Answer {
    /// Reads gap.json.
    pub fn from_json(text: &str) -> Result<Self> {
        serde_json::from_str(text).context("an answer cannot be turned into JSON or back")
    }
}

/// The name alone: without a joint behind `@` or blanks, aliases resolved.
pub(crate) fn plain_name(text: &str) -> &str {
    let name = text.split(['@', ' ', '(']).next().unwrap_or(text);
    if name == "link-compliance" {
        "joint-compliance"
    } else {
        name
    }
}

impl Cause {
    /// Its name and those it is confused with.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.effect.as_str())
            .chain(self.confusable_with.iter().map(String::as_str))
            .map(plain_name)
    }
}
