//! Holds where a frame is, and how that changes with one scalar.

use nalgebra::{Matrix3, Vector3};

/// Position and orientation of the chain's last frame, seen from frame (-1).
///
/// Together they are the `[C P; 0 1]` of Baser & Konukseven eq. (4): a point with coordinates `v`
/// in the last frame has the coordinates `P + C v` in frame (-1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin of the last frame, `P`.
    pub position_m: Vector3<f64>,
    /// Its axes x, y, z as columns, `C` (no unit).
    pub rotation: Matrix3<f64>,
}

impl Default for Pose {
    /// The pose of frame (-1) in itself.
    fn default() -> Self {
        Self {
            position_m: Vector3::zeros(),
            rotation: Matrix3::identity(),
        }
    }
}

/// Derivative of a [`Pose`] with respect to one scalar `x`, both parts expressed in frame (-1).
///
/// `dP = linear dx` and `dR = [angular]x R dx`. With respect to an angle `linear` is in m/rad and
/// `angular` in rad/rad; with respect to a length, `linear` is in m/m and `angular` in rad/m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Derivative of the position of the last frame's origin.
    pub linear: Vector3<f64>,
    /// Rotation vector of the orientation's change per unit of `x`.
    pub angular: Vector3<f64>,
}
