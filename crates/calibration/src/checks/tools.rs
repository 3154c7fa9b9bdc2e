//! Checks that a recording can serve tools on the hand, and a tracker place for each run.

use std::collections::BTreeMap;

use haptical_model::{Device, Recording};

use crate::{CalibrationError, Channel};

/// Fewest rows that place a tracker and leave one to check it: three points have a place whatever the device is.
const BASE_ROWS: usize = 4;
/// Fewest rows that place a tool and leave one to check it.
const TOOL_ROWS: usize = 2;

/// Refuses a log and a device file that both say what is on the hand, a cable's reading in a row that is about a tool, and
/// runs or tools of too few rows to be placed.
///
/// # Errors
/// [`CalibrationError::Rig`], [`CalibrationError::Reading`].
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let tools = &device.surroundings.tools;
    let put_on = tools.iter().find(|tool| tool.from_line.is_some());
    if let (Some(tool), Some(_)) = (put_on, &recording.tool) {
        return refuse(
            format!("[[tool]] `{}`", tool.id),
            "it has `from_line`, and the log a column `tool`: two answers to what is on the hand; remove one"
                .to_owned(),
        );
    }
    let (runs, tools) = counts(device, recording)?;
    if let Some((run, rows)) = runs.iter().find(|(_, rows)| **rows < BASE_ROWS) {
        return refuse(
            "[tracker] base = \"per-run\"".to_owned(),
            format!(
                "run {run} has {rows} readings of the tracker, which fit wherever it stood: record at least \
                 {BASE_ROWS} in a run, better 20, or leave these out"
            ),
        );
    }
    if let Some((id, rows)) = tools.iter().find(|(_, rows)| **rows < TOOL_ROWS) {
        return refuse(
            format!(
                "column `{}`",
                if device.is_of_hand(id) {
                    "hand"
                } else {
                    "tool"
                }
            ),
            format!(
                "`{id}` is named in {rows} row, which fits wherever it is on the hand: record at least {TOOL_ROWS}, \
                 better 10, or leave it out"
            ),
        );
    }
    Ok(())
}

/// Rows with a reading by run of a tracker, and by tool.
type Counts<'r> = (BTreeMap<i64, usize>, BTreeMap<&'r str, usize>);

fn counts<'r>(
    device: &'r Device,
    recording: &'r Recording,
) -> Result<Counts<'r>, CalibrationError> {
    let (mut runs, mut tools) = Counts::default();
    let has_tools = device.has_tools(recording);
    for row in 0..recording.len() {
        let sees = |channel: Channel| channel.has_reading(recording, row);
        let is_tracked = sees(Channel::Position) || sees(Channel::Orientation);
        if device.has_run_bases() && is_tracked {
            *runs.entry(recording.run_at(row)).or_default() += 1;
        }
        let id = match has_tools {
            true => device.tool_at(recording, row),
            false => "",
        };
        if id.is_empty() {
            continue;
        }
        if is_tracked || sees(Channel::Contact) || sees(Channel::Plane) {
            *tools.entry(id).or_default() += 1;
        }
        if !device.is_of_hand(id) {
            refuse_cable(recording, row, id)?;
        }
    }
    Ok((runs, tools))
}

fn refuse(what: String, message: String) -> Result<(), CalibrationError> {
    Err(CalibrationError::Rig { what, message })
}

/// A cable ends at the handle, and nobody knows whether it was moved to the tool.
fn refuse_cable(recording: &Recording, row: usize, id: &str) -> Result<(), CalibrationError> {
    for index in 0..recording.cable_m.len() {
        let channel = Channel::Cable { index };
        if channel.has_reading(recording, row) {
            return Err(CalibrationError::Reading {
                line: recording.line.get(row).copied().unwrap_or(0),
                column: format!("{}_m", channel.name()),
                message: format!(
                    "the row is about the tool `{id}`, and a cable ends at the handle: put its reading into a row of \
                     its own with an empty `tool`"
                ),
            });
        }
    }
    Ok(())
}
