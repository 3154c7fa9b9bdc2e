//! A tool that was put on at another line of the log than the device file says.

use haptical_model::{Device, Recording, Tool};

use crate::checks::otherwise::hypotheses::Hypothesis;
use crate::fit::request::FitRequest;
use crate::fit::trial::Trial;

/// Rows on either side that the line must leave: fewer have a place wherever they were touched.
const FEWEST: usize = 4;
/// Rows of the log, around the line that some rows have found, that the line is looked for again.
const NEAR: usize = 60;

const LINES: &str = "look at which line of the log the tool was put on, and correct it";

/// For each tool with a `from_line` the other line that leaves the least residual.
///
/// Which line that is shows before any number of the chain is fitted: a tool is longer than a chain is wrong. `bare` is the
/// device without places.
pub(super) fn of_tools(
    request: &FitRequest<'_>,
    bare: &Device,
    rows: &[usize],
) -> Vec<Hypothesis<'static>> {
    let tools = bare.surroundings.tools.iter().enumerate();
    let of_tool = |(index, tool): (usize, &Tool)| {
        let stated = tool.from_line?;
        let (first, _) = nearest(request, bare, index, &request.recording.select(rows))?;
        // some rows say it to the rows between them: all of these say it to the row
        let near = around(request.recording, rows, first);
        let near = nearest(request, bare, index, &request.recording.select(&near));
        let line = near.map_or(first, |(line, _)| line);
        let what = format!("from_line = {line} of [[tool]] `{}`, not {stated}", tool.id);
        let change = move |device: &mut Device| put_on(device, index, line);
        (line != stated).then(|| Hypothesis::of_device(what, LINES, 1, change))
    };
    tools.filter_map(of_tool).collect()
}

fn put_on(device: &mut Device, tool: usize, line: u64) {
    device.surroundings.tools[tool].from_line = Some(line);
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
    let mut moved = bare.clone();
    let tried = lines.filter_map(|&line| {
        put_on(&mut moved, tool, line);
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
