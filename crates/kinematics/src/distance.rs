//! Measures the distance from an anchor to the chain's end, and differentiates it.

use nalgebra::Vector3;

use crate::{KinematicsError, Pose, Twist};

/// Distance between a position and an anchor, `delta = |P - anchor|`, in m.
///
/// Both are in m, expressed in the same frame. With the anchor at the origin of frame (-1), where
/// the measurement cable leaves its encoder, this is Baser & Konukseven eq. (5).
///
/// ```
/// use haptical_kinematics::{distance_m, nalgebra::Vector3};
/// let delta_m = distance_m(&Vector3::new(2.0, 3.0, 6.0), &Vector3::zeros())?;
/// assert!((delta_m - 7.0).abs() < 1e-15);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
///
/// # Errors
///
/// [`KinematicsError::ZeroDistance`] if the two coincide, where the distance has no derivative;
/// [`KinematicsError::NonFiniteVector`]; [`KinematicsError::Overflow`].
pub fn distance_m(
    position_m: &Vector3<f64>,
    anchor_m: &Vector3<f64>,
) -> Result<f64, KinematicsError> {
    let (_, distance_m) = separation(position_m, anchor_m)?;
    Ok(distance_m)
}

/// Derivative of the distance between a pose and an anchor, `d delta = u . linear dx` with
/// `u = (P - anchor) / |P - anchor|`.
///
/// The anchor is in m in frame (-1) and does not move. The result is in m per unit of the scalar
/// to which `twist` belongs. It is the derivative of Baser & Konukseven eq. (5).
///
/// ```
/// use haptical_kinematics::{Pose, Twist, distance_derivative, nalgebra::Vector3};
/// let pose = Pose { position_m: Vector3::new(0.0, 0.3, 0.4), ..Pose::default() };
/// let twist = Twist { linear: Vector3::y(), angular: Vector3::zeros() };
/// let derivative = distance_derivative(&pose, &Vector3::zeros(), &twist)?;
/// assert!((derivative - 0.6).abs() < 1e-15);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
///
/// # Errors
///
/// As [`distance_m`].
pub fn distance_derivative(
    pose: &Pose,
    anchor_m: &Vector3<f64>,
    twist: &Twist,
) -> Result<f64, KinematicsError> {
    check_finite("the twist's linear part", &twist.linear)?;
    let (separation_m, distance_m) = separation(&pose.position_m, anchor_m)?;
    let derivative = (separation_m / distance_m).dot(&twist.linear);
    finite(derivative, "the derivative of the distance")
}

fn separation(
    position_m: &Vector3<f64>,
    anchor_m: &Vector3<f64>,
) -> Result<(Vector3<f64>, f64), KinematicsError> {
    check_finite("the position", position_m)?;
    check_finite("the anchor", anchor_m)?;
    let separation_m = position_m - anchor_m;
    // hypot, because the squares of very short or very long separations are not representable
    let distance_m = libm::hypot(libm::hypot(separation_m.x, separation_m.y), separation_m.z);
    if distance_m == 0.0 {
        return Err(KinematicsError::ZeroDistance {
            position_m: (*position_m).into(),
        });
    }
    Ok((separation_m, finite(distance_m, "the distance")?))
}

pub(crate) fn check_finite(
    vector: &'static str,
    value: &Vector3<f64>,
) -> Result<(), KinematicsError> {
    if value.iter().all(|component| component.is_finite()) {
        Ok(())
    } else {
        Err(KinematicsError::NonFiniteVector {
            vector,
            value: (*value).into(),
        })
    }
}

pub(crate) fn finite(value: f64, quantity: &'static str) -> Result<f64, KinematicsError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(KinematicsError::Overflow { quantity })
    }
}
