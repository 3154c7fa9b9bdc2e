//! The laws of a servo, one file each: from a command to the position that answers it.

pub(crate) mod droop;
pub(crate) mod friction;
pub(crate) mod gain;
pub(crate) mod lag;
pub(crate) mod latency;
pub(crate) mod offset;
pub(crate) mod recording;
pub(crate) mod saturation;
pub(crate) mod second_order;
pub(crate) mod torque_gain;

/// Names of all effects, rivals included; `haptical-effects` describes them.
pub const NAMES: [&str; 8] = [
    offset::NAME,
    latency::NAME,
    lag::NAME,
    friction::NAME,
    friction::DEAD_ZONE,
    friction::BACKLASH,
    gain::NAME,
    saturation::NAME,
];
