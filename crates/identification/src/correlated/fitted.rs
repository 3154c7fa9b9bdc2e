//! Least squares over the products of all bands, with or without a line in time for every signal.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::bands::SignalBands;
use super::least_squares::{AT_ONCE, LEAST_ROOM, inverse_factor, row_products};
use super::problem::OrderedProblem;
use super::rows::{Rows, along};

/// A fit of all signals together.
pub(super) struct Fitted {
    /// Coordinates of the basis, then the lines.
    pub(super) values: DVector<f64>,
    /// The same of what held parameters add to the readings, a column each.
    held: DMatrix<f64>,
    /// Inverse of the lower Cholesky factor of the normal matrix.
    pub(super) inverse_factor: DMatrix<f64>,
    /// Sum of squares that is left.
    pub(super) rest: f64,
    /// The part of it that errors of earlier steps are expected to have.
    leaked: f64,
    /// Unknown of each signal's line.
    pub(super) line_of_signal: Vec<Option<usize>>,
    rows: f64,
    parameters: usize,
}

impl Fitted {
    pub(super) fn new(bands: &[SignalBands], rows: &Rows, with_lines: bool) -> Option<Self> {
        let parameters = rows.parameters();
        let mut unknowns = parameters;
        let mut line = |signal: &SignalBands| {
            (with_lines && signal.may_have_line).then(|| {
                unknowns += 1;
                unknowns - 1
            })
        };
        let line_of_signal: Vec<Option<usize>> = bands.iter().map(&mut line).collect();
        let held = rows.held();
        let mut normal = DMatrix::zeros(unknowns, unknowns);
        let mut rhs = DMatrix::zeros(unknowns, 1 + held);
        let mut square = 0.0;
        for (signal, &line) in bands.iter().zip(&line_of_signal) {
            let places = places(parameters, line);
            for gram in &signal.grams {
                for &(own, at) in &places {
                    for &(other, column) in &places {
                        normal[(at, column)] += gram[(own, other)];
                    }
                    for column in 0..=held {
                        rhs[(at, column)] += gram[(own, parameters + 1 + column)];
                    }
                }
                square += gram[(parameters + 1, parameters + 1)];
            }
        }
        let inverse_factor = inverse_factor(normal)?;
        let turned = &inverse_factor * rhs;
        let solved = inverse_factor.tr_mul(&turned);
        let rest = square - turned.column(0).norm_squared();
        let mut fitted = Self {
            values: solved.column(0).into_owned(),
            held: solved.columns(1, held).into_owned(),
            inverse_factor,
            rest,
            leaked: 0.0,
            line_of_signal,
            rows: bands.iter().flat_map(|signal| &signal.modes).sum(),
            parameters,
        };
        for (signal, &line) in bands.iter().zip(&fitted.line_of_signal) {
            let of_bands = signal.grams.iter().map(|gram| {
                let left = fitted.left(gram, line);
                rows.leaked(&left.view((1, 1), (held, held)).into_owned())
            });
            fitted.leaked += of_bands.sum::<f64>();
        }
        (rest > 0.0 && fitted.degrees_of_freedom() >= 1.0).then_some(fitted)
    }

