//! The laws of a servo, one file each: from a command to the position that answers it.

pub(crate) mod droop;
pub(crate) mod friction;
pub(crate) mod gain;
pub(crate) mod lag;
pub(crate) mod latency;
pub(crate) mod offset;
pub(crate) mod saturation;
pub(crate) mod torque_gain;

/// An effect's name and parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spec {
    /// Name: `joint-offset`.
    pub name: &'static str,
    /// What happens, a clause without a full stop.
    pub meaning: &'static str,
    /// What to look at on the device.
    pub inspect: &'static str,
    /// Its numbers, the size first.
    pub parameters: &'static [&'static str],
}

/// All effects of a servo, rivals included.
pub const SPECS: [Spec; 8] = [
    offset::SPEC,
    latency::SPEC,
    lag::SPEC,
    friction::SPEC,
    friction::DEAD_ZONE,
    friction::BACKLASH,
    gain::SPEC,
    saturation::SPEC,
];
