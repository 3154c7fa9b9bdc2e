//! The answer: gap.json (docs/diagnosis.md), and what a report draws.

mod adjusted;
mod advice;
mod assemble;
mod cause;
mod causes;
mod corrected;
mod correction;
mod floor;
mod floors;
mod gap;
mod p_spline;
mod place;
mod second;
mod shrink;
mod tables;
mod unseen;

use std::collections::{BTreeMap, BTreeSet};

use haptical_judge::Admission;
pub use haptical_judge::Verdict;
use haptical_model::Device;
use serde::Serialize;

pub use self::adjusted::{AdjustedAnswer, OwnModel};
pub use self::cause::{AbsorbedAnswer, CauseAnswer, MovedNumber, ParameterAnswer};
pub use self::correction::{CorrectionAnswer, Refusal, RefusedCorrection};
pub use self::floor::NoReduction;
pub use self::gap::{ChannelGap, Gap};
pub use self::second::{SecondAnswer, SecondChannel};
use crate::Options;
use crate::noise::NoiseSource;

pub(crate) use self::advice::next_experiment;
pub(crate) use self::assemble::answer;
pub(crate) use self::causes::{noise_findings, noise_level, position_causes, reported};
pub use self::corrected::BESIDE_TORQUES;
pub(crate) use self::corrected::{Corrected, changed, corrected, not_in_file, of_drives};
pub(crate) use self::correction::{Correction, Outcome, correction};
pub(crate) use self::floor::Floor;
pub(crate) use self::floors::{channel_rms, floors};
pub(crate) use self::gap::{held_out, reduction_percent};
pub(crate) use self::p_spline::{Normal, Smooth};
pub(crate) use self::place::{Located, by_dependence, in_torques, locate, of_base_term};
pub(crate) use self::second::{Left, OnSecond, judged, not_predicted};
pub use self::shrink::BOOTSTRAP_SEED;
pub(crate) use self::shrink::{
    Shrink, Unseen, device_on_second, model_residual, on_held_back, on_second,
};
pub(crate) use self::tables::{candidates, channels, noise, steps, traces, untestable};
pub(crate) use self::unseen::{hints, unseen};

/// A diagnosis.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// What is said of the gap.
    pub verdict: Verdict,
    /// Whether there may be a verdict: four questions.
    pub admission: Admission,
    /// What was fitted before anything was judged, and counts as calibration: friction and armature of a moving arm's drives.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub adjusted: Vec<AdjustedAnswer>,
    /// How far the device file as it is was off, and what is left, channel by channel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub own_model: Vec<OwnModel>,
    /// What the fit of a moving arm's torques changed of the device's bodies next to the causes, within what is plausible.
    #[serde(skip)]
    pub bodies: Vec<haptical_motion::Change>,
    /// Every channel's gap.
    pub gap: Gap,
    /// Where it lies; none without a gap.
    #[serde(rename = "where")]
    pub place: Option<Place>,
    /// Strongest first.
    pub causes: Vec<CauseAnswer>,
    /// What a model identified earlier had taken up of the causes; none without such a model, and where its numbers
    /// hold.
    pub absorbed: Option<AbsorbedAnswer>,
    /// Share of the structured energy that the causes leave.
    pub unexplained_share: f64,
    /// Where named causes leave a part of the gap: the share of its squares beyond noise that they close on rows that their fit
    /// did not see; none where they account for the gap, or where none is named.
    pub closed_unseen_share: Option<f64>,
    /// Of a device with effects of its own, where their laws leave more than noise and that is no gap: the share of the squares
    /// beyond noise that they leave of what a device without them does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_effects_leave: Option<f64>,
    /// Torques of which nothing, or next to nothing, is said: those of one value, and those no larger than their noise.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub silent: Vec<String>,
    /// What the model of the log leaves of a second recording, where there is one.
    #[serde(rename = "second_recording", skip_serializing_if = "Option::is_none")]
    pub second: Option<SecondAnswer>,
    /// Where the cause is unknown: the curve in its place that `corrected` has; none where no curve predicts unseen rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<CorrectionAnswer>,
    /// Where the cause is unknown: a curve that predicts unseen rows of the log, and is not in `corrected`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_refused: Option<RefusedCorrection>,
    /// What the answer rests on, and a device file cannot hold.
    pub not_in_file: Vec<String>,
    /// Probability that the cause is none of the catalogue's.
    pub probability_unknown: f64,
    /// Effects that the recording cannot test.
    pub untestable: Vec<Untestable>,
    /// Effects that the base model swallows.
    pub invisible: Vec<Invisible>,
    /// For each testable effect the smallest size that would have been noticed.
    pub detectable: Vec<Detectable>,
    /// Noise of each channel, and its outliers.
    pub noise: Vec<NoiseAnswer>,
    /// Tests of what the causes leave against what noise does not depend on.
    pub whiteness: Whiteness,
    /// Candidates for the first cause with how far the data tell them apart.
    pub candidates: Vec<CandidateAnswer>,
    /// Fitted values of the base model that a sound device hardly has: an effect may hide in them.
    pub plausibility: Vec<Hint>,
    /// What to record next, in words.
    pub next_experiment: Option<String>,
    /// Things that a user should know.
    pub warnings: Vec<String>,
    /// What was held out, in words; [`SECOND_RECORDING`] first, where that was one.
    pub held_out: String,
    /// What the answer rests on; gap.json has it together with how the file came about.
    #[serde(skip)]
    pub provenance: Provenance,
    /// The base model.
    #[serde(skip)]
    pub device: Device,
    /// The device with the causes, geometry and drives fitted together with them, or with the correction; none where no cause is
    /// named that is part of a device, and no correction found.
    #[serde(skip)]
    pub corrected: Option<Device>,
    /// The rows that [`ChannelGap::rms_fit`] is of.
    #[serde(skip)]
    pub fit_rows: FitRows,
    /// What the events among the causes did to the readings, step by step.
    #[serde(skip)]
    pub steps: Vec<StepAnswer>,
    /// Of single postures whose gap has no name: row from which on a displacement would explain it.
    #[serde(skip)]
    pub split_row: Option<usize>,
    /// For pictures.
    #[serde(skip)]
    pub traces: Vec<Trace>,
    /// Predictions on the validation recording (or the held-out rows).
    #[serde(skip)]
    pub predictions: Vec<Prediction>,
}

