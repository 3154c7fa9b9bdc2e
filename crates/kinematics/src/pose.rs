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

impl Pose {
    /// A pose from plain numbers, `rotation[row][column]`; usable in a constant.
    ///
    /// ```
    /// use haptical_kinematics::Pose;
    /// const QUARTER: Pose = Pose::from_rows([0.1, 0.0, 0.0], [[0., -1., 0.], [1., 0., 0.], [0., 0., 1.]]);
    /// assert_eq!(QUARTER.rotation.column(0).as_slice(), [0.0, 1.0, 0.0]);
    /// ```
    pub const fn from_rows([x, y, z]: [f64; 3], rotation: [[f64; 3]; 3]) -> Self {
        let [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]] = rotation;
        Self {
            position_m: Vector3::new(x, y, z),
            rotation: Matrix3::new(x0, y0, z0, x1, y1, z1, x2, y2, z2),
        }
    }

    /// Whether the coordinates are at most `limit_m` in size and the matrix turns without stretching or
    /// mirroring. NaN is neither. Usable in a constant.
    pub const fn is_rigid(&self, limit_m: f64) -> bool {
        let [[x, y, z]] = self.position_m.data.0;
        let columns = self.rotation.data.0;
        let mut is_rigid = x.abs() <= limit_m && y.abs() <= limit_m && z.abs() <= limit_m;
        let mut column = 0;
        while column < 3 {
            let (axis, next) = (columns[column], columns[(column + 1) % 3]);
            is_rigid = is_rigid
                && (dot(axis, axis) - 1.0).abs() <= ROTATION_TOLERANCE
                && dot(axis, next).abs() <= ROTATION_TOLERANCE;
            column += 1;
        }
        is_rigid && dot(cross(columns[0], columns[1]), columns[2]) > 0.0
    }
}

/// How far the product of a rotation with its transpose may be from the identity: what six digits in
/// a file leave.
const ROTATION_TOLERANCE: f64 = 1e-6;

const fn dot([a0, a1, a2]: [f64; 3], [b0, b1, b2]: [f64; 3]) -> f64 {
    a0 * b0 + a1 * b1 + a2 * b2
}

const fn cross([a0, a1, a2]: [f64; 3], [b0, b1, b2]: [f64; 3]) -> [f64; 3] {
    [a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0]
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
