//! The noise of each stream, before anything is called a gap: its size and colour from what successive
//! rows do not share, and the rows that are outliers.
//!
//! docs/diagnosis.md, "Noise", derives the formulas.

use std::ops::Range;

use crate::cleaning::NORMAL_MEDIAN;

/// Noise of one stream.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation over the stated one.
    pub(crate) ratio: f64,
    /// Correlation of successive rows of its coloured part (first-order autoregression).
    pub(crate) colour: f64,
    /// Share of the variance that is coloured; the rest is white (rounding, say).
    pub(crate) coloured_share: f64,
    /// Relative standard deviation of the estimated variance.
    pub(crate) uncertainty: f64,
    /// Estimated from differences within a motion; otherwise from all that the model leaves.
    pub(crate) from_motion: bool,
    /// Increase of the standard deviation at the highest tenth of speeds over that at the lowest.
    pub(crate) speed_ratio: f64,
}

/// Relative uncertainty of the variance that a device file states.
const STATED_UNCERTAINTY: f64 = 0.3;
/// Share of rounding from which it counts as a large part of the noise.
const MUCH_ROUNDING: f64 = 0.1;

impl Noise {
    /// Rounding errors of a slow motion are slow themselves and pass for a signal within a segment: where
    /// they are much of the noise, its size is at least the stated one.
    pub(crate) fn with_rounding(mut self, share: f64) -> Self {
        if share > MUCH_ROUNDING {
            self.ratio = self.ratio.max(1.0);
            self.uncertainty = self.uncertainty.hypot(0.2 * share);
        }
        self
    }
}

/// Rows of a segment within which a signal is taken for a cubic.
pub(crate) const SEGMENT: usize = 16;
/// Segments that are enough for an estimate.
const ENOUGH_SEGMENTS: usize = 8;
/// Rows on each side of the median that an outlier is compared with.
const MEDIAN_REACH: usize = 3;

/// Parts of the speeds in which the noise is compared.
const SPEEDS: usize = 4;
/// Variance at the fastest quarter over that at the slowest from which noise depends on speed: with ninety
/// segments each, ten standard deviations.
const DEPENDS_ON_SPEED: f64 = 1.6;

/// Scale of the noise at every row by the speed there, with mean square 1, and the ratio of the deviation
/// at the fastest quarter to that at the slowest; none where it does not depend on speed.
pub(crate) fn speed_scale(
    scaled: &[f64],
    speed: &[f64],
    runs: &[Range<usize>],
) -> Option<(Vec<f64>, f64)> {
    let basis = segment_basis();
    let mut segments: Vec<(f64, f64)> = Vec::new();
    for run in runs {
        let rows: Vec<usize> = run.clone().filter(|&row| scaled[row].is_finite()).collect();
        for part in rows.chunks_exact(SEGMENT) {
            let values: Vec<f64> = part.iter().map(|&row| scaled[row]).collect();
            let fast = part.iter().map(|&row| speed[row].abs()).sum::<f64>() / SEGMENT as f64;
            segments.push((fast, segment_moments(&values, &basis)[0]));
        }
    }
    if segments.len() < 16 * SPEEDS {
        return None;
    }
    segments.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = segments.len() / SPEEDS;
    let parts: Vec<(f64, f64)> = segments
        .chunks(size)
        .take(SPEEDS)
        .map(|part| {
            let mut squares: Vec<f64> = part.iter().map(|segment| segment.1).collect();
            squares.sort_by(f64::total_cmp);
            let limit = DISTURBED * squares[squares.len() / 2];
            let kept: Vec<f64> = squares
                .into_iter()
                .filter(|square| *square <= limit)
                .collect();
            let mean = kept.iter().sum::<f64>() / kept.len().max(1) as f64;
            (
                part.iter().map(|segment| segment.0).sum::<f64>() / part.len() as f64,
                mean,
            )
        })
        .collect();
    let (slow, fast) = (parts[0].1, parts[SPEEDS - 1].1);
    if slow <= 0.0 || fast < DEPENDS_ON_SPEED * slow {
        return None;
    }
    let deviation = |speed: f64| {
        let next = parts
            .iter()
            .position(|part| part.0 > speed)
            .unwrap_or(SPEEDS);
        let square = match next {
            0 => parts[0].1,
            SPEEDS => parts[SPEEDS - 1].1,
            next => {
                let (before, after) = (parts[next - 1], parts[next]);
                let share = (speed - before.0) / (after.0 - before.0).max(1e-300);
                before.1 + share * (after.1 - before.1)
            }
        };
        square.sqrt()
    };
    let scale: Vec<f64> = speed.iter().map(|speed| deviation(speed.abs())).collect();
    let mean = scale.iter().map(|s| s * s).sum::<f64>() / scale.len().max(1) as f64;
    let norm = mean.sqrt().max(1e-300);
    Some((
        scale.into_iter().map(|s| s / norm).collect(),
        (fast / slow).sqrt(),
    ))
}

