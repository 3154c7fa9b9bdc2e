//! Dependence of the residuals of single postures, posture by posture, with probabilities by chance
//! (docs/diagnosis.md, "Touches").

mod questions;

use haptical_effects::{Context, Signal};
use haptical_metrics::{chi_square_p_value, holm_adjusted};
use nalgebra::{DMatrix, DVector};

use crate::Result;
use crate::answer::Dependence;
use crate::engine::{System, across, dot};
use crate::thresholds::dependence::{ASKED_SHARE, DEPENDENCE_P, DEPENDENT, STRETCHES};
use crate::thresholds::engine::AGAIN_BELOW;

use self::questions::questions;

/// Every question with its answer by the residual of `system`: first the significant ones, by what they explain,
/// then the others by probability. Adjusted probabilities are by Holm's method over all questions.
pub(crate) fn dependences(context: &Context<'_>, system: &System) -> Result<Vec<Dependence>> {
    let found = asked(context, system)?;
    Ok(found.into_iter().map(|(found, _)| found).collect())
}

/// Largest squared residual of `system` that one question explains beyond chance, of those whose adjusted
/// probability by chance is below `p`.
pub(crate) fn largest_dependence(context: &Context<'_>, system: &System, p: f64) -> Result<f64> {
    let square = dot(&system.residual, &system.residual);
    let found = asked(context, system)?;
    let sure = found.iter().filter(|(found, _)| found.p_adjusted < p);
    Ok(sure.fold(0.0, |largest: f64, (_, share)| largest.max(share * square)))
}

/// Every question with its answer, and its share of the squared residual beyond chance, in the order of
/// [`dependences`].
fn asked(context: &Context<'_>, system: &System) -> Result<Vec<(Dependence, f64)>> {
    let mut asked = Vec::new();
    for question in questions(context) {
        if let Some(answer) = ask(context, system, &question.signals)? {
            asked.push((question, answer));
        }
    }
    if asked.is_empty() {
        return Ok(Vec::new());
    }
    let p_values: Vec<f64> = asked.iter().map(|(_, answer)| answer.p_value).collect();
    let adjusted = holm_adjusted(&p_values)?;
    let mut found: Vec<(Dependence, f64)> = Vec::new();
    for ((question, answer), p_adjusted) in asked.into_iter().zip(adjusted) {
        let dependence = Dependence {
            column: question.column,
            joint: question.joint.map(|joint| joint + 1),
            asked: question.asked,
            channel: question
                .stream
                .map(|stream| context.streams[stream].channel.name()),
            on: question.on,
            p_value: answer.p_value,
            p_adjusted,
            share: answer.share,
        };
        found.push((dependence, answer.beyond_chance));
    }
    // of what is sure the one that explains most, its number of columns allowed for; of the rest the surest
    let is_significant = |found: &Dependence| found.p_adjusted < DEPENDENCE_P;
    found.sort_by(|(a, by_a), (b, by_b)| {
        is_significant(b)
            .cmp(&is_significant(a))
            .then_with(|| match is_significant(a) {
                true => by_b.total_cmp(by_a),
                false => a.p_value.total_cmp(&b.p_value),
            })
    });
    Ok(found)
}

struct Answer {
    /// Probability by chance of what its columns explain.
    p_value: f64,
    /// Share of the squared residual that they explain.
    share: f64,
    /// The same, less what as many columns explain of any residual.
    beyond_chance: f64,
}

/// What columns explain; none where the base model takes them up. A score test that sums within postures first (Liang & Zeger 1986): one disturbed joint
/// moves all three coordinates of a touch.
fn ask(context: &Context<'_>, system: &System, signals: &[Signal]) -> Result<Option<Answer>> {
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for signal in signals {
        let column = system.layout.dense(signal);
        let length = dot(&column, &column).sqrt();
        let across = across(column, AGAIN_BELOW, || system.basis.iter());
        let left = across.as_ref().and_then(|across| across.products.last());
        let is_left = left.is_some_and(|left| *left > ASKED_SHARE * length);
        columns.extend(across.filter(|_| is_left).map(|across| across.direction));
    }
    let postures = together(context, system);
    let rows = postures.iter().max().map_or(0, |row| row + 1);
    let count = columns.len();
    if count == 0 || rows <= count {
        return Ok(None);
    }
    let mut sums = DMatrix::<f64>::zeros(rows, count);
    for (k, column) in columns.iter().enumerate() {
        for ((entry, residual), row) in column.iter().zip(&system.residual).zip(&postures) {
            sums[(*row, k)] += entry * residual;
        }
    }
    let total = DVector::from_fn(count, |k, _| sums.column(k).sum());
    let spread = sums.transpose() * &sums;
    let own = DMatrix::from_fn(count, count, |a, b| dot(&columns[a], &columns[b]));
    let Some((statistic, rank)) = quadratic(&spread, &total) else {
        return Ok(None);
    };
    let square = dot(&system.residual, &system.residual);
    let (explained, columns) = quadratic(&own, &total).unwrap_or((0.0, 0));
    let share = (explained / square.max(1e-300)).min(1.0);
    let freedom = system.residual.len().max(1) as f64;
    Ok(Some(Answer {
        p_value: chi_square_p_value(statistic, rank as f64)?,
        share,
        beyond_chance: share - columns as f64 / freedom,
    }))
}

/// What errors may go together in, for each block: a posture; of a motion a stretch of it.
fn together(context: &Context<'_>, system: &System) -> Vec<usize> {
    let mut postures = system.postures();
    if context.ordered {
        let rows = context.rows().div_ceil(STRETCHES).max(1);
        postures.iter_mut().for_each(|row| *row /= rows);
    }
    postures
}

/// u^T V^+ u and the rank of V.
fn quadratic(matrix: &DMatrix<f64>, vector: &DVector<f64>) -> Option<(f64, usize)> {
    let eigen = matrix.clone().symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    if !largest.is_finite() || largest <= 0.0 {
        return None;
    }
    let mut sum = 0.0;
    let mut rank = 0;
    for (value, direction) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > DEPENDENT * largest {
            sum += direction.dot(vector).powi(2) / value;
            rank += 1;
        }
    }
    Some((sum, rank))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quadratic_form_leaves_out_what_depends() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 2.0, 2.0, 2.0]);
        let (sum, rank) = quadratic(&matrix, &DVector::from_vec(vec![3.0, 3.0])).unwrap();
        // one direction (1, 1) / sqrt 2 of eigenvalue 4 and projection 6 / sqrt 2
        assert_eq!(rank, 1);
        assert!((sum - 18.0 / 4.0).abs() < 1e-12);
    }
}
