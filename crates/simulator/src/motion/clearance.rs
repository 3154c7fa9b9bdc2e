//! Keeps the hand's way clear of the points where the cables leave their guides.

use haptical_model::{Device, Evaluation, ModelError};

use crate::poses::way_m;
use crate::{Motion, SimulatorError};

/// Instants looked at \[1/s\]: at a hand's speed of 1.5 m/s the handle moves 15 mm between two.
const LOOKS_PER_S: f64 = 100.0;
/// Times that the targets near a cable's exit are drawn again.
const MAX_DRAWS: usize = 100;

/// Draws targets again until the handle of `truth` is at least `minimum_distance_m` from every cable's
/// exit at every instant looked at. A device without links has no handle.
pub(crate) fn keep_clear(
    motion: &mut Motion,
    truth: &Device,
    seconds: f64,
    minimum_distance_m: f64,
) -> Result<(), SimulatorError> {
    if !truth.has_links() || truth.cables.is_empty() {
        return Ok(());
    }
    let looks = libm::ceil(seconds * LOOKS_PER_S) as usize;
    let mut evaluation = Evaluation::new(truth);
    let mut readings = vec![0.0; truth.joints.len()];
    let mut near = 0;
    for _ in 0..MAX_DRAWS {
        let mut is_clear = true;
        for look in 0..looks {
            let time_s = look as f64 / LOOKS_PER_S;
            for (joint, reading) in readings.iter_mut().enumerate() {
                *reading = motion.joint_motion(joint, time_s).position;
            }
            let shortest_m = shortest_m(&mut evaluation, truth, &readings)
                .map_err(|source| SimulatorError::Row { row: look, source })?;
            if shortest_m < minimum_distance_m {
                motion.redraw(time_s);
                is_clear = false;
                near = look;
            }
        }
        if is_clear {
            return Ok(());
        }
    }
    Err(SimulatorError::TooNearCableExit {
        row: near,
        attempts: MAX_DRAWS,
        minimum_distance_m,
    })
}

/// Distance to the nearest exit \[m\].
fn shortest_m(
    evaluation: &mut Evaluation<'_>,
    truth: &Device,
    readings: &[f64],
) -> Result<f64, ModelError> {
    evaluation.move_pose_to(readings)?;
    let handle_m = evaluation.pose()?.position_m;
    let mut cables = truth.cables.iter();
    cables.try_fold(f64::INFINITY, |shortest_m, cable| {
        Ok(shortest_m.min(way_m(cable, &handle_m)?))
    })
}
