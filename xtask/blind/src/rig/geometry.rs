//! The pose of the handle when links flex and axes wobble: the chain with small rotations in between.

use haptical_model::Device;
use haptical_model::kinematics::Link;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

/// Rotation about z.
pub(crate) fn turn_z(angle_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = libm::sincos(angle_rad);
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// `Rx(alpha) Ry(beta)`: what follows the joint's turn in a row of the standard convention.
pub(crate) fn link_rotation_after_axis(link: &Link) -> Matrix3<f64> {
    let (sin, cos) = libm::sincos(link.alpha_rad);
    let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos);
    if link.beta_rad == 0.0 {
        return about_x;
    }
    let (sin, cos) = libm::sincos(link.beta_rad);
    about_x * Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos)
}

/// Rotation by a small rotation vector, exact to the second order (the vectors here are below 0.1 rad
/// and their cubes below a tenth of a count).
fn small_turn(vector: &Vector3<f64>) -> Matrix3<f64> {
    let skew = vector.cross_matrix();
    Matrix3::identity() + skew + skew * skew * 0.5
}

/// Deviations of the structure from the chain of rigid rows, row by row.
#[derive(Debug, Clone, Default)]
pub struct Flex {
    /// For each joint: rotation vectors in the frame before the joint, about its origin \[rad\].
    pub tilt_rad: Vec<Option<Vec<[f64; 3]>>>,
    /// Shift of the hook in the handle's frame \[m\].
    pub tool_m: Option<Vec<[f64; 3]>>,
}

/// The handle at one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandlePose {
    /// Position of the hook in frame (-1) \[m\].
    pub position_m: Vector3<f64>,
    /// Axes of the handle as columns, in frame (-1).
    pub rotation: Matrix3<f64>,
}

/// Constant parts of a device's chain.
#[derive(Debug)]
pub struct Chain {
    angles_rad: Vec<f64>,
    shifts_m: Vec<Vector3<f64>>,
    after: Vec<Matrix3<f64>>,
}

impl Chain {
    /// The chain of `device` (standard convention, revolute joints).
    pub fn new(device: &Device) -> Self {
        let links = device.chain_links();
        Self {
            angles_rad: links.iter().map(|link| link.theta_rad).collect(),
            shifts_m: links
                .iter()
                .map(|link| Vector3::new(link.a_m, 0.0, link.d_m))
                .collect(),
            after: links.iter().map(link_rotation_after_axis).collect(),
        }
    }

    /// Handle pose with the joints at `angle(joint)` from home \[rad\], at `row` of the flex.
    pub fn pose(&self, angle: impl Fn(usize) -> f64, flex: &Flex, row: usize) -> HandlePose {
        let mut rotation: Matrix3<f64> = Matrix3::identity();
        let mut position_m = Vector3::zeros();
        for index in 0..self.after.len() {
            let mut turn_rad = self.angles_rad[index];
            if let Some(joint) = index.checked_sub(1) {
                if let Some(Some(tilt)) = flex.tilt_rad.get(joint) {
                    rotation *= small_turn(&Vector3::from(tilt[row]));
                }
                turn_rad += angle(joint);
            }
            rotation *= turn_z(turn_rad);
            position_m += rotation * self.shifts_m[index];
            rotation *= self.after[index];
        }
        if let Some(shift_m) = &flex.tool_m {
            position_m += rotation * Vector3::from(shift_m[row]);
        }
        HandlePose {
            position_m,
            rotation,
        }
    }
}
