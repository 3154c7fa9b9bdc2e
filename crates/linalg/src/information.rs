//! What the rows of a fit say of a row that the fit did not see.

use crate::dot;

/// A column of which no more than this share of the square lies across those before it is not told apart from them.
const DEPENDENT: f64 = 1e-8;

/// Leverage up to which a row is predicted. At 1 the error of the fit scatters a prediction as much as noise scatters the reading
/// itself, and in a fit that saw the row the reading would have as large a say in its own prediction as all others together
/// (Hoaglin and Welsch 1978, The American Statistician 32: a leverage of 1/2).
pub const MOST_LEVERAGE: f64 = 1.0;

/// Products of the whitened columns of a fit, with what is known of their coefficients beforehand: how well the fit
/// determines a prediction at any other row.
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
    /// Lengths of the columns.
    scale: Vec<f64>,
    /// Rows of the lower factor of the scaled products; a zero on the diagonal is a column that is not told apart.
    factor: Vec<Vec<f64>>,
}

impl Information {
    /// Products of `count` columns, by their numbers; those that are known add one over their variance to their square.
    pub fn new(count: usize, product: impl Fn(usize, usize) -> f64) -> Self {
        let scale: Vec<f64> = (0..count).map(|k| product(k, k).sqrt()).collect();
        let mut factor: Vec<Vec<f64>> = Vec::with_capacity(count);
        for a in 0..count {
            let mut row = vec![0.0; a + 1];
            if scale[a] > 0.0 {
                for (b, other) in factor.iter().enumerate().filter(|(b, own)| own[*b] != 0.0) {
                    let scaled = product(a, b) / (scale[a] * scale[b]);
                    row[b] = (scaled - dot(&row[..b], &other[..b])) / other[b];
                }
                let left = 1.0 - dot(&row[..a], &row[..a]);
                if left > DEPENDENT {
                    row[a] = left.sqrt();
                }
            }
            factor.push(row);
        }
        Self { scale, factor }
    }

    /// Variance of the prediction at a row, over that of its noise, by the error of the fit: `x' (X'X + K)^-1 x`. The row is
    /// whitened as the fit's are. Along what the fit's rows do not tell apart, nothing is known.
    pub fn leverage(&self, row: impl Fn(usize) -> f64) -> f64 {
        let mut found = vec![0.0; self.scale.len()];
        let mut sum = 0.0;
        for (a, own) in self.factor.iter().enumerate() {
            let entry = row(a);
            if self.scale[a] == 0.0 && entry == 0.0 {
                continue;
            }
            let left = entry / self.scale[a] - dot(&own[..a], &found[..a]);
            let pivot = own[a];
            sum += match pivot == 0.0 {
                true => left * left / DEPENDENT,
                false => {
                    found[a] = left / pivot;
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
