//! Moves a frame by one elementary motion at a time, for the forward pass.

use nalgebra::{ArrayStorage, Matrix3, Vector3};

use crate::trigonometry::sine_cosine;
use crate::{Parameter, Pose, Twist};

/// A frame as its origin and its three axes, expressed in frame (-1).
///
/// Not a 4x4 matrix: an elementary turn mixes two axes and a slide moves the origin along one, so
/// the general product would spend most of its work on zeros. Its steps are constant functions, which
/// know no operators of vectors: a device can be prepared by the compiler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: Vector3<f64>,
    pub(crate) x: Vector3<f64>,
    pub(crate) y: Vector3<f64>,
    pub(crate) z: Vector3<f64>,
}

impl Frame {
    pub(crate) const fn identity() -> Self {
        Self {
            origin: Vector3::new(0.0, 0.0, 0.0),
            x: Vector3::new(1.0, 0.0, 0.0),
            y: Vector3::new(0.0, 1.0, 0.0),
            z: Vector3::new(0.0, 0.0, 1.0),
        }
    }

    /// Multiplies the frame from the right by the elementary motion of `parameter`.
    pub(crate) fn step(&mut self, parameter: Parameter, value: f64) {
        match parameter {
            Parameter::A | Parameter::B | Parameter::D => self.slide(parameter, value),
            _ => self.turn(parameter, libm::sincos(value)),
        }
    }

    /// As [`Frame::step`], with sines that the compiler can evaluate; angles up to
    /// [`LARGEST_RAD`](crate::trigonometry::LARGEST_RAD).
    pub(crate) const fn constant_step(&mut self, parameter: Parameter, value: f64) {
        match parameter {
            Parameter::A | Parameter::B | Parameter::D => self.slide(parameter, value),
            _ => self.turn(parameter, sine_cosine(value)),
        }
    }

    /// Multiplies the frame by a slide along x, y or z.
    #[inline]
    const fn slide(&mut self, parameter: Parameter, length_m: f64) {
        let axis = match parameter {
            Parameter::A => self.x,
            Parameter::B => self.y,
            _ => self.z,
        };
        self.origin = along(&self.origin, &axis, length_m);
    }

    /// Multiplies the frame by a turn about x, y or z, whose sine and cosine are given.
    #[inline]
    const fn turn(&mut self, parameter: Parameter, turn: (f64, f64)) {
        match parameter {
            Parameter::Alpha => (self.y, self.z) = turned(&self.y, &self.z, turn),
            Parameter::Beta => (self.z, self.x) = turned(&self.z, &self.x, turn),
            _ => (self.x, self.y) = turned(&self.x, &self.y, turn),
        }
    }

    /// Multiplies the frame from the right by a constant transform.
    pub(crate) const fn place(&mut self, constant: &Pose) {
        let [x, y, z] = constant.rotation.data.0;
        let origin = self.rotate(constant.position_m.data.0[0]);
        self.origin = along(&self.origin, &origin, 1.0);
        (self.x, self.y, self.z) = (self.rotate(x), self.rotate(y), self.rotate(z));
    }

    /// A direction of this frame, expressed in frame (-1).
    const fn rotate(&self, [a, b, c]: [f64; 3]) -> Vector3<f64> {
        let ([x], [y], [z]) = (self.x.data.0, self.y.data.0, self.z.data.0);
        Vector3::new(
            x[0] * a + y[0] * b + z[0] * c,
            x[1] * a + y[1] * b + z[1] * c,
            x[2] * a + y[2] * b + z[2] * c,
        )
    }

    /// What the parameter's motion, made from this frame, does to a body attached after it.
    ///
    /// A slide's twist is complete. A turn's `linear` holds a point of its axis instead, because
    /// the end point is not known yet: [`complete_turn`] puts the velocity there.
    pub(crate) fn screw(&self, parameter: Parameter) -> Twist {
        let slide = |axis: Vector3<f64>| Twist {
            linear: axis,
            angular: Vector3::zeros(),
        };
        let turn = |axis: Vector3<f64>| Twist {
            linear: self.origin,
            angular: axis,
        };
        match parameter {
            Parameter::A => slide(self.x),
            Parameter::B => slide(self.y),
            Parameter::D => slide(self.z),
            Parameter::Alpha => turn(self.x),
            Parameter::Beta => turn(self.y),
            Parameter::Theta => turn(self.z),
        }
    }

    pub(crate) const fn pose(&self) -> Pose {
        let ([x], [y], [z]) = (self.x.data.0, self.y.data.0, self.z.data.0);
        Pose {
            position_m: self.origin,
            rotation: Matrix3::from_array_storage(ArrayStorage([x, y, z])),
        }
    }
}

/// Replaces a turn's point on the axis `p` by the end point's velocity, `w x (P - p)`.
pub(crate) fn complete_turn(twist: &mut Twist, end: &Vector3<f64>) {
    twist.linear = twist.angular.cross(&(end - twist.linear));
}

/// Moves a point along an axis.
#[inline]
const fn along(point: &Vector3<f64>, axis: &Vector3<f64>, length_m: f64) -> Vector3<f64> {
    let ([p], [a]) = (point.data.0, axis.data.0);
    Vector3::new(
        p[0] + a[0] * length_m,
        p[1] + a[1] * length_m,
        p[2] + a[2] * length_m,
    )
}

/// Turns two axes in their plane, the first towards the second.
#[inline]
const fn turned(
    first: &Vector3<f64>,
    second: &Vector3<f64>,
    (sine, cosine): (f64, f64),
) -> (Vector3<f64>, Vector3<f64>) {
    let ([f], [s]) = (first.data.0, second.data.0);
    (
        Vector3::new(
            f[0] * cosine + s[0] * sine,
            f[1] * cosine + s[1] * sine,
            f[2] * cosine + s[2] * sine,
        ),
        Vector3::new(
            s[0] * cosine - f[0] * sine,
            s[1] * cosine - f[1] * sine,
            s[2] * cosine - f[2] * sine,
        ),
    )
}
