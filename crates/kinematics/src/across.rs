//! Directions across a joint's axis that stand still in the link before it.

use nalgebra::Vector3;

use crate::Twist;

/// Sine of the angle between two axes up to which they count as parallel.
const PARALLEL: f64 = 0.05;
/// Way between two axes \[m\] up to which they count as one.
const ONE_AXIS_M: f64 = 1e-3;

impl Twist {
    /// Two unit vectors across the axis of a turning joint, of which this is the twist of the end point, that the link before
    /// the joint carries along; `before` is the twist of the joint before it, none where the link before stands still.
    ///
    /// The first one is across the axis before as well; where the two axes are parallel, it is along the way from that axis to
    /// this one. None after a slide along the axis, and where the two axes are one. Source: docs/equations.md, `axis-wobble`.
    ///
    /// ```
    /// use haptical_kinematics::{Twist, nalgebra::Vector3};
    ///
    /// // two parallel axes along z, at x = 0 and at x = 0.3 m; the end point is at x = 0.5 m
    /// let about_z = |arm_m: f64| Twist { linear: Vector3::y() * arm_m, angular: Vector3::z() };
    /// let [first, second] = about_z(0.2).across(Some(&about_z(0.5))).ok_or("one axis")?;
    /// assert_eq!((first, second), (Vector3::x(), Vector3::y()));
    /// assert!(about_z(0.2).across(Some(&about_z(0.2))).is_none());
    /// # Ok::<(), &str>(())
    /// ```
    #[inline]
    pub fn across(&self, before: Option<&Self>) -> Option<[Vector3<f64>; 2]> {
        let axis = &self.angular;
        let first = match before {
            Some(before) => {
                let slides = before.angular.norm_squared() < 0.5;
                let direction = if slides {
                    &before.linear
                } else {
                    &before.angular
                };
                match unit(axis.cross(direction), PARALLEL) {
                    Some(first) => first,
                    None if slides => return None,
                    None => unit(self.way_from(before), ONE_AXIS_M)?,
                }
            }
            // any fixed direction that is not along it
            None if axis.x.abs() < 0.9 => unit(axis.cross(&Vector3::x()), 0.0)?,
            None => unit(axis.cross(&Vector3::y()), 0.0)?,
        };
        Some([first, axis.cross(&first)])
    }

    /// The way \[m\] from a parallel axis to this one, across the latter. A twist `l = z x r` of the end point at `r` from a point of
    /// the axis has the axis's nearest point at `z x l` from the end point.
    #[inline]
    fn way_from(&self, before: &Self) -> Vector3<f64> {
        let way = self.angular.cross(&self.linear) - before.angular.cross(&before.linear);
        way - self.angular * self.angular.dot(&way)
    }
}

/// The direction of a vector that is longer than `least`.
#[inline]
fn unit(vector: Vector3<f64>, least: f64) -> Option<Vector3<f64>> {
    let length = libm::sqrt(vector.norm_squared());
    (length > least).then(|| vector / length)
}
