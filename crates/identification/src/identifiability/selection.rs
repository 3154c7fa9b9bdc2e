//! The columns that are kept: independent in the order of preference, and fixed to a useful size.

use haptical_linalg::{LinalgError, OrderedColumns, OrderedRank, Reduction};

use crate::identifiability::proven::{Variances, variances};
use crate::identifiability::rules::IdentifiabilityRules;
use crate::{IdentificationError, ParameterInfo, Status, Term};

/// Whether bounds prove that the singular values would give the same rank.
///
/// The largest is at least the norm of a column, 1, and at most the root of their number. As many as
/// there are kept columns are at least the `least` of these; the next is at most the distance from a
/// matrix of that rank, the norm of all remainders (Weyl; Golub & Van Loan, section 2.4).
pub(crate) fn is_clear(
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
pub(crate) fn keep_strong(
    reduction: &Reduction,
    parameters: &[ParameterInfo],
    visible: &[usize],
    rules: &IdentifiabilityRules,
    statuses: &mut [Status],
) -> Result<(OrderedRank, f64), IdentificationError> {
    let mut levels = vec![OrderedColumns::new(
        reduction,
        visible,
        rules.rank_tolerance,
    )?];
    let (mut level, mut spread) = independent_columns(&mut levels)?;
    let structural = (levels[level].rank()?, spread.least);
    loop {
        let independent: Vec<usize> = levels[level].independent().collect();
        let deviation = |position: usize| spread.variances[position].sqrt();
        let weak = (0..independent.len()).rev().find(|&position| {
            let size = parameters[independent[position]].plausible_size;
            deviation(position) > rules.weak_share * size
        });
        if let Some(position) = weak {
            let index = independent[position];
            statuses[index] = Status::Weak {
                standard_deviation: deviation(position),
            };
            for level in &mut levels {
                level.take_away(index);
            }
            if levels.iter().all(|level| level.columns().next().is_none()) {
                return Ok(structural);
            }
            (level, spread) = independent_columns(&mut levels)?;
            continue;
        }
        for (position, &index) in independent.iter().enumerate() {
            statuses[index] = Status::Identifiable {
                standard_deviation: deviation(position),
            };
        }
        for dependence in &levels[level].rank()?.dependent {
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
/// tolerance is raised until it has one. `levels` are the columns at each tolerance so far; the
/// answer says at which.
fn independent_columns(
    levels: &mut Vec<OrderedColumns<'_>>,
) -> Result<(usize, Variances), IdentificationError> {
    let mut level = 0;
    loop {
        let tolerance = levels[level].tolerance();
        match variances(&mut levels[level], SMALLEST_PIVOT) {
            Ok(variances) => return Ok((level, variances)),
            Err(LinalgError::RankDeficient { .. }) if tolerance < LARGEST_REMAINDER => {
                level += 1;
                if level == levels.len() {
                    let before = &levels[level - 1];
                    let columns: Vec<usize> = before.columns().collect();
                    let reduction = before.reduction();
                    levels.push(OrderedColumns::new(reduction, &columns, 10.0 * tolerance)?);
                }
            }
            Err(error) => return Err(error.into()),
        }
    }
}

/// Relative pivot below which a set of unit-norm columns is dependent to rounding.
const SMALLEST_PIVOT: f64 = 1e-13;
/// Remainder that no dependent column of finite rounding reaches: far above 1e-16 times the square
/// of any condition number whose columns are still distinguished.
const LARGEST_REMAINDER: f64 = 1e-4;
