//! Reported numbers of an effect with their variances, by the delta method.

use haptical_effects::{Context, Effect};
use nalgebra::{DMatrix, DVector};

/// Values and variances of an effect's numbers, from the covariance of its amplitudes and, last, of the logarithm of a
/// continuous shape.
pub(crate) fn with_variances(
    effect: &dyn Effect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
    covariance: &DMatrix<f64>,
) -> Vec<(f64, f64)> {
    let here = effect.values(context, amplitudes, shape);
    let mut slopes = DMatrix::zeros(here.len(), covariance.ncols());
    for (number, mut column) in slopes.column_iter_mut().enumerate() {
        let sd = covariance[(number, number)].max(0.0).sqrt();
        let (mut amplitudes, mut shape) = (amplitudes.to_vec(), shape);
        let step = match amplitudes.get_mut(number) {
            Some(amplitude) => {
                let step = (1e-3 * sd).max(1e-9 * amplitude.abs()).max(1e-300);
                *amplitude += step;
                step
            }
            None => {
                shape *= 1e-4_f64.exp();
                1e-4
            }
        };
        let there = effect.values(context, &amplitudes, shape);
        column.copy_from(&((DVector::from_vec(there) - DVector::from_row_slice(&here)) / step));
    }
    let values = here.into_iter().zip(slopes.row_iter());
    values
        .map(|(value, slope)| (value, (slope * covariance * slope.transpose())[0]))
        .collect()
}
