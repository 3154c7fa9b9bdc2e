//! Which parameters the data can fix: invisible, combinations of others, weak, or identifiable.

use haptical_linalg::{LinalgError, OrderedRank, RANK_TOLERANCE, Reduction};
use serde::Serialize;

use crate::proven::{Variances, variances};
use crate::{IdentificationError, Observability};

/// What a report needs to know of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterInfo {
    /// Short name, as in the paper's tables: `alpha4`, `ratio_deviation2`.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Size that a deviation of this parameter may plausibly have, in its unit.
    pub plausible_size: f64,
}

/// Thresholds of the analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentifiabilityRules {
    /// A column whose plausible effect is below this share of the largest is invisible.
    pub zero_tolerance: f64,
    /// Remainder of a unit-norm column below which it is a combination of others.
    pub rank_tolerance: f64,
    /// Standard deviation, as a share of the plausible size, above which a parameter is weak.
    pub weak_share: f64,
    /// Work out singular values, condition number and observability. Statuses, rank and standard
    /// deviations are the same without them, and take a fifth of the time: for many simulated devices.
    pub singular_values: bool,
}

impl Default for IdentifiabilityRules {
    fn default() -> Self {
        // zero_tolerance: analytic derivatives of an absent effect are rounding, about 1e-16 of the
        // others; weak_share: data that shrink the plausible size by less than half say little.
        Self {
            zero_tolerance: 1e-11,
            rank_tolerance: RANK_TOLERANCE,
            weak_share: 0.5,
            singular_values: true,
        }
    }
}

impl IdentifiabilityRules {
    /// Refuses thresholds outside their range.
    ///
    /// # Errors
    /// [`IdentificationError::Setting`].
    pub fn check(&self) -> Result<(), IdentificationError> {
        for (name, value) in [
            ("zero_tolerance", self.zero_tolerance),
            ("rank_tolerance", self.rank_tolerance),
        ] {
            if !(0.0..1.0).contains(&value) {
                return Err(IdentificationError::Setting {
                    name,
                    value,
                    allowed: "from 0 to below 1",
                });
            }
        }
        positive("weak_share", self.weak_share)
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), IdentificationError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(IdentificationError::Setting {
        name,
        value,
        allowed: "finite and above 0",
    })
}

/// One term of a combination.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Term {
    /// Index of the parameter.
    pub parameter: usize,
    /// Name of the parameter.
    pub name: String,
    /// Change of that parameter which acts like a unit change of the dependent one.
    pub coefficient: f64,
}

/// What the data say of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
pub enum Status {
    /// The data fix it.
    Identifiable {
        /// Standard deviation for the stated noise.
        standard_deviation: f64,
    },
    /// Independent, but fixed no better than its plausible size.
    Weak {
        /// Standard deviation for the stated noise.
        standard_deviation: f64,
    },
    /// It has no effect on any measurement.
    Invisible,
    /// Its effect is a combination of others' effects.
    Dependent {
        /// The combination.
        combination: Vec<Term>,
    },
}

impl Status {
    /// Whether the parameter can be estimated (identifiable or weak).
    pub fn is_independent(&self) -> bool {
        matches!(self, Self::Identifiable { .. } | Self::Weak { .. })
    }
}

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
        gap: [ordered.smallest_kept, ordered.largest_dropped],
        condition_unit_norm: (rank as f64).sqrt() / least,
        observability: None,
        singular_values: Vec::new(),
        statuses,
        independent,
    };
    if !rules.singular_values && is_clear(&ordered, least, visible.len(), rules) {
        return Ok(judged);
    }
    let (singular_values, _) = reduction.singular_values(&visible)?;
    let cut = rules.rank_tolerance * singular_values[0];
    let singular_rank = singular_values
        .iter()
        .position(|value| *value <= cut)
        .unwrap_or(singular_values.len());
    let independent_values = if rank == visible.len() {
        singular_values.clone()
    } else {
        reduction.singular_values(&judged.independent)?.0
    };
    Ok(Identifiability {
        singular_rank,
        condition_unit_norm: independent_values[0]
            / independent_values[independent_values.len() - 1],
        observability: Observability::new(reduction, &judged.independent, parameters)?,
        singular_values,
        ..judged
    })
}

