//! Base parameters with intervals that count a rest with a memory: least squares, or instruments.
//!
//! Covariance: A^-1 S A^-T with S the long-run covariance of the scores (Newey and West 1987), its window by Andrews 1991, eq. (6.2)
//! and (6.4). Instruments: Wooldridge, Econometric Analysis, section 5.2; in robots Janot, Vandanjon and Gautier 2014.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use crate::MotionError;
use crate::fit::column::Column;
use crate::identify::combinations::{Combinations, folded};
use crate::identify::fit::rest;
use crate::thresholds::identify::MOST_MEMORY;

/// Base parameters.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    /// Values, as deviations from the nominal ones.
    pub(crate) values: DVector<f64>,
    pub(crate) sd: Vec<f64>,
    /// Rows R with `|R (b - values)|^2` the squares that values off these ones add.
    pub(crate) root: DMatrix<f64>,
    /// Variance by rows with a memory over that by independent ones: the median of all parameters.
    pub(crate) inflation: f64,
}

/// Least squares.
pub(crate) fn least_squares(
    base: &Combinations,
    columns: &[Rc<Column>],
    target: &[f64],
    rows: usize,
) -> Result<Estimate, MotionError> {
    let kept: Vec<Rc<Column>> = base
        .kept()
        .iter()
        .map(|own| Rc::clone(&columns[*own]))
        .collect();
    let (root, right) = base.root()?;
    estimate((root, &right), &kept, &kept, (target, rows))
}

/// With instruments, one for each kept column: columns that the noise of the positions is not in.
pub(crate) fn instrumented(
    kept: &[Rc<Column>],
    instruments: &[Rc<Column>],
    target: &[f64],
    rows: usize,
) -> Result<Estimate, MotionError> {
    let count = kept.len();
    let triangle = folded(instruments, target, rows)?;
    let factor = DMatrix::from_fn(count, count, |row, column| match row <= column {
        true => triangle.entry(row, column),
        false => 0.0,
    });
    let products = DMatrix::from_fn(count, count, |row, column| {
        instruments[row].times(&kept[column])
    });
    let root = factor
        .transpose()
        .solve_lower_triangular(&products)
        .ok_or(MotionError::Fit(
            "the instruments do not span the motion".to_owned(),
        ))?;
    estimate(
        (root, triangle.projected()),
        kept,
        instruments,
        (target, rows),
    )
}

/// Solves `root b = right` in the least squares, and says how well it is known.
fn estimate(
    (root, right): (DMatrix<f64>, &[f64]),
    kept: &[Rc<Column>],
    instruments: &[Rc<Column>],
    (target, rows): (&[f64], usize),
) -> Result<Estimate, MotionError> {
    let singular = || MotionError::Fit("its equations are singular".to_owned());
    let count = kept.len();
    let scale: Vec<f64> = (0..count)
        .map(|k| root.column(k).norm().max(1e-300))
        .collect();
    let scaled = DMatrix::from_fn(root.nrows(), count, |row, k| root[(row, k)] / scale[k]);
    let qr = scaled.qr();
    let (q, r) = (qr.q(), qr.r());
    let projected = q.transpose() * DVector::from_column_slice(&right[..root.nrows()]);
    let mut values = r.solve_upper_triangular(&projected).ok_or_else(singular)?;
    let half = r
        .solve_upper_triangular(&DMatrix::identity(count, count))
        .ok_or_else(singular)?;
    (0..count).for_each(|k| values[k] /= scale[k]);
    let rest = rest(target, kept, values.as_slice());
    let freedom = (target.len() as f64 - count as f64).max(1.0);
    let variance = haptical_linalg::dot(&rest, &rest) / freedom;
    let white: Vec<f64> = (0..count)
        .map(|k| variance * half.row(k).norm_squared() / scale[k].powi(2))
        .collect();
    // one over the products of instruments and columns
    let products = DMatrix::from_fn(count, count, |row, k| {
        instruments[row].times(&kept[k]) / (scale[k] * scale[row])
    });
    let inverse = products.try_inverse().ok_or_else(singular)?;
    let scores = long_run(instruments, &rest, rows, &scale);
    let covariance = &inverse * scores * inverse.transpose();
    let grow = target.len() as f64 / freedom;
    let long: Vec<f64> = (0..count)
        .map(|k| grow * covariance[(k, k)] / scale[k].powi(2))
        .collect();
    let mut ratios: Vec<f64> = (long.iter().zip(&white))
        .map(|(long, white)| long / white)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let inflation = ratios.get(count / 2).copied().unwrap_or(1.0).max(1.0);
    if !values.iter().all(|own| own.is_finite()) {
        return Err(singular());
    }
    Ok(Estimate {
        sd: (long.iter().zip(&white))
            .map(|(long, white)| long.max(*white).sqrt())
            .collect(),
        values,
        root: root / variance.sqrt(),
        inflation,
    })
}

