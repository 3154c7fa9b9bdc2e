//! Maps a wrench at the chain's end to the joints that hold it.

use nalgebra::Vector3;

use crate::derivatives::check_length;
use crate::distance::{check_finite, finite};
use crate::{KinematicsError, Twist};

/// Joint torques equivalent to a wrench acting at the handle, `tau = J^T [F; M]`.
///
/// `jacobian` holds the columns of [`Chain::geometric_jacobian`](crate::Chain::geometric_jacobian).
/// The force, in N, acts at the last frame's origin; the moment, in Nm, about it; both are
/// expressed in frame (-1). `out` has one entry per column: `linear . F + angular . M`, in Nm for
/// a revolute joint and in N for a prismatic one. These are the torques with which the joints
/// exert the wrench on the surroundings; gravity, friction and acceleration are not part of it.
/// Source: Siciliano et al., *Robotics: Modelling, Planning and Control*, section on statics.
///
/// ```
/// use haptical_kinematics::nalgebra::Vector3;
/// use haptical_kinematics::{Chain, Convention, Link, Motion, Twist, joint_torques_nm};
/// let links = [Link { a_m: 0.3, ..Link::default() }];
/// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute])?;
/// let mut jacobian = [Twist::default()];
/// chain.geometric_jacobian(&[0.0], &mut jacobian)?;
/// let mut torque_nm = [0.0];
/// let force_n = Vector3::new(0.0, 2.0, 0.0);
/// joint_torques_nm(&jacobian, &force_n, &Vector3::zeros(), &mut torque_nm)?;
/// assert!((torque_nm[0] - 0.6).abs() < 1e-15); // 2 N at 0.3 m
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
///
/// # Errors
///
/// [`KinematicsError::BufferLength`] if `out` has not one entry per column;
/// [`KinematicsError::NonFiniteVector`] for a force, moment or column that is not finite;
/// [`KinematicsError::Overflow`].
pub fn joint_torques_nm(
    jacobian: &[Twist],
    force_n: &Vector3<f64>,
    moment_nm: &Vector3<f64>,
    out: &mut [f64],
) -> Result<(), KinematicsError> {
    check_length("the slice of joint torques", jacobian.len(), out.len())?;
    check_finite("the force", force_n)?;
    check_finite("the moment", moment_nm)?;
    for (torque, column) in out.iter_mut().zip(jacobian) {
        check_finite("a Jacobian column's linear part", &column.linear)?;
        check_finite("a Jacobian column's angular part", &column.angular)?;
        let sum = column.linear.dot(force_n) + column.angular.dot(moment_nm);
        *torque = finite(sum, "a joint torque")?;
    }
    Ok(())
}
