//! The part of a device file that a log of this device must fit.

/// What the device file says that the log must fit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogShape {
    /// The joints, in the order of the device.
    pub joints: Vec<JointShape>,
    /// Number of measurement cables: `cable_m` is the first, `cable2_m` the second.
    pub cable_count: usize,
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

impl JointShape {
    /// Unit suffix of the joint's columns.
    pub(crate) fn unit(&self) -> &'static str {
        if self.prismatic { "m" } else { "rad" }
    }
}