/// Estimates one stream's noise from its residuals over the stated standard deviation (NaN where
/// there is none), `lost` of which the model's parameters have taken.
pub(crate) fn estimate(
    scaled: &[f64],
    runs: &[Range<usize>],
    ordered: bool,
    lost: f64,
    stated: bool,
    rounding: f64,
) -> Noise {
    let series: Vec<Vec<f64>> = runs
        .iter()
        .map(|run| {
            let values = scaled[run.clone()].iter();
            values.copied().filter(|value| value.is_finite()).collect()
        })
        .collect();
    if ordered {
        let mut moments: Vec<[f64; LAGS]> = Vec::new();
        let basis = segment_basis();
        for run in &series {
            moments.extend(
                run.chunks_exact(SEGMENT)
                    .map(|part| segment_moments(part, &basis)),
            );
        }
        if moments.len() >= ENOUGH_SEGMENTS {
            return from_segments(&mut moments, rounding);
        }
    }
    let values: Vec<f64> = series.concat();
    if stated {
        // single postures cannot tell noise from a gap: the device file's figure is what there is
        return Noise {
            ratio: 1.0,
            colour: 0.0,
            coloured_share: 0.0,
            uncertainty: STATED_UNCERTAINTY,
            from_motion: false,
            speed_ratio: 1.0,
        };
    }
    let freedom = (values.len() as f64 - lost).max(1.0);
    let sum: f64 = values.iter().map(|value| value * value).sum();
    Noise {
        ratio: (sum / freedom).sqrt().max(1e-6),
        colour: 0.0,
        coloured_share: 0.0,
        uncertainty: (2.0 / freedom).sqrt(),
        from_motion: false,
        speed_ratio: 1.0,
    }
}

/// Orthonormal polynomials up to the third degree on a segment.
fn segment_basis() -> [[f64; SEGMENT]; 4] {
    let mut basis = [[0.0; SEGMENT]; 4];
    for degree in 0..4 {
        let mut vector = [0.0; SEGMENT];
        for (index, entry) in vector.iter_mut().enumerate() {
            let place = (index as f64 - 7.5) / 7.5;
            *entry = place.powi(degree as i32);
        }
        for earlier in basis.iter().take(degree) {
            let shared: f64 = vector.iter().zip(earlier).map(|(a, b)| a * b).sum();
            for (entry, other) in vector.iter_mut().zip(earlier) {
                *entry -= shared * other;
            }
        }
        let norm = vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|entry| *entry /= norm);
        basis[degree] = vector;
    }
    basis
}

fn without_cubic(part: &mut [f64; SEGMENT], basis: &[[f64; SEGMENT]; 4]) {
    for polynomial in basis {
        let shared: f64 = part.iter().zip(polynomial).map(|(a, b)| a * b).sum();
        for (entry, other) in part.iter_mut().zip(polynomial) {
            *entry -= shared * other;
        }
    }
}

/// Highest lag at which products of rows are compared.
const LAGS: usize = 2;

/// Sums of products of rows at lags 0, 1, ... of what a cubic leaves.
fn segment_moments(part: &[f64], basis: &[[f64; SEGMENT]; 4]) -> [f64; LAGS] {
    let mut rest = [0.0; SEGMENT];
    rest.copy_from_slice(part);
    without_cubic(&mut rest, basis);
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT).map(|row| rest[row] * rest[row - lag]).sum();
    }
    moments
}

/// Expected moments of a segment of a first-order autoregression of unit variance.
fn expected_moments(colour: f64, basis: &[[f64; SEGMENT]; 4]) -> [f64; LAGS] {
    // M C M, M the projection that takes the cubic out: columns first, then rows
    let mut projected = [[0.0; SEGMENT]; SEGMENT];
    for (column, entries) in projected.iter_mut().enumerate() {
        for (row, entry) in entries.iter_mut().enumerate() {
            *entry = colour.powi((row as i32 - column as i32).abs());
        }
        without_cubic(entries, basis);
    }
    let mut both = [[0.0; SEGMENT]; SEGMENT];
    for row in 0..SEGMENT {
        for column in 0..SEGMENT {
            both[row][column] = projected[column][row];
        }
        without_cubic(&mut both[row], basis);
    }
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT).map(|index| both[index - lag][index]).sum();
    }
    moments
}

