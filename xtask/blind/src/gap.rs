//! The gap that effects open in a recording: what the true base model leaves unexplained, without noise.

use std::collections::BTreeMap;

use anyhow::Result;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation};
use serde::{Deserialize, Serialize};

use crate::rig::scene::Recorded;

/// The gap of one channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelGapTruth {
    /// Root mean square, in the channel's unit (rad or m).
    pub rms: f64,
    /// The same over the stated standard deviation of the channel's noise.
    pub over_sd: f64,
}

/// Every so many rows are enough for a root mean square.
const ROW_STEP: usize = 10;

/// Root mean square of the difference that rounding of the motor-side readings makes to what the true device
/// predicts, per channel.
pub(crate) fn rounding(
    device: &Device,
    exact_rad: &[Vec<f64>],
    rounded_rad: &[Vec<f64>],
) -> Result<BTreeMap<String, f64>> {
    let mut evaluation = Evaluation::new(device);
    let mut predict = |columns: &[Vec<f64>], row: usize| -> Result<Vec<f64>> {
        let readings: Vec<f64> = columns.iter().map(|column| column[row]).collect();
        evaluation.move_to(&readings)?;
        let outputs = (0..readings.len()).map(|joint| evaluation.output_rad(joint));
        let mut predicted: Vec<f64> = outputs.collect();
        let position_m = evaluation.pose()?.position_m;
        for cable in &device.cables {
            predicted.push((position_m - Vector3::from(cable.anchor_m)).norm());
        }
        Ok(predicted)
    };
    let rows = exact_rad.first().map_or(0, Vec::len);
    let mut squares = vec![0.0; device.joints.len() + device.cables.len()];
    for row in (0..rows).step_by(ROW_STEP) {
        let (exact, rounded) = (predict(exact_rad, row)?, predict(rounded_rad, row)?);
        for (square, (exact, rounded)) in squares.iter_mut().zip(exact.iter().zip(&rounded)) {
            *square += (exact - rounded).powi(2);
        }
    }
    let counted = rows.div_ceil(ROW_STEP).max(1) as f64;
    let channels = squares.into_iter().enumerate().map(|(channel, square)| {
        let name = match channel.checked_sub(device.joints.len()) {
            None => format!("out{}", channel + 1),
            Some(0) => "cable".to_owned(),
            Some(cable) => format!("cable{}", cable + 1),
        };
        (name, libm::sqrt(square / counted))
    });
    Ok(channels.collect())
}

/// Root mean square of noise-free reading less prediction by the true device from the motor-side
/// readings, per channel (`out1`, ..., `cable`). It holds the rounding of the motor-side readings, and
/// all of the effect: a fit of the base model takes up a part.
pub(crate) fn true_gap(
    device: &Device,
    recorded: &Recorded,
) -> Result<BTreeMap<String, ChannelGapTruth>> {
    let joints = device.joints.len();
    let mut evaluation = Evaluation::new(device);
    let mut readings = vec![0.0; joints];
    let mut squares = vec![0.0; joints + 1];
    let mut rows = 0.0;
    let anchor_m = device.cables.first().map(|cable| cable.anchor_m);
    for row in (0..recorded.log.len()).step_by(ROW_STEP) {
        recorded.log.read_joints(row, &mut readings);
        evaluation.move_to(&readings)?;
        for (joint, clean) in recorded.clean.output_rad.iter().enumerate() {
            if let Some(clean) = clean {
                let difference = clean[row] - evaluation.output_rad(joint);
                squares[joint] += difference * difference;
            }
        }
        if let (Some(Some(clean)), Some(anchor_m)) = (recorded.clean.cable_m.first(), anchor_m) {
            let position_m = evaluation.pose()?.position_m;
            let difference = clean[row] - (position_m - Vector3::from(anchor_m)).norm();
            squares[joints] += difference * difference;
        }
        rows += 1.0;
    }
    let mut gaps = BTreeMap::new();
    for (channel, square) in squares.iter().enumerate() {
        let (name, sd) = match device.joints.get(channel) {
            Some(joint) => (format!("out{}", channel + 1), joint.output_sd_rad()),
            None => ("cable".to_owned(), device.cable_sd_m(0)),
        };
        if let Some(sd) = sd {
            let rms = libm::sqrt(square / rows);
            let over_sd = rms / sd;
            gaps.insert(name, ChannelGapTruth { rms, over_sd });
        }
    }
    Ok(gaps)
}
