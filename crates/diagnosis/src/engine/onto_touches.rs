//! The postures of touches, moved to where the handle is on what it touches: there derivatives know nothing of noise.

use haptical_calibration::Weights;
use haptical_effects::{Touches, streams};
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Evaluation, Recording};

use crate::Result;
use crate::engine::{Base, BaseProblem};
use crate::thresholds::engine::TOUCHES_RIDGE;

/// The recording with each touch's joints moved by the least angles that take the handle to what it touches, by a base
/// model's fit; none without touches.
///
/// A touch's noise is in its joint readings, and so in every derivative that is taken at them: derivative and residual
/// are correlated, and the sum of their products is not zero without a gap but N tr((dC/dq) J^+ V), with V the noise's
/// covariance (errors in variables; Fuller, *Measurement Error Models*, 1987, chapter 3). With touches of 2 mm it is
/// several standard deviations. To the first order the posture on the target has none of the noise: q - J^+ r.
pub(crate) fn onto_touches(base: &Base, recording: &Recording) -> Result<Option<Recording>> {
    let streams = streams(&base.device, &base.channels);
    let touched: Vec<usize> = (0..streams.len())
        .filter(|&s| streams[s].is_touch())
        .collect();
    if touched.is_empty() {
        return Ok(None);
    }
    let weights = Weights::stated(&base.device, &base.channels);
    let problem = BaseProblem::new(base, recording, recording, &streams, &weights)?;
    let residual = problem.evaluate(&problem.start(), false)?.residual;
    let touches = Touches::new(&base.device, recording);
    let mounts = base.device.mounts(recording).unwrap_or_default();
    let mut evaluation = Evaluation::new(&base.device);
    let mut moved = recording.clone();
    let mut readings = vec![0.0; recording.joint.len()];
    for row in 0..recording.len() {
        recording.read_joints(row, &mut readings);
        evaluation.choose_hand(base.device.hand_at(recording, row));
        // what is wrong with a row, the context says
        if evaluation.move_to(&readings).is_err() {
            continue;
        }
        // measured minus model: where the handle has to go
        let mount = mounts.get(row).copied().unwrap_or_default();
        let handle = evaluation.pose().map(|pose| pose.rotation);
        let arm = handle.unwrap_or_default() * base.device.touching_m(mount);
        let mut way = Vector3::zeros();
        let mut across = Matrix3::zeros();
        for &stream in &touched {
            let gap = residual[stream][row];
            if gap.is_finite() {
                let seen = touches.direction(&streams[stream], row);
                way += seen * gap;
                across += seen * seen.transpose();
            }
        }
        let twists: Vec<Vector3<f64>> = (0..readings.len())
            .map(|joint| {
                let twist = evaluation.reading_twist(joint);
                across * (twist.linear + twist.angular.cross(&arm))
            })
            .collect();
        let square: Matrix3<f64> = twists.iter().map(|twist| twist * twist.transpose()).sum();
        let square = square + Matrix3::identity() * (TOUCHES_RIDGE * square.trace() / 3.0);
        let Some(inverse) = square.try_inverse() else {
            continue;
        };
        let pull = inverse * way;
        for (column, twist) in moved.joint.iter_mut().zip(&twists) {
            column[row] += twist.dot(&pull);
        }
    }
    Ok(Some(moved))
}
