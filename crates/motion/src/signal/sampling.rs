//! Rows that a log repeats, and rows that it lacks though its stamps run on.

use haptical_model::Recording;

use crate::thresholds::signal::{
    CLEAR_MOTION, LEAST_FAULTY_ROWS, LEAST_FAULTY_SHARE, LONG_STEP, MOST_MISSING_ROWS,
    UNEVEN_CLOCK, WHOLE_STEP,
};

/// Rows that stay, with the times that they have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sampling {
    pub(crate) rows: Vec<usize>,
    /// Rows that repeat the one before them, and those behind missing ones.
    pub(crate) repeated: Vec<usize>,
    pub(crate) behind_missing: Vec<usize>,
    pub(crate) time_s: Vec<f64>,
    /// Rows that repeat the one before them, and rows that are missing, as shares of all.
    pub(crate) repeated_share: f64,
    pub(crate) missing_share: f64,
}

impl Sampling {
    /// What a recording has wrong; none where it has nothing.
    pub(crate) fn of(recording: &Recording, time_s: &[f64], step_s: f64) -> Option<Self> {
        let all = recording.len();
        let is_next = |row: usize| recording.run_at(row) == recording.run_at(row - 1);
        let values = |row: usize| {
            let joints = recording.joint.iter();
            joints
                .chain(recording.torque_nm.iter().flatten())
                .map(move |own| own[row])
        };
        let moves =
            |row: usize, other: usize| recording.joint.iter().any(|own| own[row] != own[other]);
        let is_repeated = |row: usize| {
            row > 1
                && row + 1 < all
                && is_next(row)
                && values(row)
                    .zip(values(row - 1))
                    .all(|(own, before)| own == before)
                && moves(row + 1, row)
                && moves(row - 1, row - 2)
        };
        let (repeats, rows): (Vec<usize>, Vec<usize>) = (0..all).partition(|&row| is_repeated(row));
        let repeated = repeats.len();
        let mut stamps: Vec<f64> = rows.iter().map(|&row| time_s[row]).collect();
        let mut missing = 0;
        let finest: Vec<f64> = recording
            .joint
            .iter()
            .map(|own| smallest_step(own).max(scatter(own)))
            .collect();
        let per_step = |k: usize, joint: usize| {
            let own = &recording.joint[joint];
            // a row that follows a repeated one took two steps
            (own[rows[k]] - own[rows[k - 1]]) / ((stamps[k] - stamps[k - 1]) / step_s)
        };
        // stamps that jitter say themselves how long a step took
        let is_even = |k: usize| {
            let steps = (stamps[k] - stamps[k - 1]) / step_s;
            (steps - steps.round().max(1.0)).abs() < WHOLE_STEP
        };
        let uneven = (1..rows.len()).filter(|k| is_next(rows[*k]) && !is_even(*k));
        let is_clock = uneven.count() as f64 > UNEVEN_CLOCK * rows.len() as f64;
        let judged = if is_clock { 0 } else { rows.len() };
        let mut shifts = vec![0.0; rows.len()];
        for k in 3..judged.saturating_sub(3) {
            let is_whole = (rows[k - 3]..rows[k + 2]).all(|row| is_next(row + 1));
            if !is_whole || !(k - 2..=k + 2).all(is_even) {
                continue;
            }
            let (mut product, mut square, mut size) = (0.0, 0.0, 0.0_f64);
            for joint in 0..recording.joint.len() {
                let near = [
                    per_step(k - 2, joint),
                    per_step(k - 1, joint),
                    per_step(k + 1, joint),
                    per_step(k + 2, joint),
                ];
                let usual = near.iter().sum::<f64>() / 4.0;
                let scale = finest[joint].max(1e-300);
                product += per_step(k, joint) * usual / scale.powi(2);
                square += usual * usual / scale.powi(2);
                size = size.max(usual.abs() / scale);
            }
            let ratio = product / square.max(1e-300);
            if size > CLEAR_MOTION && (LONG_STEP..MOST_MISSING_ROWS).contains(&ratio) {
                let lost = ratio.round() - 1.0;
                shifts[k] = lost * step_s;
                missing += lost as usize;
            }
        }
        let share = (repeated + missing) as f64 / all as f64;
        if repeated + missing < LEAST_FAULTY_ROWS || share < LEAST_FAULTY_SHARE {
            return None;
        }
        let mut shift = 0.0;
        for (stamp, own) in stamps.iter_mut().zip(&shifts) {
            shift += own;
            *stamp += shift;
        }
        let behind = (0..rows.len()).filter(|k| shifts[*k] > 0.0);
        Some(Self {
            behind_missing: behind.map(|k| rows[k]).collect(),
            repeated: repeats,
            rows,
            time_s: stamps,
            repeated_share: repeated as f64 / all as f64,
            missing_share: missing as f64 / all as f64,
        })
    }
}

