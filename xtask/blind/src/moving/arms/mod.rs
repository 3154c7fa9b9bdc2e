//! The arms that are tried, as their makers describe them.

mod file;
mod makes;

use haptical_model::kinematics::nalgebra::{Matrix3, Rotation3, Vector3};

use crate::moving::motion::rigid::{Chain, Link};

pub(crate) use file::{OUTPUT_COUNTS, device_toml, device_toml_of, urdf};
pub(crate) use makes::{OTHER_SEVEN, OTHER_SIX, SEVEN, SIX, SLIDER};

/// Gravity in the frame of a base that stands upright \[m/s^2\].
pub(crate) const GRAVITY_MPS2: [f64; 3] = [0.0, 0.0, -9.81];

/// One joint, its drive, and the body behind it. Angles are \[rad\], torques \[N m\]; of a joint that slides \[m\] and \[N\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    pub(crate) slides: bool,
    /// Frame of the joint in that of the body before: place, and roll, pitch, yaw as URDF has them.
    pub(crate) origin_m: [f64; 3],
    pub(crate) origin_rpy: [f64; 3],
    pub(crate) mass_kg: f64,
    pub(crate) centre_m: [f64; 3],
    /// Principal moments of inertia along the body's axes \[kg m^2\].
    pub(crate) inertia_kgm2: [f64; 3],
    /// Inertia of the rotor at the joint \[kg m^2\] (\[kg\] where it slides).
    pub(crate) armature: f64,
    /// Motor angle over joint variable.
    pub(crate) ratio: f64,
    /// Counts of the encoder per turn of the motor.
    pub(crate) counts: f64,
    /// Largest torque of the drive at the joint.
    pub(crate) range: f64,
    pub(crate) reach: [f64; 2],
    /// Largest speed.
    pub(crate) speed: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arm {
    pub(crate) name: &'static str,
    pub(crate) axes: &'static [Axis],
    /// In the last body \[m\].
    pub(crate) flange_m: [f64; 3],
}

/// The rotation of roll, pitch and yaw about fixed axes.
pub(crate) fn of_rpy(rpy: [f64; 3]) -> Matrix3<f64> {
    *Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]).matrix()
}

impl Arm {
    pub(crate) fn count(&self) -> usize {
        self.axes.len()
    }

    pub(crate) fn chain(&self) -> Chain {
        self.chain_of(self.axes)
    }

    /// The chain of other bodies on the same flange.
    pub(crate) fn chain_of(&self, axes: &[Axis]) -> Chain {
        let link = |axis: &Axis| Link {
            slides: axis.slides,
            origin_m: axis.origin_m.into(),
            turn: of_rpy(axis.origin_rpy),
            mass_kg: axis.mass_kg,
            centre_m: axis.centre_m.into(),
            inertia_kgm2: Matrix3::from_diagonal(&Vector3::from(axis.inertia_kgm2)),
        };
        Chain {
            links: axes.iter().map(link).collect(),
            gravity_mps2: GRAVITY_MPS2.into(),
            flange_m: self.flange_m.into(),
            behind: 0,
        }
    }
}
