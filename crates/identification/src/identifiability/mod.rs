//! Identifiability of parameters: invisible, dependent, weak, or identifiable.

pub(crate) mod observability;
mod proven;
pub(crate) mod rules;
mod selection;
pub(crate) mod status;

use haptical_linalg::{LinalgError, Reduction, singular_values};
use serde::Serialize;

use crate::identifiability::rules::{IdentifiabilityRules, positive};
use crate::identifiability::selection::{is_clear, keep_strong};
use crate::{IdentificationError, Observability, ParameterInfo, Status};

/// The answer of [`analyse`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identifiability {
    /// Names, in the order of the columns.
    pub names: Vec<String>,
    /// One status per parameter.
    pub statuses: Vec<Status>,
    /// Indices of the independent parameters, ascending, weak ones included.
    pub independent: Vec<usize>,
    /// Rank by the order of preference.
    pub rank: usize,
    /// Rank by the singular values of the unit-norm columns; differs only where the data are
    /// on the edge, which a report must say.
    pub singular_rank: usize,
    /// Singular values of the unit-norm visible columns, largest first; empty where the rules ask for
    /// none and bounds prove the rank.
    pub singular_values: Vec<f64>,
    /// Remainder of the least independent parameter that was kept, and the largest that was not:
    /// the gap in which the tolerance lies.
    pub gap: [f64; 2],
    /// Condition number of the independent columns at unit norm; without singular values an upper bound.
    pub condition_unit_norm: f64,
    /// Observability of the independent columns, scaled by the plausible sizes; none without singular
    /// values.
    pub observability: Option<Observability>,
}

impl Identifiability {
    /// Whether order of preference and singular values agree on the rank.
    pub fn is_clear(&self) -> bool {
        self.rank == self.singular_rank
    }

    /// A sentence for a parameter that is not identifiable; none for one that is.
    pub fn reason(&self, parameter: usize) -> Option<String> {
        let name = self.names.get(parameter)?;
        match self.statuses.get(parameter)? {
            Status::Invisible => Some(format!("{name} has no effect on any measurement")),
            Status::Dependent { combination } => {
                let terms: Vec<String> = combination
                    .iter()
                    .map(|term| format!("{:+.6} {}", term.coefficient, term.name))
                    .collect();
                Some(format!("{name} acts like {}", terms.join(" ")))
            }
            Status::Weak { standard_deviation } => Some(format!(
                "{name} is fixed no better than it is plausibly large (sd {standard_deviation:.3e})"
            )),
            Status::Identifiable { .. } => None,
        }
    }
}

/// Judges every column of a reduced derivative matrix.
///
/// `order` lists the columns by preference: of a dependent set, those named first are kept
/// (Khalil & Dombre 2002, section 10.2.2); it must be a permutation of all columns. Rows must be
/// weighted by the noise, so that standard deviations are those of the stated noise.
///
/// # Errors
/// [`IdentificationError::Shape`] if lengths do not fit, [`IdentificationError::Setting`] for a
/// threshold or a plausible size outside its range; refusals of the linear algebra, among them an
/// order that is not a permutation.
pub fn analyse(
    reduction: &Reduction,
    parameters: &[ParameterInfo],
    order: &[usize],
    rules: &IdentifiabilityRules,
) -> Result<Identifiability, IdentificationError> {
    let count = reduction.columns();
    check(count, parameters, order, rules)?;
    let effects: Vec<f64> = reduction
        .column_norms()
        .iter()
        .zip(parameters)
        .map(|(norm, parameter)| norm * parameter.plausible_size)
        .collect();
    let largest = effects
        .iter()
        .fold(0.0_f64, |largest, effect| largest.max(*effect));
    if !largest.is_finite() {
        return Err(LinalgError::Overflow {
            what: "a column norm times a plausible size",
        }
        .into());
    }
    let visible: Vec<usize> = order
        .iter()
        .copied()
        .filter(|&index| effects[index] > rules.zero_tolerance * largest)
        .collect();
    let mut statuses = vec![Status::Invisible; count];
    let names = parameters
        .iter()
        .map(|parameter| parameter.name.clone())
        .collect();
    if visible.is_empty() {
        return Ok(Identifiability {
            names,
            statuses,
            independent: Vec::new(),
            rank: 0,
            singular_rank: 0,
            singular_values: Vec::new(),
            gap: [f64::INFINITY, 0.0],
            condition_unit_norm: f64::INFINITY,
            observability: None,
        });
    }
    let (ordered, least) = keep_strong(reduction, parameters, &visible, rules, &mut statuses)?;
    let mut independent = ordered.independent.clone();
    independent.sort_unstable();
    let rank = independent.len();
    let judged = Identifiability {
        names,
        rank,
        singular_rank: rank,
        gap: [
            ordered.smallest_kept,
            or_nothing(ordered.largest_dropped, 1.0, visible.len()),
        ],
        condition_unit_norm: (rank as f64).sqrt() / least,
        observability: None,
        singular_values: Vec::new(),
        statuses,
        independent,
    };
    if !rules.singular_values && is_clear(&ordered, least, visible.len(), rules) {
        return Ok(judged);
    }
    let at_unit_norm = |columns: &[usize]| -> Result<Vec<f64>, LinalgError> {
        singular_values(&reduction.scaled_factor(columns, &vec![1.0; columns.len()])?)
    };
    let singular_values = at_unit_norm(&visible)?;
    let cut = rules.rank_tolerance * singular_values[0];
    let singular_rank = singular_values
        .iter()
        .position(|value| *value <= cut)
        .unwrap_or(singular_values.len());
    let independent_values = if rank == visible.len() {
        singular_values.clone()
    } else {
        at_unit_norm(&judged.independent)?
    };
    let largest = singular_values[0];
    let singular_values = singular_values.iter();
    let singular_values = singular_values.map(|&value| or_nothing(value, largest, visible.len()));
    let singular_values = singular_values.collect();
    Ok(Identifiability {
        singular_rank,
        condition_unit_norm: independent_values[0]
            / independent_values[independent_values.len() - 1],
        observability: Observability::new(reduction, &judged.independent, parameters)?,
        singular_values,
        ..judged
    })
}

/// A singular value, or a pivot, of so many columns; nothing where it is what rounding leaves of a zero, as each processor has another
/// rest (Golub & Van Loan, *Matrix Computations*, section 5.5.8: a few epsilons times the largest).
fn or_nothing(value: f64, largest: f64, columns: usize) -> f64 {
    let rounding = 4.0 * columns as f64 * f64::EPSILON * largest;
    // what is no number stays none
    if value <= rounding { 0.0 } else { value }
}

fn check(
    count: usize,
    parameters: &[ParameterInfo],
    order: &[usize],
    rules: &IdentifiabilityRules,
) -> Result<(), IdentificationError> {
    for (what, found) in [
        ("parameter names", parameters.len()),
        ("preference order", order.len()),
    ] {
        if found != count {
            return Err(IdentificationError::Shape {
                what,
                expected: count,
                found,
            });
        }
    }
    rules.check()?;
    let mut seen = vec![false; count];
    for &column in order {
        match seen.get_mut(column) {
            Some(taken) if !*taken => *taken = true,
            _ => {
                let columns = count;
                return Err(LinalgError::Column { column, columns }.into());
            }
        }
    }
    for parameter in parameters {
        positive("plausible_size", parameter.plausible_size)?;
    }
    Ok(())
}
