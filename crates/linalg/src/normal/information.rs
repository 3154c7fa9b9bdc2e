//! Products of the columns of a fit, factored: its solutions, and what its rows say of a row that it did not see.

use crate::dot;

/// A column of which no more than this share of the square lies across those before it is not told apart from them.
const DEPENDENT: f64 = 1e-8;

/// Sum of products: results that were recorded depend on the order in which it adds.
pub(crate) trait Dot: Fn(&[f64], &[f64]) -> f64 {}

impl<F: Fn(&[f64], &[f64]) -> f64> Dot for F {}

/// Leverage up to which a row is predicted. At 1 the error of the fit scatters a prediction as much as noise scatters the reading
/// itself, and in a fit that saw the row the reading would have as large a say in its own prediction as all others together
/// (Hoaglin and Welsch 1978, The American Statistician 32: a leverage of 1/2).
pub const MOST_LEVERAGE: f64 = 1.0;

/// Products of the whitened columns of a fit, with what is known of their coefficients beforehand: how well the fit
/// determines a prediction at any other row. A dependent column has the coefficient 0.
///
/// ```
/// use haptical_linalg::Information;
/// // a line fitted to readings at 0, 1, 2 and 3: 1/4 + (t - 1.5)^2 / 5
/// let products = [[4.0, 6.0], [6.0, 14.0]];
/// let line = Information::new(2, |a, b| products[a][b]);
/// let leverage = |t: f64| line.leverage(|column| [1.0, t][column]);
/// assert!((leverage(1.5) - 0.25).abs() < 1e-12 && (leverage(4.0) - 1.5).abs() < 1e-12);
/// assert!(line.determines(|column| [1.0, 3.0][column]));
/// assert!(!line.determines(|column| [1.0, 4.0][column]));
/// // nothing says how far a second reading of nothing moves
/// let nothing = Information::new(1, |_, _| 0.0);
/// assert!(nothing.determines(|_| 0.0) && !nothing.determines(|_| 1e-9));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// Lengths of the columns, by which the factor's were divided.
    scale: Vec<f64>,
    /// Lower Cholesky factor of the scaled products, row by row; a zero on the diagonal is a dependent column.
    factor: Vec<f64>,
}

impl Information {
    /// Share of its square below which a column is not told apart from those before it.
    pub const DEPENDENT: f64 = DEPENDENT;

    /// Products of `count` columns, by their numbers; those that are known add one over their variance to their square.
    pub fn new(count: usize, product: impl Fn(usize, usize) -> f64) -> Self {
        Self::scaled(count, DEPENDENT, product, dot)
    }

    /// Products of what other columns leave of some; `squares` are those of the whole columns, with which what is left is compared:
    /// more than the share `dependent` of it, [`Self::DEPENDENT`] at least, is left of a column that counts.
    pub fn of_rests(
        squares: &[f64],
        dependent: f64,
        product: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let least = |k| dependent.max(DEPENDENT) * squares[k];
        Self::factored(vec![1.0; squares.len()], least, product, dot)
    }

    /// Of columns that are scaled to length 1; more than `dependent` of a square is left of a column that counts.
    pub(crate) fn scaled(
        count: usize,
        dependent: f64,
        product: impl Fn(usize, usize) -> f64,
        dot: impl Dot,
    ) -> Self {
        let length = |k: usize| product(k, k).max(1e-300).sqrt();
        let scale = (0..count).map(length).collect();
        Self::factored(scale, |_| dependent, product, dot)
    }

    fn factored(
        scale: Vec<f64>,
        least: impl Fn(usize) -> f64,
        product: impl Fn(usize, usize) -> f64,
        dot: impl Dot,
    ) -> Self {
        let count = scale.len();
        let mut factor = vec![0.0; count * count];
        for a in 0..count {
            let (above, row) = factor.split_at_mut(a * count);
            for b in 0..a {
                let other = &above[b * count..b * count + b + 1];
                if other[b] != 0.0 {
                    let entry = product(a, b) / (scale[a] * scale[b]);
                    row[b] = (entry - dot(&row[..b], &other[..b])) / other[b];
                }
            }
            let left = product(a, a) / (scale[a] * scale[a]) - dot(&row[..a], &row[..a]);
            if left > least(a) {
                row[a] = left.sqrt();
            }
        }
        Self { scale, factor }
    }

    /// The factor's row up to the diagonal.
    fn row(&self, column: usize) -> &[f64] {
        let first = column * self.scale.len();
        &self.factor[first..=first + column]
    }

    /// Whether a column differs from those before it.
    pub fn is_independent(&self, column: usize) -> bool {
        self.row(column)[column] != 0.0
    }

    /// Forward substitution: what is along the columns, each made orthogonal to those before it.
    pub fn along(&self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        self.along_by(dot, right)
    }

    pub(crate) fn along_by(&self, dot: impl Dot, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut solved = vec![0.0; self.scale.len()];
        for a in 0..solved.len() {
            let row = self.row(a);
            if row[a] != 0.0 {
                solved[a] = (right(a) / self.scale[a] - dot(&row[..a], &solved[..a])) / row[a];
            }
        }
        solved
    }

    /// Coefficients of the columns out of what is [along](Self::along) them.
    pub fn coefficients(&self, mut along: Vec<f64>) -> Vec<f64> {
        for a in (0..along.len()).rev() {
            let row = self.row(a);
            if row[a] == 0.0 {
                along[a] = 0.0;
                continue;
            }
            let value = along[a] / row[a];
            along[a] = value / self.scale[a];
            let before = along[..a].iter_mut().zip(row);
            before.for_each(|(other, entry)| *other -= value * entry);
        }
        along
    }

    /// A column of the inverse: the coefficient's covariances for noise of unit size. Zero of a dependent column.
    pub fn inverse(&self, column: usize) -> Vec<f64> {
        self.coefficients(self.along(|k| f64::from(u8::from(k == column))))
    }

    /// Variance of the prediction at a row, over that of its noise, by the error of the fit: `x' (X'X + K)^-1 x`. The row is
    /// whitened as the fit's are. Along what the fit's rows do not tell apart, nothing is known.
    pub fn leverage(&self, row: impl Fn(usize) -> f64) -> f64 {
        let mut found = vec![0.0; self.scale.len()];
        let mut sum = 0.0;
        for a in 0..found.len() {
            let own = self.row(a);
            let left = row(a) / self.scale[a] - dot(&own[..a], &found[..a]);
            sum += match own[a] == 0.0 {
                true => left * left / DEPENDENT,
                false => {
                    found[a] = left / own[a];
                    found[a] * found[a]
                }
            };
        }
        sum
    }

    /// Whether the fit determines the prediction at a row.
    pub fn determines(&self, row: impl Fn(usize) -> f64) -> bool {
        // not so of what is no number
        self.leverage(row) <= MOST_LEVERAGE
    }
}
