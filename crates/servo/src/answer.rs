//! What is said of a joint.

use std::fmt;

use crate::predict::Model;

/// What is said of a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The joint stands where it is told, but for the noise of its sensor.
    NoGap,
    /// The causes are named.
    Named,
    /// The log cannot tell the first cause from others.
    Ambiguous,
    /// There is a gap that no law of a servo explains.
    Unknown,
}

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
