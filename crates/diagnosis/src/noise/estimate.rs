//! The noise of one stream.

use std::ops::Range;

use super::colour::{
    colour_of_unit_noise, from_segments, of_moments, segment_basis, segment_moments, with_colour_of,
};
use super::{Noise, NoiseSource};
use crate::thresholds::noise::{
    ENOUGH_SEGMENTS, LAGS, LOUD, MEMORY_STEP, SEGMENT_ROWS, STATED_UNCERTAINTY,
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
