//! Joins bodies into a tree, and checks what its functions are given.

use nalgebra::Vector3;

use crate::{Body, DynamicsError, Scratch, Wrench};

/// Largest coordinate of a placement, in m, and largest other number: products of a few of them are finite.
const LIMIT: f64 = 1e50;
/// How far an axis's length may be from 1.
const AXIS_TOLERANCE: f64 = 1e-9;
/// How far a matrix of inertia may be from its transpose, per largest entry.
const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// A tree of rigid bodies on a base that stands still, one joint to each body.
///
/// It borrows the bodies; joint `i` carries body `i`. Everything that an evaluation needs besides is in a
/// slice of [`Scratch`], one for each body, that the caller owns and may use again: nothing is kept
/// in it from call to call, except what [`Scratch::pose`] shows.
///
/// Joint vectors `q`, `dq`, `ddq` have one entry per body: rad, rad/s and rad/s^2 for a revolute joint, m,
/// m/s and m/s^2 for a prismatic one; torques are in Nm and N. Matrices are written row by row.
///
/// Vectors are taken about the base's origin, so the rounding of small inertias grows with the square
/// of their distance from it: 1e-12 of 1e-4 kg m^2 for 0.1 kg at 2 m.
///
/// ```
/// use haptical_dynamics::nalgebra::{Matrix3, Vector3};
/// use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree};
/// // A pendulum: 2 kg at 0.5 m, turning about y, hanging along -z.
/// let bob_m = Vector3::new(0.0, 0.0, -0.5);
/// let bodies = [Body {
///     parent: None,
///     placement: Pose::default(),
///     joint: Joint::Revolute(Vector3::y_axis()),
///     inertia: Inertia::about_centre(2.0, &bob_m, &Matrix3::zeros()),
///     armature_kgm2: 0.0,
/// }];
/// let tree = Tree::new(&bodies, Vector3::new(0.0, 0.0, -9.81))?;
/// let (mut scratch, mut torque_nm) = ([Scratch::default()], [0.0]);
/// tree.inverse_dynamics(&[0.3], &[0.0], &[4.0], &[], &mut scratch, &mut torque_nm)?;
/// let expected = 2.0 * 0.25 * 4.0 + 2.0 * 9.81 * 0.5 * 0.3f64.sin();
/// assert!((torque_nm[0] - expected).abs() < 1e-14);
/// # Ok::<(), haptical_dynamics::DynamicsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    bodies: &'a [Body],
    gravity_mps2: Vector3<f64>,
}

impl<'a> Tree<'a> {
    /// Joins `bodies`, parents before children. `gravity_mps2` is the acceleration of free fall along the
    /// base's axes: (0, 0, -9.81) where z is up.
    ///
    /// Masses of 0 are allowed, and so are inertias that no body can have:
    /// [`Inertia::is_physical`](crate::Inertia::is_physical) tells.
    ///
    /// # Errors
    ///
    /// [`DynamicsError::EmptyTree`]; for the first such body [`DynamicsError::Parent`],
    /// [`DynamicsError::Placement`], [`DynamicsError::Axis`], [`DynamicsError::Mass`],
    /// [`DynamicsError::Inertia`], [`DynamicsError::Armature`]; [`DynamicsError::NonFiniteVector`] for
    /// gravity.
    pub fn new(bodies: &'a [Body], gravity_mps2: Vector3<f64>) -> Result<Self, DynamicsError> {
        if bodies.is_empty() {
            return Err(DynamicsError::EmptyTree);
        }
        for (index, body) in bodies.iter().enumerate() {
            check_body(index, body)?;
        }
        check_vector("gravity", &gravity_mps2)?;
        Ok(Self {
            bodies,
            gravity_mps2,
        })
    }

