//! Holds the ten inertial parameters of a body, and says whether a body can have them.

use core::ops::AddAssign;

use haptical_kinematics::Pose;
use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::spatial::{Force, Motion};

/// How negative the least second moment may be, per sum of the three: what six digits in a file leave of a
/// rod or a plate, one of whose moments is 0.
const FLATTEST: f64 = 1e-6;
/// Rounding of a second moment about the centre of mass, per moment about the frame's origin.
const ROUNDING: f64 = 1e-14;

/// Mass, first moment and inertia of a body, seen from a frame that is fixed to it.
///
/// The torques of a tree are linear in these ten numbers (Atkeson, An & Hollerbach 1986), which is why
/// the moments are about the frame's **origin**. Where a file gives a centre of mass and an inertia about it,
/// [`Inertia::about_centre`] converts them; [`Inertia::centre_of_mass_m`] and
/// [`Inertia::about_centre_kgm2`] convert them back.
///
/// ```
/// use haptical_dynamics::Inertia;
/// use haptical_dynamics::nalgebra::{Matrix3, Vector3};
/// let centre_m = Vector3::new(0.5, 0.0, 0.0);
/// let own = Matrix3::from_diagonal_element(0.1);
/// let body = Inertia::about_centre(2.0, &centre_m, &own);
/// assert_eq!(body.first_moment_kgm.x, 1.0);
/// assert!((body.about_origin_kgm2.m22 - 0.6).abs() < 1e-15); // 0.1 + 2 * 0.5^2
/// assert!((body.about_origin_kgm2.m11 - 0.1).abs() < 1e-15); // the centre is on this axis
/// assert_eq!(body.centre_of_mass_m(), Some(centre_m));
/// assert!((body.about_centre_kgm2() - own).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertia {
    /// Mass m \[kg\].
    pub mass_kg: f64,
    /// Mass times the centre of mass, m c \[kg m\].
    pub first_moment_kgm: Vector3<f64>,
    /// Moments of inertia on the diagonal and products of inertia, with their sign, beside it, about the
    /// frame's origin and along its axes: the integral of `(r . r) 1 - r r^T` over the mass \[kg m^2\].
    pub about_origin_kgm2: Matrix3<f64>,
}

impl Inertia {
    /// From a mass, its centre and the inertia about the centre, along the frame's axes.
    ///
    /// Source: the parallel-axis theorem, Featherstone (2008) eq. (2.63).
    pub fn about_centre(
        mass_kg: f64,
        centre_of_mass_m: &Vector3<f64>,
        inertia_kgm2: &Matrix3<f64>,
    ) -> Self {
        Self {
            mass_kg,
            first_moment_kgm: centre_of_mass_m * mass_kg,
            about_origin_kgm2: inertia_kgm2 + unit_mass_at(centre_of_mass_m) * mass_kg,
        }
    }