/// Readings of a log that a fit used.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FitRows {
    /// Rows that were looked at; none where all were.
    pub looked_at: Option<BTreeSet<usize>>,
    /// Channel and row of the readings that were left out.
    pub left_out: BTreeSet<(String, usize)>,
}

impl FitRows {
    /// Whether the fit used a channel's reading at a row.
    pub fn has(&self, channel: &str, row: usize) -> bool {
        let is_looked_at = (self.looked_at.as_ref()).is_none_or(|rows| rows.contains(&row));
        is_looked_at && !(self.left_out.iter()).any(|(name, own)| *own == row && name == channel)
    }
}

/// How [`Diagnosis::held_out`] begins where it is a second recording.
pub const SECOND_RECORDING: &str = "the second recording";

/// Where the gap lies.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Place {
    /// Channel that shows most of it.
    pub channel: String,
    /// Joint (from 1) where it lies, if in one.
    pub joint: Option<usize>,
    /// Columns that the residual depends on, strongest first.
    pub depends_on: Vec<String>,
    /// In words.
    pub region: String,
    /// Share of the channel's gap that each column of `depends_on` explains by itself.
    pub explained: Vec<f64>,
    /// Of single postures: everything that was asked; first what is sure, by what it explains, then by probability.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub dependence: Vec<Dependence>,
}

impl Place {
    /// In a channel, at a joint from 0 where it lies in one, with the columns that the residual depends on and what each explains.
    pub(crate) fn new(
        channel: String,
        joint: Option<usize>,
        region: String,
        on: impl IntoIterator<Item = (String, f64)>,
    ) -> Self {
        let place = Self {
            channel,
            joint: joint.map(|joint| joint + 1),
            region,
            ..Self::default()
        };
        place.depending(on)
    }

    /// With columns that it depends on, and the share that each explains.
    pub(crate) fn depending(mut self, on: impl IntoIterator<Item = (String, f64)>) -> Self {
        for (column, share) in on {
            if !self.depends_on.contains(&column) {
                self.depends_on.push(column);
                self.explained.push(share);
            }
        }
        self
    }
}

/// What a residual is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Asked {
    /// A joint's angle.
    Angle,
    /// A joint's torque, and its side.
    Torque,
    /// The side that a joint came from: its step from the row before.
    Side,
    /// The direction in which something is touched.
    Approach,
    /// Time, temperature or another column that nothing of the model reads.
    Course,
}

/// How surely the residuals of single postures depend on something.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dependence {
    /// Column of the log; `contact` for the direction of approach.
    pub column: String,
    /// Joint (from 1), where it acts at one.
    pub joint: Option<usize>,
    /// What of the column it is.
    pub asked: Asked,
    /// Channel that it was asked of alone; none where all that see the chain were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// The same in words.
    pub on: String,
    /// Probability that chance gives as much.
    pub p_value: f64,
    /// The same for all questions together (Holm 1979).
    pub p_adjusted: f64,
    /// Share of the squared residual that it explains.
    pub share: f64,
}

