//! Moves a frame by one elementary motion at a time, for the forward pass.

use nalgebra::{Matrix3, Vector3};

use crate::{Parameter, Pose, Twist};

/// A frame as its origin and its three axes, expressed in frame (-1).
///
/// Not a 4x4 matrix: an elementary turn mixes two axes and a slide moves the origin along one, so
/// the general product would spend most of its work on zeros.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: Vector3<f64>,
    pub(crate) x: Vector3<f64>,
    pub(crate) y: Vector3<f64>,
    pub(crate) z: Vector3<f64>,
}

impl Frame {
    pub(crate) fn identity() -> Self {
        Self {
            origin: Vector3::zeros(),
            x: Vector3::x(),
            y: Vector3::y(),
            z: Vector3::z(),
        }
    }

    /// Multiplies the frame from the right by the elementary motion of `parameter`.
    pub(crate) fn step(&mut self, parameter: Parameter, value: f64) {
        match parameter {
            Parameter::A => self.origin += self.x * value,
            Parameter::B => self.origin += self.y * value,
            Parameter::D => self.origin += self.z * value,
            Parameter::Alpha => turn(&mut self.y, &mut self.z, value),
            Parameter::Beta => turn(&mut self.z, &mut self.x, value),
            Parameter::Theta => turn(&mut self.x, &mut self.y, value),
        }
    }

    /// Multiplies the frame from the right by a constant transform.
    pub(crate) fn place(&mut self, constant: &Pose) {
        let rotation = Matrix3::from_columns(&[self.x, self.y, self.z]);
        self.origin += rotation * constant.position_m;
        let turned = rotation * constant.rotation;
        self.x = turned.column(0).into_owned();
        self.y = turned.column(1).into_owned();
        self.z = turned.column(2).into_owned();
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

    pub(crate) fn pose(&self) -> Pose {
        Pose {
            position_m: self.origin,
            rotation: Matrix3::from_columns(&[self.x, self.y, self.z]),
        }
    }
}

/// Replaces a turn's point on the axis `p` by the end point's velocity, `w x (P - p)`.
pub(crate) fn complete_turn(twist: &mut Twist, end: &Vector3<f64>) {
    twist.linear = twist.angular.cross(&(end - twist.linear));
}

/// Turns two axes in their plane, the first towards the second.
fn turn(first: &mut Vector3<f64>, second: &mut Vector3<f64>, angle_rad: f64) {
    let (sine, cosine) = libm::sincos(angle_rad);
    let turned = *first * cosine + *second * sine;
    *second = *second * cosine - *first * sine;
    *first = turned;
}
