//! Weighted least squares over the rows of groups, and over parts of them.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::group::Group;

/// Pivot of unit columns below which a direction is rounding.
pub(super) const SMALLEST_PIVOT: f64 = 1e-12;
/// Rows that are looked at at once: their columns stay in the processor's cache.
pub(super) const AT_ONCE: usize = 512;
/// Least room that a row leaves its residual: one that the fit follows exactly says nothing of the noise.
pub(super) const LEAST_ROOM: f64 = 0.05;

impl Group {
    /// Products of some of its rows' columns over their sizes with each other and with the readings.
    pub(super) fn products(
        &self,
        places: impl ExactSizeIterator<Item = usize>,
        sizes: &[f64],
    ) -> Products {
        let count = self.basis.ncols();
        let mut found = Products {
            rows: places.len(),
            gram: DMatrix::zeros(count, count),
            along: DVector::zeros(count),
        };
        let places: Vec<usize> = places.collect();
        for places in places.chunks(AT_ONCE) {
            let weighted = DMatrix::from_fn(places.len(), count, |k, column| {
                self.basis[(places[k], column)] / sizes[places[k]]
            });
            let readings = DVector::from_fn(places.len(), |k, _| {
                self.readings[places[k]] / sizes[places[k]]
            });
            let across = weighted.transpose();
            found.gram.gemm(1.0, &across, &weighted, 1.0);
            found.along.gemv(1.0, &across, &readings, 1.0);
        }
        found
    }
}

/// Products of some rows of a group.
pub(super) struct Products {
    rows: usize,
    gram: DMatrix<f64>,
    along: DVector<f64>,
}

impl Products {
    /// The same of no row.
    pub(super) fn none(&self) -> Self {
        let count = self.along.len();
        Self {
            rows: 0,
            gram: DMatrix::zeros(count, count),
            along: DVector::zeros(count),
        }
    }

    /// The same with further rows, all of whose sizes are `size` times theirs.
    pub(super) fn add(&mut self, other: &Self, size: f64) {
        let weight = 1.0 / (size * size);
        self.rows += other.rows;
        self.gram
            .zip_apply(&other.gram, |sum, more| *sum += weight * more);
        self.along.axpy(weight, &other.along, 1.0);
    }

    /// Room that a solution leaves these rows, all of whose sizes are `size` times theirs.
    pub(super) fn room(&self, solved: &GroupSolved, size: f64) -> f64 {
        let rows = self.rows as f64;
        let shares = solved.covariance.dot(&self.gram);
        (rows - shares / (size * size)).max(LEAST_ROOM * rows)
    }
}

/// Normal equations of all parameters.
#[derive(Clone)]
pub(super) struct Normal {
    gram: DMatrix<f64>,
    along: DVector<f64>,
}

impl Normal {
    pub(super) fn new(parameters: usize) -> Self {
        Self {
            gram: DMatrix::zeros(parameters, parameters),
            along: DVector::zeros(parameters),
        }
    }

    /// With rows of a group.
    pub(super) fn add(&mut self, group: &Group, products: &Products) {
        let way = &group.coordinates;
        self.gram += way.tr_mul(&(&products.gram * way));
        self.along += way.tr_mul(&products.along);
    }

    /// Their solution; none where they are not of full rank.
    pub(super) fn solved(self) -> Option<Solved> {
        let inverse = inverse_factor(self.gram)?;
        let coordinates = inverse.tr_mul(&(&inverse * &self.along));
        Some(Solved {
            inverse,
            coordinates,
        })
    }
}

/// A weighted fit.
pub(super) struct Solved {
    /// The inverse of the lower Cholesky factor of its normal matrix.
    inverse: DMatrix<f64>,
    coordinates: DVector<f64>,
}

impl Solved {
    pub(super) fn of_group(&self, group: &Group) -> GroupSolved {
        let spanned = &self.inverse * group.coordinates.transpose();
        GroupSolved {
            coordinates: &group.coordinates * &self.coordinates,
            covariance: spanned.tr_mul(&spanned),
        }
    }
}

/// A weighted fit in the coordinates of a group.
pub(super) struct GroupSolved {
    coordinates: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl GroupSolved {
    /// Residuals over sizes.
    pub(super) fn scaled_residuals(&self, group: &Group, sizes: &[f64]) -> Vec<f64> {
        let mut rest = DVector::from_column_slice(&group.readings);
        for first in (0..sizes.len()).step_by(AT_ONCE) {
            let count = AT_ONCE.min(sizes.len() - first);
            let basis = group.basis.rows(first, count);
            rest.rows_mut(first, count)
                .gemv(-1.0, &basis, &self.coordinates, 1.0);
        }
        let each = rest.iter().zip(sizes);
        each.map(|(rest, size)| rest / size).collect()
    }

    pub(super) fn rooms(&self, group: &Group, sizes: &[f64]) -> Vec<f64> {
        let mut rooms = Vec::with_capacity(sizes.len());
        for first in (0..sizes.len()).step_by(AT_ONCE) {
            let sizes = &sizes[first..(first + AT_ONCE).min(sizes.len())];
            let basis = group.basis.rows(first, sizes.len());
            let shares = row_products(&basis.into_owned(), &self.covariance);
            let each = shares.iter().zip(sizes);
            rooms.extend(each.map(|(share, size)| (1.0 - share / (size * size)).max(LEAST_ROOM)));
        }
        rooms
    }
}

/// Scaled residuals of a group, and their rooms.
pub(super) struct Scaled {
    pub(super) residuals: Vec<f64>,
    pub(super) rooms: Vec<f64>,
}

/// x M x^T of every row x.
pub(super) fn row_products(rows: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Vec<f64> {
    let moved = rows * matrix;
    let mut products = vec![0.0; rows.nrows()];
    for (column, moved) in rows.column_iter().zip(moved.column_iter()) {
        for ((product, a), b) in products.iter_mut().zip(column.iter()).zip(moved.iter()) {
            *product += a * b;
        }
    }
    products
}

/// The inverse of the lower Cholesky factor; none for a matrix that is not of full rank.
pub(super) fn inverse_factor(gram: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = gram.nrows();
    let diagonal: Vec<f64> = (0..count).map(|k| gram[(k, k)]).collect();
    let factor = Cholesky::new(gram)?.unpack();
    let is_sound = |k: usize| factor[(k, k)].powi(2) > SMALLEST_PIVOT * diagonal[k];
    if !(0..count).all(is_sound) {
        return None;
    }
    factor.solve_lower_triangular(&DMatrix::identity(count, count))
}
