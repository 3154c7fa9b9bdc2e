//! The budget of one posture by draws: the fitted numbers are drawn together and moved in the device itself, not along its
//! derivatives.

use haptical_kinematics::nalgebra::Vector3;
use haptical_metrics::budget::{Combined, Input, agreement, simulated};
use haptical_model::Recording;

use super::handle::Handle;
use super::{Draws, Posture, SEED};
use crate::error::Error;

/// Significant digits at which the law must agree.
const DIGITS: u32 = 2;

pub(super) fn by_draws(
    handle: &Handle,
    recording: &Recording,
    posture: &Posture,
    axis: &Vector3<f64>,
    by_law: &Combined,
    trials: usize,
) -> Result<Draws, Error> {
    let values = handle.parameters.iter();
    let values: Vec<f64> = values.map(|own| own.value(&handle.device)).collect();
    let (mut inputs, mut slopes): (Vec<Input>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut group: (&[f64], f64) = (&[], f64::INFINITY);
    for part in &posture.parts {
        match &part.input {
            None => group = (&part.covariance, part.degrees),
            Some((input, _)) => {
                inputs.push(*input);
                slopes.push(axis.dot(&part.slopes[0]));
            }
        }
    }
    let mut found = None;
    handle.with_values(&recording.select(&[posture.row]), |position| {
        let mut there = values.clone();
        let model = |draws: &[f64]| {
            let (own, moved) = draws.split_at(slopes.len());
            for ((there, value), change) in there.iter_mut().zip(&values).zip(moved) {
                *there = value + change;
            }
            let at = position(&there);
            let along = at.map_or(f64::NAN, |at| axis.dot(&(at - posture.position_m)));
            let products = slopes.iter().zip(own).map(|(slope, draw)| slope * draw);
            along + products.sum::<f64>()
        };
        found = Some(simulated(&inputs, group, model, trials, by_law.level, SEED));
    })?;
    let found = found.ok_or_else(|| Error::internal("no draws"))?;
    let found = found.map_err(Error::internal)?;
    Ok(Draws {
        simulated: found,
        agreement: agreement(0.0, by_law, &found, DIGITS).map_err(Error::internal)?,
        seed: SEED,
    })
}