    /// Variance of the noise, of one size and without memory.
    pub(super) fn variance(&self) -> f64 {
        let own = (self.rest - self.leaked).max(LEAST_SHARE * self.rest);
        own / self.degrees_of_freedom()
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

    /// The change of the parameters with held ones.
    pub(super) fn follows(&self, rows: &Rows) -> DMatrix<f64> {
        -(&rows.to_parameters * self.held.rows(0, self.parameters))
    }

    /// The products of one band with orthonormal unknowns, and those of what the fit leaves in it: of the readings, then of
    /// what held parameters add.
    pub(super) fn band(&self, gram: &DMatrix<f64>, line: Option<usize>) -> [DMatrix<f64>; 2] {
        let places = places(self.parameters, line);
        let count = places.len();
        let own = DMatrix::from_fn(count, count, |a, b| gram[(places[a].0, places[b].0)]);
        let way = DMatrix::from_fn(self.unknowns(), count, |row, k| {
            self.inverse_factor[(row, places[k].1)]
        });
        [&way * own * way.transpose(), self.left(gram, line)]
    }

    fn left(&self, gram: &DMatrix<f64>, line: Option<usize>) -> DMatrix<f64> {
        let places = places(self.parameters, line);
        let (count, held) = (places.len(), self.held.ncols());
        let own = DMatrix::from_fn(count, count, |a, b| gram[(places[a].0, places[b].0)]);
        let values = DMatrix::from_fn(count, 1 + held, |k, column| match column.checked_sub(1) {
            None => self.values[places[k].1],
            Some(column) => self.held[(places[k].1, column)],
        });
        let first = self.parameters + 1;
        let mixed = DMatrix::from_fn(count, 1 + held, |k, column| {
            gram[(places[k].0, first + column)]
        });
        let apart = gram.view((first, first), (1 + held, 1 + held));
        let crossed = values.tr_mul(&mixed);
        apart - &crossed - crossed.transpose() + values.tr_mul(&(own * &values))
    }

    /// Variances of the parameters by the usual formula, and by one that lets every row have its own size (HC2).
    pub(super) fn variances(
        &self,
        rows: &Rows,
        problem: &OrderedProblem<'_>,
        sizes: &[Vec<f64>],
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        let mut meat = DMatrix::zeros(self.unknowns(), self.unknowns());
        for (index, (group, sizes)) in rows.groups.iter().zip(sizes).enumerate() {
            // columns of the group's basis, then of its signals' lines, by the unknowns
            let lines = self.line_of_signal.iter().zip(problem.signals);
            let lines = lines
                .zip(&rows.places)
                .filter_map(|((line, signal), places)| {
                    let line = (*line).filter(|_| signal.group == index)?;
                    Some((line, places))
                });
            let lines: Vec<(usize, &Range<usize>)> = lines.collect();
            let columns = group.basis.ncols();
            let mut way = DMatrix::zeros(columns + lines.len(), self.unknowns());
            way.view_mut((0, 0), (columns, self.parameters))
                .copy_from(&group.coordinates);
            for (k, &(line, _)) in lines.iter().enumerate() {
                way[(columns + k, line)] = 1.0;
            }
            let values = &way * &self.values;
            let spanned = &self.inverse_factor * way.transpose();
            let covariance = spanned.tr_mul(&spanned);
            let mut products = DMatrix::zeros(way.nrows(), way.nrows());
            for first in (0..sizes.len()).step_by(AT_ONCE) {
                let sizes = &sizes[first..(first + AT_ONCE).min(sizes.len())];
                let entry = |row: usize, column: usize| {
                    let place = first + row;
                    let entry = match column.checked_sub(columns) {
                        None => group.basis[(place, column)],
                        Some(k) if lines[k].1.contains(&place) => {
                            along(place - lines[k].1.start, lines[k].1.len())
                        }
                        Some(_) => 0.0,
                    };
                    entry / sizes[row]
                };
                let mut part = DMatrix::from_fn(sizes.len(), way.nrows(), entry);
                let shares = row_products(&part, &covariance);
                let made = &part * &values;
                for (row, size) in sizes.iter().enumerate() {
                    let rest = group.readings[first + row] / size - made[row];
                    let room = (1.0 - shares[row]).max(LEAST_ROOM);
                    part.row_mut(row).scale_mut(rest / room.sqrt());
                }
                products.gemm(1.0, &part.transpose(), &part, 1.0);
            }
            meat += &spanned * products * spanned.transpose();
        }
        let count = self.parameters;
        let way = self.to_parameters(rows);
        let usual = self.variance();
        let usual = DVector::from_fn(count, |k, _| usual * way.row(k).norm_squared());
        let moved = &way * meat;
        let each = DVector::from_fn(count, |k, _| moved.row(k).dot(&way.row(k)));
        let is_sound =
            |variances: &DVector<f64>| variances.iter().all(|v| v.is_finite() && *v > 0.0);
        (is_sound(&usual) && is_sound(&each)).then_some((usual, each))
    }
}

/// Least share of what is left that is the noise's own: the difference of two estimates may come out at zero.
pub(super) const LEAST_SHARE: f64 = 0.05;

/// Columns of a band's products and the unknowns that they belong to.
fn places(parameters: usize, line: Option<usize>) -> Vec<(usize, usize)> {
    let own = (0..parameters).map(|k| (k, k));
    own.chain(line.map(|line| (parameters, line))).collect()
}
