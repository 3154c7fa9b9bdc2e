//! Counts of sensors, and what a reading may be off by because of them.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::{Context, Stream};
use haptical_model::Recording;

use crate::thresholds::noise::{ENOUGH_STEPS, PART_OF_A_COUNT, SAW_OF_A_LOG, SMALL_STEPS};

/// The smallest change of successive readings above `least`.
pub(crate) fn smallest_step(readings: &[f64], least: f64) -> Option<f64> {
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.filter(|step| *step > least).reduce(f64::min)
}

/// One count of the sensor that wrote these readings, in their unit: their smallest change, where all small changes are
/// whole multiples of it and some readings repeat; else none. (A scan of even steps has no count in sight.)
fn count_of(readings: &[f64]) -> Option<f64> {
    let count = smallest_step(readings, 0.0)?;
    let (mut small, mut repeats) = (0, false);
    for pair in readings.windows(2) {
        let counts = (pair[1] - pair[0]).abs() / count;
        repeats |= counts == 0.0;
        if counts > 0.5 && counts < SMALL_STEPS {
            if (counts - counts.round()).abs() > PART_OF_A_COUNT {
                return None;
            }
            small += 1;
        }
    }
    (repeats && small >= ENOUGH_STEPS).then_some(count)
}

/// What two neighbouring readings of a stream may differ by because of its own sensor's counts, where the log shows
/// them; else 0.
pub(crate) fn own_count(context: &Context<'_>, stream: &Stream) -> f64 {
    column(context.recording, stream)
        .and_then(count_of)
        .unwrap_or(0.0)
}

/// Amplitude of an oscillation up to which it may be rounding: counts that are passed at a steady speed are a saw of half a count,
/// count / pi in its first oscillation, and half of that where the speed is steady for a quarter of a log.
pub(crate) fn saw(context: &Context<'_>, stream: &Stream) -> f64 {
    SAW_OF_A_LOG * own_count(context, stream) / std::f64::consts::PI
}

/// As how many independent readings those of a slow motion scatter: all that follow each other unchanged are one, and the longest are
/// most of a mean square. Rows without a reading are none.
pub(crate) fn independent(readings: &[f64], runs: &[Range<usize>]) -> f64 {
    let (mut rows, mut squares) = (0.0, 0.0);
    for run in runs {
        let known = readings[run.clone()].iter().copied();
        let known: Vec<f64> = known.filter(|reading| reading.is_finite()).collect();
        for same in known.chunk_by(|a, b| a == b) {
            rows += same.len() as f64;
            squares += (same.len() as f64).powi(2);
        }
    }
    rows * rows / f64::max(squares, 1.0)
}

/// The readings of a stream, where one column has them.
pub(crate) fn column<'a>(recording: &'a Recording, stream: &Stream) -> Option<&'a [f64]> {
    let column = match stream.channel {
        Channel::Output { joint } => recording.output.get(joint)?.as_ref()?,
        Channel::Cable { index } => recording.cable_m.get(index)?.as_ref()?,
        Channel::Position => &recording.position_m.as_ref()?[stream.axis],
        _ => return None,
    };
    Some(column)
}

#[cfg(test)]
mod tests {
    use super::{count_of, independent, smallest_step};

    #[test]
    fn the_smallest_step_leaves_out_rests_and_arithmetic() {
        let readings = [0.0, 0.0, 0.3, 0.3 + 1e-16, 0.2, 0.7];
        let step = smallest_step(&readings, 1e-9).unwrap();
        assert!((step - 0.1).abs() < 1e-12, "{step}");
        assert_eq!(smallest_step(&[1.0, 1.0], 1e-9), None);
    }

    #[test]
    fn a_long_rest_is_one_reading() {
        let readings = [0.1, f64::NAN, 0.1, 0.1, 0.2, 0.3, 0.3];
        assert_eq!(independent(&readings, &[0..4, 4..7]), 36.0 / 14.0);
        assert_eq!(independent(&readings, &[0..3, 3..7]), 36.0 / 10.0);
    }

    #[test]
    fn a_count_is_seen_in_a_slow_motion_and_none_in_a_continuous_one() {
        let slow = |row: usize| 0.4 * (0.03 * row as f64).sin();
        let continuous: Vec<f64> = (0..400).map(slow).collect();
        assert_eq!(count_of(&continuous), None);
        // as a log writes them: six decimals
        let count = 0.000_314_159;
        let rounded = |value: &f64| ((value / count).round() * count * 1e6).round() / 1e6;
        let slower: Vec<f64> = continuous
            .iter()
            .map(|value| rounded(&(value / 20.0)))
            .collect();
        let found = count_of(&slower).unwrap();
        assert!((found - count).abs() < 1e-6, "{found}");
        // a coarse scan has no small steps, and nothing is taken for a count
        let scan: Vec<f64> = (0..40)
            .map(|row| 0.05 * row as f64 + 1e-3 * slow(7 * row))
            .collect();
        assert_eq!(count_of(&scan), None);
    }
}
