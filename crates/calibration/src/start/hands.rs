//! Start values of a tracker that sees a marker on each of several hands: one base, and each hand's tool.

use haptical_model::kinematics::Pose;
use haptical_model::{Device, Placement, Recording, Tool};

use crate::CalibrationError;
use crate::start::hand_eye::{Rig, fit, sights, trimmed};

/// Rows of a recording that are of a hand.
pub(crate) fn rows_of_hand(recording: &Recording, hand: &str) -> Vec<usize> {
    let named = recording.hand.iter().flatten().enumerate();
    let own = named.filter(|(_, name)| *name == hand);
    own.map(|(row, _)| row).collect()
}

/// Gives the tracker's base and each hand's tool a place, unless the device has one: base and tool by the hand that is seen
/// most, the other tools from that base, then all of them fitted together with the geometry held.
pub(crate) fn place_hands(
    device: &mut Device,
    recording: &Recording,
    poses: &[Pose],
) -> Result<(), CalibrationError> {
    let all = sights(recording, poses);
    let mut seen = Vec::new();
    for (index, hand) in device.hands.iter().enumerate() {
        let own = all
            .iter()
            .filter(|sight| device.hand_at(recording, sight.row) == Some(index));
        let own: Vec<_> = own.copied().collect();
        let known = device.surroundings.tool_index(&hand.name);
        let place = known.and_then(|tool| device.surroundings.tools[tool].placement);
        if !own.is_empty() {
            seen.push((hand.name.clone(), own, place));
        }
    }
    // stable: of hands that are seen as often the first one
    seen.sort_by_key(|(_, own, _)| std::cmp::Reverse(own.len()));
    let is_open = device.tracker.is_some_and(|tracker| !tracker.base_known)
        && device.surroundings.tracker_base.is_none();
    if !is_open && seen.iter().all(|(_, _, place)| place.is_some()) {
        return Ok(());
    }
    let mut base = device.surroundings.tracker_base.unwrap_or_default().pose();
    let mut tame = Vec::new();
    for (index, (hand, own, place)) in seen.iter().enumerate() {
        let opens_base = is_open && index == 0;
        let rig = match opens_base {
            true => Rig::from_open([true, true]),
            false => Rig::at_base(base),
        };
        let (frames, kept) = trimmed(own, &rig);
        tame.extend(kept.unwrap_or_else(|| own.iter().map(|sight| sight.row).collect()));
        if opens_base {
            base = frames.base;
        }
        let placement = place.unwrap_or_else(|| Placement::from_pose(&frames.tool));
        let tools = &mut device.surroundings.tools;
        match tools.iter_mut().find(|tool| tool.id == *hand) {
            Some(tool) => tool.placement = Some(placement),
            None => tools.push(Tool {
                id: hand.clone(),
                placement: Some(placement),
            }),
        }
    }
    if is_open {
        device.surroundings.tracker_base = Some(Placement::from_pose(&base));
    }
    tame.sort_unstable();
    if let Some(fitted) = fit(device, &recording.select(&tame), [is_open, true])? {
        device.surroundings = fitted.surroundings.settled();
    }
    Ok(())
}
