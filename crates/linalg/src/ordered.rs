//! Independence of columns in an order of preference (Khalil & Dombre 2002, section 10.2.2).
//!
//! The textbook reads it off the diagonal of an un-pivoted QR. Neither a rank-revealing QR (its
//! diagonal no longer belongs to the columns) nor a plain Householder QR of a square triangle (each
//! dependent column uses up one of the few remaining directions) gives that reading, so the columns
//! are orthogonalised one by one, twice each ("twice is enough": Giraud, Langou & Rozložník 2005),
//! and a column whose remainder is negligible is left out and does not use up a direction.

use crate::lanes::{dot, subtract, take_off};
use crate::reduction::at_least_zero;
use crate::{LinalgError, Reduction};

/// Which columns are kept, which vanish, which depend on kept ones.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderedRank {
    /// Independent columns, in the order in which they were offered.
    pub independent: Vec<usize>,
    /// Columns that are zero.
    pub zero: Vec<usize>,
    /// Columns that are combinations of independent ones offered before them.
    pub dependent: Vec<Dependence>,
    /// Smallest remainder of a kept unit-norm column.
    pub smallest_kept: f64,
    /// Largest remainder of a column that was left out (0 if none was).
    pub largest_dropped: f64,
}

/// A column as a combination of kept ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// The column that was left out.
    pub column: usize,
    /// Kept columns and coefficients in unscaled units: column = sum of coefficient times kept.
    pub combination: Vec<(usize, f64)>,
}

/// Coefficients below this share of the largest (both scaled to unit-norm columns) are rounding.
const COEFFICIENT_CUT: f64 = 1e-6;

impl Reduction {
    /// Which columns are independent when they are taken in the given order of preference:
    /// Khalil & Dombre's rule (first come, first kept), judged on unit-norm columns.
    ///
    /// # Errors
    /// [`LinalgError::Column`] for a bad index, [`LinalgError::OutOfRange`] for a bad tolerance,
    /// [`LinalgError::Overflow`] for a coefficient beyond 1e308.
    pub fn ordered_rank(
        &self,
        order: &[usize],
        tolerance: f64,
    ) -> Result<OrderedRank, LinalgError> {
        OrderedColumns::new(self, order, tolerance)?.rank()
    }
}

/// Columns of a reduction that are taken one by one in an order of preference, each judged by what is left of it beside
/// those that were kept before: where one is taken away, only those behind it are judged again.
///
/// ```
/// use haptical_linalg::{Matrix, OrderedColumns, RANK_TOLERANCE, Reduction};
/// // the third is the sum of the others
/// let columns = Matrix::from_fn(3, 3, |row, column| match column {
///     0 => 1.0,
///     1 => row as f64,
///     _ => 1.0 + row as f64,
/// });
/// let reduction = Reduction::new(&columns, &[0.0; 3])?;
/// let mut ordered = OrderedColumns::new(&reduction, &[0, 1, 2], RANK_TOLERANCE)?;
/// assert_eq!(ordered.independent().collect::<Vec<_>>(), [0, 1]);
/// ordered.take_away(1);
/// assert_eq!(ordered.independent().collect::<Vec<_>>(), [0, 2]);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct OrderedColumns<'r> {
    reduction: &'r Reduction,
    tolerance: f64,
    offered: Vec<Offered>,
    basis: Vec<Vec<f64>>,
    /// Column k holds the components of the k-th kept column along the basis: upper triangular.
    triangle: Vec<Vec<f64>>,
    /// Squares of the entries of the triangle's inverse, as far as they were asked for.
    inverse_squares: Vec<Vec<f64>>,
}

#[derive(Debug, Clone)]
struct Offered {
    column: usize,
    outcome: Outcome,
}

#[derive(Debug, Clone)]
enum Outcome {
    Zero,
    Kept,
    /// Components along the basis, and what is left.
    Dropped(Vec<f64>, f64),
}

