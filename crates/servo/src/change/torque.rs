//! The scale of a joint's torques, where they are read in counts: after a change all steps are a factor as large.
//!
//! Readings are whole counts of a drive. A factor that comes to them makes each step between two rows a multiple of the factor,
//! which steps of the same joint without it are now and then. So no law of the torque is asked, and its unit need not be known.

use crate::answer::{Finding, Number};
use crate::change::instant;
use crate::effect::torque_gain;
use crate::log::{JointLog, Series};
use crate::thresholds::{
    COUNT_ROUNDING, FEWEST_TORQUE_STEPS, MOST_COUNTS, TORQUE_FACTORS, TORQUE_NATS,
};

/// Says whether the scale of a joint's torques changed within its log, and when; nothing where they are not read in counts.
///
/// # Examples
/// ```
/// use haptical_servo::{JointLog, torque_gain};
///
/// let time_s: Vec<f64> = (0..600).map(|row| 0.02 * f64::from(row)).collect();
/// // counts of 0.01 N m, four times as large from 6 s on
/// let torque: Vec<f64> = (0..600_u32)
///     .map(|row| 0.01 * f64::from(row * row % 11) * if row < 300 { 1.0 } else { 4.0 })
///     .collect();
/// let log = JointLog { time_s: Some(&time_s), torque: Some(&torque), response: &torque, ..JointLog::default() };
/// let found = torque_gain(&log).unwrap();
/// assert_eq!((found.effect, found.numbers[0].value), ("torque-gain", 4.0));
/// ```
#[must_use]
pub fn torque_gain(log: &JointLog<'_>) -> Option<Finding> {
    let torque = log.torque?;
    // of a joint without commands all that is needed are times
    let series = Series::new(&JointLog {
        command: Some(torque),
        response: torque,
        others: &[],
        load_nm: None,
        ..*log
    })
    .ok()?;
    let counts = counts(series.torque.as_deref()?)?;
    let grown = TORQUE_FACTORS.filter_map(|factor| Some((later(&counts, factor)?, factor, true)));
    let backward: Vec<i64> = counts.iter().rev().copied().collect();
    let shrunk =
        TORQUE_FACTORS.filter_map(|factor| Some((later(&backward, factor)?, factor, false)));
    let ((_, rows), factor, has_grown) =
        grown.chain(shrunk).max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
    let [first, shown, last] = rows;
    let mut instants = [first, usize::midpoint(first, shown), last];
    if !has_grown {
        // read backward: the first row after it is the last one before
        instants = instants.map(|row| counts.len() - row);
        instants.reverse();
    }
    let factor = match has_grown {
        true => f64::from(factor),
        false => 1.0 / f64::from(factor),
    };
    Some(Finding {
        effect: torque_gain::NAME,
        numbers: vec![Number {
            name: "factor",
            value: factor,
            ci95: [
                (1.0 - COUNT_ROUNDING) * factor,
                (1.0 + COUNT_ROUNDING) * factor,
            ],
        }],
        confusable_with: Vec::new(),
        share: 0.0,
        since: Some(instant(&series, instants)),
    })
}

/// Readings in counts, the smallest step between two rows; none where they are no whole counts.
fn counts(torque: &[f64]) -> Option<Vec<i64>> {
    let steps = torque.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let largest = torque
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let least = 1e-9 * largest.max(1e-300);
    let count = steps
        .filter(|step| *step > least)
        .fold(f64::INFINITY, f64::min);
    if !count.is_finite() || largest > MOST_COUNTS * count {
        return None;
    }
    let whole = torque.iter().map(|value| {
        let value = value / count;
        // a count is known to the digits of its own step
        let allowed = COUNT_ROUNDING.max(2e-4 * value.abs()).min(0.3);
        ((value - value.round()).abs() < allowed).then_some(value.round() as i64)
    });
    whole.collect()
}

/// What the steps after the last reading that is no multiple of a factor say for it; the row after that, the row of the next reading
/// that is not zero, and of the third, of which some may be multiples by chance.
fn later(counts: &[i64], factor: u32) -> Option<(f64, [usize; 3])> {
    let factor = i64::from(factor);
    let last_other = counts.iter().rposition(|count| count % factor != 0)?;
    let first = last_other + 1;
    let steps = |rows: &[i64]| -> Vec<i64> {
        let steps = rows.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step != 0).collect()
    };
    let (before, after) = (steps(&counts[..first]), steps(&counts[first..]));
    if before.len().min(after.len()) < FEWEST_TORQUE_STEPS {
        return None;
    }
    let multiples = before.iter().filter(|step| *step % factor == 0).count();
    // one more than were seen, so that none is not impossible
    let share = (multiples + 1) as f64 / (before.len() + 2) as f64;
    let nats = -(after.len() as f64) * share.ln();
    let mut shown = (first..counts.len()).filter(|&row| counts[row] != 0);
    let (next, third) = (shown.next()?, shown.nth(1)?);
    (nats > TORQUE_NATS).then_some((nats, [first, next, third]))
}
