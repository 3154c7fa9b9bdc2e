//! The noise of one stream.

use std::ops::Range;

use super::colour::{
    colour_of_unit_noise, from_segments, of_moments, segment_basis, segment_moments, with_colour_of,
};
use super::{Noise, NoiseSource};
use crate::thresholds::noise::{
    ENOUGH_SEGMENTS, LAGS, LOUD, MEMORY_STEP, SEGMENT_ROWS, STATED_UNCERTAINTY, TWO_PART_CHANCE,
    TWO_PART_LAGS, TWO_PART_MEMORIES, TWO_PART_SHARES, TWO_PART_UNCERTAINTY,
};

/// What is known of a stream before its noise is estimated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<'k> {
    pub(crate) runs: &'k [Range<usize>],
    /// Rows follow a motion.
    pub(crate) ordered: bool,
    /// What repeats of postures show, and whether all were come to from one side.
    pub(crate) repeats: Option<&'k Noise>,
    pub(crate) are_of_one_side: bool,
    /// Degrees of freedom that the model's parameters have taken.
    pub(crate) lost: f64,
    /// The device file says how noisy it is.
    pub(crate) stated: bool,
    /// Share of the stated variance that the rounding of the motor encoders has.
    pub(crate) rounding: f64,
}

/// Estimates one stream's noise from its residuals over the stated standard deviation (NaN where there is none): by repeats
/// of postures, by neighbours in a motion, by what is stated, by all that the model leaves; the first that is no larger
/// than all that is left, beyond chance.
pub(crate) fn estimate(scaled: &[f64], known: &Known<'_>) -> Noise {
    let series: Vec<Vec<f64>> = known
        .runs
        .iter()
        .map(|run| {
            let values = scaled[run.clone()].iter();
            values.copied().filter(|value| value.is_finite()).collect()
        })
        .collect();
    let left = all_that_is_left(&series.concat(), known.lost);
    let stated = Noise::of_postures(1.0, 2.0 / STATED_UNCERTAINTY.powi(2), NoiseSource::Stated);
    let repeats = known.repeats.cloned();
    let repeats =
        repeats.filter(|noise| !known.stated || overrules(noise, &stated, known.are_of_one_side));
    let stated = known.stated.then_some(stated);
    let neighbours = by_neighbours(&series, known);
    let coloured = |noise: Noise| match &neighbours {
        Some(neighbours) => with_colour_of(noise, neighbours),
        None => noise,
    };
    let stated = stated.map(coloured);
    let rest = coloured(left.clone());
    let sources = [repeats, neighbours, stated];
    let mut sources = sources.into_iter().flatten();
    let is_possible = |noise: &Noise| {
        let freedom = left.freedom * noise.independent();
        !noise.is_above(left.ratio, freedom)
    };
    let found = sources.find(is_possible).unwrap_or(rest);
    match found.source {
        NoiseSource::Motion | NoiseSource::Stated if known.stated => {
            found.with_rounding(known.rounding)
        }
        _ => found,
    }
}

/// Whether repeats say more than the device file: they are enough of them to know better, or differ from it beyond
/// chance. What repeats from several sides scatter by holds any play: it does not raise a stated noise.
fn overrules(noise: &Noise, stated: &Noise, are_of_one_side: bool) -> bool {
    if !are_of_one_side && noise.ratio > stated.ratio {
        return false;
    }
    let differs =
        noise.is_above(stated.ratio, stated.freedom) || stated.is_above(noise.ratio, noise.freedom);
    noise.freedom >= stated.freedom || differs
}

/// The noise of a motion by every few rows: what has a memory longer than a segment shows its size there, and so does what
/// is louder at times. Signals of a few segments' length pass for it too.
///
/// Of a `stated` size the colour alone is sought, and there is none where all that is left is louder.
pub(crate) fn with_memory(scaled: &[f64], runs: &[Range<usize>], stated: bool) -> Option<Noise> {
    let basis = segment_basis();
    let mut moments = Vec::new();
    for run in runs {
        for phase in 0..MEMORY_STEP {
            let every: Vec<f64> = scaled[run.clone()]
                .iter()
                .copied()
                .skip(phase)
                .step_by(MEMORY_STEP)
                .filter(|value| value.is_finite())
                .collect();
            let parts = every.chunks_exact(SEGMENT_ROWS);
            moments.extend(parts.map(|part| segment_moments(part, &basis)));
        }
    }
    let step = MEMORY_STEP as f64;
    if moments.len() < ENOUGH_SEGMENTS * MEMORY_STEP {
        return None;
    }
    let mut noise = of_moments(&moments, 0.0);
    if stated {
        let values = scaled.iter().filter(|value| value.is_finite()).copied();
        if all_that_is_left(&values.collect::<Vec<f64>>(), 0.0).ratio > LOUD {
            return None;
        }
        let square = moments.iter().map(|segment| segment[0]).sum::<f64>() / moments.len() as f64;
        noise = Noise {
            ratio: 1.0,
            colour: colour_of_unit_noise(square)?,
            coloured_share: 1.0,
            ..noise
        };
    }
    Some(Noise {
        colour: noise.colour.max(0.0).powf(1.0 / step),
        // rows between those of a segment are not independent of them
        uncertainty: noise.uncertainty * step.sqrt(),
        freedom: noise.freedom / step,
        ..noise
    })
}