    /// From the ten numbers of [`Inertia::parameters`].
    pub fn from_parameters([m, x, y, z, xx, yy, zz, xy, xz, yz]: [f64; 10]) -> Self {
        Self {
            mass_kg: m,
            first_moment_kgm: Vector3::new(x, y, z),
            about_origin_kgm2: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// `m, m c_x, m c_y, m c_z, I_xx, I_yy, I_zz, I_xy, I_xz, I_yz`, all about the frame's origin
    /// \[kg, kg m, kg m^2\]: the columns of [`Tree::regressor`](crate::Tree::regressor).
    pub fn parameters(&self) -> [f64; 10] {
        let (h, i) = (&self.first_moment_kgm, &self.about_origin_kgm2);
        [
            self.mass_kg,
            h.x,
            h.y,
            h.z,
            i.m11,
            i.m22,
            i.m33,
            i.m12,
            i.m13,
            i.m23,
        ]
    }

    /// The centre of mass in the frame \[m\]; none without mass.
    pub fn centre_of_mass_m(&self) -> Option<Vector3<f64>> {
        (self.mass_kg > 0.0).then(|| self.first_moment_kgm / self.mass_kg)
    }

    /// The inertia about the centre of mass, along the frame's axes \[kg m^2\]; about the origin without mass.
    pub fn about_centre_kgm2(&self) -> Matrix3<f64> {
        let centre_m = self.centre_of_mass_m().unwrap_or_default();
        self.about_origin_kgm2 - unit_mass_at(&centre_m) * self.mass_kg
    }

    /// The same body seen from another frame, in which its own frame has the pose `pose`.
    ///
    /// What hangs on a body by a fixed joint is added to it so:
    ///
    /// ```
    /// use haptical_dynamics::{Inertia, Pose};
    /// use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// let tool = Inertia::about_centre(0.5, &Vector3::zeros(), &Matrix3::zeros());
    /// let flange = Pose { position_m: Vector3::new(0.0, 0.0, 0.2), ..Pose::default() };
    /// let mut link = Inertia { mass_kg: 1.0, ..Inertia::default() };
    /// link += tool.seen_from(&flange);
    /// assert_eq!((link.mass_kg, link.first_moment_kgm.z), (1.5, 0.1));
    /// assert!((link.about_origin_kgm2.m11 - 0.02).abs() < 1e-16);
    /// ```
    pub fn seen_from(&self, pose: &Pose) -> Self {
        let (rotation, p) = (&pose.rotation, &pose.position_m);
        let h = rotation * self.first_moment_kgm;
        // the integral of |p + r|^2 1 - (p + r)(p + r)^T, r along the new axes
        let outer = p * (h + p * (0.5 * self.mass_kg)).transpose();
        let shift = Matrix3::from_diagonal_element(2.0 * outer.trace()) - outer - outer.transpose();
        Self {
            mass_kg: self.mass_kg,
            first_moment_kgm: h + p * self.mass_kg,
            about_origin_kgm2: rotation * self.about_origin_kgm2 * rotation.transpose() + shift,
        }
    }

    /// The 4x4 pseudo-inertia `[Sigma, m c; (m c)^T, m]` with `Sigma = tr(I)/2 1 - I`, the second moments
    /// about the frame's origin.
    ///
    /// It is positive semidefinite where and only where some distribution of mass has these ten numbers.
    /// Source: Wensing, Kim & Slotine, *Linear Matrix Inequalities for Physically Consistent Inertial
    /// Parameter Identification*, IEEE RA-L 3(1), 2018, section III.
    pub fn pseudo_inertia(&self) -> Matrix4<f64> {
        let mut pseudo = second_moments(&self.about_origin_kgm2).to_homogeneous();
        for (axis, moment) in self.first_moment_kgm.iter().enumerate() {
            pseudo[(axis, 3)] = *moment;
            pseudo[(3, axis)] = *moment;
        }
        pseudo[(3, 3)] = self.mass_kg;
        pseudo
    }

    /// Whether some distribution of mass has these ten numbers: whether [`Inertia::pseudo_inertia`] is
    /// positive semidefinite.
    ///
    /// It is asked of the mass and of the second moments about the centre of mass, the Schur complement of
    /// the mass, so the answer depends neither on the unit of length nor on where the frame is. Moments of
    /// 0 (rods, plates, points) are physical, and so is one that six digits in a file made less than 0 by
    /// a millionth of their sum. Without mass nothing else may differ from 0.
    ///
    /// ```
    /// use haptical_dynamics::Inertia;
    /// use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// let body = |xx, yy, zz| {
    ///     let moments = Matrix3::from_diagonal(&Vector3::new(xx, yy, zz));
    ///     Inertia::about_centre(1.0, &Vector3::new(0.0, 3.0, 0.0), &moments)
    /// };
    /// assert!(body(0.1, 0.1, 0.0).is_physical()); // a rod
    /// assert!(!body(0.1, 0.1, 0.3).is_physical()); // positive, but not a triangle
    /// ```
    pub fn is_physical(&self) -> bool {
        let parameters = self.parameters();
        if !parameters.iter().all(|value| value.is_finite()) {
            return false;
        }
        if self.mass_kg <= 0.0 {
            return parameters.iter().all(|value| *value == 0.0);
        }
        let about_centre = second_moments(&self.about_centre_kgm2());
        let about_origin = second_moments(&self.about_origin_kgm2).trace();
        let least = about_centre.symmetric_eigenvalues().min();
        least >= -FLATTEST * about_centre.trace() - ROUNDING * about_origin.abs()
    }

    /// The force that gives the body this acceleration at rest, or its momentum at this velocity.
    pub(crate) fn times(&self, motion: &Motion) -> Force {
        let h = &self.first_moment_kgm;
        Force {
            force: motion.linear * self.mass_kg + motion.angular.cross(h),
            moment: h.cross(&motion.linear) + self.about_origin_kgm2 * motion.angular,
        }
    }
}

impl AddAssign for Inertia {
    fn add_assign(&mut self, other: Self) {
        self.mass_kg += other.mass_kg;
        self.first_moment_kgm += other.first_moment_kgm;
        self.about_origin_kgm2 += other.about_origin_kgm2;
    }
}

/// `(c . c) 1 - c c^T`: the inertia of a unit mass at `c`.
fn unit_mass_at(c: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(c.norm_squared()) - c * c.transpose()
}

/// `tr(I)/2 1 - I`: the integral of `r r^T`.
pub(crate) fn second_moments(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia
}
