//! Rigid transforms: products, inverses, turns about z, rotation vectors.

use haptical_kinematics::Pose;
use haptical_kinematics::nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// `first`, then `second` in the frame it leads to.
///
/// ```
/// use haptical_model::kinematics::Pose;
/// use haptical_model::kinematics::nalgebra::Vector3;
/// use haptical_model::rigid::{about_z, inverse, then, turn};
/// let up = Pose { position_m: Vector3::y(), ..Pose::default() };
/// let turned = then(&turn(about_z(std::f64::consts::FRAC_PI_2)), &up);
/// assert!((turned.position_m + Vector3::x()).amax() < 1e-15);
/// assert!(then(&inverse(&turned), &turned).position_m.amax() < 1e-15);
/// ```
pub fn then(first: &Pose, second: &Pose) -> Pose {
    Pose {
        position_m: first.position_m + first.rotation * second.position_m,
        rotation: first.rotation * second.rotation,
    }
}

/// The transform back.
pub fn inverse(pose: &Pose) -> Pose {
    let rotation = pose.rotation.transpose();
    Pose {
        position_m: -(rotation * pose.position_m),
        rotation,
    }
}

/// A rotation without a displacement.
pub fn turn(rotation: Matrix3<f64>) -> Pose {
    Pose {
        rotation,
        ..Pose::default()
    }
}

/// The turn about z by an angle.
pub fn about_z(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// Rotation vector of a rotation matrix: its axis, as long as its angle \[rad\].
///
/// ```
/// use haptical_model::rigid::{about_z, rotation_vector};
/// assert!((rotation_vector(&about_z(0.3)).z - 0.3).abs() < 1e-15);
/// ```
pub fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation)).scaled_axis()
}
