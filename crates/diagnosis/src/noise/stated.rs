//! Channels whose noise the device file or the rig states.

use haptical_calibration::Channel;
use haptical_model::Device;

/// Whether the device file says how noisy a channel is.
pub(crate) fn is_stated(device: &Device, channel: Channel) -> bool {
    match channel {
        Channel::Output { joint } => device.joints[joint].output_sd_rad().is_some(),
        Channel::Cable { index } => device.cable_sd_m(index).is_some(),
        Channel::Position => device.tracker.is_some_and(|t| t.position_sd_m.is_some()),
        Channel::Orientation => device.tracker.is_some_and(|t| t.rotation_sd_rad.is_some()),
        Channel::Contact => device.surroundings.contact_sd_m.is_some(),
        Channel::Plane => device.surroundings.plane_sd_m.is_some(),
        Channel::Fixture { .. } => device.surroundings.fixture_sd_rad.is_some(),
        Channel::ContactPair { .. } | Channel::PlanePair { .. } => true,
    }
}
