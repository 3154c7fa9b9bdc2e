//! The budget of one posture by draws: the fitted numbers are drawn together and moved in the device itself, not along its
//! derivatives.

use haptical_kinematics::nalgebra::Vector3;
use haptical_metrics::budget::{Combined, Input, agreement, simulated};
use haptical_model::Recording;

use super::contributions::What;
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
    let values = handle
        .parameters
        .iter()
        .map(|parameter| parameter.value(&handle.device));
    let values: Vec<f64> = values.collect();
    let mut inputs: Vec<Input> = Vec::new();
    let mut slopes: Vec<f64> = Vec::new();
    let mut group: (&[f64], f64) = (&[], f64::INFINITY);
    for part in &posture.parts {
        match &part.what {
            What::Fit => group = (&part.covariance, part.degrees),
            What::Input { input, .. } => {
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
            let along =
                position(&there).map_or(f64::NAN, |at| axis.dot(&(at - posture.position_m)));
            along
                + slopes
                    .iter()
                    .zip(own)
                    .map(|(slope, draw)| slope * draw)
                    .sum::<f64>()
        };
        found = Some(simulated(&inputs, group, model, trials, by_law.level, SEED));
    })?;
    let found = found
        .ok_or_else(|| Error::internal("no draws"))?
        .map_err(Error::internal)?;
    Ok(Draws {
        simulated: found,
        agreement: agreement(0.0, by_law, &found, DIGITS).map_err(Error::internal)?,
        seed: SEED,
    })
}