/// A segment this many times louder than the median one shows more than noise: a jump, a dent, fast
/// motion. Of white noise one in 10^5 is; leaving out more would prefer the less coloured ones.
const DISTURBED: f64 = 4.0;

/// Smallest and largest colours that are looked for.
const LEAST_COLOUR: f64 = -0.9;
const MOST_COLOUR: f64 = 0.97;

/// The colour up to which the correlation of successive rows grows: a cubic takes most of a strongly
/// coloured part out of a segment, and white rounding is what is left.
fn most_colour(mixed: &dyn Fn(f64) -> [f64; LAGS]) -> f64 {
    let correlation = |colour: f64| {
        let [square, next] = mixed(colour);
        next / square
    };
    let mut most = LEAST_COLOUR;
    while most < MOST_COLOUR && correlation(most + COLOUR_STEP) > correlation(most) {
        most += COLOUR_STEP;
    }
    most
}

/// Step in which the turning point is looked for.
const COLOUR_STEP: f64 = 0.01;

/// Solves for size and colour by the moments of the segments that nothing disturbs; the share of the
/// variance that rounding has is white.
fn from_segments(moments: &mut [[f64; LAGS]], rounding: f64) -> Noise {
    let basis = segment_basis();
    moments.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let median = moments[moments.len() / 2][0];
    let kept: Vec<&[f64; LAGS]> = moments
        .iter()
        .filter(|segment| segment[0] <= DISTURBED * median)
        .collect();
    let count = kept.len();
    let mut seen = [0.0; LAGS];
    for segment in &kept {
        for (sum, moment) in seen.iter_mut().zip(segment.iter()) {
            *sum += moment / count as f64;
        }
    }
    let white = expected_moments(0.0, &basis);
    let scatter = 1.0 / ((count * (SEGMENT - 4)) as f64).sqrt();
    let share = 1.0 - rounding.clamp(0.0, 0.9);
    let mixed = |colour: f64| {
        let coloured = expected_moments(colour, &basis);
        let part = |lag: usize| share * coloured[lag] + (1.0 - share) * white[lag];
        [part(0), part(1)]
    };
    let mut colour = 0.0;
    let found = seen[1] / seen[0].max(1e-300);
    let [square, next] = mixed(0.0);
    // a colour within its scatter of white is white: it would only add noise to the whitening
    if (found - next / square).abs() > 3.0 * scatter {
        let (mut low, mut high) = (LEAST_COLOUR, most_colour(&mixed));
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let [square, next] = mixed(middle);
            if next / square < found {
                low = middle;
            } else {
                high = middle;
            }
        }
        colour = 0.5 * (low + high);
    }
    let variance = (seen[0] / mixed(colour)[0]).max(1e-12);
    let freedom = (SEGMENT - 4) as f64 * (1.0 - colour * colour) / (1.0 + colour * colour);
    // the level at low frequency, (1 + c) / (1 - c), inherits the colour's scatter too
    let slope = if colour == 0.0 {
        0.0
    } else {
        4.0 * scatter / (1.0 - colour * colour)
    };
    Noise {
        ratio: variance.sqrt(),
        colour,
        coloured_share: if colour == 0.0 { 0.0 } else { share },
        uncertainty: (2.0 / (count as f64 * freedom)).sqrt().hypot(slope),
        from_motion: true,
        speed_ratio: 1.0,
    }
}

/// Rows whose value stands alone: further than `limit` noise deviations from the median of the seven
/// rows around, which follow a motion, a jump or a drift.
pub(crate) fn outliers(
    scaled: &[f64],
    runs: &[Range<usize>],
    ordered: bool,
    ratio: f64,
    limit: f64,
) -> Vec<usize> {
    let mut found = Vec::new();
    for run in runs {
        let rows: Vec<usize> = run.clone().filter(|&row| scaled[row].is_finite()).collect();
        for (index, &row) in rows.iter().enumerate() {
            let centre = if ordered {
                let first = index.saturating_sub(MEDIAN_REACH);
                let end = (index + MEDIAN_REACH + 1).min(rows.len());
                let mut around: Vec<f64> = rows[first..end].iter().map(|&r| scaled[r]).collect();
                around.sort_by(f64::total_cmp);
                around[around.len() / 2]
            } else {
                0.0
            };
            if (scaled[row] - centre).abs() > limit * ratio {
                found.push(row);
            }
        }
    }
    found
}

