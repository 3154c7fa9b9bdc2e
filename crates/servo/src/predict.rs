//! What the causes that one log shows make of another log of the same joint.

use haptical_judge::{Closed, closed_share};
use haptical_linalg::Information;

use crate::answer::JointAnswer;
use crate::change::Change;
use crate::effect::droop;
use crate::fit::{Fit, Problem, Terms};
use crate::log::{JointLog, Series, Untested};
use crate::select::parts;
use crate::thresholds::FOLDS;

/// The laws of a joint with their numbers, and what changed within the log that they are from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    terms: Terms,
    fit: Fit,
    angles: Vec<bool>,
    /// How well the log determines predictions of others.
    information: Information,
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
    /// Rows that are not among these, as the first log does not determine what they do.
    pub left_out: usize,
}

impl Model {
    pub(crate) fn new(series: &Series, terms: Terms, fit: &Fit, changes: &[Change]) -> Self {
        let angles = droop::moving(series);
        Self {
            information: Problem::with_droop(series, &angles).information(terms, fit),
            terms,
            fit: fit.clone(),
            angles,
            changes: changes.to_vec(),
        }
    }
}

impl JointAnswer {
    /// Predicts another log of the same joint where the first one determines that: nothing is fitted to it. What changed within the first log is taken to last.
    ///
    /// # Errors
    /// [`Untested`] where the other log has no command, no times or few rows, does not move, or goes where the first one says nothing.
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
    /// assert!(seen.closed(0.0).share > 0.999);
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
        let (mut after, determined) = match &self.model {
            Some(model) => {
                let problem = Problem::with_droop(&series, &model.angles);
                let fit = (model.terms, &model.fit);
                (
                    problem.predicted(model.terms, &model.fit),
                    problem.determined(fit, &model.information),
                )
            }
            None => (before.clone(), vec![true; before.len()]),
        };
        changes.rev().for_each(|change| change.read_all(&mut after));
        let kept: Vec<usize> = (0..determined.len())
            .filter(|row| determined[*row])
            .collect();
        if kept.len() < FOLDS {
            return Err(Untested::Elsewhere {
                rows: determined.len(),
            });
        }
        let of_kept = |own: &[f64]| kept.iter().map(|row| own[*row]).collect::<Vec<f64>>();
        Ok(Predicted {
            row: kept.iter().map(|row| series.row[*row]).collect(),
            measured: of_kept(&series.response),
            before: of_kept(&before),
            after: of_kept(&after),
            left_out: determined.len() - kept.len(),
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
    pub fn closed(&self, noise_floor: f64) -> Closed {
        let noise = noise_floor * noise_floor * self.row.len() as f64;
        let (before, after) = (self.squares(&self.before), self.squares(&self.after));
        closed_share(&before, &after, noise)
    }

    /// Sums of squares of contiguous parts.
    fn squares(&self, predicted: &[f64]) -> Vec<f64> {
        let square = |row: usize| (self.measured[row] - predicted[row]).powi(2);
        let parts = parts(self.row.len());
        parts.map(|rows| rows.map(square).sum()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Shape;

    /// A joint 0.05 rad beside its command, which swings so far.
    fn series(swing_rad: f64) -> Series {
        let time_s: Vec<f64> = (0..1500).map(|row| 0.02 * f64::from(row)).collect();
        let command: Vec<f64> = time_s.iter().map(|t| swing_rad * (1.7 * t).sin()).collect();
        let response: Vec<f64> = command.iter().map(|at| at + 0.05).collect();
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&command),
            response: &response,
            ..JointLog::default()
        };
        Series::new(&log).unwrap()
    }

    /// Sines and cosines of a droop that a small swing hardly tells from an offset.
    #[test]
    fn a_droop_is_not_predicted_where_the_first_log_did_not_go() {
        let terms = Terms {
            offset: true,
            droop: true,
            ..Terms::NONE
        };
        let (first, second) = (series(0.15), series(1.4));
        let problem = Problem::new(&first);
        let fit = problem.evaluate(terms, Shape::default(), &None);
        let information = problem.information(terms, &fit);
        let there = Problem::with_droop(&second, &droop::moving(&first));
        let determined = there.determined((terms, &fit), &information);
        let is_there =
            |angle: &f64| determined[second.command.iter().position(|at| at == angle).unwrap()];
        let (near, far): (Vec<f64>, Vec<f64>) = (second.command.iter())
            .filter(|angle| !(0.15..1.2).contains(&angle.abs()))
            .partition(|angle| angle.abs() < 0.15);
        assert!(!near.is_empty() && near.iter().all(is_there));
        assert!(!far.is_empty() && !far.iter().any(is_there));
    }
}
