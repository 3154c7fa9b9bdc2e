//! What the residuals of touches depend on, posture by posture, with probabilities by chance (docs/diagnosis.md,
//! "Touches").

use haptical_metrics::{chi_square_p_value, holm_adjusted};
use haptical_model::kinematics::nalgebra::Vector3;
use nalgebra::{DMatrix, DVector};

use crate::DiagnosisError;
use crate::answer::Dependence;
use crate::catalogue::Hook;
use crate::context::{Context, Stream};
use crate::generic::{Covariate, Place, free_function};
use crate::select::Selector;
use crate::signal::Signal;
use crate::system::{System, dot, take_off};

/// Intervals of the free functions of an angle.
const KNOTS: usize = 6;
/// Probability, all questions together, below which a dependence is told.
pub(crate) const TOLD: f64 = 0.01;
/// Share of a column that the base model must leave for it to be asked at all.
const VISIBLE: f64 = 1e-2;
/// Share of the largest direction's square below which one is left out.
const DEPENDENT: f64 = 1e-6;

/// What a residual is asked for.
struct Question {
    column: String,
    joint: Option<usize>,
    on: String,
    signals: Vec<Signal>,
}

/// Every joint's angle and torque, and the direction of approach: first those that are told, by what they explain,
/// then the others by probability. Adjusted
/// probabilities are by Holm's method over all questions.
pub(crate) fn dependences(selector: &Selector<'_, '_>) -> Result<Vec<Dependence>, DiagnosisError> {
    let engine = selector.engine;
    let mut asked = Vec::new();
    for question in questions(&engine.context) {
        if let Some((p_value, share)) = ask(&engine.system, &question.signals)? {
            asked.push((question, p_value, share));
        }
    }
    if asked.is_empty() {
        return Ok(Vec::new());
    }
    let p_values: Vec<f64> = asked.iter().map(|(_, p_value, _)| *p_value).collect();
    let adjusted = holm_adjusted(&p_values)?;
    let mut found: Vec<Dependence> = asked
        .into_iter()
        .zip(adjusted)
        .map(|((question, p_value, share), p_adjusted)| Dependence {
            column: question.column,
            joint: question.joint.map(|joint| joint + 1),
            on: question.on,
            p_value,
            p_adjusted,
            share,
        })
        .collect();
    // of what is sure the one that explains most, of the rest the surest
    let told = |found: &Dependence| found.p_adjusted < TOLD;
    found.sort_by(|a, b| {
        told(b).cmp(&told(a)).then_with(|| match told(a) {
            true => b.share.total_cmp(&a.share),
            false => a.p_value.total_cmp(&b.p_value),
        })
    });
    Ok(found)
}

fn questions(context: &Context<'_>) -> Vec<Question> {
    let mut questions = Vec::new();
    for joint in 0..context.device.joints.len() {
        let place = Place {
            hook: Hook::Joint,
            joint: Some(joint),
        };
        let angle = Covariate::Angle(joint);
        if let Some(signals) = free_function(context, place, angle, KNOTS) {
            questions.push(Question {
                column: angle.column(context),
                joint: Some(joint),
                on: angle.words(context),
                signals,
            });
        }
        if let Some(Some(torque)) = context.torque_nm.get(joint) {
            let side: Vec<f64> = torque.iter().map(|torque| torque.signum()).collect();
            let logged = matches!(context.recording.torque_nm.get(joint), Some(Some(_)));
            let source = if logged { "" } else { " (from the masses)" };
            questions.push(Question {
                column: Covariate::Torque(joint).column(context),
                joint: Some(joint),
                on: format!(
                    "{} and its side{source}",
                    Covariate::Torque(joint).words(context)
                ),
                signals: vec![
                    context.downstream(joint, torque),
                    context.downstream(joint, &side),
                ],
            });
        }
    }
    if !context.rotation.is_empty() && context.streams.iter().any(Stream::is_touch) {
        // the handle's own axes as the base sees them: a shift that turns with them is another tool's, and so
        // in the base model already
        let signals = (0..9).map(|index| {
            context.handle(|row| {
                let approach = context.rotation[row].column(2).into_owned();
                (
                    Vector3::ith(index / 3, approach[index % 3]),
                    Vector3::zeros(),
                )
            })
        });
        questions.push(Question {
            column: "contact".to_owned(),
            joint: None,
            on: "the direction of approach (the handle's z axis)".to_owned(),
            signals: signals.collect(),
        });
    }
    questions
}

/// Probability by chance of what columns explain, and the share of the squared residual; none where the base
/// model takes them up. A score test that sums within postures first (Liang & Zeger 1986): one disturbed joint
/// moves all three coordinates of a touch.
fn ask(system: &System, signals: &[Signal]) -> Result<Option<(f64, f64)>, DiagnosisError> {
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for signal in signals {
        let mut column = system.dense(&system.column(signal));
        let length = dot(&column, &column).sqrt();
        for _ in 0..2 {
            for direction in &system.basis {
                take_off(&mut column, direction);
            }
        }
        let left = dot(&column, &column).sqrt();
        if left > VISIBLE * length && left > 0.0 {
            column.iter_mut().for_each(|entry| *entry /= left);
            columns.push(column);
        }
    }
    let postures = system.postures();
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
    let explained = quadratic(&own, &total).map_or(0.0, |(explained, _)| explained);
    let p_value = chi_square_p_value(statistic, rank as f64)?;
    Ok(Some((p_value, (explained / square.max(1e-300)).min(1.0))))
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
