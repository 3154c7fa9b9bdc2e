//! A 7-joint arm with small deviations everywhere, as after a calibration.

use std::f64::consts::FRAC_PI_2;

use haptical_kinematics::{Link, Motion};

/// Moving rows.
pub(crate) const JOINTS: usize = 7;

/// Row 0 leads to the base, the others turn.
pub(crate) const MOTIONS: [Motion; JOINTS + 1] = {
    let mut motions = [Motion::Revolute; JOINTS + 1];
    motions[0] = Motion::Fixed;
    motions
};

/// A posture without a special angle.
pub(crate) const POSTURE_RAD: [f64; JOINTS] = [0.3, -0.2, 0.4, -1.1, 0.6, -0.7, 0.8];

/// The rows: nominal ones, a hundredth off.
pub(crate) fn links() -> [Link; JOINTS + 1] {
    core::array::from_fn(|row| {
        let off = 0.01 * (row as f64 - 3.3);
        let side = if row % 2 == 0 { 1.0 } else { -1.0 };
        Link {
            a_m: 0.05 * row as f64 + off,
            alpha_rad: side * FRAC_PI_2 + off,
            d_m: 0.1 * side + off,
            theta_rad: 0.2 * off,
            beta_rad: if row == 3 { off } else { 0.0 },
            b_m: 0.0,
        }
    })
}