/// What noise does not depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// No frequency stands out.
    Frequency,
    /// Time, temperature and other logged columns.
    Time,
    /// Angles and torques of the joints.
    Posture,
    /// The side that a joint came from, and the direction of a touch.
    Approach,
}

/// Tests of a residual that passes for noise: asked only where no cause is named.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Whiteness {
    /// Number of tests; 0 where a cause is named.
    pub tests: usize,
    /// What was tested; what is missing could not be.
    pub over: Vec<Over>,
    /// Smallest probability by chance, all tests together (Holm 1979).
    pub least_p_adjusted: Option<f64>,
    /// What that is of, in words.
    pub on: Option<String>,
}

/// Among what a cause may be taken for: an effect that is in no catalogue.
pub const IN_NO_CATALOGUE: &str = "unknown";

/// What a warning begins with where a log's torques say nothing to the verdict.
pub const TORQUES_NOT_TESTED: &str = "the torques were not tested";

/// A step of an event.
#[derive(Debug, Clone, PartialEq)]
pub struct StepAnswer {
    /// Name of the effect.
    pub effect: String,
    /// Joint (from 1), where it has one.
    pub joint: Option<usize>,
    /// The first row after it lies between these two, from 0: they are one where all rows were looked at.
    pub first_row: [usize; 2],
    /// What its channels read more from there to the end of the run \[rad\] or \[m\]: of lost counts of a motor encoder, what
    /// the joint's angle is more than that encoder says.
    pub size: f64,
}

/// The gap on data that the fit did not see.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldOutAnswer {
    /// Channel in which the gap is largest.
    pub channel: String,
    /// Root mean square before.
    pub rms_before: f64,
    /// And after.
    pub rms_after: f64,
    /// Noise.
    pub noise_floor: f64,
    /// Unit of the three.
    pub unit: String,
    /// Share of the gap closed, noise taken out.
    pub reduction_percent: Option<f64>,
    /// 95 % interval.
    pub reduction_ci95: Option<[f64; 2]>,
    /// Why there is no share of the gap.
    pub no_reduction: Option<NoReduction>,
}

impl HeldOutAnswer {
    /// Without a share where there is a reason for none.
    pub(crate) fn settled(mut self) -> Self {
        if self.no_reduction.is_some() {
            self.reduction_percent = None;
            self.reduction_ci95 = None;
        }
        self
    }

    /// Share of the squares beyond noise that is left of the gap, where there is one.
    pub(crate) fn left(&self) -> Option<f64> {
        let beyond = |rms: f64| (rms.powi(2) - self.noise_floor.powi(2)).max(0.0);
        let left = beyond(self.rms_after) / beyond(self.rms_before);
        (self.no_reduction.is_none() && left.is_finite()).then_some(left)
    }

    /// As the gap's record has it: no share where that has none.
    pub(crate) fn agreeing(mut self, gap: &Gap) -> Self {
        let mut channels = gap.channels.iter();
        let own = channels.find(|channel| channel.channel == self.channel);
        self.no_reduction = own.and_then(|own| own.no_reduction).or(self.no_reduction);
        self.settled()
    }
}

/// An effect that the recording cannot test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Untestable {
    /// Name.
    pub effect: String,
    /// Joints (from 1) that this is said of; empty for the device.
    pub joints: Vec<usize>,
    /// Reason.
    pub why: String,
}

impl Untestable {
    /// An effect that nothing shows, at any joint.
    pub(crate) fn new(effect: &str, why: impl Into<String>) -> Self {
        Self {
            effect: effect.to_owned(),
            joints: Vec::new(),
            why: why.into(),
        }
    }

    /// Adds an effect with a reason, at a joint from 0 where that is of one: joints with the same reason share an entry.
    pub(crate) fn add(all: &mut Vec<Self>, effect: &str, joint: Option<usize>, why: String) {
        let joint = joint.map(|joint| joint + 1);
        let same = |own: &&mut Self| own.effect == effect && own.why == why;
        match all.iter_mut().find(same) {
            Some(own) => {
                let new = joint.filter(|joint| !own.joints.contains(joint));
                own.joints.extend(new);
            }
            None => all.push(Self {
                joints: joint.into_iter().collect(),
                ..Self::new(effect, why)
            }),
        }
    }
}

/// An effect that the base model swallows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Invisible {
    /// Name.
    pub effect: String,
    /// Joint (from 1).
    pub joint: Option<usize>,
    /// Reason.
    pub why: String,
    /// The parameters that it would falsify.
    pub would_bias: String,
}