/// Long-run covariance of the scores `sum over joints of instrument times rest`, summed over the rows: what a score repeats of the row before is
/// taken off first and put back after (Andrews & Monahan 1992), without which a window is too short for a memory.
fn long_run(instruments: &[Rc<Column>], rest: &[f64], rows: usize, scale: &[f64]) -> DMatrix<f64> {
    let count = instruments.len();
    let mut scores = DMatrix::zeros(count, rows);
    for (k, column) in instruments.iter().enumerate() {
        let (first, values) = column.parts();
        for (at, value) in values.iter().enumerate() {
            scores[(k, (first + at) % rows)] += value * rest[first + at] / scale[k];
        }
    }
    let memories: Vec<f64> = scores.row_iter().map(|own| memory(&own)).collect();
    for (mut own, memory) in scores.row_iter_mut().zip(&memories) {
        for at in (1..rows).rev() {
            own[at] -= memory * own[at - 1];
        }
    }
    let window = window(&scores);
    // sums over a window that moves across the rows: their mean product is Bartlett's estimate
    let mut sums = DMatrix::zeros(count, rows + window - 1);
    let mut sum = DVector::zeros(count);
    for at in 0..rows + window - 1 {
        if at < rows {
            sum += scores.column(at);
        }
        if at >= window {
            sum -= scores.column(at - window);
        }
        sums.set_column(at, &sum);
    }
    for (mut own, memory) in sums.row_iter_mut().zip(&memories) {
        own /= 1.0 - memory;
    }
    let transposed = sums.transpose();
    sums * transposed / window as f64
}

/// Correlation of a score with the row before.
fn memory<S: nalgebra::RawStorage<f64, nalgebra::U1, nalgebra::Dyn>>(
    own: &nalgebra::Matrix<f64, nalgebra::U1, nalgebra::Dyn, S>,
) -> f64 {
    let square: f64 = own.iter().map(|value| value * value).sum();
    let next: f64 = (own.iter().zip(own.iter().skip(1)))
        .map(|(a, b)| a * b)
        .sum();
    (next / square.max(1e-300)).clamp(-MOST_MEMORY, MOST_MEMORY)
}

/// Rows of Bartlett's window, from autoregressions of the scores (Andrews 1991, eq. 6.4).
fn window(scores: &DMatrix<f64>) -> usize {
    let rows = scores.ncols();
    let (mut above, mut below) = (0.0, 0.0);
    for own in scores.row_iter() {
        let memory = memory(&own);
        above += 4.0 * memory.powi(2) / ((1.0 - memory).powi(6) * (1.0 + memory).powi(2));
        below += (1.0 - memory).powi(-4);
    }
    let alpha = above / f64::max(below, 1e-300);
    let width = 1.1447 * (alpha * rows as f64).cbrt();
    (width.ceil() as usize + 1).clamp(1, (rows / 4).max(1))
}