/// Median of the absolute differences of neighbours, as a standard deviation: a size of the noise
/// that outliers and gaps cannot move.
pub(crate) fn difference_sd(scaled: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let mut steps: Vec<f64> = Vec::new();
    for run in runs {
        let values: Vec<f64> = scaled[run.clone()]
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        // second differences: a slope is not noise
        steps.extend(
            values
                .windows(3)
                .map(|w| (w[0] - 2.0 * w[1] + w[2]).abs() / 6.0_f64.sqrt()),
        );
    }
    let median = haptical_metrics::median(&steps).ok()?;
    Some(median / NORMAL_MEDIAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear congruential sequence made normal by the sum of twelve uniforms.
    fn normal(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count)
            .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
            .collect()
    }

    #[test]
    fn white_noise_on_a_slow_signal_is_measured() {
        let values: Vec<f64> = normal(6000, 1)
            .into_iter()
            .enumerate()
            .map(|(k, e)| 1.3 * e + 20.0 * (k as f64 * 0.01).sin())
            .collect();
        let noise = estimate(
            &values,
            &[Range {
                start: 0,
                end: 6000,
            }],
            true,
            0.0,
            true,
            0.0,
        );
        assert!((noise.ratio - 1.3).abs() < 0.06, "{noise:?}");
        assert!(noise.colour.abs() < 0.05);
    }

    #[test]
    fn coloured_noise_is_measured() {
        let mut value = 0.0;
        let values: Vec<f64> = normal(6000, 2)
            .into_iter()
            .map(|e| {
                value = 0.5 * value + 0.75_f64.sqrt() * e;
                value
            })
            .collect();
        let noise = estimate(
            &values,
            &[Range {
                start: 0,
                end: 6000,
            }],
            true,
            0.0,
            true,
            0.0,
        );
        assert!((noise.colour - 0.5).abs() < 0.03, "{noise:?}");
        assert!((noise.ratio - 1.0).abs() < 0.08, "{noise:?}");
    }

    #[test]
    fn a_white_part_of_known_share_leaves_the_colour() {
        // with a third of the variance white, the correlation of successive rows rises up to a colour of
        // 0.6 alone, and is flat there
        for (colour, tolerance) in [(0.3_f64, 0.12), (0.5, 0.15), (0.6, 0.25)] {
            let mut value = 0.0;
            let values: Vec<f64> = normal(12_000, 7)
                .chunks_exact(2)
                .map(|pair| {
                    value = colour * value + (1.0 - colour * colour).sqrt() * pair[0];
                    value + 0.7 * pair[1]
                })
                .collect();
            let run = 0..6000;
            let noise = estimate(&values, &[run], true, 0.0, true, 0.49 / 1.49);
            let low = noise.ratio.powi(2)
                * (1.0 + noise.coloured_share * 2.0 * noise.colour / (1.0 - noise.colour));
            // level at low frequency: (1 + c) / (1 - c) of the coloured part, 0.49 of the white one
            let truth = (1.0 + colour) / (1.0 - colour) + 0.49;
            assert!(
                (low / truth - 1.0).abs() < tolerance,
                "{colour}: {noise:?} {low} {truth}"
            );
        }
    }

    #[test]
    fn noise_that_grows_with_speed_is_scaled() {
        let speed: Vec<f64> = (0..6000).map(|k| (f64::from(k) * 0.01).sin()).collect();
        let values: Vec<f64> = normal(6000, 5)
            .iter()
            .zip(&speed)
            .map(|(e, v)| e * (1.0 + 2.0 * v.abs()))
            .collect();
        let (scale, ratio) = speed_scale(
            &values,
            &speed,
            &[Range {
                start: 0,
                end: 6000,
            }],
        )
        .unwrap_or_default();
        assert!((1.7..3.0).contains(&ratio), "{ratio}");
        assert!(scale[157] > 1.4 * scale[1], "{} {}", scale[157], scale[1]);
        assert!(
            speed_scale(
                &normal(6000, 6),
                &speed,
                &[Range {
                    start: 0,
                    end: 6000
                }]
            )
            .is_none()
        );
    }

    #[test]
    fn single_disturbed_rows_are_outliers_and_a_jump_is_not() {
        let mut values = normal(1000, 3);
        for row in 500..1000 {
            values[row] += 30.0;
        }
        values[100] += 12.0;
        values[700] -= 12.0;
        assert_eq!(
            outliers(
                &values,
                &[Range {
                    start: 0,
                    end: 1000
                }],
                true,
                1.0,
                6.0
            ),
            vec![100, 700]
        );
    }
}
