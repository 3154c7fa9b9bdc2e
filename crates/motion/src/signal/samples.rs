//! Recorded columns at equal steps of time, in pieces without a gap.

use haptical_model::Recording;

use crate::MotionError;
use crate::signal::sampling::Sampling;
use crate::thresholds::signal::{
    BREAK_SHARE, EVEN_STAMPS, FILLED_STEPS, LEAST_PIECE_SAMPLES, LONG_PIECE_S, ROWS_AROUND_STEP,
    SHORTEST_STEP, UNEVEN_FILLED_S,
};

/// What was recorded without a gap; sample k is `k * step_s` after the first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    /// Row of the recording that its first sample was.
    pub(crate) first_row: usize,
    pub(crate) start_s: f64,
    pub(crate) length: usize,
    /// Motor-side positions, joint by joint \[rad\] or \[m\].
    pub(crate) motor: Vec<Vec<f64>>,
    /// Link-side positions, where a joint has an encoder there.
    pub(crate) link: Vec<Option<Vec<f64>>>,
    /// Torques \[N m\] or forces \[N\], where a joint has them.
    pub(crate) torque: Vec<Option<Vec<f64>>>,
    /// What effects add to readings, in the order of [`Recording::added`].
    pub(crate) added: Vec<Vec<f64>>,
}

/// All pieces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Samples {
    pub(crate) step_s: f64,
    pub(crate) pieces: Vec<Piece>,
    /// Share of the rows that are in no piece.
    pub(crate) lost_share: f64,
    /// Rows that it repeats or lacks, as shares of all: they were set right.
    pub(crate) sampling: Option<[f64; 2]>,
    /// Those that it repeats, and those behind ones that it lacks.
    pub(crate) set_right: [Vec<usize>; 2],
    /// Root mean square deviation of the stamps from an even grid, as a share of a step.
    pub(crate) jitter: f64,
    /// Whether the positions are smoother on an even grid than at the stamps: rows were taken evenly, and stamped unevenly.
    pub(crate) is_stamped_late: bool,
}

impl Samples {
    /// Takes a recording apart; `sets_right`: rows that it repeats are left out, and times of rows behind missing ones moved.
    ///
    /// # Errors
    /// [`MotionError`] without time, torques, or enough rows.
    pub(crate) fn new(recording: &Recording, sets_right: bool) -> Result<Self, MotionError> {
        let missing = |what: &str, why| MotionError::Missing {
            what: what.to_owned(),
            why,
        };
        let time_s = (recording.time_s.as_ref())
            .ok_or_else(|| missing("t_s", "velocities and accelerations are by time"))?;
        if !recording.torque_nm.iter().any(Option::is_some) {
            return Err(missing(
                "torque1_nm",
                "the equations of motion are of torques",
            ));
        }
        let step_s = usual_step(recording, time_s)
            .ok_or_else(|| MotionError::Sampling("the log has too few rows".to_owned()))?;
        let sampling = Sampling::of(recording, time_s, step_s).filter(|_| sets_right);
        let shares = sampling
            .as_ref()
            .map(|own| [own.repeated_share, own.missing_share]);
        let kept = sampling.as_ref().map(|own| recording.select(&own.rows));
        let (recording, time_s, longest) = match (&kept, &sampling) {
            (Some(kept), Some(own)) => (kept, own.time_s.as_slice(), FILLED_STEPS),
            _ => (recording, time_s.as_slice(), 1.0 + BREAK_SHARE),
        };
        let mut pieces = Vec::new();
        let (mut deviation, mut count) = (0.0, 0);
        let steps_s = [(1.0 - BREAK_SHARE) * step_s, longest * step_s];
        let mut all = stretches(recording, time_s, (step_s, steps_s));
        let long = all.iter().map(std::ops::Range::len);
        let long = long.filter(|rows| *rows as f64 * step_s > LONG_PIECE_S);
        if 2 * long.sum::<usize>() < recording.len() {
            let steps_s = [
                SHORTEST_STEP * step_s,
                (FILLED_STEPS * step_s).max(UNEVEN_FILLED_S),
            ];
            all = stretches(recording, time_s, (step_s, steps_s));
        }
        let (mut late, mut late_s) = (0, 0.0);
        for rows in all {
            // rows that were left out are no steps of an even grid
            let may_be_late = kept.is_none();
            let (piece, square, late_step_s) =
                piece(recording, time_s, (step_s, may_be_late), rows.clone());
            deviation += square * piece.length as f64;
            if let Some(own_s) = late_step_s {
                late += piece.length;
                late_s += own_s * piece.length as f64;
            }
            count += piece.length;
            pieces.push(piece);
        }
        if pieces.is_empty() {
            let message = format!("no {LEAST_PIECE_SAMPLES} rows follow each other without a gap");
            return Err(MotionError::Sampling(message));
        }
        let is_stamped_late = 2 * late > count;
        Ok(Self {
            step_s: match is_stamped_late {
                true => late_s / late as f64,
                false => step_s,
            },
            pieces,
            sampling: shares,
            set_right: sampling.map_or_else(<[Vec<usize>; 2]>::default, |own| {
                [own.repeated, own.behind_missing]
            }),
            lost_share: 1.0 - count as f64 / recording.len() as f64,
            jitter: (deviation / count as f64).sqrt(),
            is_stamped_late,
        })
    }

