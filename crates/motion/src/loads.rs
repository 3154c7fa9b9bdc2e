//! What the links ask of their drives, row by row.

use haptical_model::{Device, Recording};

use crate::MotionError;
use crate::arm::Arm;
use crate::recorded::hand_torques;
use crate::signal::link::Link;
use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::samples::Samples;
use crate::thresholds::signal::{LOADS_CUTOFF_HZ, LOADS_OF_RATE};

/// Torques of the rigid bodies of a device along a recording, joint by joint and row by row, armatures and friction left out:
/// what a spring between motor and link carries, the force of a hand that is in the recording included. Positions are those of the
/// links' encoders where there are any. A row that no piece without a gap reaches has NaN.
///
/// # Errors
/// As [`crate::examine`].
pub fn link_torques(device: &Device, recording: &Recording) -> Result<Vec<Vec<f64>>, MotionError> {
    let arm = Arm::new(device)?;
    let samples = Samples::new(recording, false)?;
    let cutoff_hz = LOADS_CUTOFF_HZ.min(LOADS_OF_RATE * samples.rate_hz());
    let local = LocalPolynomial::new(samples.step_s, cutoff_hz);
    let joints = arm.joints();
    let links: Vec<Option<Link>> = (0..joints)
        .map(|joint| Link::new(&samples, joint, cutoff_hz))
        .collect();
    let nominal = arm.nominal();
    let columns = nominal.len();
    let mut work = arm.work();
    let mut regressor = vec![0.0; joints * columns];
    let mut found = vec![vec![f64::NAN; recording.len()]; joints];
    let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    for (number, piece) in samples.pieces.iter().enumerate() {
        if piece.length <= 2 * local.half {
            continue;
        }
        for k in 0..piece.length {
            // at its ends the nearest sample that has neighbours enough
            let inner = k.clamp(local.half, piece.length - 1 - local.half);
            for (order, values) in at.iter_mut().enumerate() {
                for joint in 0..joints {
                    let link = links[joint].as_ref().map(|link| &link.pieces[number]);
                    let positions = link.unwrap_or(&piece.motor[joint]);
                    values[joint] = local.at(order, positions, inner);
                }
            }
            arm.bodies
                .regressor(&at[0], &at[1], &at[2], &mut work, &mut regressor)?;
            for (joint, own) in regressor.chunks_exact(columns).enumerate() {
                if let Some(into) = found[joint].get_mut(piece.first_row + k) {
                    *into = haptical_linalg::dot(own, &nominal);
                }
            }
        }
    }
    for (load, of_hand) in found.iter_mut().zip(hand_torques(device, recording)) {
        (load.iter_mut().zip(of_hand)).for_each(|(load, of_hand)| *load += of_hand);
    }
    Ok(found)
}
