//! The direction of gravity in frame (-1): known where the base is fixed to the root.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;

use crate::chain::path::Path;
use crate::robot::{Inertial, Robot};
use haptical_model::rigid::then;

/// Gravity where the file says nothing, z of the root link being up \[m/s^2\].
const GRAVITY_MPS2: [f64; 3] = [0.0, 0.0, -9.81];

/// Gravity in the frame of a path's base \[m/s^2\]; none where a joint moves between the root and the base.
pub(crate) fn gravity_mps2(robot: &Robot, path: &Path) -> Option<[f64; 3]> {
    let gravity_mps2 = robot.stated_gravity_mps2.unwrap_or(GRAVITY_MPS2);
    let to_base = Path::from_root(robot, path.base);
    if to_base.steps.is_empty() {
        return Some(gravity_mps2);
    }
    if to_base.moving(robot) > 0 {
        return None;
    }
    let steps = to_base.steps.iter();
    let base = steps.fold(Pose::default(), |base, step| {
        then(&base, &robot.joints[step.joint].origin)
    });
    let turned = base.rotation.tr_mul(&Vector3::from(gravity_mps2));
    Some(turned.into())
}

/// What is said where gravity has no fixed direction and the file has masses.
pub(crate) fn said_of_no_gravity(robot: &Robot, path: &Path, file: &str) -> Option<String> {
    let is_heavy = |own: Option<Inertial>| own.is_some_and(|own| own.mass_kg > 0.0);
    if !robot.links.iter().any(|link| is_heavy(link.inertial)) {
        return None;
    }
    let root = Path::from_root(robot, path.base).base;
    Some(format!(
        "{file}: the base `{}` moves with respect to the root `{}`, so gravity has no fixed direction in frame \
         (-1): masses and gravity are left out; for joints that yield to their torque log the torques, in \
         columns torque1_nm, ...",
        robot.links[path.base].name, robot.links[root].name
    ))
}