    pub(crate) fn rate_hz(&self) -> f64 {
        1.0 / self.step_s
    }

    /// Of a joint that has torques whether they are one value, and which.
    pub(crate) fn constant_torque(&self, joint: usize) -> Option<Option<f64>> {
        let columns = (self.pieces.iter()).filter_map(|own| own.torque[joint].as_ref());
        let mut values = columns.flatten();
        let first = *values.next()?;
        Some(values.all(|own| *own == first).then_some(first))
    }
}

/// The median step within runs; none of few rows. Where stamps jitter it is that of several rows together, whose jitter is smaller.
pub(crate) fn usual_step(recording: &Recording, time_s: &[f64]) -> Option<f64> {
    let over = |rows: usize| {
        let mut steps: Vec<f64> = (rows..time_s.len())
            .filter(|&row| recording.run_at(row) == recording.run_at(row - rows))
            .map(|row| (time_s[row] - time_s[row - rows]) / rows as f64)
            .filter(|step| *step > 0.0)
            .collect();
        steps.sort_by(f64::total_cmp);
        (steps.len() >= LEAST_PIECE_SAMPLES / 2).then(|| (steps[steps.len() / 2], steps))
    };
    let (usual_s, steps) = over(1)?;
    let quarter = steps.len() / 4;
    let jitters = steps[steps.len() - 1 - quarter] - steps[quarter] > 2.0 * EVEN_STAMPS * usual_s;
    let together = || over(ROWS_AROUND_STEP).map(|own| own.0);
    Some(if jitters { together() } else { None }.unwrap_or(usual_s))
}

/// Rows that follow each other at the usual step, with every torque that the recording has anywhere.
fn stretches(
    recording: &Recording,
    time_s: &[f64],
    (step_s, [shortest_s, longest_s]): (f64, [f64; 2]),
) -> Vec<std::ops::Range<usize>> {
    let columns: Vec<&[f64]> = (recording.torque_nm.iter().flatten())
        .chain(recording.output.iter().flatten())
        .map(Vec::as_slice)
        .filter(|column| column.iter().any(|value| value.is_finite()))
        .collect();
    let is_whole = |row: usize| columns.iter().all(|column| column[row].is_finite());
    let mut found = Vec::new();
    let mut from = 0;
    for row in 0..=recording.len() {
        if row <= from {
            let is_empty = row < recording.len() && !is_whole(row);
            from += usize::from(row == from && is_empty);
            continue;
        }
        let goes_on = row < recording.len() && is_whole(row) && {
            let step = time_s[row] - time_s[row - 1];
            recording.run_at(row) == recording.run_at(row - 1)
                && ((shortest_s..=longest_s).contains(&step)
                    || is_jitter(recording, time_s, row, step_s))
        };
        if goes_on {
            continue;
        }
        if row - from >= LEAST_PIECE_SAMPLES {
            found.push(from..row);
        }
        let is_empty = row < recording.len() && !is_whole(row);
        from = row + usize::from(is_empty);
    }
    found
}

