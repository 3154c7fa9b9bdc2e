//! Power by frequency of a series that may have gaps: the median of windowed segments (Welch 1967), which a jump or a
//! dent in one of them does not move.

use haptical_metrics::Fourier;

use crate::thresholds::lines::{FILLED, LONGEST_ROWS, PAUSE, SEGMENTS, SHORTEST_ROWS};

/// Power of a series at multiples of `bin_hz`.
#[derive(Debug)]
pub(super) struct Spectrum {
    pub(super) bin_hz: f64,
    /// Median over the segments.
    pub(super) power: Vec<f64>,
    pub(super) segments: usize,
    /// Power at its frequency of an oscillation of amplitude 1.
    pub(super) of_unit: f64,
}

/// Readings at equal steps of time; NaN where one is missing.
type Piece = Vec<f64>;

impl Spectrum {
    /// Of runs of times \[s\] and values; none of too short ones.
    pub(super) fn new(runs: &[(Vec<f64>, Vec<f64>)]) -> Option<Self> {
        let steps: Vec<f64> = runs
            .iter()
            .flat_map(|(time_s, _)| time_s.windows(2).map(|pair| pair[1] - pair[0]))
            .collect();
        let step_s = haptical_metrics::median(&steps).ok().filter(|s| *s > 0.0)?;
        let pieces: Vec<Piece> = runs
            .iter()
            .flat_map(|(time_s, values)| pieces(time_s, values, step_s))
            .collect();
        let longest = pieces.iter().map(Vec::len).max()?;
        let length = (longest / SEGMENTS + 1).next_power_of_two() / 2;
        let length = length.clamp(SHORTEST_ROWS, LONGEST_ROWS);
        let window: Vec<f64> = (0..length)
            .map(|slot| 0.5 - 0.5 * (std::f64::consts::TAU * slot as f64 / length as f64).cos())
            .collect();
        let mut fourier = Fourier::new(length);
        let segments: Vec<Vec<f64>> = pieces
            .iter()
            .flat_map(|piece| {
                let starts = (0..=piece.len().checked_sub(length)?).step_by(length / 2);
                Some(starts.map(|start| &piece[start..start + length]))
            })
            .flatten()
            .filter_map(|segment| power(segment, &window, &mut fourier))
            .collect();
        let count = segments.len();
        if count == 0 {
            return None;
        }
        let median = |bin: usize| {
            let mut values: Vec<f64> = segments.iter().map(|power| power[bin]).collect();
            values.sort_by(f64::total_cmp);
            values[(count - 1) / 2]
        };
        let sum: f64 = window.iter().sum();
        let squares: f64 = window.iter().map(|w| w * w).sum();
        Some(Self {
            bin_hz: 1.0 / (step_s * length as f64),
            power: (0..length / 2).map(median).collect(),
            segments: count,
            of_unit: sum * sum / (4.0 * squares),
        })
    }
}

/// Cuts a run at pauses, and puts each reading at its multiple of the step.
fn pieces(time_s: &[f64], values: &[f64], step_s: f64) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut start_s = f64::NEG_INFINITY;
    let mut before_s = f64::NEG_INFINITY;
    for (&time, &value) in time_s.iter().zip(values) {
        if time - before_s > PAUSE * step_s {
            pieces.push(Vec::new());
            start_s = time;
        }
        before_s = time;
        let slot = ((time - start_s) / step_s).round().max(0.0) as usize;
        if let Some(piece) = pieces.last_mut() {
            if piece.len() <= slot {
                piece.resize(slot + 1, f64::NAN);
            }
            piece[slot] = value;
        }
    }
    pieces
}

/// Power of a segment without its mean, over the sum of the squares of its window; none of one with too many gaps.
fn power(segment: &[f64], window: &[f64], fourier: &mut Fourier) -> Option<Vec<f64>> {
    let known = segment.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count < FILLED * segment.len() as f64 {
        return None;
    }
    let mean = sum / count;
    let pairs = || segment.iter().zip(window);
    let known = pairs().filter(|(value, _)| value.is_finite());
    let squares: f64 = known.map(|(_, window)| window * window).sum();
    let terms = pairs().map(|(value, window)| match value.is_finite() {
        true => window * (value - mean),
        false => 0.0,
    });
    let half = fourier.transform(terms)[..segment.len() / 2].iter();
    Some(half.map(|term| term.norm_sqr() / squares).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oscillation_with_missing_readings_has_its_power_at_its_frequency() {
        let kept = |row: &usize| row % 7 != 3 && !(300..420).contains(row);
        let rows: Vec<usize> = (0..2000).filter(kept).collect();
        let time_s: Vec<f64> = rows.iter().map(|row| 0.01 * *row as f64).collect();
        let wave = |time: &f64| 0.3 * (std::f64::consts::TAU * 12.5 * time + 0.4).cos();
        let values = time_s.iter().map(wave).collect();
        let spectrum = Spectrum::new(&[(time_s, values)]).unwrap();
        let (bin, power) = (0..spectrum.power.len())
            .map(|bin| (bin, spectrum.power[bin]))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        assert!((bin as f64 * spectrum.bin_hz - 12.5).abs() < 1e-9);
        // one reading in seven is missing
        let amplitude = (power / spectrum.of_unit).sqrt();
        assert!((amplitude / 0.3 - 1.0).abs() < 0.1, "{amplitude}");
    }
}
