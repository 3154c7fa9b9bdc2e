//! Size and colour of a noise by the moments of its segments: what a cubic leaves of a motion.

use super::{Noise, NoiseSource};
use crate::thresholds::engine::COLOUR_STEP;
use crate::thresholds::noise::{DISTURBED, LAGS, LEAST_COLOUR, MOST_COLOUR, SEGMENT_ROWS};

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

/// Solves for size and colour by the moments of the segments that nothing disturbs; the share of the
/// variance that rounding has is white.
pub(super) fn from_segments(mut moments: Vec<[f64; LAGS]>, rounding: f64) -> Noise {
    leave_undisturbed(&mut moments, |segment| segment[0]);
    of_moments(&moments, rounding)
}

/// The same of all segments.
pub(super) fn of_moments(moments: &[[f64; LAGS]], rounding: f64) -> Noise {
    let basis = segment_basis();
    let count = moments.len();
    let mut seen = [0.0; LAGS];
    for segment in moments {
        for (sum, moment) in seen.iter_mut().zip(segment.iter()) {
            *sum += moment / count as f64;
        }
    }
    let white = expected_moments(0.0, &basis);
    let scatter = 1.0 / ((count * (SEGMENT_ROWS - 4)) as f64).sqrt();
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
        colour = bisected([LEAST_COLOUR, most_colour(&mixed)], |colour| {
            let [square, next] = mixed(colour);
            next / square < found
        });
    }
    let variance = (seen[0] / mixed(colour)[0]).max(1e-12);
    let freedom = (SEGMENT_ROWS - 4) as f64 * (1.0 - colour * colour) / (1.0 + colour * colour);
    // the level at low frequency, (1 + c) / (1 - c), inherits the colour's scatter too
    let slope = if colour == 0.0 {
        0.0
    } else {
        4.0 * scatter / (1.0 - colour * colour)
    };
    // and so does the size; at the limit of what is looked for the colour is no estimate
    let slope_of_size = if colour == 0.0 || colour > MOST_COLOUR - COLOUR_STEP {
        0.0
    } else {
        let [low, high] = [-COLOUR_STEP, COLOUR_STEP].map(|step| mixed(colour + step)[0]);
        (low / high).ln().abs() / (2.0 * COLOUR_STEP)
    };
    let of_size = (2.0 / (count as f64 * freedom)).sqrt();
    let of_size = of_size.hypot(2.0 * scatter * slope_of_size);
    Noise {
        ratio: variance.sqrt(),
        colour,
        coloured_share: if colour == 0.0 { 0.0 } else { share },
        uncertainty: (2.0 / (count as f64 * freedom)).sqrt().hypot(slope),
        freedom: 2.0 / of_size.powi(2),
        source: NoiseSource::Motion,
        speed_ratio: 1.0,
    }
}

/// The colour at which noise of unit variance leaves segments of this mean square; none where they are larger than white ones.
pub(super) fn colour_of_unit_noise(mean_square: f64) -> Option<f64> {
    let basis = segment_basis();
    let square = |colour: f64| expected_moments(colour, &basis)[0];
    if mean_square >= square(0.0) {
        return None;
    }
    Some(bisected([0.0, MOST_COLOUR], |colour| {
        square(colour) > mean_square
    }))
}

/// The colour up to which something holds, between two.
fn bisected([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match holds(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// Noise of a size that another source gives, with the colour by which segments of that size leave what `segments` were
/// estimated from. A smooth signal makes segments larger than white noise of that size: it gives no colour.
pub(super) fn with_colour_of(given: Noise, segments: &Noise) -> Noise {
    if segments.colour <= 0.0 || segments.coloured_share <= 0.0 {
        return given;
    }
    let basis = segment_basis();
    let share = segments.coloured_share;
    let [white, _] = expected_moments(0.0, &basis);
    let square = |colour: f64| share * expected_moments(colour, &basis)[0] + (1.0 - share) * white;
    let seen = (segments.ratio / given.ratio).powi(2) * square(segments.colour);
    if seen >= white {
        return given;
    }
    Noise {
        colour: bisected([0.0, segments.colour], |colour| square(colour) > seen),
        coloured_share: share,
        ..given
    }
}

/// Orthonormal polynomials up to the third degree on a segment.
pub(super) fn segment_basis() -> [[f64; SEGMENT_ROWS]; 4] {
    let mut basis = [[0.0; SEGMENT_ROWS]; 4];
    for degree in 0..4 {
        let mut vector = [0.0; SEGMENT_ROWS];
        for (index, entry) in vector.iter_mut().enumerate() {
            let place = (index as f64 - 7.5) / 7.5;
            *entry = place.powi(degree as i32);
        }
        without(&mut vector, &basis[..degree]);
        let norm = vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|entry| *entry /= norm);
        basis[degree] = vector;
    }
    basis
}

/// Takes the parts along orthonormal polynomials off a segment.
fn without(part: &mut [f64; SEGMENT_ROWS], basis: &[[f64; SEGMENT_ROWS]]) {
    for polynomial in basis {
        let shared: f64 = part.iter().zip(polynomial).map(|(a, b)| a * b).sum();
        for (entry, other) in part.iter_mut().zip(polynomial) {
            *entry -= shared * other;
        }
    }
}

/// Sums of products of rows at lags 0, 1, ... of what a cubic leaves.
pub(super) fn segment_moments(part: &[f64], basis: &[[f64; SEGMENT_ROWS]; 4]) -> [f64; LAGS] {
    let mut rest = [0.0; SEGMENT_ROWS];
    rest.copy_from_slice(part);
    without(&mut rest, basis);
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT_ROWS)
            .map(|row| rest[row] * rest[row - lag])
            .sum();
    }
    moments
}

/// Expected moments of a segment of a first-order autoregression of unit variance.
pub(super) fn expected_moments(colour: f64, basis: &[[f64; SEGMENT_ROWS]; 4]) -> [f64; LAGS] {
    // M C M, M the projection that takes the cubic out: columns first, then rows
    let powers: [f64; SEGMENT_ROWS] = std::array::from_fn(|lag| colour.powi(lag as i32));
    let mut projected = [[0.0; SEGMENT_ROWS]; SEGMENT_ROWS];
    for (column, entries) in projected.iter_mut().enumerate() {
        for (row, entry) in entries.iter_mut().enumerate() {
            *entry = powers[row.abs_diff(column)];
        }
        without(entries, basis);
    }
    let mut both = [[0.0; SEGMENT_ROWS]; SEGMENT_ROWS];
    for row in 0..SEGMENT_ROWS {
        for column in 0..SEGMENT_ROWS {
            both[row][column] = projected[column][row];
        }
        without(&mut both[row], basis);
    }
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT_ROWS)
            .map(|index| both[index - lag][index])
            .sum();
    }
    moments
}

/// Leaves the segments that nothing disturbs, the quietest first.
pub(super) fn leave_undisturbed<T>(segments: &mut Vec<T>, square: impl Fn(&T) -> f64) {
    segments.sort_by(|a, b| square(a).total_cmp(&square(b)));
    let limit = DISTURBED * square(&segments[segments.len() / 2]);
    segments.retain(|segment| square(segment) <= limit);
}
