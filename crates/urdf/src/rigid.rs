//! Turns about axes, and the angles in which URDF writes a rotation.

use haptical_model::kinematics::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use haptical_model::rigid::about_z;

/// Shortest vector that has a direction, as a share of nothing: MuJoCo's own is 1e-15 \[m\] or without unit.
pub(crate) const SHORTEST: f64 = 1e-10;

pub(crate) fn about_x(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

pub(crate) fn about_y(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

/// URDF's roll, pitch, yaw about fixed axes: Rz(yaw) Ry(pitch) Rx(roll).
pub(crate) fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> Matrix3<f64> {
    about_z(yaw) * about_y(pitch) * about_x(roll)
}

/// A rotation as a quaternion with its real part first; none without a length.
pub(crate) fn from_quaternion([w, x, y, z]: [f64; 4]) -> Option<Matrix3<f64>> {
    let quaternion = Quaternion::new(w, x, y, z);
    let turn = UnitQuaternion::try_new(quaternion, SHORTEST)?;
    Some(turn.to_rotation_matrix().into_inner())
}

/// Roll, pitch, yaw of a rotation.
///
/// Pitch and roll are those of the rotation turned back by the yaw, so that the three together give the
/// rotation back wherever the pitch is: near a quarter turn, where only a sum of roll and yaw is
/// determined, any yaw serves.
pub(crate) fn to_rpy(r: &Matrix3<f64>) -> [f64; 3] {
    let yaw = libm::atan2(r[(1, 0)], r[(0, 0)]);
    let (s, c) = libm::sincos(yaw);
    let pitch = libm::atan2(-r[(2, 0)], c * r[(0, 0)] + s * r[(1, 0)]);
    let roll = libm::atan2(s * r[(0, 2)] - c * r[(1, 2)], c * r[(1, 1)] - s * r[(0, 1)]);
    [roll, pitch, yaw]
}

/// The rotation by the least angle that takes z to a unit vector; for one that points down, the least one
/// behind a half turn about x, so that no direction is singular.
pub(crate) fn z_to(axis: &[f64; 3]) -> Matrix3<f64> {
    let axis = Vector3::from(*axis);
    if axis.z < 0.0 {
        return least_z_to(&-axis) * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    }
    least_z_to(&axis)
}

/// Rodrigues' formula for the turn about z x axis; the axis does not point down.
fn least_z_to(axis: &Vector3<f64>) -> Matrix3<f64> {
    let skew = Vector3::z().cross(axis).cross_matrix();
    Matrix3::identity() + skew + skew * skew / (1.0 + axis.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-14;

    #[test]
    fn roll_pitch_yaw_come_back_next_to_a_quarter_turn_too() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for offset in [0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1e-3, 0.4] {
            for pitch in [quarter - offset, -quarter + offset, offset] {
                for (roll, yaw) in [(0.0, 0.0), (0.3, -2.9), (-3.1, 1.2), (1.5, 1.5)] {
                    let rotation = from_rpy([roll, pitch, yaw]);
                    let gap = (from_rpy(to_rpy(&rotation)) - rotation).amax();
                    assert!(gap < ROUNDING, "{gap:e} at {roll} {pitch} {yaw}");
                }
            }
        }
    }

    #[test]
    fn z_goes_to_any_axis() {
        let mut axes = vec![
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
            [1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
        ];
        for step in 0..200 {
            let (s, c) = (0.37 * f64::from(step)).sin_cos();
            let (height, width) = (f64::from(step) * 0.9).sin_cos();
            axes.push([width * c, width * s, height]);
        }
        for axis in axes {
            let rotation = z_to(&axis);
            assert!((rotation.column(2) - Vector3::from(axis)).amax() < ROUNDING);
            assert!((rotation * rotation.transpose() - Matrix3::identity()).amax() < ROUNDING);
            assert!((rotation.determinant() - 1.0).abs() < ROUNDING);
        }
    }
}