impl<'r> OrderedColumns<'r> {
    /// Takes the columns of `order`, at unit norm, in this order; a remainder up to the tolerance is none.
    ///
    /// # Errors
    /// [`LinalgError::Column`] for a bad index, [`LinalgError::Empty`] for none, [`LinalgError::OutOfRange`] for a bad
    /// tolerance.
    pub fn new(
        reduction: &'r Reduction,
        order: &[usize],
        tolerance: f64,
    ) -> Result<Self, LinalgError> {
        at_least_zero("tolerance", tolerance)?;
        reduction.check_chosen(order)?;
        let mut ordered = Self {
            reduction,
            tolerance,
            offered: Vec::with_capacity(order.len()),
            basis: Vec::new(),
            triangle: Vec::new(),
            inverse_squares: Vec::new(),
        };
        order.iter().for_each(|&column| ordered.offer(column));
        Ok(ordered)
    }

    /// The reduction whose columns they are.
    pub fn reduction(&self) -> &'r Reduction {
        self.reduction
    }

    /// Remainder up to which a column counts as dependent.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// All that were offered and not taken away.
    pub fn columns(&self) -> impl Iterator<Item = usize> {
        self.offered.iter().map(|offered| offered.column)
    }

    /// Independent columns, in their order.
    pub fn independent(&self) -> impl Iterator<Item = usize> {
        let kept = self.offered.iter();
        let kept = kept.filter(|offered| matches!(offered.outcome, Outcome::Kept));
        kept.map(|offered| offered.column)
    }

    fn offer(&mut self, column: usize) {
        let outcome = self.judged(column);
        self.offered.push(Offered { column, outcome });
    }

    fn judged(&mut self, column: usize) -> Outcome {
        if self.reduction.column_norms[column] == 0.0 {
            return Outcome::Zero;
        }
        let mut remainder = self.reduction.factor.column(column).to_vec();
        let mut components = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            for (direction, component) in self.basis.iter().zip(&mut components) {
                *component += take_off(&mut remainder, direction);
            }
        }
        let size = dot(&remainder, &remainder).sqrt();
        if size > self.tolerance && self.basis.len() < remainder.len() {
            remainder.iter_mut().for_each(|value| *value /= size);
            self.basis.push(remainder);
            components.push(size);
            self.triangle.push(components);
            Outcome::Kept
        } else {
            Outcome::Dropped(components, size)
        }
    }

    /// Takes a column away, as if it had never been offered.
    ///
    /// The triangle of the kept columns behind it is made upper again by plane rotations (Golub & Van Loan, *Matrix
    /// Computations*, section 6.5.2). A column that depended on it is judged again, with all behind that one.
    pub fn take_away(&mut self, column: usize) {
        let place = self.columns().position(|other| other == column);
        let Some(place) = place else {
            return;
        };
        let behind = self.offered.split_off(place);
        if !matches!(behind[0].outcome, Outcome::Kept) {
            self.offered.extend(behind.into_iter().skip(1));
            return;
        }
        let kept = self.independent().count();
        self.inverse_squares.truncate(kept);
        let mut triangle = self.triangle.split_off(kept).into_iter().skip(1);
        let mut basis = self.basis.split_off(kept).into_iter();
        // the direction that no column has any more
        let mut freed = basis.next().unwrap_or_default();
        let mut turns: Vec<[f64; 2]> = Vec::new();
        let mut behind = behind.into_iter().skip(1);
        while let Some(Offered { column, outcome }) = behind.next() {
            let outcome = match outcome {
                Outcome::Zero => Outcome::Zero,
                Outcome::Kept => {
                    let (Some(mut components), Some(mut next)) = (triangle.next(), basis.next())
                    else {
                        return;
                    };
                    turn_all(&turns, &mut components[kept..]);
                    let size = components.pop().unwrap_or_default();
                    let Some(last) = components.last_mut() else {
                        return;
                    };
                    let length = last.hypot(size);
                    let turn = [*last / length, size / length];
                    *last = length;
                    for (a, b) in freed.iter_mut().zip(&mut next) {
                        turned(turn, a, b);
                    }
                    self.basis.push(std::mem::replace(&mut freed, next));
                    self.triangle.push(components);
                    turns.push(turn);
                    Outcome::Kept
                }
                Outcome::Dropped(mut components, size) => {
                    turn_all(&turns, &mut components[kept..]);
                    let size = size.hypot(components.pop().unwrap_or_default());
                    if size > self.tolerance {
                        self.offer(column);
                        behind.for_each(|own| self.offer(own.column));
                        return;
                    }
                    Outcome::Dropped(components, size)
                }
            };
            self.offered.push(Offered { column, outcome });
        }
    }

    /// Squared norms of the rows of the inverse of the independent columns' triangle: their variances for unit noise, at
    /// unit norm.
    pub fn inverse_row_squares(&mut self) -> Vec<f64> {
        for index in self.inverse_squares.len()..self.triangle.len() {
            // R x = e_index has nothing beyond its entry `index`
            let mut solved = vec![0.0; index + 1];
            solved[index] = 1.0;
            solve_triangle(&self.triangle, &mut solved);
            let squares = solved.into_iter().map(|value| value * value);
            self.inverse_squares.push(squares.collect());
        }
        let mut sums = vec![0.0; self.triangle.len()];
        for squares in &self.inverse_squares {
            for (sum, square) in sums.iter_mut().zip(squares) {
                *sum += square;
            }
        }
        sums
    }

    /// What was found.
    ///
    /// # Errors
    /// [`LinalgError::Overflow`] for a coefficient beyond 1e308.
    pub fn rank(&self) -> Result<OrderedRank, LinalgError> {
        let norms = &self.reduction.column_norms;
        let mut result = OrderedRank {
            independent: self.independent().collect(),
            zero: Vec::new(),
            dependent: Vec::new(),
            smallest_kept: f64::INFINITY,
            largest_dropped: 0.0,
        };
        for column in &self.triangle {
            let size = column.last().copied().unwrap_or(f64::INFINITY);
            result.smallest_kept = result.smallest_kept.min(size);
        }
        for Offered { column, outcome } in &self.offered {
            let column = *column;
            match outcome {
                Outcome::Kept => {}
                Outcome::Zero => result.zero.push(column),
                Outcome::Dropped(components, size) => {
                    result.largest_dropped = result.largest_dropped.max(*size);
                    let independent = &result.independent;
                    let own = combination(&self.triangle, components.clone(), independent, norms);
                    let own = own.into_iter();
                    let combination = own.map(|(kept, value)| (kept, value * norms[column]));
                    result.dependent.push(Dependence {
                        column,
                        combination: combination.collect(),
                    });
                }
            }
        }
        let mut coefficients = result.dependent.iter().flat_map(|own| &own.combination);
        if coefficients.any(|(_, value)| !value.is_finite()) {
            return Err(LinalgError::Overflow {
                what: "the coefficient of a dependence",
            });
        }
        Ok(result)
    }
}

