//! What is refused of a simulated log of postures, and what is left out of it.

use haptical_design::{Measure, Rig};
use haptical_effects::device::DeviceEffectError;
use haptical_simulator::SimulatorError;

use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// Lines that a warning lists.
const MOST_LINES: usize = 5;

/// Refuses postures that do not say what a rig needs to know of them.
pub(super) fn unasked(rig: Option<&Rig>, postures: &Log) -> Result<(), Error> {
    let Some(rig) = rig else {
        return Ok(());
    };
    for measure in &rig.measures {
        let recording = &postures.recording;
        let (column, ids) = match measure {
            Measure::Contact { .. } => ("contact", &recording.contact),
            Measure::Plane { .. } => ("plane", &recording.plane),
            _ => continue,
        };
        if ids.is_none() {
            let name = &rig.name;
            let what =
                format!("the rig {name} touches things, and no column `{column}` says which");
            let next = format!(
                "take the poses.csv of `haptical plan --measure {name} --poses 60`, or add the column"
            );
            return Err(Error::in_file("rig", what, &postures.source().path, next));
        }
    }
    Ok(())
}

/// What the simulator refuses, said of the file that it came from.
pub(super) fn simulator(error: &SimulatorError, device: &Device, postures: &Log) -> Error {
    let path = &postures.source().path;
    let text = error.to_string();
    let what = text.split_once(": ").map_or(&*text, |(_, what)| what);
    let at = |row: usize, next: &str| postures.refuse_row("posture", what, row, next);
    match error {
        SimulatorError::OutOfReach { .. } => {
            let next = "plan the poses for a device that is nearer to the true one, or place it elsewhere: [[contact_point]] or \
                        [[touched_plane]] of the device file";
            Error::in_file("posture", text, path, next)
        }
        SimulatorError::NoPlane { .. } => {
            let next = "let three rows or more touch it, not in a line, or give its place: [[touched_plane]] of the device file";
            Error::in_file("posture", text, path, next)
        }
        SimulatorError::NotMet { row, .. } => at(*row, "leave the row out, or take another --seed"),
        SimulatorError::HeldTouch { row } => {
            at(*row, "empty the cell of the touch or that of the fixture")
        }
        SimulatorError::Row { row, .. } => at(*row, "leave the row out"),
        _ => {
            let next = "correct the device file, or the poses";
            Error::in_file("device", text, &device.source().path, next).with_equipment(device)
        }
    }
}

/// An effect of the true device that postures do not drive, or that has no meaning.
pub(super) fn effect(error: &DeviceEffectError, device: &Device, postures: &Log) -> Error {
    let path = &postures.source().path;
    match error {
        DeviceEffectError::Untestable { .. } => {
            let next = "give what drives it in a column of the poses (t_s, temp_degc, torque1_nm, ...) or, for torques at rest, masses \
                        and [gravity] in the device file; or take the effect out";
            Error::in_file("effect", error.to_string(), path, next)
        }
        _ => Error::effect(error, &device.source().path, path),
    }
}

/// Postures and effects that never come together.
pub(super) fn unsettled(postures: &Log) -> Error {
    let said = "the postures that touch do not settle: each change of them changes what the effects of the device do; take fewer \
                effects, or smaller ones";
    Error::of_file("effect", said, &postures.source().path)
}

/// What is said of postures that the true device does not get to.
pub(super) fn left_out(rows: &[usize], postures: &Log) -> Vec<String> {
    if rows.is_empty() {
        return Vec::new();
    }
    let lines = rows
        .iter()
        .filter_map(|row| postures.recording.line.get(*row));
    let mut lines: Vec<String> = lines.take(MOST_LINES).map(u64::to_string).collect();
    if rows.len() > MOST_LINES {
        lines.push("...".to_owned());
    }
    vec![format!(
        "{}: {} of {} postures are left out: the true device does not get to what it is to touch there within the limits \
         of its joints (lines {})",
        postures.source().label,
        rows.len(),
        postures.recording.len(),
        lines.join(", ")
    )]
}
