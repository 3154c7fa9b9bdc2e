//! What is said of a joint.

use std::fmt;

pub use haptical_judge::Verdict;

use crate::joint::judged;
use crate::predict::Model;

/// A number of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    /// Name with its unit: `offset_rad`.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// When something changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Rows of the log that may be the first after it: the first, the likeliest and the last of them.
    pub rows: [usize; 3],
    /// Their times \[s\].
    pub time_s: [f64; 3],
    /// The runs before and after it, where it lies between two.
    pub between_runs: Option<[i64; 2]>,
    /// The run that it lies in.
    pub run: i64,
}

impl fmt::Display for Instant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, at, last] = self.time_s;
        match self.between_runs {
            Some([before, after]) => write!(f, "between runs {before} and {after}"),
            None if last - first < 0.05 => write!(f, "at {at:.2} s"),
            None => write!(f, "at {at:.2} s (between {first:.2} and {last:.2} s)"),
        }
    }
}

/// A cause.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the effect.
    pub effect: &'static str,
    /// Its numbers, the size first.
    pub numbers: Vec<Number>,
    /// Names that the log cannot tell it from.
    pub confusable_with: Vec<&'static str>,
    /// Share of the gap's squares that is left without it.
    pub share: f64,
    /// When it came about; none of what holds all along.
    pub since: Option<Instant>,
}

impl Finding {
    /// Probability of the name among those that the log cannot tell it from.
    #[must_use]
    pub fn probability(&self) -> f64 {
        haptical_judge::probability(self.confusable_with.iter().map(|_| 0.0))
    }
}

/// Errors of a joint over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// Row of the log.
    pub row: Vec<usize>,
    /// Time \[s\].
    pub time_s: Vec<f64>,
    /// Position less command \[rad\].
    pub before: Vec<f64>,
    /// Position less what the causes make of the command \[rad\].
    pub after: Vec<f64>,
}

/// What is said of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointAnswer {
    /// What is said of the gap.
    pub verdict: Verdict,
    /// Strongest first.
    pub causes: Vec<Finding>,
    /// Root mean square of position less command, on the rows that are held out in turn \[rad\].
    pub rms_before: f64,
    /// The same with the causes, fitted to the other rows.
    pub rms_after: f64,
    /// Noise of the sensor: a count's rounding, or what neighbours scatter by.
    pub noise_floor: f64,
    /// Share of the gap's squares beyond noise that the causes close on unseen rows, with its 95 % interval.
    pub closed: f64,
    /// See [`JointAnswer::closed`].
    pub closed_ci95: [f64; 2],
    /// What was moved.
    pub course: Course,
    /// Which motion would tell what this one cannot.
    pub next: Option<String>,
    /// What is odd about the log.
    pub warnings: Vec<String>,
    /// Models that were tried.
    pub tried: usize,
    pub(crate) model: Option<Model>,
}

impl JointAnswer {
    /// The answer without some effects: a rival takes the place of one, and without a rival it goes.
    #[must_use]
    pub fn without(&self, names: &[String]) -> Self {
        let mut kept = self.clone();
        let is_left_out = |name: &str| names.iter().any(|other| other == name);
        kept.causes.retain_mut(|cause| {
            let all = std::iter::once(cause.effect).chain(cause.confusable_with.iter().copied());
            let mut all = all.filter(|name| !is_left_out(name)).collect::<Vec<_>>();
            if all.is_empty() {
                return false;
            }
            cause.effect = all.remove(0);
            cause.confusable_with = all;
            true
        });
        if kept.causes.len() < self.causes.len() {
            let share = |answer: &Self| answer.causes.iter().map(|cause| cause.share).sum::<f64>();
            kept.closed = (self.closed - (share(self) - share(&kept))).max(0.0);
            kept.verdict = judged(self.verdict != Verdict::NoGap, kept.closed, &kept.causes);
        }
        kept
    }
}