    /// The bodies, parents before children.
    pub fn bodies(&self) -> &'a [Body] {
        self.bodies
    }

    /// The acceleration of free fall, along the base's axes.
    pub fn gravity_mps2(&self) -> &Vector3<f64> {
        &self.gravity_mps2
    }

    /// The body and everything that it hangs on, outermost first.
    pub(crate) fn path(&self, body: usize) -> impl Iterator<Item = usize> {
        core::iter::successors(Some(body), |body| self.bodies[*body].parent)
    }

    pub(crate) fn check_joints(
        &self,
        quantity: &'static str,
        values: &[f64],
    ) -> Result<(), DynamicsError> {
        check_length(quantity, self.bodies.len(), values.len())?;
        for (joint, value) in values.iter().copied().enumerate() {
            if !is_usable(value) {
                return Err(DynamicsError::NonFiniteJoint {
                    quantity,
                    joint,
                    value,
                });
            }
        }
        Ok(())
    }

    pub(crate) fn check_scratch(&self, scratch: &[Scratch]) -> Result<(), DynamicsError> {
        check_length("the scratch", self.bodies.len(), scratch.len())
    }

    pub(crate) fn check_wrenches(&self, wrenches: &[Wrench]) -> Result<(), DynamicsError> {
        for wrench in wrenches {
            let bodies = self.bodies.len();
            if wrench.body >= bodies {
                let body = wrench.body;
                return Err(DynamicsError::WrenchBody { body, bodies });
            }
            check_vector("the point of a wrench", &wrench.point_m)?;
            check_vector("the force of a wrench", &wrench.force_n)?;
            check_vector("the moment of a wrench", &wrench.moment_nm)?;
        }
        Ok(())
    }
}

fn check_body(index: usize, body: &Body) -> Result<(), DynamicsError> {
    if let Some(parent) = body.parent
        && parent >= index
    {
        return Err(DynamicsError::Parent {
            body: index,
            parent,
        });
    }
    if !body.placement.is_rigid(LIMIT) {
        return Err(DynamicsError::Placement { body: index });
    }
    let length = body.joint.axis().norm();
    // not `> tolerance`: a NaN is caught as well
    let is_unit = (length - 1.0).abs() <= AXIS_TOLERANCE;
    if !is_unit {
        return Err(DynamicsError::Axis {
            body: index,
            length,
        });
    }
    let inertia = &body.inertia;
    let is_weight = |value: f64| (0.0..=LIMIT).contains(&value);
    if !is_weight(inertia.mass_kg) {
        return Err(DynamicsError::Mass {
            body: index,
            mass_kg: inertia.mass_kg,
        });
    }
    let refused = |quantity| DynamicsError::Inertia {
        body: index,
        quantity,
    };
    if !inertia.first_moment_kgm.iter().copied().all(is_usable) {
        return Err(refused("first moment"));
    }
    let moments = &inertia.about_origin_kgm2;
    let skew = (moments - moments.transpose()).amax();
    let is_symmetric = skew <= SYMMETRY_TOLERANCE * moments.amax();
    if !moments.iter().copied().all(is_usable) || !is_symmetric {
        return Err(refused("inertia"));
    }
    if !is_weight(body.armature_kgm2) {
        return Err(DynamicsError::Armature {
            body: index,
            value: body.armature_kgm2,
        });
    }
    Ok(())
}

/// Whether a number is finite, and products of a few such numbers are.
fn is_usable(value: f64) -> bool {
    value.abs() <= LIMIT
}

fn check_vector(vector: &'static str, value: &Vector3<f64>) -> Result<(), DynamicsError> {
    if value.iter().copied().all(is_usable) {
        return Ok(());
    }
    Err(DynamicsError::NonFiniteVector {
        vector,
        value: [value.x, value.y, value.z],
    })
}

pub(crate) fn check_length(
    buffer: &'static str,
    expected: usize,
    got: usize,
) -> Result<(), DynamicsError> {
    if got == expected {
        return Ok(());
    }
    Err(DynamicsError::Length {
        buffer,
        expected,
        got,
    })
}

/// Refuses a result that is infinite or not a number.
pub(crate) fn check_result(quantity: &'static str, out: &[f64]) -> Result<(), DynamicsError> {
    if out.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(DynamicsError::Overflow { quantity })
}
