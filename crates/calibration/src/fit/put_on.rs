//! A tool that was put on at another line of the log than the device file says: refused where the other line fits far better.

use haptical_model::{Device, Recording};

use crate::fit::request::FitRequest;
use crate::fit::trial::{LEFT, NEARER, Trial};
use crate::{CalibrationError, ParameterFit};

/// Rows on either side that the line must leave: fewer have a place wherever they were touched.
const FEWEST: usize = 4;
/// Rows of the log, around the line that some rows have found, that the line is looked for again.
const NEAR: usize = 60;

/// Refuses a log with which a fit stays doubtful, if it fits several times better where a tool's `from_line` is another.
///
/// Which line that is shows before any number of the chain is fitted: a tool is longer than a chain is wrong. `bare` is the
/// device without places, with the residual that it leaves of the rows.
///
/// # Errors
/// [`CalibrationError::Rig`].
pub(super) fn refuse(
    request: &FitRequest<'_>,
    fit: &ParameterFit,
    (bare, unfitted): (&Device, f64),
    rows: &[usize],
) -> Result<(), CalibrationError> {
    for tool in 0..bare.surroundings.tools.len() {
        let Some(stated) = bare.surroundings.tools[tool].from_line else {
            continue;
        };
        let part = request.recording.select(rows);
        let Some((first, left)) = nearest(request, bare, tool, &part) else {
            continue;
        };
        if left >= NEARER * unfitted {
            continue;
        }
        // some rows say it to the rows between them: all of these say it to the row
        let near = around(request.recording, rows, first);
        let line = nearest(request, bare, tool, &request.recording.select(&near))
            .map_or(first, |(line, _)| line);
        let fitted = |device: &Device| Trial::new(request, device, &part)?.fitted();
        let (Some((before, odd)), Some((after, odd_there))) =
            (fitted(&fit.device), fitted(&moved(bare, tool, line)))
        else {
            continue;
        };
        if line != stated && after < LEFT * before && odd_there <= odd {
            return Err(CalibrationError::Rig {
                what: format!("[[tool]] `{}`", bare.surroundings.tools[tool].id),
                message: format!(
                    "from_line = {stated} leaves {before:.1} times the stated noise, from_line = {line} leaves \
                     {after:.1}: look at which line of the log the tool was put on, and correct it"
                ),
            });
        }
    }
    Ok(())
}

/// The device with a tool that was put on at another line.
fn moved(bare: &Device, tool: usize, line: u64) -> Device {
    let mut moved = bare.clone();
    moved.surroundings.tools[tool].from_line = Some(line);
    moved
}

/// The line from which on a tool leaves the least residual before a fit, with that residual.
fn nearest(
    request: &FitRequest<'_>,
    bare: &Device,
    tool: usize,
    part: &Recording,
) -> Option<(u64, f64)> {
    let end = part.len().checked_sub(FEWEST)?;
    let lines = part.line.get(FEWEST..end)?.iter();
    let tried = lines.filter_map(|&line| {
        let moved = moved(bare, tool, line);
        Some((line, Trial::new(request, &moved, part)?.unfitted()?))
    });
    tried.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The rows next to a line, and some of the others, so that each tool still has a place.
fn around(recording: &Recording, rows: &[usize], line: u64) -> Vec<usize> {
    let at = recording.line.partition_point(|&other| other < line);
    let near = at.saturating_sub(NEAR)..(at + NEAR).min(recording.len());
    let mut all: Vec<usize> = near.chain(rows.iter().copied()).collect();
    all.sort_unstable();
    all.dedup();
    all
}