/// Whether bounds prove that the singular values would give the same rank.
///
/// The largest is at least the norm of a column, 1, and at most the root of their number. As many as
/// there are kept columns are at least the `least` of these; the next is at most the distance from a
/// matrix of that rank, the norm of all remainders (Weyl; Golub & Van Loan, section 2.4).
fn is_clear(
    ordered: &OrderedRank,
    least: f64,
    visible: usize,
    rules: &IdentifiabilityRules,
) -> bool {
    let dropped = (visible - ordered.independent.len()) as f64;
    let tolerance = rules.rank_tolerance;
    // twice, as the bounds themselves are rounded
    least > 2.0 * tolerance * (visible as f64).sqrt()
        && 2.0 * dropped.sqrt() * ordered.largest_dropped <= tolerance
}

/// Takes weak parameters out one at a time, the least preferred first, until every kept one is
/// fixed to a useful size; writes the statuses of all visible parameters and
/// returns the structural verdict, weak parameters included, with the bound of [`Variances::least`].
///
/// One at a time, because a single bad direction makes all of its members weak: two offsets along
/// nearly parallel axes are each unknown, but with one of them held the other is known well, and
/// what depended on them may come back (docs/equations.md, "Column scaling and the order of
/// preference").
fn keep_strong(
    reduction: &Reduction,
    parameters: &[ParameterInfo],
    visible: &[usize],
    rules: &IdentifiabilityRules,
    statuses: &mut [Status],
) -> Result<(OrderedRank, f64), IdentificationError> {
    let mut candidates = visible.to_vec();
    let (mut ordered, mut spread) = independent_columns(reduction, &candidates, rules)?;
    let structural = (ordered.clone(), spread.least);
    loop {
        let deviation = |position: usize| spread.variances[position].sqrt();
        let weak = (0..ordered.independent.len()).rev().find(|&position| {
            let size = parameters[ordered.independent[position]].plausible_size;
            deviation(position) > rules.weak_share * size
        });
        if let Some(position) = weak {
            let index = ordered.independent[position];
            statuses[index] = Status::Weak {
                standard_deviation: deviation(position),
            };
            candidates.retain(|&candidate| candidate != index);
            if candidates.is_empty() {
                return Ok(structural);
            }
            (ordered, spread) = independent_columns(reduction, &candidates, rules)?;
            continue;
        }
        for (position, &index) in ordered.independent.iter().enumerate() {
            statuses[index] = Status::Identifiable {
                standard_deviation: deviation(position),
            };
        }
        for dependence in &ordered.dependent {
            let combination = dependence
                .combination
                .iter()
                .map(|&(parameter, coefficient)| Term {
                    parameter,
                    name: parameters[parameter].name.clone(),
                    coefficient,
                })
                .collect();
            statuses[dependence.column] = Status::Dependent { combination };
        }
        return Ok(structural);
    }
}

/// Independent columns in the order given, and the variances that prove them independent.
///
/// A column that depends on nearly dependent ones leaves a remainder of rounding times their
/// condition number, which can exceed the tolerance. Then the kept set has no covariance; the
/// tolerance is raised until it has one.
fn independent_columns(
    reduction: &Reduction,
    candidates: &[usize],
    rules: &IdentifiabilityRules,
) -> Result<(OrderedRank, Variances), IdentificationError> {
    let mut tolerance = rules.rank_tolerance;
    loop {
        let ordered = reduction.ordered_rank(candidates, tolerance)?;
        match variances(reduction, &ordered.independent, SMALLEST_PIVOT) {
            Ok(variances) => return Ok((ordered, variances)),
            Err(LinalgError::RankDeficient { .. }) if tolerance < LARGEST_REMAINDER => {
                tolerance *= 10.0;
            }
            Err(error) => return Err(error.into()),
        }
    }
}

/// Relative pivot below which a set of unit-norm columns is dependent to rounding.
const SMALLEST_PIVOT: f64 = 1e-13;
/// Remainder that no dependent column of finite rounding reaches: far above 1e-16 times the square
/// of any condition number whose columns are still told apart.
const LARGEST_REMAINDER: f64 = 1e-4;

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

impl ParameterInfo {
    /// A parameter by name, unit and plausible size.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, plausible_size: f64) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            plausible_size,
        }
    }
}

/// Columns of a reduction's chosen factor scaled by plausible sizes instead of unit norms.
pub(crate) fn plausible_scaling(
    reduction: &Reduction,
    columns: &[usize],
    parameters: &[ParameterInfo],
) -> Result<haptical_linalg::Matrix, IdentificationError> {
    let sizes: Vec<f64> = columns
        .iter()
        .map(|&column| reduction.column_norms()[column] * parameters[column].plausible_size)
        .collect();
    Ok(reduction.scaled_factor(columns, &sizes)?)
}
