//! A recording as it is judged, and which rows of the log these are.

use std::borrow::Cow;

use haptical_calibration::{distinct_rows, without_copies};
use haptical_model::{Device, Recording};
use haptical_motion::unwrapped;

use crate::answer::{Diagnosis, FitRows, Prediction, SECOND_RECORDING};
use crate::dropouts::{Dropouts, name_dropouts, without_dropouts};
use crate::hand::without_idle_force;
use crate::thresholds::recording::MOST_ROWS;

/// Said of orientations that an earlier model cannot predict.
const NO_ORIENTATION: &str = "the earlier model was identified without orientations: how what the tracker sees is turned on the handle \
                              is not known, and the log's orientations are left out";

/// A recording as it is judged.
pub(crate) struct Log<'r> {
    pub(crate) recording: Cow<'r, Recording>,
    /// Row of the log for each row of `recording`; none where it has them all.
    rows: Option<Vec<usize>>,
    /// What was changed, in words.
    changes: Vec<String>,
    has_lost_orientations: bool,
    /// Readings that were left out, as they are none.
    dropouts: Vec<Dropouts>,
}

impl<'r> Log<'r> {
    /// The recording without copies of rows, turns of encoders that begin anew, forces of a sensor that nothing touches, and orientations
    /// that `model` cannot predict.
    pub(crate) fn new(device: &Device, recording: &'r Recording, model: Option<&Device>) -> Self {
        let mut log = Self {
            recording: Cow::Borrowed(recording),
            rows: None,
            changes: Vec::new(),
            has_lost_orientations: false,
            dropouts: Vec::new(),
        };
        // rows of a motion are readings of other moments, however alike they are
        if recording.time_s.is_none() {
            log.leave_out_copies();
        }
        // a log of torques is one of a motion: between its rows no joint makes half a turn
        if log.recording.torque_nm.iter().flatten().next().is_some()
            && let Some((unturned, turns)) = unwrapped(device, &log.recording)
        {
            log.changes
                .extend(turns.iter().map(|turn| of_turn(device, *turn)));
            log.recording = Cow::Owned(unturned);
        }
        if let Some((without, dropouts)) = without_dropouts(device, &log.recording) {
            log.dropouts = dropouts;
            log.recording = Cow::Owned(without);
        }
        if let Some((without, words)) = without_idle_force(&log.recording) {
            log.changes.push(words);
            log.recording = Cow::Owned(without);
        }
        if let Some(without) =
            model.and_then(|model| model.without_unknown_orientation(&log.recording))
        {
            log.has_lost_orientations = true;
            log.recording = Cow::Owned(without);
        }
        log
    }

    fn leave_out_copies(&mut self) {
        let Cow::Borrowed(recording) = self.recording else {
            return;
        };
        let (once, words) = without_copies(recording);
        if let Some(words) = words {
            self.rows = Some(distinct_rows(recording));
            self.changes.push(words);
        }
        self.recording = once;
    }

    /// Adds to an answer on this log what was changed, and gives its rows the numbers that they have in the log; `second`: the second
    /// recording, where there is one.
    pub(crate) fn of_log(&self, found: &mut Diagnosis, second: Option<&Self>) {
        let every = step_of_rows(&self.recording);
        let row_of = |row: usize| self.looked_at(row);
        for step in &mut found.steps {
            // it happened after the row before of those that were looked at
            let [first, last] = step.first_row;
            let before = row_of(first.saturating_sub(1));
            step.first_row = [(before + 1).min(row_of(first)), row_of(last)];
        }
        let left_out = std::mem::take(&mut found.fit_rows.left_out).into_iter();
        let is_whole = every == 1 && self.rows.is_none();
        let looked_at = (0..self.recording.len()).step_by(every);
        found.fit_rows = FitRows {
            looked_at: (!is_whole).then(|| looked_at.map(|row| self.row(row)).collect()),
            left_out: left_out.map(|(name, row)| (name, row_of(row))).collect(),
        };
        let is_of_second = found.held_out.starts_with(SECOND_RECORDING);
        for Prediction { row, .. } in &mut found.predictions {
            *row = match second.filter(|_| is_of_second) {
                Some(second) => second.row(*row),
                None => row_of(*row),
            };
        }
        name_dropouts(&self.dropouts, found);
        for own in second.into_iter().flat_map(|second| &second.dropouts) {
            found
                .warnings
                .push(format!("{SECOND_RECORDING}: {}", own.words()));
        }
        if self.has_lost_orientations {
            found.warnings.push(NO_ORIENTATION.to_owned());
        }
        found.warnings.extend(self.changes.iter().cloned());
        for words in second.into_iter().flat_map(|second| &second.changes) {
            if !self.changes.contains(words) {
                found.warnings.push(format!("{SECOND_RECORDING}: {words}"));
            }
        }
    }

    /// Row of the log of a row that positions are judged by.
    fn looked_at(&self, row: usize) -> usize {
        self.row(row * step_of_rows(&self.recording))
    }

    fn row(&self, row: usize) -> usize {
        let rows = self.rows.as_ref();
        rows.and_then(|rows| rows.get(row)).copied().unwrap_or(row)
    }
}

/// Positions are judged by one row in so many.
fn step_of_rows(recording: &Recording) -> usize {
    recording.len().div_ceil(MOST_ROWS).max(1)
}

/// The rows of a long recording that positions are judged by; none where these are all.
pub(crate) fn thinned(recording: &Recording) -> Option<Recording> {
    let step = step_of_rows(recording);
    (step > 1).then(|| {
        let rows: Vec<usize> = (0..recording.len()).step_by(step).collect();
        recording.select(&rows)
    })
}

/// What is said of turns that were undone.
fn of_turn(device: &Device, (joint, count): (usize, usize)) -> String {
    format!(
        "theta{number}_{unit} jumps by a whole turn at {count} rows: the turns were undone, as those of an encoder that begins anew; \
         the log itself stays as it is",
        number = joint + 1,
        unit = device.joints[joint].unit()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device() -> Device {
        let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n";
        Device::from_toml(text, "lever.toml").unwrap().device
    }

    fn recording(angles: Vec<f64>) -> Recording {
        Recording {
            line: (2..).take(angles.len()).collect(),
            joint: vec![angles],
            ..Recording::default()
        }
    }

    #[test]
    fn rows_behind_copies_keep_their_numbers() {
        let copied = recording(vec![0.1, 0.1, 0.2, 0.1, 0.3]);
        let log = Log::new(&device(), &copied, None);
        assert_eq!(log.recording.joint[0], [0.1, 0.2, 0.3]);
        assert_eq!([0, 1, 2].map(|row| log.looked_at(row)), [0, 2, 4]);
        assert!(log.changes[0].contains("2 of 5 rows"), "{:?}", log.changes);
        // readings of a motion that agree are of two moments
        let timed = Recording {
            time_s: Some(vec![0.0, 0.1, 0.2, 0.3, 0.4]),
            ..copied
        };
        let log = Log::new(&device(), &timed, None);
        assert_eq!((log.recording.len(), log.looked_at(3)), (5, 3));
    }

    #[test]
    fn rows_of_a_long_log_that_are_looked_at_keep_their_numbers() {
        let long = recording((0..2 * MOST_ROWS + 1).map(|row| row as f64).collect());
        let log = Log::new(&device(), &long, None);
        let judged = thinned(&log.recording).unwrap();
        for row in [0, 1, 70] {
            assert_eq!(judged.joint[0][row], log.looked_at(row) as f64);
        }
        assert_eq!(log.looked_at(70), 210);
    }
}