/// Whether a step of an odd length before a row is one of uneven stamps: the rows on both sides are as far apart as they should be.
fn is_jitter(recording: &Recording, time_s: &[f64], row: usize, step_s: f64) -> bool {
    if row < ROWS_AROUND_STEP || row + ROWS_AROUND_STEP > recording.len() {
        return false;
    }
    let (before, after) = (row - ROWS_AROUND_STEP..row, row..row + ROWS_AROUND_STEP);
    let is_next = |own: usize| recording.run_at(own) == recording.run_at(own - 1);
    let mean =
        |rows: std::ops::Range<usize>| time_s[rows].iter().sum::<f64>() / ROWS_AROUND_STEP as f64;
    (before.start + 1..after.end).all(is_next)
        && ((mean(after) - mean(before)) / step_s - ROWS_AROUND_STEP as f64).abs() < BREAK_SHARE
}

/// A stretch on an even grid, the mean square deviation of its stamps from it in steps, and the step of the rows where stamps were
/// left aside, as they may be.
fn piece(
    recording: &Recording,
    time_s: &[f64],
    (step_s, may_be_late): (f64, bool),
    rows: std::ops::Range<usize>,
) -> (Piece, f64, Option<f64>) {
    let stamps = &time_s[rows.clone()];
    let length = stamps.len();
    // the grid of least squares
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / length as f64;
    let middle = 0.5 * (length - 1) as f64;
    let centre = mean(&mut stamps.iter().copied());
    let offset = |k: usize| k as f64 - middle;
    let slope = (0..length)
        .map(|k| offset(k) * (stamps[k] - centre))
        .sum::<f64>()
        / (0..length).map(|k| offset(k).powi(2)).sum::<f64>();
    let deviation = |k: usize| (stamps[k] - centre - offset(k) * slope) / step_s;
    let square = mean(&mut (0..length).map(|k| deviation(k).powi(2)));
    let even: Vec<f64> = (0..length).map(|k| centre + offset(k) * slope).collect();
    let motors: Vec<&[f64]> = recording
        .joint
        .iter()
        .map(|own| &own[rows.clone()])
        .collect();
    let is_late = may_be_late
        && square.sqrt() >= EVEN_STAMPS
        && roughness(&even, &motors) < roughness(stamps, &motors);
    let stamps = if is_late { even.as_slice() } else { stamps };
    let is_even = is_late
        || square.sqrt() < EVEN_STAMPS
            && ((slope / step_s) - 1.0).abs() * (length as f64) < EVEN_STAMPS;
    let column = |values: &[f64]| match is_even {
        true => values[rows.clone()].to_vec(),
        false => resampled(stamps, &values[rows.clone()], step_s),
    };
    let piece = Piece {
        first_row: rows.start,
        start_s: stamps[0],
        length: 0,
        motor: recording.joint.iter().map(|own| column(own)).collect(),
        link: (recording.output.iter())
            .map(|own| own.as_deref().map(column))
            .collect(),
        torque: (recording.torque_nm.iter())
            .map(|own| own.as_deref().map(column))
            .collect(),
        added: (recording.added.iter())
            .map(|own| column(&own.readings))
            .collect(),
    };
    let length = piece.motor.first().map_or(0, Vec::len);
    (Piece { length, ..piece }, square, is_late.then_some(slope))
}

