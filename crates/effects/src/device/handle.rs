//! Where the effects of a device put its handle.

use haptical_calibration::Channel;
use haptical_model::{Device, Recording, Tracker};

use crate::device::added::attached;
use crate::device::error::DeviceEffectError;
use crate::{Hook, spec};

/// A tracker that sees the handle itself, in frame (-1); nothing is weighted by its noise.
const EXACT: Tracker = Tracker {
    base_known: true,
    base_per_run: false,
    tool_known: true,
    position_sd_m: Some(1e-6),
    rotation_sd_rad: None,
    scale_sd: None,
};

/// How far the effects of a device move its handle from where readings and geometry put it, in frame (-1), row by row
/// \[m\]: what they add to the readings of a tracker that sees the handle itself. None without an effect that moves it.
///
/// # Errors
/// [`DeviceEffectError`], as [`attached`].
pub fn handle_moved_m(
    device: &Device,
    recording: &Recording,
) -> Result<Option<Vec<[f64; 3]>>, DeviceEffectError> {
    let mut seen = seen_exactly(device);
    seen.effects
        .retain(|effect| spec(&effect.name).is_none_or(|spec| spec.hook != Hook::Tracker));
    for effect in &mut seen.effects {
        effect.fit = false;
    }
    let rows = recording.len();
    let tracked = Recording {
        position_m: Some(std::array::from_fn(|_| vec![0.0; rows])),
        orientation_wxyz: None,
        contact: None,
        plane: None,
        tool: None,
        ..recording.clone()
    };
    let with = attached(&mut seen, &tracked)?;
    let position = Channel::Position.name();
    let mut moved: Option<Vec<[f64; 3]>> = None;
    for added in with.added.iter().filter(|own| own.channel == position) {
        let sums = moved.get_or_insert_with(|| vec![[0.0; 3]; rows]);
        for (sum, reading) in sums.iter_mut().zip(&added.readings) {
            if let Some(sum) = sum.get_mut(added.axis) {
                *sum += reading;
            }
        }
    }
    Ok(moved)
}

/// The device with such a tracker.
pub(super) fn seen_exactly(device: &Device) -> Device {
    let mut seen = device.clone();
    seen.tracker = Some(EXACT);
    seen.surroundings.tracker_base = None;
    seen.surroundings.run_bases.clear();
    seen.surroundings.tracker_tool = None;
    seen
}