/// A noise of two parts, one white and one with a memory (a first-order autoregression), by the products of rows up to some lags apart
/// (Yule 1927): `r(0) = s^2`, `r(k) = c s^2 a^k`. None where they do not follow that law, or where rows further apart still belong together, as
/// of a gap they do; and none much louder than stated.
pub(crate) fn of_two_parts(scaled: &[f64], runs: &[Range<usize>], stated: bool) -> Option<Noise> {
    let mut products = [0.0_f64; TWO_PART_LAGS + 1];
    let mut counts = [0.0_f64; TWO_PART_LAGS + 1];
    for run in runs {
        let rows = &scaled[run.clone()];
        for (lag, (sum, count)) in products.iter_mut().zip(&mut counts).enumerate() {
            for (one, other) in rows.iter().zip(rows.iter().skip(lag)) {
                if one.is_finite() && other.is_finite() {
                    *sum += one * other;
                    *count += 1.0;
                }
            }
        }
    }
    let of = |lag: usize| products[lag] / counts[lag].max(1.0);
    let (square, rows) = (of(0), counts[0]);
    if rows < (ENOUGH_SEGMENTS * SEGMENT_ROWS) as f64 || (stated && square.sqrt() > LOUD) {
        return None;
    }
    let correlation: Vec<f64> = (0..=TWO_PART_LAGS).map(|lag| of(lag) / square).collect();
    // share and misfit of a colour
    let fitted = |colour: f64| {
        let powers: Vec<f64> = (1..=TWO_PART_LAGS)
            .map(|lag| colour.powi(lag as i32))
            .collect();
        let along: f64 = powers
            .iter()
            .zip(&correlation[1..])
            .map(|(a, b)| a * b)
            .sum();
        let own: f64 = powers.iter().map(|power| power * power).sum();
        let share = along / own;
        let pairs = powers.iter().zip(&correlation[1..]);
        let misfit: f64 = pairs
            .map(|(power, seen)| (seen - share * power).powi(2))
            .sum();
        (share, misfit)
    };
    let colours = (4..=48).map(|step| 0.02 * f64::from(step));
    let colour = colours.min_by(|a, b| fitted(*a).1.total_cmp(&fitted(*b).1))?;
    let (share, misfit) = fitted(colour);
    let lags = TWO_PART_LAGS as f64;
    // products of white rows scatter by one over the root of their number; those of a memory by its level more
    let level = share * (1.0 + colour) / (1.0 - colour) + 1.0 - share;
    let is_law = misfit < TWO_PART_CHANCE * lags * level.max(1.0) / rows;
    let memory = (TWO_PART_MEMORIES / -colour.ln()).ceil() as usize;
    let has_ended = memory < TWO_PART_LAGS;
    if !(TWO_PART_SHARES.contains(&share) && is_law && has_ended) {
        return None;
    }
    let freedom = rows / level.max(1.0);
    Some(Noise {
        ratio: square.sqrt(),
        colour,
        coloured_share: share,
        uncertainty: (2.0 / freedom).sqrt().max(TWO_PART_UNCERTAINTY),
        freedom,
        source: NoiseSource::Motion,
        speed_ratio: 1.0,
    })
}

fn by_neighbours(series: &[Vec<f64>], known: &Known<'_>) -> Option<Noise> {
    if !known.ordered {
        return None;
    }
    let basis = segment_basis();
    let parts = series.iter().flat_map(|run| run.chunks_exact(SEGMENT_ROWS));
    let moments: Vec<[f64; LAGS]> = parts.map(|part| segment_moments(part, &basis)).collect();
    let rounding = if known.stated { known.rounding } else { 0.0 };
    (moments.len() >= ENOUGH_SEGMENTS).then(|| from_segments(moments, rounding))
}

/// The root mean square of everything: noise and gap, which cannot be told apart.
fn all_that_is_left(values: &[f64], lost: f64) -> Noise {
    let freedom = (values.len() as f64 - lost).max(1.0);
    let sum: f64 = values.iter().map(|value| value * value).sum();
    let ratio = (sum / freedom).sqrt().max(1e-6);
    Noise::of_postures(ratio, freedom, NoiseSource::Rest)
}
