//! What the causes that one log shows make of another log of the same joint.

use crate::answer::JointAnswer;
use crate::change::Change;
use crate::effect::droop;
use crate::fit::{Fit, Problem, Terms};
use crate::log::{JointLog, Series, Untested};
use crate::thresholds::FOLDS;

/// The laws of a joint with their numbers, and what changed within the log that they are from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    terms: Terms,
    fit: Fit,
    angles: Vec<bool>,
    changes: Vec<Change>,
}

/// A log beside what a model makes of its commands.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Row of the log.
    pub row: Vec<usize>,
    /// Measured positions \[rad\].
    pub measured: Vec<f64>,
    /// The commands: where an ideal servo stands.
    pub before: Vec<f64>,
    /// With the causes.
    pub after: Vec<f64>,
}

impl Model {
    pub(crate) fn new(series: &Series, terms: Terms, fit: &Fit, changes: &[Change]) -> Self {
        Self {
            terms,
            fit: fit.clone(),
            angles: droop::moving(series),
            changes: changes.to_vec(),
        }
    }
}

impl JointAnswer {
    /// Predicts another log of the same joint: nothing is fitted to it. What changed within the first log is taken to last.
    ///
    /// # Errors
    /// [`Untested`] where the other log has no command, no times or few rows, or does not move.
    ///
    /// # Examples
    /// ```
    /// use haptical_servo::{JointLog, diagnose_joint};
    ///
    /// let time_s: Vec<f64> = (0..1500).map(|row| 0.02 * f64::from(row)).collect();
    /// let command = |shift_s: f64| -> Vec<f64> {
    ///     let at = time_s.iter().map(|time_s| time_s + shift_s);
    ///     at.map(|s| 0.3 * (1.7 * s).sin() + 0.1 * (4.1 * s).cos()).collect()
    /// };
    /// let beside = |command: &[f64]| -> Vec<f64> { command.iter().map(|c| c + 0.05).collect() };
    /// let (first, second) = (command(0.0), command(40.0));
    /// let (of_first, of_second) = (beside(&first), beside(&second));
    /// let log = |command, response| JointLog { time_s: Some(&time_s), command: Some(command), response, ..JointLog::default() };
    /// let answer = diagnose_joint(&log(&first, &of_first)).unwrap();
    /// let seen = answer.predict(&log(&second, &of_second)).unwrap();
    /// assert!((seen.after[700] - of_second[700]).abs() < 1e-6);
    /// assert!(seen.closed(0.0).0 > 0.999);
    /// ```
    pub fn predict(&self, log: &JointLog<'_>) -> Result<Predicted, Untested> {
        let mut series = Series::new(log)?;
        if !series.moves() {
            return Err(Untested::Still);
        }
        series.check_related()?;
        let before = series.command.clone();
        let changes = self.model.iter().flat_map(|model| &model.changes);
        changes
            .clone()
            .for_each(|change| change.delay_all(&mut series));
        let mut after = match &self.model {
            Some(model) => {
                Problem::with_droop(&series, &model.angles).predicted(model.terms, &model.fit)
            }
            None => before.clone(),
        };
        changes.rev().for_each(|change| change.read_all(&mut after));
        Ok(Predicted {
            row: series.row,
            measured: series.response,
            before,
            after,
        })
    }
}

impl Predicted {
    /// Root mean square of measured less predicted, before and with the causes \[rad\].
    #[must_use]
    pub fn rms(&self) -> [f64; 2] {
        let rms = |parts: Vec<f64>| (parts.iter().sum::<f64>() / self.row.len() as f64).sqrt();
        [
            rms(self.squares(&self.before)),
            rms(self.squares(&self.after)),
        ]
    }

    /// Share of the squares beyond a noise that the causes close, with its 95 % interval; below zero where they are wrong.
    #[must_use]
    pub fn closed(&self, noise_floor: f64) -> (f64, [f64; 2]) {
        let noise = noise_floor * noise_floor * self.row.len() as f64;
        let (before, after) = (self.squares(&self.before), self.squares(&self.after));
        closed(&before, &after, noise)
    }

    /// Sums of squares of contiguous parts.
    fn squares(&self, predicted: &[f64]) -> Vec<f64> {
        let rows = self.row.len();
        let part = |part: usize| part * rows / FOLDS..(part + 1) * rows / FOLDS;
        let square = |row: usize| (self.measured[row] - predicted[row]).powi(2);
        (0..FOLDS).map(|own| part(own).map(square).sum()).collect()
    }
}

/// Share of the squares beyond noise that close, and its interval by the parts (jackknife).
pub(crate) fn closed(before: &[f64], after: &[f64], noise: f64) -> (f64, [f64; 2]) {
    let parts = before.len();
    let share = |without: Option<usize>| {
        let sum = |values: &[f64]| -> f64 {
            let kept = values.iter().enumerate();
            let kept = kept.filter(|(index, _)| Some(*index) != without);
            kept.map(|(_, value)| value).sum()
        };
        let own = match without {
            Some(_) => noise * (1.0 - 1.0 / parts as f64),
            None => noise,
        };
        let gap = (sum(before) - own).max(1e-300);
        1.0 - (sum(after) - own).max(0.0) / gap
    };
    let all = share(None);
    let sd = jackknife_sd((0..parts).map(|part| share(Some(part))));
    (all, [all - 1.96 * sd, (all + 1.96 * sd).min(1.0)])
}

/// Deviation by a number without each part (Efron & Tibshirani 1993, 11).
pub(crate) fn jackknife_sd(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count.max(1.0);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares * (count - 1.0) / count.max(1.0)).sqrt()
}
