//! The noise of one stream.

use std::ops::Range;

use super::Noise;
use super::colour::from_segments;
use super::segments::{segment_basis, segment_moments};
use crate::thresholds::noise::{ENOUGH_SEGMENTS, LAGS, SEGMENT_ROWS, STATED_UNCERTAINTY};

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
                run.chunks_exact(SEGMENT_ROWS)
                    .map(|part| segment_moments(part, &basis)),
            );
        }
        if moments.len() >= ENOUGH_SEGMENTS {
            return from_segments(moments, rounding);
        }
    }
    let values: Vec<f64> = series.concat();
    if stated {
        // single postures cannot tell noise from a gap: the device file's figure is what there is
        return Noise::of_postures(1.0, STATED_UNCERTAINTY);
    }
    let freedom = (values.len() as f64 - lost).max(1.0);
    let sum: f64 = values.iter().map(|value| value * value).sum();
    let ratio = (sum / freedom).sqrt().max(1e-6);
    Noise::of_postures(ratio, (2.0 / freedom).sqrt())
}
