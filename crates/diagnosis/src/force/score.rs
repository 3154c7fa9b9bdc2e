//! What a candidate would explain beside the base columns.

use nalgebra::{DMatrix, DVector};

use super::columns::{Term, Values};
use super::normal::Normal;
use crate::engine::system::dot;

/// Squared share of a direction that must survive the base columns.
const SURVIVING: f64 = 1e-6;

/// Products of a candidate's columns.
#[derive(Debug, Clone)]
pub(super) struct Products {
    pub(super) terms: Vec<Term>,
    pub(super) own: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    /// Base columns by candidate columns.
    cross: Vec<DVector<f64>>,
}

/// What a candidate explains.
#[derive(Debug, Clone)]
pub(super) struct Score {
    /// Chi-square with `rank` under noise.
    pub(super) score: f64,
    pub(super) rank: usize,
    pub(super) amplitudes: Vec<f64>,
    /// Share of its columns that the base leaves, the largest direction.
    pub(super) retained: f64,
}

impl Products {
    /// Forgets products with base columns from `count` on.
    pub(super) fn forget(&mut self, count: usize) {
        self.cross.truncate(count);
    }
}

impl Normal<'_> {
    /// Products with one base column.
    pub(super) fn with_known(&self, index: usize, term: &Term) -> f64 {
        let column = &self.known[index];
        let slow = match (&term.values, column.releases) {
            (Values::All(values), _) => dot(values, &column.weighed),
            (Values::Channel(channel, values), _) => {
                let blocks = self.weights.blocks;
                dot(
                    values,
                    &column.weighed[channel * blocks..(channel + 1) * blocks],
                )
            }
            // the prior's row: the released column and other releases of it
            (Values::Release(base), None) if *base == index => column.prior,
            (Values::Release(base), Some(other)) if *base == other => self.known[other].prior,
            (Values::Release(_), _) => 0.0,
        };
        slow + self.fast.product(term.fast, column.fast)
    }

    /// Products of a candidate with itself, the reading and the base.
    pub(super) fn products(&self, terms: Vec<Term>) -> Products {
        let count = terms.len();
        let mut own = DMatrix::zeros(count, count);
        let weighed: Vec<Option<Vec<f64>>> = terms
            .iter()
            .map(|term| match &term.values {
                Values::All(values) => Some(self.weights.weigh(values)),
                _ => None,
            })
            .collect();
        for a in 0..count {
            for b in 0..=a {
                let slow = match (&terms[a].values, &terms[b].values) {
                    (Values::All(values), _) if weighed[b].is_some() => {
                        weighed[b].as_ref().map_or(0.0, |other| dot(values, other))
                    }
                    (Values::Channel(channel, x), Values::Channel(other, y))
                        if channel == other =>
                    {
                        self.weights.own(*channel, x, y)
                    }
                    (Values::Release(x), Values::Release(y)) if x == y => self.known[*x].prior,
                    _ => 0.0,
                };
                let product = slow + self.fast.product(terms[a].fast, terms[b].fast);
                own[(a, b)] = product;
                own[(b, a)] = product;
            }
        }
        let blocks = self.weights.blocks;
        let right = terms.iter().map(|term| {
            let slow = match &term.values {
                Values::All(values) => dot(values, &self.weighed_reading),
                Values::Channel(channel, values) => dot(
                    values,
                    &self.weighed_reading[channel * blocks..(channel + 1) * blocks],
                ),
                Values::Release(_) => 0.0,
            };
            slow + self.fast.right(term.fast)
        });
        let mut products = Products {
            own,
            right: DVector::from_iterator(count, right),
            cross: Vec::with_capacity(self.columns()),
            terms,
        };
        self.extend(&mut products);
        products
    }

    /// Catches up with base columns that were added.
    pub(super) fn extend(&self, products: &mut Products) {
        for index in products.cross.len()..self.columns() {
            let entries = products
                .terms
                .iter()
                .map(|term| self.with_known(index, term));
            let entries = DVector::from_iterator(products.terms.len(), entries);
            products.cross.push(entries);
        }
    }

    /// What a candidate would explain beside the base.
    pub(super) fn score(&self, products: &Products) -> Score {
        let count = products.terms.len();
        let mut result = Score {
            score: 0.0,
            rank: 0,
            amplitudes: vec![0.0; count],
            retained: 0.0,
        };
        let norms: Vec<f64> = (0..count)
            .map(|k| products.own[(k, k)].max(0.0).sqrt())
            .collect();
        if norms.iter().any(|norm| !norm.is_finite()) {
            return result;
        }
        let scale = |k: usize| if norms[k] > 0.0 { 1.0 / norms[k] } else { 0.0 };
        let cross = DMatrix::from_fn(self.columns(), count, |row, k| products.cross[row][k]);
        let mut gram = products.own.clone();
        let mut right = products.right.clone();
        for column in 0..count {
            let taken = self.inverse_times(&cross.column(column).into_owned());
            for row in 0..count {
                gram[(row, column)] -= cross.column(row).dot(&taken);
            }
            right[column] -= cross.column(column).dot(&self.solution);
        }
        for column in 0..count {
            right[column] *= scale(column);
            for row in 0..count {
                gram[(row, column)] *= scale(row) * scale(column);
            }
        }
        let symmetric = (&gram + gram.transpose()) * 0.5;
        let eigen = symmetric.symmetric_eigen();
        let mut amplitudes = DVector::zeros(count);
        for k in 0..count {
            let value = eigen.eigenvalues[k];
            result.retained = result.retained.max(value.max(0.0).sqrt());
            if value <= SURVIVING {
                continue;
            }
            let direction = eigen.eigenvectors.column(k);
            let along = direction.dot(&right);
            result.score += along * along / value;
            result.rank += 1;
            amplitudes += direction * (along / value);
        }
        for k in 0..count {
            result.amplitudes[k] = amplitudes[k] * scale(k);
        }
        result
    }
}
