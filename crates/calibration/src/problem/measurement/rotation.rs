//! Rotations of the tracker and how their residuals change.

use haptical_model::Recording;
use haptical_model::kinematics::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
pub(crate) use haptical_model::rigid::rotation_vector;

/// The tracker's orientation at a row, as a rotation matrix.
pub(crate) fn measured_rotation(recording: &Recording, row: usize) -> Matrix3<f64> {
    match &recording.orientation_wxyz {
        Some([w, x, y, z]) => {
            let quaternion = Quaternion::new(w[row], x[row], y[row], z[row]);
            UnitQuaternion::from_quaternion(quaternion)
                .to_rotation_matrix()
                .into_inner()
        }
        None => Matrix3::from_element(f64::NAN),
    }
}

/// Inverse of the left Jacobian of SO(3): d log(exp([w]) R) / d w at w = 0, for log R = v
/// (Chirikjian 2012, section 10.6): 1 - [v]/2 + (1/|v|^2 - cot(|v|/2)/(2|v|)) [v]^2.
pub(crate) fn inverse_left_jacobian(v: &Vector3<f64>) -> Matrix3<f64> {
    let angle = v.norm();
    let cross = v.cross_matrix();
    let factor = if angle < 1e-4 {
        // Series: the closed form loses all digits near zero.
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        1.0 / (angle * angle) - 0.5 / (angle * (0.5 * angle).tan())
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * factor
}
