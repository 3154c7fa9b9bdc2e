//! The parameters that a fit frees: enough readings for them, and the parameters that each channel pays for.

use std::collections::BTreeMap;

use haptical_identification::{
    Identifiability, IdentifiabilityRules, IdentificationError, Matrix, ParameterInfo, Problem,
    Reduction, Status, Uncertainty, analyse,
};

use crate::fit::considered::sensitivity;
use crate::problem::form::Prepared;
use crate::{CalibrationError, Channel, DeviceProblem, preference_order};

/// Gives the parameters that are not free their values of the start.
pub(crate) fn hold(values: &mut [f64], free: &[usize], start: &[f64]) {
    for index in (0..values.len()).filter(|index| !free.contains(index)) {
        values[index] = start[index];
    }
}

/// The same, the free ones moved by what the linearised problem says makes up for it, where that costs less.
///
/// `reduction` is of all parameters at `values`.
pub(crate) fn hold_linearly(
    (problem, reduction): (&dyn Problem, &Reduction),
    values: &mut Vec<f64>,
    free: &[usize],
    start: &[f64],
) {
    let moved = |index: &usize| !free.contains(index) && values[*index] != start[*index];
    let dropped: Vec<usize> = (0..values.len()).filter(moved).collect();
    let before = values.clone();
    hold(values, free, start);
    if dropped.is_empty() {
        return;
    }
    let Ok((sensitivity, _)) = sensitivity(reduction, free, &dropped) else {
        return;
    };
    let mut made_up = values.clone();
    for (row, &index) in free.iter().enumerate() {
        let each = dropped.iter().enumerate();
        made_up[index] += each
            .map(|(column, &k)| sensitivity[(row, column)] * (start[k] - before[k]))
            .sum::<f64>();
    }
    let cost = |values: &[f64]| {
        let mut residuals = vec![0.0; problem.residual_count()];
        let evaluated = problem.evaluate(values, &mut residuals, None);
        let cost: f64 = residuals.iter().map(|residual| residual * residual).sum();
        evaluated.ok().map(|()| cost)
    };
    if let (Some(plain), Some(cost)) = (cost(values), cost(&made_up))
        && cost < plain
    {
        *values = made_up;
    }
}

/// Each channel's part of the trace of J (J^T J)^-1 J^T, with `spread` for unit noise: the sum of
/// f^T C f over the rows f of its triangle. A single channel pays for all of them.
pub(crate) fn parameter_shares(
    prepared: &Prepared<'_>,
    values: &[f64],
    free: &[usize],
    spread: &Uncertainty,
) -> Result<BTreeMap<Channel, f64>, IdentificationError> {
    let mut channels = prepared.problem.channels();
    if let (Some(channel), None) = (channels.next(), channels.next()) {
        return Ok([(channel, free.len() as f64)].into());
    }
    let share = |rows: &Matrix| {
        // of each pair of columns, as both matrices have theirs in memory
        let pair = |a: usize, b: usize| {
            let entries = rows.column(a).iter().zip(rows.column(b));
            spread.covariance[(a, b)] * entries.map(|(x, y)| x * y).sum::<f64>()
        };
        let along = |a: usize| (0..free.len()).map(move |b| pair(a, b)).sum::<f64>();
        (0..free.len()).map(along).sum()
    };
    let channels = prepared.by_channel(values, free)?.into_iter();
    Ok(channels
        .map(|(channel, rows)| (channel, share(&rows)))
        .collect())
}

/// The identifiable parameters, ascending, without those that the samples do not support; weak ones would take the noise for their value.
pub(crate) fn supported(judged: &Identifiability, unsupported: &[usize]) -> Vec<usize> {
    let is_worth_it = |index: &usize| {
        let is_identifiable = matches!(judged.statuses[*index], Status::Identifiable { .. });
        is_identifiable && !unsupported.contains(index)
    };
    (0..judged.statuses.len()).filter(is_worth_it).collect()
}

pub(crate) fn enough(
    what: &str,
    problem: &DeviceProblem<'_>,
    free: &[usize],
    judged: &Identifiability,
    is_whole: bool,
) -> Result<(), CalibrationError> {
    let rows = problem.residual_count();
    // A rank equal to the number of rows means too few rows, not a special geometry; a part of the candidates may
    // need fewer
    let is_short = is_whole && judged.rank >= rows;
    let parameters = free.len().max(if is_short { rows + 1 } else { 0 });
    if rows <= parameters {
        return Err(CalibrationError::TooFewRows {
            what: what.to_owned(),
            rows,
            parameters: parameters.max(judged.names.len().min(judged.rank + 1)),
            advised: 5 * judged.names.len(),
        });
    }
    if free.is_empty() {
        let reasons: Vec<String> = (0..judged.names.len())
            .filter_map(|index| judged.reason(index))
            .take(3)
            .collect();
        return Err(CalibrationError::NothingIdentifiable {
            what: what.to_owned(),
            reason: reasons.join("; "),
        });
    }
    Ok(())
}

/// Judges every candidate of a reduced problem. What is in `first` is preferred to what is not: of a dependent set the
/// member stays that was chosen at the nominal device, so that rounds come to an end.
pub(crate) fn judge(
    problem: &DeviceProblem<'_>,
    infos: &[ParameterInfo],
    reduction: &Reduction,
    first: &[usize],
    rules: &IdentifiabilityRules,
) -> Result<Identifiability, IdentificationError> {
    let mut order = preference_order(problem.parameters());
    order.sort_by_key(|index| !first.contains(index));
    let mut judged = analyse(reduction, infos, &order, rules)?;
    if let Some(index) = &mut judged.observability {
        // for the readings, not for the rows of triangles; only O1 counts them, as 1/sqrt(m)
        index.o1 *= (reduction.rows() as f64 / problem.residual_count() as f64).sqrt();
    }
    Ok(judged)
}

#[cfg(test)]
mod tests {
    use haptical_identification::{IdentificationError, evaluate_jacobian};

    use super::*;

    /// a + b t - y at t = 0 to 3.
    struct Line([f64; 4]);

    impl Problem for Line {
        fn parameter_count(&self) -> usize {
            2
        }

        fn residual_count(&self) -> usize {
            4
        }

        fn evaluate(
            &self,
            parameters: &[f64],
            residuals: &mut [f64],
            jacobian: Option<(&[usize], &mut Matrix)>,
        ) -> Result<(), IdentificationError> {
            for (row, residual) in residuals.iter_mut().enumerate() {
                *residual = parameters[0] + parameters[1] * row as f64 - self.0[row];
            }
            if let Some((free, matrix)) = jacobian {
                for (column, &parameter) in free.iter().enumerate() {
                    for row in 0..4 {
                        matrix[(row, column)] = if parameter == 0 { 1.0 } else { row as f64 };
                    }
                }
            }
            Ok(())
        }
    }

    #[test]
    fn what_is_dropped_is_made_up_for_by_what_is_left() {
        let problem = Line([1.0, 3.0, 5.0, 7.0]);
        let mut values = vec![1.0, 2.0];
        let (jacobian, residuals) = evaluate_jacobian(&problem, &values, &[0, 1]).unwrap();
        let reduction = Reduction::new(&jacobian, &residuals).unwrap();
        hold_linearly((&problem, &reduction), &mut values, &[0], &[0.0, 0.0]);
        // without a slope the mean of the readings
        assert!((values[0] - 4.0).abs() < 1e-12, "{values:?}");
        assert_eq!(values[1], 0.0);
    }
}
