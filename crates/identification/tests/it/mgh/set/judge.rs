//! Runs the solver on one problem and judges its claim by a route of its own.

use haptical_identification::{
    Fit, IdentificationError, Problem, Settings, evaluate_jacobian, solve,
};

use super::{Instance, Known, Tables};

/// The paper prints six digits and cuts the rest off.
const PRINTED: f64 = 1e-5;
/// A sum below this is zero: residuals of 1e-10 in problems whose residuals are of order one.
const ZERO: f64 = 1e-20;
/// Relative offset up to which a gradient is zero. Its square is the share of the sum that a step could
/// still take away: 1e-12, a thousand times the rounding of a sum of some ten squares.
const LARGEST_OFFSET: f64 = 1e-6;
/// Share of a column that must remain across the others for it to count.
const INDEPENDENT: f64 = 1e-10;

/// What a run ended with.
pub(crate) struct Outcome {
    /// The fit, or why there is none.
    pub(crate) fit: Result<Fit, IdentificationError>,
    /// Cosine between the residuals and what the derivatives span, 0 at a stationary point.
    pub(crate) offset: Option<f64>,
    /// The known sum that was reached.
    pub(crate) reached: Option<Known>,
}

impl Outcome {
    /// Whether the solver says that it found a minimum.
    pub(crate) fn claims(&self) -> bool {
        let fit = self.fit.as_ref();
        fit.is_ok_and(|fit| fit.convergence.was_successful())
    }

    /// Why a claim is false, if it is.
    pub(crate) fn false_claim(&self) -> Option<&'static str> {
        if !self.claims() {
            return None;
        }
        // of a sum that is zero, residuals and gradient are both nothing but rounding
        let is_offset = !self.is_zero() && self.offset.is_none_or(|offset| offset > LARGEST_OFFSET);
        if is_offset {
            return Some("the gradient is not zero");
        }
        if self.reached.is_none() {
            return Some("no known stationary value");
        }
        None
    }

    /// Whether the sum is zero to rounding.
    pub(crate) fn is_zero(&self) -> bool {
        self.fit.as_ref().is_ok_and(|fit| fit.cost <= ZERO)
    }

    /// Whether a sum was reached that is known, with or without a claim.
    pub(crate) fn is_solved(&self) -> bool {
        self.reached.is_some()
    }
}

/// Solves from `factor` times the standard start.
pub(crate) fn run(
    instance: &Instance,
    tables: &Tables,
    factor: f64,
    settings: &Settings,
) -> Outcome {
    let free: Vec<usize> = (0..instance.parameter_count()).collect();
    let fit = solve(instance, &instance.start_at(factor), &free, settings);
    let (mut offset, mut reached) = (None, None);
    if let Ok(fit) = &fit {
        offset = relative_offset(instance, &fit.parameters);
        let (parameters, residuals) = (free.len(), instance.residual_count());
        reached = tables
            .known(instance.name, parameters, residuals)
            .find(|known| is_same(fit.cost, known.sum_of_squares))
            .cloned();
    }
    Outcome {
        fit,
        offset,
        reached,
    }
}

/// Whether a sum is a known one, to the digits that are printed of it.
fn is_same(sum: f64, known: f64) -> bool {
    if known == 0.0 {
        sum <= ZERO
    } else {
        (sum - known).abs() <= PRINTED * known
    }
}

/// The offset of Bates & Watts (1981) by Gram-Schmidt, twice over, where the solver has a pivoted QR.
fn relative_offset(instance: &Instance, parameters: &[f64]) -> Option<f64> {
    let free: Vec<usize> = (0..parameters.len()).collect();
    let (jacobian, residuals) = evaluate_jacobian(instance, parameters, &free).ok()?;
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let length = norm(&residuals);
    if length == 0.0 {
        return Some(0.0);
    }
    let mut square = 0.0;
    for &column in &free {
        let mut direction = jacobian.column(column).to_vec();
        if !scale(&mut direction) {
            continue;
        }
        for _ in 0..2 {
            for known in &basis {
                let along = product(known, &direction);
                let pairs = direction.iter_mut().zip(known);
                pairs.for_each(|(entry, known)| *entry -= along * known);
            }
        }
        if norm(&direction) > INDEPENDENT && scale(&mut direction) {
            square += (product(&direction, &residuals) / length).powi(2);
            basis.push(direction);
        }
    }
    Some(square.sqrt()).filter(|offset| offset.is_finite())
}

/// Brings a vector to unit length, unless it has none.
fn scale(vector: &mut [f64]) -> bool {
    let largest = vector
        .iter()
        .fold(0.0_f64, |most, entry| most.max(entry.abs()));
    if largest == 0.0 {
        return false;
    }
    vector.iter_mut().for_each(|entry| *entry /= largest);
    let length = norm(vector);
    vector.iter_mut().for_each(|entry| *entry /= length);
    true
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(vector: &[f64]) -> f64 {
    product(vector, vector).sqrt()
}