/// How far columns are, at times, from the cubic through their two neighbours on each side: sums of squares, each column's by its
/// variance, and each row's by what the cubic makes of white noise: that of uneven times has larger weights, and rounded readings would
/// be smoother on any even grid.
fn roughness(times: &[f64], columns: &[&[f64]]) -> f64 {
    let of_column = |column: &&[f64]| {
        let mean = column.iter().sum::<f64>() / column.len() as f64;
        let variance: f64 = column.iter().map(|own| (own - mean).powi(2)).sum();
        let off = (2..column.len().saturating_sub(2)).map(|k| {
            let near = [k - 2, k - 1, k + 1, k + 2];
            let weights = cubic_weights(times[k], near.map(|i| times[i]));
            let pairs = weights.iter().zip(near);
            let fitted: f64 = pairs.map(|(weight, i)| weight * column[i]).sum();
            let of_noise = 1.0 + weights.iter().map(|own| own * own).sum::<f64>();
            (column[k] - fitted).powi(2) / of_noise
        });
        off.sum::<f64>() / variance.max(1e-300)
    };
    columns.iter().map(of_column).sum()
}

/// Weights of four values in that of the cubic through them at a time (Lagrange).
fn cubic_weights(time: f64, times: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| {
        let others = (0..4).filter(|j| *j != i);
        others
            .map(|j| (time - times[j]) / (times[i] - times[j]))
            .product()
    })
}