/// The smallest size of an effect that would have been noticed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detectable {
    /// Name.
    pub effect: String,
    /// Joint (from 1).
    pub joint: Option<usize>,
    /// Parameter.
    pub parameter: String,
    /// Its value at 80 % power; for a stiffness the largest.
    pub value: f64,
}

/// Noise of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseAnswer {
    /// Channel.
    pub channel: String,
    /// Standard deviation over the stated one.
    pub ratio: f64,
    /// Standard deviation in the fastest quarter of the motion over that in the slowest.
    pub speed_ratio: f64,
    /// Correlation of successive rows.
    pub colour: f64,
    /// Share of readings left out as outliers.
    pub outlier_share: f64,
    /// Usable readings.
    pub readings: usize,
    /// Degrees of freedom that the size was estimated with.
    pub degrees_of_freedom: f64,
    /// What the size was estimated from.
    pub source: NoiseSource,
    /// Where the figures come from, in words.
    pub from: String,
}

/// A candidate for the first cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateAnswer {
    /// Name.
    pub effect: String,
    /// Joint (from 1).
    pub joint: Option<usize>,
    /// Share of the gap's energy that it would explain alone.
    pub share: f64,
    /// How far behind the best it is \[nats\], misfit allowed for.
    pub nats_behind: f64,
    /// Probability.
    pub probability: f64,
    /// Its numbers by name, as fitted in the first cause's place; empty where it is too far behind to have been fitted, or
    /// refused.
    pub parameters: BTreeMap<String, f64>,
    /// Why it is no candidate after all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

impl CandidateAnswer {
    /// A cause that was fitted, and why it is not named.
    pub(crate) fn of_cause(cause: &CauseAnswer, refused: Option<String>) -> Self {
        let numbers = cause.parameters.iter();
        Self {
            effect: cause.effect.clone(),
            joint: cause.joint,
            share: cause.share,
            nats_behind: 0.0,
            probability: 0.0,
            parameters: numbers
                .map(|(name, own)| (name.clone(), own.value))
                .collect(),
            refused,
        }
    }
}

/// A value of the base model that is hardly plausible.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hint {
    /// Parameter.
    pub parameter: String,
    /// What is odd.
    pub why: String,
}

/// What the answer rests on.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Provenance {
    /// Rows of the recording.
    pub rows: usize,
    /// Parameters of the base model, and how many of them the recording fixes.
    pub base_parameters: usize,
    /// Those that the recording fixes.
    pub base_identifiable: usize,
    /// Effects at places that were tested.
    pub tested: usize,
    /// Version of the thresholds: a hash of the texts of their files.
    pub thresholds: String,
    /// Step that the fit of base model and causes still asks for at its end, in standard deviations of the residuals.
    pub last_step: f64,
    /// Effects left out on request.
    pub without: Vec<String>,
}

impl Provenance {
    /// Of a model whose numbers are all fixed, with the effects that were tested beside it.
    pub(crate) fn new(rows: usize, numbers: usize, tested: usize, options: &Options<'_>) -> Self {
        Self {
            rows,
            base_parameters: numbers,
            base_identifiable: numbers,
            tested,
            thresholds: crate::version::version(),
            last_step: 0.0,
            without: options.without.clone(),
        }
    }
}

/// Residuals of the channel that shows most of the gap, against the covariate that matters most.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Channel.
    pub channel: String,
    /// Its unit.
    pub unit: String,
    /// Column on the horizontal axis.
    pub covariate: String,
    /// Whether its rows are those that the fit did not see.
    pub is_held_out: bool,
    /// Values of the covariate.
    pub at: Vec<f64>,
    /// Residuals of the base model.
    pub before: Vec<f64>,
    /// Residuals with the causes in the model.
    pub after: Vec<f64>,
}

impl Trace {
    /// Residuals over time of rows that the fit saw.
    pub(crate) fn over_time(
        channel: String,
        unit: &str,
        at: &[f64],
        [before, after]: [Vec<f64>; 2],
    ) -> Self {
        Self {
            channel,
            unit: unit.to_owned(),
            covariate: "t_s".to_owned(),
            is_held_out: false,
            at: at.to_vec(),
            before,
            after,
        }
    }
}

/// One row of predictions.csv.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Row of the recording, from 0.
    pub row: usize,
    /// Channel.
    pub channel: String,
    /// Measured.
    pub measured: f64,
    /// By the base model.
    pub before: f64,
    /// With the causes in the model.
    pub after: f64,
}