/// What steps of a column scatter by from row to row: the median of their changes.
fn scatter(column: &[f64]) -> f64 {
    let mut changes: Vec<f64> = (column.windows(3))
        .map(|own| (own[2] - 2.0 * own[1] + own[0]).abs())
        .collect();
    if changes.is_empty() {
        return 0.0;
    }
    let middle = changes.len() / 2;
    let (_, median, _) = changes.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

/// Smallest change of a column between rows: a count, or the last digit that is written.
fn smallest_step(column: &[f64]) -> f64 {
    let steps = column.windows(2).map(|own| (own[1] - own[0]).abs());
    steps.filter(|own| *own > 0.0).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(values: &[f64]) -> Recording {
        Recording {
            line: (2..).take(values.len()).collect(),
            joint: vec![
                values
                    .iter()
                    .map(|t| (t.sin() * 1e6).round() * 1e-6)
                    .collect(),
            ],
            output: vec![None],
            torque_nm: vec![Some(values.iter().map(|t| t.cos()).collect())],
            time_s: Some((0..values.len()).map(|k| 0.01 * k as f64).collect()),
            ..Recording::default()
        }
    }

    fn sampling(values: &[f64]) -> Option<Sampling> {
        let log = recording(values);
        Sampling::of(&log, log.time_s.as_deref().unwrap(), 0.01)
    }

    #[test]
    fn a_sound_log_has_nothing_wrong() {
        let values: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        assert_eq!(sampling(&values), None);
    }

    #[test]
    fn missing_rows_are_found_where_they_are_and_time_is_set_right() {
        let lost = [100, 300, 301, 620];
        let values: Vec<f64> = (0..1000)
            .filter(|k| !lost.contains(k))
            .map(|k| 0.01 * f64::from(k))
            .collect();
        let found = sampling(&values).unwrap();
        assert!(
            (found.missing_share - 4.0 / 996.0).abs() < 1e-12,
            "{found:?}"
        );
        for (time, value) in found.time_s.iter().zip(&values) {
            assert!((time - value).abs() < 1e-9, "{time}, {value}");
        }
    }

    /// A logger reads a controller's state of every 10 ms at about that rate, by a clock of its own: it repeats some, and skips some.
    #[test]
    fn a_logger_out_of_step_keeps_its_clock() {
        let read: Vec<f64> = (0..2000)
            .map(|k| 0.01 * (f64::from(k) + 0.35 * (1.7 * f64::from(k)).sin()))
            .collect();
        let states: Vec<f64> = read.iter().map(|t| 0.01 * (t / 0.01).floor()).collect();
        let log = Recording {
            time_s: Some(read.clone()),
            ..recording(&states)
        };
        let found = Sampling::of(&log, &read, 0.01).unwrap();
        assert!(found.repeated_share > 0.05, "{}", found.repeated_share);
        assert_eq!(found.missing_share, 0.0);
        for (row, time_s) in found.rows.iter().zip(&found.time_s) {
            assert_eq!(*time_s, read[*row]);
        }
    }

    #[test]
    fn repeated_rows_are_left_out() {
        let held = |k: u32| if k % 50 == 7 { k - 1 } else { k };
        let values: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(held(k))).collect();
        let found = sampling(&values).unwrap();
        assert_eq!((found.repeated_share, found.missing_share), (0.02, 0.0));
        assert!(!found.rows.contains(&57) && found.rows.contains(&56));
    }
}