/// Turns two numbers in their plane, the first towards the second.
fn turned([cosine, sine]: [f64; 2], a: &mut f64, b: &mut f64) {
    (*a, *b) = (cosine * *a + sine * *b, cosine * *b - sine * *a);
}

/// Turns each number with the one behind it, one after the other.
fn turn_all(turns: &[[f64; 2]], values: &mut [f64]) {
    for (index, turn) in turns.iter().enumerate() {
        if let [a, b, ..] = &mut values[index..] {
            turned(*turn, a, b);
        }
    }
}

/// Solves R x = b of the leading rows of an upper triangle, column by column, in place.
fn solve_triangle(triangle: &[Vec<f64>], values: &mut [f64]) {
    for index in (0..values.len()).rev() {
        let column = &triangle[index];
        let value = values[index] / column[index];
        values[index] = value;
        subtract(&mut values[..index], value, &column[..index]);
    }
}

/// Solves the triangle of kept columns for the components of a dependent one.
fn combination(
    triangle: &[Vec<f64>],
    mut components: Vec<f64>,
    kept: &[usize],
    norms: &[f64],
) -> Vec<(usize, f64)> {
    solve_triangle(triangle, &mut components);
    let largest = components
        .iter()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    components
        .iter()
        .zip(kept)
        .filter(|(value, _)| value.abs() > COEFFICIENT_CUT * largest)
        .map(|(value, &column)| (column, value / norms[column]))
        .collect()
}
