//! Positions and orientations of an MJCF's elements: quaternions, axes and angles, Euler's angles, two axes, one axis.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use crate::numbers::exactly;
use crate::rigid::{SHORTEST, about_x, about_y, from_quaternion};
use crate::robot::mjcf::{Attributes, Mjcf};
use crate::robot::xml::Result;
use haptical_model::rigid::about_z;

/// Attributes with an orientation, of which an element has one at most.
pub(crate) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

impl<'d> Mjcf<'d, '_> {
    /// `pos` and the orientation of an element in the frame around it.
    pub(crate) fn pose(&self, own: &Attributes<'d, '_>, place: &str) -> Result<Pose> {
        let position_m = self.three(own, place, "pos")?.unwrap_or([0.0; 3]);
        Ok(Pose {
            position_m: Vector3::from(position_m),
            rotation: self.orientation(own, place)?,
        })
    }

    /// Three numbers.
    pub(crate) fn three(
        &self,
        own: &Attributes<'d, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<[f64; 3]>> {
        self.some(own, place, key)
    }

    /// Exactly `N` numbers.
    pub(crate) fn some<const N: usize>(
        &self,
        own: &Attributes<'d, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<[f64; N]>> {
        let Some(text) = self.attribute(own, key) else {
            return Ok(None);
        };
        exactly(text).map(Some).ok_or_else(|| {
            let allowed = format!(
                "{N} finite numbers of at most 1e6 in size are expected, separated by blanks"
            );
            let found = format!("\"{text}\"");
            self.reader.refuse(own.node, place, key, &found, &allowed)
        })
    }

    fn orientation(&self, own: &Attributes<'d, '_>, place: &str) -> Result<Matrix3<f64>> {
        let stated = |key: &&&str| own.node.has_attribute(**key);
        let keys: Vec<&&str> = ORIENTATIONS.iter().filter(stated).collect();
        if let [first, second, ..] = keys[..] {
            let message =
                format!("{place} has both {first} and {second}: one orientation is expected");
            return Err(self.reader.tree(own.node.range().start, message));
        }
        // an orientation of its own takes the place of its class's
        let keys = match keys[..] {
            [own] => vec![*own],
            _ => ORIENTATIONS.to_vec(),
        };
        let refuse = |key: &'static str| {
            let found = format!("\"{}\"", self.attribute(own, key).unwrap_or_default());
            let allowed = "it must have a direction";
            self.reader.refuse(own.node, place, key, &found, allowed)
        };
        for key in keys {
            let turn = match key {
                "quat" => self.some(own, place, key)?.map(from_quaternion),
                "axisangle" => {
                    let turn = self.some(own, place, key)?;
                    turn.map(|[x, y, z, angle]: [f64; 4]| {
                        let axis = direction(Vector3::new(x, y, z))?;
                        let angle_rad = angle * self.compiler.angle_rad;
                        let turn = UnitQuaternion::from_axis_angle(&axis, angle_rad);
                        Some(turn.to_rotation_matrix().into_inner())
                    })
                }
                "euler" => self
                    .three(own, place, key)?
                    .map(|angles| Some(self.euler(angles))),
                "xyaxes" => self.some(own, place, key)?.map(from_two_axes),
                _ => self.three(own, place, key)?.map(from_one_axis),
            };
            if let Some(turn) = turn {
                return turn.ok_or_else(|| refuse(key));
            }
        }
        Ok(Matrix3::identity())
    }

    fn euler(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let mut turned = Matrix3::identity();
        for (axis, angle) in self.compiler.euler.into_iter().zip(angles) {
            let angle_rad = angle * self.compiler.angle_rad;
            let own = match axis.to_ascii_lowercase() {
                'x' => about_x(angle_rad),
                'y' => about_y(angle_rad),
                _ => about_z(angle_rad),
            };
            turned = match axis.is_ascii_lowercase() {
                true => turned * own,
                false => own * turned,
            };
        }
        turned
    }
}

pub(crate) fn direction(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    Unit::try_new(vector, SHORTEST)
}

/// The first axis as it is, the second one made square with it.
fn from_two_axes([a, b, c, d, e, f]: [f64; 6]) -> Option<Matrix3<f64>> {
    let x = direction(Vector3::new(a, b, c))?;
    let y = Vector3::new(d, e, f);
    let y = direction(y - x.into_inner() * x.dot(&y))?;
    Some(Matrix3::from_columns(&[
        x.into_inner(),
        y.into_inner(),
        x.cross(&y),
    ]))
}

/// The least turn that takes z there; a half turn about x where it is downwards.
fn from_one_axis(axis: [f64; 3]) -> Option<Matrix3<f64>> {
    let axis = direction(Vector3::from(axis))?;
    let about = Vector3::z().cross(&axis);
    let sine = about.norm();
    let angle_rad = libm::atan2(sine, axis.z);
    let about = direction(about).unwrap_or_else(Vector3::x_axis);
    let turn = UnitQuaternion::from_axis_angle(&about, angle_rad);
    Some(turn.to_rotation_matrix().into_inner())
}
