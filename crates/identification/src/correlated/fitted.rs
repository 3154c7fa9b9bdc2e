//! Least squares over the products of all bands, with or without a line in time for every signal.

use nalgebra::{DMatrix, DVector};

use super::bands::SignalBands;
use super::rows::{Rows, inverse_factor};
use super::unmixed::Unmixed;

/// A fit of all signals together.
pub(super) struct Fitted {
    /// Coordinates of the basis, then the lines.
    pub(super) values: DVector<f64>,
    /// Inverse of the lower Cholesky factor of the normal matrix.
    pub(super) inverse_factor: DMatrix<f64>,
    /// Sum of squares that is left.
    pub(super) rest: f64,
    /// Unknown of each signal's line.
    pub(super) line_of_signal: Vec<Option<usize>>,
    rows: f64,
    parameters: usize,
}

impl Fitted {
    pub(super) fn new(bands: &[SignalBands], rows: &Rows, with_lines: bool) -> Option<Self> {
        let parameters = rows.basis.ncols();
        let mut unknowns = parameters;
        let mut line = |signal: &SignalBands| {
            (with_lines && signal.is_long).then(|| {
                unknowns += 1;
                unknowns - 1
            })
        };
        let line_of_signal: Vec<Option<usize>> = bands.iter().map(&mut line).collect();
        let mut normal = DMatrix::zeros(unknowns, unknowns);
        let mut rhs = DVector::zeros(unknowns);
        let mut square = 0.0;
        for (signal, &line) in bands.iter().zip(&line_of_signal) {
            let places = places(parameters, line);
            for gram in &signal.grams {
                for &(own, at) in &places {
                    for &(other, column) in &places {
                        normal[(at, column)] += gram[(own, other)];
                    }
                    rhs[at] += gram[(own, parameters + 1)];
                }
                square += gram[(parameters + 1, parameters + 1)];
            }
        }
        let inverse_factor = inverse_factor(normal)?;
        let turned = &inverse_factor * rhs;
        let values = inverse_factor.tr_mul(&turned);
        let rest = square - turned.norm_squared();
        let fitted = Self {
            values,
            inverse_factor,
            rest,
            line_of_signal,
            rows: bands.iter().flat_map(|signal| &signal.modes).sum(),
            parameters,
        };
        (rest > 0.0 && fitted.degrees_of_freedom() >= 1.0).then_some(fitted)
    }

    pub(super) fn unknowns(&self) -> usize {
        self.values.len()
    }

    pub(super) fn degrees_of_freedom(&self) -> f64 {
        self.rows - self.unknowns() as f64
    }

    /// Parameters by orthonormal coordinates of the unknowns.
    pub(super) fn to_parameters(&self, rows: &Rows) -> DMatrix<f64> {
        let own = self.inverse_factor.columns(0, self.parameters);
        &rows.to_parameters * own.transpose()
    }

    /// Covariance of the parameters for noise of the stated size.
    pub(super) fn covariance(&self, rows: &Rows) -> DMatrix<f64> {
        let way = self.to_parameters(rows);
        &way * way.transpose()
    }

    /// Change of the parameters.
    pub(super) fn step(&self, rows: &Rows) -> DVector<f64> {
        &rows.to_parameters * self.values.rows(0, self.parameters)
    }

    /// Change of each signal over the log by its line; empty without lines.
    pub(super) fn lines(&self) -> Vec<f64> {
        let lines = self.line_of_signal.iter();
        if self.unknowns() == self.parameters {
            return Vec::new();
        }
        lines
            .map(|line| line.map_or(0.0, |line| self.values[line]))
            .collect()
    }

    /// The products of one band with orthonormal unknowns, and the power that the fit leaves in it.
    pub(super) fn band(&self, gram: &DMatrix<f64>, line: Option<usize>) -> (DMatrix<f64>, f64) {
        let places = places(self.parameters, line);
        let count = places.len();
        let own = DMatrix::from_fn(count, count, |a, b| gram[(places[a].0, places[b].0)]);
        let way = DMatrix::from_fn(self.unknowns(), count, |row, k| {
            self.inverse_factor[(row, places[k].1)]
        });
        let values = DVector::from_fn(count, |k, _| self.values[places[k].1]);
        let readings = self.parameters + 1;
        let with_readings = DVector::from_fn(count, |k, _| gram[(places[k].0, readings)]);
        let power = gram[(readings, readings)] - 2.0 * values.dot(&with_readings)
            + values.dot(&(&own * &values));
        (&way * own * way.transpose(), power.max(0.0))
    }

    pub(super) fn unmixed(&self, bands: &[SignalBands]) -> Unmixed {
        Unmixed::new(self, bands)
    }
}

/// Columns of a band's products and the unknowns that they belong to.
fn places(parameters: usize, line: Option<usize>) -> Vec<(usize, usize)> {
    let own = (0..parameters).map(|k| (k, k));
    own.chain(line.map(|line| (parameters, line))).collect()
}
