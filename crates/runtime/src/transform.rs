//! Rigid transforms: what is fixed between two joint axes, and the frame that a step carries along.

use crate::trigonometry::sine_cosine;
use crate::{Convention, Frame, GeneralRow, Row};

/// A point or direction in frame (-1), or a column of a rotation.
pub(crate) type Vector = [f64; 3];

/// A frame by its origin and the columns of its rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transform {
    pub(crate) origin: Vector,
    pub(crate) x: Vector,
    pub(crate) y: Vector,
    pub(crate) z: Vector,
}

/// `vector + axis * length`.
#[inline]
const fn along(vector: Vector, axis: Vector, length: f64) -> Vector {
    let ([v0, v1, v2], [a0, a1, a2]) = (vector, axis);
    [v0 + a0 * length, v1 + a1 * length, v2 + a2 * length]
}

/// `first * cosine + second * sine` and `second * cosine - first * sine`.
#[inline]
const fn turn(first: Vector, second: Vector, (sine, cosine): (f64, f64)) -> (Vector, Vector) {
    let ([f0, f1, f2], [s0, s1, s2]) = (first, second);
    (
        [
            f0 * cosine + s0 * sine,
            f1 * cosine + s1 * sine,
            f2 * cosine + s2 * sine,
        ],
        [
            s0 * cosine - f0 * sine,
            s1 * cosine - f1 * sine,
            s2 * cosine - f2 * sine,
        ],
    )
}

impl Transform {
    pub(crate) const IDENTITY: Self = Self {
        origin: [0.0; 3],
        x: [1.0, 0.0, 0.0],
        y: [0.0, 1.0, 0.0],
        z: [0.0, 0.0, 1.0],
    };

    /// The direction `vector` of this frame, in the frame that this one is expressed in.
    #[inline]
    const fn rotate(&self, vector: Vector) -> Vector {
        let ([x0, x1, x2], [y0, y1, y2], [z0, z1, z2]) = (self.x, self.y, self.z);
        let [a, b, c] = vector;
        [
            x0 * a + y0 * b + z0 * c,
            x1 * a + y1 * b + z1 * c,
            x2 * a + y2 * b + z2 * c,
        ]
    }

    /// This transform, then `next` in the frame it leads to.
    #[inline]
    pub(crate) const fn then(&self, next: &Self) -> Self {
        Self {
            origin: along(self.origin, self.rotate(next.origin), 1.0),
            x: self.rotate(next.x),
            y: self.rotate(next.y),
            z: self.rotate(next.z),
        }
    }

    /// This frame, slid along its z.
    #[inline]
    pub(crate) const fn slid_along_z(self, length_m: f64) -> Self {
        Self {
            origin: along(self.origin, self.z, length_m),
            ..self
        }
    }

    /// This frame, turned about its z.
    #[inline]
    pub(crate) const fn turned_about_z(self, angle_rad: f64) -> Self {
        let (x, y) = turn(self.x, self.y, sine_cosine(angle_rad));
        Self { x, y, ..self }
    }

    /// This frame, and then a constant transform, where there is one.
    pub(crate) const fn placed(&self, constant: &Option<Frame>) -> Self {
        match constant {
            None => *self,
            Some(frame) => {
                let [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]] = frame.rotation;
                self.then(&Self {
                    origin: frame.position_m,
                    x: [x0, x1, x2],
                    y: [y0, y1, y2],
                    z: [z0, z1, z2],
                })
            }
        }
    }

    const fn slid_along_x(self, length_m: f64) -> Self {
        Self {
            origin: along(self.origin, self.x, length_m),
            ..self
        }
    }

    const fn slid_along_y(self, length_m: f64) -> Self {
        Self {
            origin: along(self.origin, self.y, length_m),
            ..self
        }
    }

    /// This frame, turned by a row's twist about x and then by its tilt about y.
    const fn twisted(self, row: &Row) -> Self {
        let (y, z) = turn(self.y, self.z, sine_cosine(row.alpha_rad));
        let (z, x) = turn(z, self.x, sine_cosine(row.beta_rad));
        Self { x, y, z, ..self }
    }

    /// This frame, moved by the part of a row that lies before the joint's motion.
    pub(crate) const fn before_joint(self, convention: Convention, row: &GeneralRow) -> Self {
        let b_m = row.b_m;
        let row = &row.row;
        match convention {
            Convention::Standard => self.turned_about_z(row.theta_rad),
            Convention::Modified => self
                .slid_along_x(row.a_m)
                .slid_along_y(b_m)
                .twisted(row)
                .turned_about_z(row.theta_rad),
        }
    }

    /// This frame, moved by the part of a row that lies behind the joint's motion.
    pub(crate) const fn after_joint(self, convention: Convention, row: &GeneralRow) -> Self {
        let b_m = row.b_m;
        let row = &row.row;
        match convention {
            Convention::Standard => self
                .slid_along_x(row.a_m)
                .slid_along_y(b_m)
                .slid_along_z(row.d_m)
                .twisted(row),
            Convention::Modified => self.slid_along_z(row.d_m),
        }
    }
}
