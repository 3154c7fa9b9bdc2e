//! The score scan: how much each effect of the catalogue would explain, the base model's freedom and the causes found so far projected out
//! (docs/diagnosis.md, "Score scan").

use haptical_effects::{Context, Effect, Shape, Signal};
use nalgebra::{DMatrix, DVector};

use crate::engine::{Cause, Column, Layout, System, dot};
use crate::thresholds::engine::ROUNDING;

/// An effect at one shape, with its whitened columns.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// Position in the catalogue.
    pub(crate) effect: usize,
    pub(crate) shape: f64,
    pub(crate) columns: Vec<Column>,
    /// Products with the system's basis, per column.
    coefficients: Vec<Vec<f64>>,
    /// Products of the columns with each other.
    own: DMatrix<f64>,
}

impl From<&Score> for Cause {
    fn from(score: &Score) -> Self {
        Self {
            effect: score.effect,
            amplitudes: score.amplitudes.clone(),
            shape: score.shape,
            times: score.times.clone(),
        }
    }
}

/// What a candidate explains.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    /// Position in the catalogue.
    pub(crate) effect: usize,
    pub(crate) shape: f64,
    /// Explained part of the squared residual; chi-square with `rank` under noise.
    pub(crate) score: f64,
    pub(crate) rank: usize,
    pub(crate) amplitudes: Vec<f64>,
    /// Of an event: one instant for each amplitude.
    pub(crate) times: Vec<f64>,
    /// Share of the column that the base model does not swallow.
    pub(crate) retained: f64,
    /// Amplitude at which the score's expectation is 1 (largest direction).
    pub(crate) unit_amplitude: f64,
}

impl Score {
    /// A cause as a scan would have listed it.
    pub(crate) fn of_cause(cause: &Cause, gained: f64) -> Self {
        Self {
            effect: cause.effect,
            shape: cause.shape,
            score: gained,
            rank: cause.amplitudes.len(),
            amplitudes: cause.amplitudes.clone(),
            times: cause.times.clone(),
            retained: 1.0,
            unit_amplitude: 1.0,
        }
    }
}

impl Candidate {
    pub(crate) fn new(
        system: &System,
        context: &Context<'_>,
        effect: &dyn Effect,
        index: usize,
        amplitudes: &[f64],
        shape: f64,
    ) -> Self {
        let signals = effect.derivative(context, amplitudes, shape);
        Self::of_signals(system, &signals, index, shape)
    }

    pub(crate) fn of_signals(
        system: &System,
        signals: &[Signal],
        index: usize,
        shape: f64,
    ) -> Self {
        let columns = signals.iter().map(|signal| system.column(signal)).collect();
        Self::of_columns(system, columns, index, shape)
    }

    pub(crate) fn of_columns<L: Layout>(
        system: &System<L>,
        columns: Vec<Column>,
        index: usize,
        shape: f64,
    ) -> Self {
        let count = columns.len();
        let own = DMatrix::from_fn(count, count, |a, b| product(&columns[a], &columns[b]));
        let mut candidate = Self {
            effect: index,
            shape,
            coefficients: vec![Vec::with_capacity(system.basis.len()); count],
            columns,
            own,
        };
        candidate.extend(system);
        candidate
    }

    /// Forgets products beyond the first `known` directions, and takes those of `system`.
    pub(crate) fn reset<L: Layout>(&mut self, system: &System<L>, known: usize) {
        for coefficients in &mut self.coefficients {
            coefficients.truncate(known);
        }
        self.extend(system);
    }

    /// Catches up with directions that were added to the basis.
    pub(crate) fn extend<L: Layout>(&mut self, system: &System<L>) {
        let known = self.coefficients.first().map_or(0, Vec::len);
        // direction by direction: a basis is larger than the processor's cache
        for direction in &system.basis[known..] {
            for (column, coefficients) in self.columns.iter().zip(&mut self.coefficients) {
                coefficients.push(system.dot_direction(column, direction));
            }
        }
    }

    /// Whether no reading depends on it.
    pub(crate) fn is_nothing(&self) -> bool {
        self.own.iter().all(|product| *product == 0.0)
    }

    /// The score with nothing but the base model projected out, whatever was taken up since.
    pub(crate) fn score_at_base(&self, system: &System) -> Score {
        let mut candidate = self.clone();
        candidate.reset(system, system.basis.len());
        candidate.score(system)
    }