/// Values at steps of `step_s` from the first stamp on: a cubic through the two samples on each side.
fn resampled(stamps: &[f64], values: &[f64], step_s: f64) -> Vec<f64> {
    let last = stamps.len() - 1;
    let count = ((stamps[last] - stamps[0]) / step_s).floor() as usize + 1;
    let mut after = 1;
    (0..count)
        .map(|k| {
            let time = stamps[0] + k as f64 * step_s;
            while after < last && stamps[after] < time {
                after += 1;
            }
            let first = after.saturating_sub(2).min(stamps.len().saturating_sub(4));
            let near = [0, 1, 2, 3].map(|k| first + k);
            let weights = cubic_weights(time, near.map(|i| stamps[i]));
            let pairs = weights.iter().zip(near);
            pairs.map(|(weight, i)| weight * values[i]).sum()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(time_s: Vec<f64>) -> Recording {
        let of = |f: fn(f64) -> f64| time_s.iter().map(|t| f(*t)).collect::<Vec<f64>>();
        Recording {
            line: (2..).take(time_s.len()).collect(),
            joint: vec![of(f64::sin)],
            output: vec![None],
            torque_nm: vec![Some(of(f64::cos))],
            time_s: Some(time_s),
            ..Recording::default()
        }
    }

    #[test]
    fn a_gap_and_an_empty_cell_end_a_piece() {
        let mut stamps: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        stamps[100..].iter_mut().for_each(|t| *t += 0.05);
        let mut log = recording(stamps);
        log.torque_nm[0].as_mut().unwrap()[150] = f64::NAN;
        let samples = Samples::new(&log, true).unwrap();
        let found: Vec<_> = (samples.pieces.iter())
            .map(|piece| (piece.first_row, piece.length))
            .collect();
        assert_eq!(found, [(0, 100), (100, 50), (151, 49)]);
        assert!((samples.lost_share - 0.005).abs() < 1e-12);
    }

    #[test]
    fn uneven_rows_are_interpolated_from_both_sides() {
        let stamp = |k: u32| 0.01 * (f64::from(k) + 0.3 * (1.7 * f64::from(k)).sin());
        let stamps: Vec<f64> = (0..300).map(stamp).collect();
        let sine = |time: f64| (8.0 * time).sin();
        let values: Vec<f64> = stamps.iter().map(|time| sine(*time)).collect();
        let even = resampled(&stamps, &values, 0.01);
        let off = |(k, own): (usize, &f64)| (own - sine(stamps[0] + 0.01 * k as f64)).abs();
        let most = even.iter().enumerate().skip(2).take(290).map(off);
        let most = most.fold(0.0, f64::max);
        // a cubic through four neighbours at steps h is off by 3 / 128 h^4 of the fourth derivative, and from one side ten times that
        let allowed = 3.0 / 128.0 * 0.016_f64.powi(4) * 8.0_f64.powi(4);
        assert!(most < allowed, "{most}");
    }

    /// Steps from nothing to two and a half: no rows are missing, but for those behind row 300.
    #[test]
    fn stamps_that_jitter_are_no_gap_and_lost_rows_are_one() {
        let late = |k: u32| 0.6 * (1.7 * f64::from(k)).sin() + 0.3 * (0.9 * f64::from(k * k)).sin();
        let stamps: Vec<f64> = (0..600)
            .map(|k| 0.01 * (f64::from(k) + if k > 300 { 2.0 } else { 0.0 } + 0.55 * late(k)))
            .collect();
        let lost = |k: usize| if k > 300 { k + 2 } else { k };
        let mut log = recording(stamps);
        log.joint[0] = (0..600).map(|k| (0.01 * lost(k) as f64).sin()).collect();
        let samples = Samples::new(&log, true).unwrap();
        let found: Vec<_> = (samples.pieces.iter())
            .map(|piece| (piece.first_row, piece.length))
            .collect();
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            found[0].0 < ROWS_AROUND_STEP && found[0].1.abs_diff(300) < 2 * ROWS_AROUND_STEP,
            "{found:?}"
        );
        // rows that were taken evenly stay as they are
        assert!(samples.is_stamped_late);
        let step = samples.step_s / 0.01;
        assert!((step - 1.0).abs() < 1e-3, "{step}");
        let first = samples.pieces[0].first_row;
        assert_eq!(
            samples.pieces[0].motor[0],
            log.joint[0][first..][..samples.pieces[0].length]
        );
    }

    /// Readings of four decimals that were taken at uneven times are rougher than rows without rounding wherever they are put; the stamps
    /// are believed.
    #[test]
    fn rounded_readings_of_uneven_times_keep_their_stamps() {
        let stamps: Vec<f64> = (0..2000)
            .map(|k| 0.001 * (f64::from(k) + 0.4 * (1.7 * f64::from(k)).sin()))
            .collect();
        let mut log = recording(stamps.clone());
        let rounded = |t: &f64| ((0.1 * t.sin()) * 1e4).round() * 1e-4;
        log.joint[0] = stamps.iter().map(rounded).collect();
        assert!(!Samples::new(&log, false).unwrap().is_stamped_late);
    }

    /// Rows that were left out are no steps of an even grid, however smooth that were: places of one half would come early.
    #[test]
    fn rows_that_repeat_do_not_move_the_clock() {
        let is_repeated = |k: u32| k < 1000 && k % 20 == 5;
        let late = |k: u32| 0.3 * (1.7 * f64::from(k)).sin();
        let stamps: Vec<f64> = (0..2000)
            .map(|k| 0.001 * (f64::from(k) + late(k)))
            .collect();
        let mut log = recording(stamps);
        let taken = (0..2000).map(|k| k - u32::from(is_repeated(k)));
        let taken: Vec<f64> = taken.map(|k| 0.001 * f64::from(k)).collect();
        log.joint[0] = taken.iter().map(|t| t.sin()).collect();
        log.torque_nm[0] = Some(taken.iter().map(|t| t.cos()).collect());
        let samples = Samples::new(&log, true).unwrap();
        assert!(samples.sampling.is_some() && samples.pieces.len() == 1);
        let piece = &samples.pieces[0];
        for (k, value) in piece.motor[0].iter().enumerate() {
            let wanted = (piece.start_s + samples.step_s * k as f64).sin();
            assert!((value - wanted).abs() < 2e-3, "{k}: {value}, {wanted}");
        }
    }

    #[test]
    fn uneven_stamps_are_put_on_a_grid() {
        let stamps: Vec<f64> = (0..400)
            .map(|k| 0.01 * (f64::from(k) + 0.3 * (1.7 * f64::from(k)).sin()))
            .collect();
        let samples = Samples::new(&recording(stamps), true).unwrap();
        let piece = &samples.pieces[0];
        assert!((samples.jitter - 0.21).abs() < 0.01, "{}", samples.jitter);
        for (k, value) in piece.motor[0].iter().enumerate() {
            let wanted = (piece.start_s + samples.step_s * k as f64).sin();
            assert!((value - wanted).abs() < 1e-6, "{k}: {value}, {wanted}");
        }
    }
}
