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

/// The counts of a stream's sensor, where the log shows them. Readings that do not change share one rounding error
/// (docs/diagnosis.md, "Rounding").
pub(crate) struct Counts<'c> {
    /// What neighbouring readings may differ by because of them.
    pub(crate) count: f64,
    readings: &'c [f64],
    /// The angle of the motor of the sensor's joint; none of a sensor of the whole chain.
    motor: Option<&'c [f64]>,
}

impl<'c> Counts<'c> {
    pub(crate) fn new(context: &Context<'c>, stream: &Stream) -> Option<Self> {
        let readings = column(context.recording, stream)?;
        Some(Self {
            count: count_of(readings)?,
            readings,
            motor: match stream.channel {
                Channel::Output { joint } => Some(&context.recording.joint[joint]),
                _ => None,
            },
        })
    }

    /// Variance of the rounding of one reading.
    pub(crate) fn variance(&self) -> f64 {
        self.count * self.count / 12.0
    }

    /// Amplitude of an oscillation up to which it may be rounding: counts that are passed at a steady speed are a saw of half a count,
    /// count / pi in its first oscillation, and half of that where the speed is steady for a quarter of a log.
    pub(crate) fn saw(&self) -> f64 {
        SAW_OF_A_LOG * self.count / std::f64::consts::PI
    }

    /// As how many independent readings those of a slow motion scatter: all that follow each other unchanged are one, and the longest
    /// are most of a mean square. Rows without a reading are none.
    pub(crate) fn independent(&self, runs: &[Range<usize>]) -> f64 {
        let (mut rows, mut squares) = (0.0, 0.0);
        for run in runs {
            let known = self.readings[run.clone()].iter().copied();
            let known: Vec<f64> = known.filter(|reading| reading.is_finite()).collect();
            for same in known.chunk_by(|a, b| a == b) {
                rows += same.len() as f64;
                squares += (same.len() as f64).powi(2);
            }
        }
        rows * rows / f64::max(squares, 1.0)
    }

    /// Readings of rows that differ from the one before, and the first.
    pub(crate) fn different(&self, rows: &[usize]) -> f64 {
        let pairs = rows.windows(2);
        let changes = pairs.filter(|pair| self.readings[pair[0]] != self.readings[pair[1]]);
        (1 + changes.count()) as f64
    }

    /// Covariance of the means of rows and of those that follow them: that of the reading that they share, which falls as the joint
    /// moves within the count. Errors of a saw of the count q that are x apart have the correlation 1 - 6 u + 6 u^2, u = x / q, of which
    /// what is below zero is left out.
    pub(crate) fn common(&self, before: &[usize], rows: &[usize]) -> f64 {
        let (Some(motor), Some(&last), Some(&first)) = (self.motor, before.last(), rows.first())
        else {
            return 0.0;
        };
        if self.readings[last] != self.readings[first] {
            return 0.0;
        }
        let mean =
            |rows: &[usize]| rows.iter().map(|&row| motor[row]).sum::<f64>() / rows.len() as f64;
        let u = ((mean(rows) - mean(before)).abs() / self.count).min(0.5);
        let shared = (1.0 - 6.0 * u + 6.0 * u * u).max(0.0);
        shared * self.variance() / (self.different(before) * self.different(rows))
    }
}

/// The readings of a stream, where one column has them.
fn column<'a>(recording: &'a Recording, stream: &Stream) -> Option<&'a [f64]> {
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
    use super::{Counts, count_of, smallest_step};

    #[test]
    fn the_smallest_step_leaves_out_rests_and_arithmetic() {
        let readings = [0.0, 0.0, 0.3, 0.3 + 1e-16, 0.2, 0.7];
        let step = smallest_step(&readings, 1e-9).unwrap();
        assert!((step - 0.1).abs() < 1e-12, "{step}");
        assert_eq!(smallest_step(&[1.0, 1.0], 1e-9), None);
    }

    fn counts<'c>(readings: &'c [f64], motor: Option<&'c [f64]>) -> Counts<'c> {
        Counts {
            count: 0.1,
            readings,
            motor,
        }
    }

    #[test]
    fn a_long_rest_is_one_reading() {
        let readings = [0.1, f64::NAN, 0.1, 0.1, 0.2, 0.3, 0.3];
        let counts = counts(&readings, None);
        assert_eq!(counts.independent(&[0..4, 4..7]), 36.0 / 14.0);
        assert_eq!(counts.independent(&[0..3, 3..7]), 36.0 / 10.0);
    }

    #[test]
    fn blocks_share_a_reading_as_far_as_the_motor_stands() {
        // of two blocks with two and three readings
        let readings = [0.1, 0.2, 0.2, 0.2, 0.2, 0.3, 0.4];
        let (one, two): (Vec<usize>, Vec<usize>) = ((0..3).collect(), (3..7).collect());
        let still = [0.15; 7];
        let whole = 0.01 / 12.0 / 6.0;
        let at_rest = counts(&readings, Some(&still));
        assert_eq!(
            (at_rest.different(&one), at_rest.different(&two)),
            (2.0, 3.0)
        );
        assert!((at_rest.common(&one, &two) - whole).abs() < 1e-15);
        assert_eq!(at_rest.common(&two[..3], &two[3..]), 0.0);
        for (moved, shared) in [(0.1, 0.46), (0.5, 0.0)] {
            let moving = [0.0, 0.0, 0.0, moved, moved, moved, moved].map(|part| part * 0.1);
            let moving = counts(&readings, Some(&moving));
            assert!((moving.common(&one, &two) - shared * whole).abs() < 1e-15);
        }
        assert_eq!(counts(&readings, None).common(&one, &two), 0.0);
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