    pub(crate) fn score<L: Layout>(&self, system: &System<L>) -> Score {
        let count = self.columns.len();
        let mut result = Score {
            effect: self.effect,
            shape: self.shape,
            score: 0.0,
            rank: 0,
            amplitudes: vec![0.0; count],
            times: Vec::new(),
            retained: 0.0,
            unit_amplitude: f64::INFINITY,
        };
        let mut norms: Vec<f64> = (0..count).map(|k| self.own[(k, k)].sqrt()).collect();
        if count == 0 || norms.iter().any(|norm| !norm.is_finite()) {
            return result;
        }
        let longest = norms.iter().fold(0.0_f64, |most, norm| most.max(*norm));
        for norm in norms.iter_mut().filter(|norm| **norm <= ROUNDING * longest) {
            *norm = 0.0;
        }
        let scale = |k: usize| if norms[k] > 0.0 { 1.0 / norms[k] } else { 0.0 };
        let gram = DMatrix::from_fn(count, count, |a, b| {
            let taken = dot(&self.coefficients[a], &self.coefficients[b]);
            (self.own[(a, b)] - taken) * scale(a) * scale(b)
        });
        let right = DVector::from_fn(count, |k, _| {
            system.dot(&self.columns[k], &system.residual) * scale(k)
        });
        let eigen = gram.symmetric_eigen();
        let mut amplitudes = DVector::zeros(count);
        for k in 0..count {
            let value = eigen.eigenvalues[k];
            result.retained = result.retained.max(value.max(0.0).sqrt());
            if value <= L::SURVIVING {
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
            if norms[k] > 0.0 && result.retained > 0.0 {
                let unit = 1.0 / (norms[k] * result.retained);
                result.unit_amplitude = result.unit_amplitude.min(unit);
            }
        }
        result
    }
}

fn product(a: &Column, b: &Column) -> f64 {
    a.parts
        .iter()
        .filter_map(|(stream, values)| {
            let (_, others) = b.parts.iter().find(|(other, _)| other == stream)?;
            Some(dot(values, others))
        })
        .sum()
}

/// All effects but events, at every shape of their grids.
pub(crate) fn candidates(
    system: &System,
    context: &Context<'_>,
    effects: &[Box<dyn Effect>],
    tested: &[usize],
) -> Vec<Candidate> {
    let lasting = tested.iter().copied().filter(|&index| {
        let spec = effects[index].spec();
        spec.shape != Shape::Event && !spec.is_found_beside
    });
    let made = haptical_parallel::map(lasting, |index| {
        let effect = effects[index].as_ref();
        let zero = vec![0.0; effect.spec().amplitudes];
        let shapes = effect.shapes(context).into_iter();
        let made = shapes.map(|shape| Candidate::new(system, context, effect, index, &zero, shape));
        made.collect::<Vec<Candidate>>()
    });
    made.into_iter().flatten().collect()
}

/// An effect in a cause's place.
#[derive(Debug, Clone)]
pub(crate) struct Rival {
    /// Position in the catalogue, and its fit, where it was refitted.
    pub(crate) cause: Option<Cause>,
    /// Whether its refit, if any, ended at a minimum; one that did not is no further behind than its end promises.
    pub(crate) has_converged: bool,
    pub(crate) name: &'static str,
    pub(crate) joint: Option<usize>,
    /// Share of the squared residual that it explains of what the cause explains.
    pub(crate) share: f64,
    /// Nats behind the best, misfit allowed for.
    pub(crate) nats_behind: f64,
    pub(crate) probability: f64,
}

impl Rival {
    /// An effect that was not refitted; its probability is that of nothing yet.
    pub(crate) fn new(effect: &dyn Effect, share: f64, nats_behind: f64) -> Self {
        Self {
            cause: None,
            has_converged: true,
            name: effect.name(),
            joint: effect.joint(),
            share,
            nats_behind,
            probability: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;

    /// Four readings of one stream.
    #[derive(Debug, Clone)]
    struct Four;

    impl Layout for Four {
        const SURVIVING: f64 = 1e-9;

        fn count(&self) -> usize {
            4
        }

        fn range(&self, _: usize) -> Range<usize> {
            0..4
        }
    }

    #[test]
    fn a_column_that_is_rounding_is_no_direction() {
        let system = System::bare(Four, vec![Vec::new()], vec![1.0, 2.0, -1.0, 0.5]);
        let column = |values: [f64; 4]| Column {
            parts: vec![(0, values.to_vec())],
        };
        let shown = column([1.0, 1.0, 0.0, 0.0]);
        let rounding = column([3e-16, -2e-16, 1e-16, 4e-16]);
        let alone = Candidate::of_columns(&system, vec![shown.clone()], 0, 0.0).score(&system);
        let both = Candidate::of_columns(&system, vec![shown, rounding], 0, 0.0).score(&system);
        assert_eq!((alone.rank, both.rank), (1, 1));
        assert!((alone.score - both.score).abs() < 1e-12);
        assert_eq!(both.amplitudes[1], 0.0);
    }
}
