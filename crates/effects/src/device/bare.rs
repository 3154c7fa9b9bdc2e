//! A device without its effects.

use haptical_model::Device;

/// The device without its effects.
pub fn bare(device: &Device) -> Device {
    Device {
        effects: Vec::new(),
        ..device.clone()
    }
}
