//! Which inertias some body has: one rule for everything that reads them.

use haptical_kinematics::nalgebra::Matrix3;

/// Least second moment of the mass about its centre, per trace of the inertia: six digits in a file leave it.
pub(super) const FLATTEST: f64 = 1e-6;

/// What is to be made of the inertia that a file gives for a link or a row.
///
/// Some distribution of mass has an inertia where and only where its second moments, half the trace less the inertia, are
/// not negative: no principal moment is larger than the sum of the two others. Source: Wensing, Kim & Slotine, *Linear
/// Matrix Inequalities for Physically Consistent Inertial Parameter Identification*, IEEE RA-L 3(1), 2018, section III.
/// A diagnosis, an identification, a forward prediction and an export all ask this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GivenInertia {
    /// None is given.
    None,
    /// All of it is 0: a point.
    Point,
    /// A body has it \[kg m^2\].
    Body(Matrix3<f64>),
    /// No body has it, for the reason in words.
    NoBody(&'static str),
}

impl GivenInertia {
    /// Judges an inertia about the centre of mass \[kg m^2\].
    ///
    /// ```
    /// use haptical_model::GivenInertia;
    /// use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
    /// let of = |x, y, z| GivenInertia::new(Some(&Matrix3::from_diagonal(&Vector3::new(x, y, z))));
    /// assert!(matches!(of(1.0, 1.0, 1.5), GivenInertia::Body(_)));
    /// assert_eq!(of(1.0, 1.0, 2.5), GivenInertia::NoBody("izz is more than ixx + iyy"));
    /// assert_eq!(of(-0.1, 1.0, 1.0), GivenInertia::NoBody("ixx is below 0"));
    /// ```
    pub fn new(inertia: Option<&Matrix3<f64>>) -> Self {
        let Some(inertia) = inertia else {
            return Self::None;
        };
        let inertia = (inertia + inertia.transpose()) * 0.5;
        if inertia == Matrix3::zeros() {
            return Self::Point;
        }
        let trace = inertia.trace();
        if !inertia.iter().all(|entry| entry.is_finite()) {
            return Self::NoBody("it is not finite");
        }
        let moments = Matrix3::identity() * (0.5 * trace) - inertia;
        let least = FLATTEST * trace;
        if trace > 0.0 && (moments + Matrix3::identity() * least).cholesky().is_some() {
            return Self::Body(inertia);
        }
        Self::NoBody(why_not(&inertia, least.abs()))
    }
}

/// What is wrong with an inertia that no body has.
fn why_not(inertia: &Matrix3<f64>, least: f64) -> &'static str {
    let [xx, yy, zz] = [0, 1, 2].map(|axis| inertia[(axis, axis)]);
    let faults = [
        (-xx, "ixx is below 0"),
        (-yy, "iyy is below 0"),
        (-zz, "izz is below 0"),
        (xx - yy - zz, "ixx is more than iyy + izz"),
        (yy - zz - xx, "iyy is more than izz + ixx"),
        (zz - xx - yy, "izz is more than ixx + iyy"),
    ];
    let found = faults.iter().find(|(excess, _)| *excess > least);
    found.map_or(
        "its largest principal moment is more than the sum of the two others",
        |(_, why)| why,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptical_kinematics::nalgebra::{Rotation3, Vector3};

    #[test]
    fn the_rule_does_not_depend_on_the_axes() {
        let turned = |moments: [f64; 3]| {
            let turn = Rotation3::from_euler_angles(0.4, -0.7, 1.1).into_inner();
            let inertia = turn * Matrix3::from_diagonal(&Vector3::from(moments)) * turn.transpose();
            GivenInertia::new(Some(&inertia))
        };
        assert!(matches!(turned([0.2, 0.3, 0.45]), GivenInertia::Body(_)));
        // a rod and a plate, the plate with the rounding of a file
        assert!(matches!(turned([0.2, 0.2, 0.0]), GivenInertia::Body(_)));
        assert!(matches!(
            turned([0.2, 0.3, 0.500_000_5]),
            GivenInertia::Body(_)
        ));
        for none in [[0.2, 0.3, 0.52], [0.2, 0.3, -0.001], [-1.0, -1.0, -1.0]] {
            assert!(matches!(turned(none), GivenInertia::NoBody(_)), "{none:?}");
        }
    }

    #[test]
    fn the_entry_is_named() {
        let of = |inertia: Matrix3<f64>| GivenInertia::new(Some(&inertia));
        let mut off = Matrix3::identity();
        off[(0, 1)] = 0.9;
        off[(1, 0)] = 0.9;
        let principal = "its largest principal moment is more than the sum of the two others";
        // moments 0.1, 1.9, 1
        assert_eq!(of(off), GivenInertia::NoBody(principal));
        let mut lost = Matrix3::identity();
        lost[(2, 2)] = f64::NAN;
        assert_eq!(of(lost), GivenInertia::NoBody("it is not finite"));
        assert_eq!(of(Matrix3::zeros()), GivenInertia::Point);
        assert_eq!(GivenInertia::new(None), GivenInertia::None);
    }
}
