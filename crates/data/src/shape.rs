//! The part of a device file that a log of this device must fit.

use haptical_model::{Device, JointType};

use crate::error::place::Place;
use crate::error::{DataError, Fault};

/// What the device file says that the log must fit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogShape {
    /// The joints, in the order of the device.
    pub joints: Vec<JointShape>,
    /// Number of measurement cables: `cable_m` is the first, `cable2_m` the second.
    pub cable_count: usize,
    /// Names of the hands, where the device tells several apart: then each row names one in the column `hand`.
    pub hands: Vec<String>,
}

/// What the device file says about one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointShape {
    /// The joint's name in the device file, for messages.
    pub name: String,
    /// Whether the joint slides (readings in m) instead of turning (readings in rad).
    pub prismatic: bool,
    /// Lower limit from home \[rad\] or \[m\]; may be infinite.
    pub lower: f64,
    /// Upper limit from home \[rad\] or \[m\]; may be infinite.
    pub upper: f64,
}

impl From<&Device> for LogShape {
    /// The shape of the logs of a device. A chain without a `[cable_encoder]` still has the distance from frame
    /// (-1)'s origin, so its logs may have `cable_m`.
    fn from(device: &Device) -> Self {
        let joints = device.joints.iter().map(|joint| JointShape {
            name: joint.name.clone(),
            prismatic: joint.joint_type == JointType::Prismatic,
            lower: joint.lower_rad,
            upper: joint.upper_rad,
        });
        Self {
            joints: joints.collect(),
            cable_count: device.cables.len().max(usize::from(device.has_links())),
            hands: device.hands.iter().map(|hand| hand.name.clone()).collect(),
        }
    }
}

impl LogShape {
    /// Refuses a device without joints.
    pub(crate) fn check(&self, file: &str) -> Result<(), DataError> {
        match self.joints[..] {
            [] => Err(Place::file(file).error(Fault::InvalidShape)),
            _ => Ok(()),
        }
    }
}

impl JointShape {
    /// Unit suffix of the joint's columns.
    pub(crate) fn unit(&self) -> &'static str {
        if self.prismatic { "m" } else { "rad" }
    }
}
