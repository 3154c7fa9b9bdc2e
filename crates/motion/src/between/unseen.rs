//! What the terms leave of rows that they were not fitted to.

use super::choose::Chosen;
use super::fit::{Fitted, determined, fit, predicted};
use super::rows::{JointRows, Rows};
use super::terms::Term;
use crate::MotionError;
use crate::thresholds::examine::{FOLDS, PARTS};
use crate::unseen::Unseen;

/// Rows of the recording, left out in turn.
pub(super) fn within(rows: &Rows, chosen: &Chosen) -> Vec<Unseen> {
    let of_joint = |(rows, (bare, own)): (&JointRows, (&Fitted, &Fitted))| {
        let count = rows.count();
        let part = |k: usize| k * PARTS / count;
        let mut is_predicted = vec![true; count];
        let mut rest = |terms: &[Term]| {
            let mut rest = vec![0.0; count];
            for fold in 0..FOLDS {
                let is_held = |k: usize| part(k) % FOLDS == fold;
                let fitted = fit(rows, terms, &|k| !is_held(k));
                let is_determined = determined(&fitted, rows, true);
                for (k, value) in fitted.rest.iter().enumerate().filter(|(k, _)| is_held(*k)) {
                    rest[k] = *value;
                    is_predicted[k] &= is_determined[k];
                }
            }
            rest
        };
        let rests = [rest(&shapes(own)), rest(&own.terms)];
        collected(
            rows,
            &own.weights,
            &rests,
            (&is_predicted, Some(&bare.rest)),
        )
    };
    rows.joints
        .iter()
        .zip(chosen.bare.iter().zip(&chosen.fitted))
        .map(of_joint)
        .collect()
}

/// Rows of a second recording, whose zeros are its own.
pub(super) fn on_second(
    second: &Rows,
    rows: &Rows,
    chosen: &Chosen,
) -> Result<Vec<Unseen>, MotionError> {
    let numbers = |own: &Rows| own.joints.iter().map(|own| own.joint).collect::<Vec<_>>();
    if numbers(second) != numbers(rows) {
        let message = "the second recording lacks encoders on links that the first one has";
        return Err(MotionError::Sampling(message.to_owned()));
    }
    let mut found = Vec::new();
    for (at, there) in second.joints.iter().enumerate() {
        let (bare, own) = (&chosen.bare[at], &chosen.fitted[at]);
        let weights = weights_of(own, there);
        let rests = [bare, own].map(|fitted| {
            let model = predicted(there, &fitted.terms, &fitted.coefficients);
            let rest = there
                .beside
                .iter()
                .zip(&model)
                .map(|(own, model)| own - model);
            about_zero(there, &weights, rest.collect())
        });
        let mut is_predicted = determined(own, there, false);
        let of_bare = determined(bare, there, false);
        (is_predicted.iter_mut().zip(of_bare)).for_each(|(own, bare)| *own &= bare);
        let mut unseen = collected(there, &weights, &rests, (&is_predicted, None));
        let at = |k: usize| {
            let measured = there.link[k];
            (
                second.row_of[k],
                [measured, measured - rests[0][k], measured - rests[1][k]],
            )
        };
        let rows = (0..there.count()).filter(|k| is_predicted[*k]);
        unseen.predictions = rows.map(at).collect();
        found.push(unseen);
    }
    Ok(found)
}

/// Weights of rows that a fit may not be of: less where its law does not say where in its play the link is.
pub(super) fn weights_of(fitted: &Fitted, there: &JointRows) -> Vec<f64> {
    let play = fitted.of(Term::PLAY);
    let flight = play.and_then(|(at, term)| Some((fitted.coefficients[at], term.flight(there)?)));
    match flight {
        Some((half, flight)) => (flight.iter())
            .map(|share| (fitted.sd / fitted.sd.hypot(share * half)).powi(2))
            .collect(),
        None => vec![1.0; there.count()],
    }
}

/// The terms that are calibration.
fn shapes(fitted: &Fitted) -> Vec<Term> {
    let own = fitted.terms.iter().filter(|own| **own == Term::Shape);
    own.copied().collect()
}

/// A rest without each piece's mean.
pub(super) fn about_zero(rows: &JointRows, weights: &[f64], mut rest: Vec<f64>) -> Vec<f64> {
    for piece in rows.pieces.windows(2) {
        let own = piece[0]..piece[1];
        let sum: f64 = own.clone().map(|k| weights[k] * rest[k]).sum();
        let mean = sum / weights[own.clone()].iter().sum::<f64>().max(1e-300);
        rest[own].iter_mut().for_each(|value| *value -= mean);
    }
    rest
}

/// Sums of squares by parts of the rows that are predicted; a row counts by its weight. Of the others those of `seen`, if there is such
/// a fit.
fn collected(
    rows: &JointRows,
    weights: &[f64],
    [before, after]: &[Vec<f64>; 2],
    (is_predicted, seen): (&[bool], Option<&[f64]>),
) -> Unseen {
    let count = rows.count();
    let mean = weights.iter().sum::<f64>() / count.max(1) as f64;
    let mut found = Unseen::new(rows.joint, rows.noise);
    for k in 0..count {
        let weight = weights[k] / mean.max(1e-300);
        if !is_predicted[k] {
            found.left_out.0 += 1;
            found.left_out.1 += seen.map_or(0.0, |seen| weight * seen[k].powi(2));
            continue;
        }
        let square = |rest: &[f64]| weight * rest[k].powi(2);
        found.add((k, count), [square(before), square(after)]);
    }
    found
}
