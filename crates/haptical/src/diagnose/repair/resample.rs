//! A late channel at the times that its rows say, by interpolation between its readings.

use std::ops::Range;

/// A step between readings that is so many times the usual one is a pause: nothing is interpolated across it.
const PAUSE: f64 = 2.5;
/// Share of a step below which a reading is taken as it is.
const AT_A_READING: f64 = 1e-6;

/// Readings of a run as they were `delay_s` before they were recorded, row by row: what the row's time should have shown. `None`
/// where the row has no reading, or none is recorded before or after that time, or a pause lies there.
///
/// Between four readings a cubic runs (Lagrange), at the ends of a run and next to a pause a straight line: of a motion of a
/// hand at 100 rows a second a straight line is off by more than a cable encoder's noise.
pub(super) fn on_time(
    time_s: &[f64],
    readings: &[f64],
    run: Range<usize>,
    delay_s: f64,
) -> Vec<Option<f64>> {
    let is_read = |row: &usize| readings[*row].is_finite() && time_s[*row].is_finite();
    let known: Vec<usize> = run.clone().filter(is_read).collect();
    let steps = known.windows(2);
    let steps = steps.map(|pair| time_s[pair[1]] - time_s[pair[0]]);
    let mut steps: Vec<f64> = steps.collect();
    steps.sort_by(f64::total_cmp);
    let usual_s = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let between = Between {
        time_s,
        readings,
        known: &known,
        longest_s: PAUSE * usual_s,
        near_s: AT_A_READING * usual_s,
    };
    run.map(|row| match is_read(&row) {
        true => between.at(time_s[row] + delay_s),
        false => None,
    })
    .collect()
}

/// Readings to interpolate between.
struct Between<'r> {
    time_s: &'r [f64],
    readings: &'r [f64],
    /// Rows with a reading.
    known: &'r [usize],
    longest_s: f64,
    near_s: f64,
}

impl Between<'_> {
    fn time_s(&self, index: usize) -> Option<f64> {
        self.known.get(index).map(|row| self.time_s[*row])
    }

    /// The reading at a time.
    fn at(&self, time_s: f64) -> Option<f64> {
        let is_before = |row: &usize| self.time_s[*row] < time_s - self.near_s;
        let after = self.known.partition_point(is_before);
        let there = *self.known.get(after)?;
        if (self.time_s[there] - time_s).abs() <= self.near_s {
            return Some(self.readings[there]);
        }
        let before = after.checked_sub(1)?;
        if !self.is_joined(before) {
            return None;
        }
        let is_cubic = before > 0
            && after + 1 < self.known.len()
            && self.is_joined(before - 1)
            && self.is_joined(after);
        let rows = match is_cubic {
            true => &self.known[before - 1..=after + 1],
            false => &self.known[before..=after],
        };
        Some(self.lagrange(rows, time_s))
    }

    /// Whether no pause lies behind a reading.
    fn is_joined(&self, index: usize) -> bool {
        match (self.time_s(index), self.time_s(index + 1)) {
            (Some(here), Some(next)) => next - here <= self.longest_s,
            _ => false,
        }
    }

    /// The polynomial through some readings.
    fn lagrange(&self, rows: &[usize], time_s: f64) -> f64 {
        let mut sum = 0.0;
        for &own in rows {
            let mut weight = 1.0;
            for &other in rows.iter().filter(|other| **other != own) {
                weight *= (time_s - self.time_s[other]) / (self.time_s[own] - self.time_s[other]);
            }
            sum += weight * self.readings[own];
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is given back where four readings are, whatever the delay, and nothing beyond the ends.
    #[test]
    fn a_cubic_is_given_back_between_four_readings() {
        let cubic = |t: f64| 0.3 - 2.0 * t + 5.0 * t * t - 7.0 * t * t * t;
        let time_s: Vec<f64> = (0..40).map(|k| 0.01 * f64::from(k)).collect();
        for delay_s in [0.004, -0.013, 0.02] {
            let late: Vec<f64> = time_s.iter().map(|t| cubic(t - delay_s)).collect();
            let found = on_time(&time_s, &late, 0..40, delay_s);
            for row in 3..36 {
                let value = found[row].unwrap();
                assert!((value - cubic(time_s[row])).abs() < 1e-12, "{row}");
            }
            let empty = found.iter().filter(|value| value.is_none()).count();
            assert_eq!(
                empty,
                (f64::abs(delay_s) / 0.01).ceil() as usize,
                "{delay_s}"
            );
            let at_an_end = if delay_s > 0.0 { found[39] } else { found[0] };
            assert!(at_an_end.is_none());
        }
    }

    #[test]
    fn a_delay_of_whole_rows_moves_readings_as_they_are() {
        let time_s: Vec<f64> = (0..10).map(|k| 0.01 * f64::from(k)).collect();
        let readings: Vec<f64> = (0..10).map(|k| f64::from(k * k % 7)).collect();
        let found = on_time(&time_s, &readings, 0..10, 0.02);
        for row in 0..8 {
            assert_eq!(found[row], Some(readings[row + 2]));
        }
        assert_eq!(found[8..], [None, None]);
    }

    /// Nothing is made up: neither across a pause, nor in a row without a reading, nor from another run.
    #[test]
    fn pauses_and_empty_cells_stay() {
        let mut time_s: Vec<f64> = (0..20).map(|k| 0.01 * f64::from(k)).collect();
        for time in &mut time_s[10..] {
            *time += 1.0;
        }
        let mut readings: Vec<f64> = (0..20).map(f64::from).collect();
        readings[4] = f64::NAN;
        let found = on_time(&time_s, &readings, 0..20, 0.005);
        assert!(found[9].is_none() && found[4].is_none() && found[19].is_none());
        // straight lines are given back across the empty cell: its neighbours are two steps apart
        assert!((found[3].unwrap() - 3.5).abs() < 1e-9);
        let apart = on_time(&time_s, &readings, 0..8, 0.005);
        assert!(apart[7].is_none());
    }
}
