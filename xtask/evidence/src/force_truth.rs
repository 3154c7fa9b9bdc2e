//! The angle between a wanted force and the one that a device exerts whose controller knows it by a fit.

use anyhow::{Result, ensure};
use haptical_model::kinematics::nalgebra::{Vector3, Vector6};
use haptical_model::{Device, Evaluation, ForceTransmission, Recording};

/// Joints that move; joint 3 is locked, as in the paper.
const FREE: [usize; 6] = [0, 1, 3, 4, 5, 6];
/// Postures of a recording, and condition from which one is left out: those of the prediction.
const POSTURES: usize = 60;
const WORST_CONDITION: f64 = 300.0;

/// Root mean square over the postures, of the transverse part of a unit force along the handle's z \[rad\].
pub(super) fn true_angle_rad(
    truth: &Device,
    fitted: &Device,
    recording: &Recording,
) -> Result<f64> {
    let step = recording.len().div_ceil(POSTURES);
    let (mut sum, mut count) = (0.0, 0);
    let (mut actual, mut known) = (Evaluation::new(truth), Evaluation::new(fitted));
    for row in (0..recording.len()).step_by(step) {
        let mut readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        readings[2] = 0.0;
        actual.move_to(&readings)?;
        known.move_to(&readings)?;
        let Ok(own) = ForceTransmission::new(&known, &known, FREE) else {
            continue;
        };
        if own.condition > WORST_CONDITION {
            continue;
        }
        let transmission = ForceTransmission::new(&actual, &known, FREE)?;
        let along: Vector3<f64> = known.pose()?.rotation.column(2).into_owned();
        let wrench = transmission.wrench(&Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0));
        let force = Vector3::new(wrench[0], wrench[1], wrench[2]);
        let felt = actual.pose()?.rotation.transpose() * force;
        sum += felt.x * felt.x + felt.y * felt.y;
        count += 1;
    }
    ensure!(count > 0, "every posture is singular");
    Ok((sum / f64::from(count)).sqrt())
}
