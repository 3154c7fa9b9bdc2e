//! The picture of a finding.

use std::ops::Range;

use haptical::servo::{EpisodeFinding, Fault};
use haptical_report::{Figure, FigureGrid, Mark, Series};

use super::Examined;
use super::recording::Label;
use super::words;

pub(super) const WIDTH_PX: u32 = 860;
pub(super) const HEIGHT_PX: u32 = 300;
/// Points of a line at most.
const MOST_POINTS: usize = 600;
/// Seconds of an episode that are shown.
const SHOWN_S: f64 = 8.0;

/// One number an episode where the fault shows in one, else what was asked and what came before and after.
pub(super) fn picture(examined: &Examined, joint: usize, finding: &EpisodeFinding) -> FigureGrid {
    let report = &examined.report.joints[joint];
    let name = &examined.recorded.names[joint];
    let unit = words::symbol(examined.recorded.unit_of(joint));
    match finding.fault {
        Fault::Offset { .. } => by_episode(
            examined,
            finding,
            &report.levels,
            &format!("{name}: position less command, median of an episode"),
            &format!("[{unit}]"),
        ),
        Fault::Gain { .. } => by_episode(
            examined,
            finding,
            &report.gains,
            &format!("{name}: spread of the position over spread of the command"),
            "[1]",
        ),
        _ => traces(examined, joint, finding),
    }
}

fn by_episode(
    examined: &Examined,
    finding: &EpisodeFinding,
    values: &[f64],
    title: &str,
    y_label: &str,
) -> FigureGrid {
    let at = |episode: usize| match examined.recorded.labels[episode] {
        Label::Number(number) => number as f64,
        // as in doctor.json
        Label::File(_) => episode as f64,
    };
    let is_in =
        |episode: usize| (finding.since..=finding.until.unwrap_or(usize::MAX)).contains(&episode);
    let mut figure = Figure::new(title, "episode", y_label);
    // the values are of the episodes that have rows enough, nearly always all
    let points = |wanted: bool| -> Vec<(f64, f64)> {
        let all = values
            .iter()
            .enumerate()
            .take(examined.recorded.episodes.len());
        all.filter(|(episode, value)| is_in(*episode) == wanted && value.is_finite())
            .map(|(episode, value)| (at(episode), *value))
            .collect()
    };
    for (label, colour, points) in [
        ("without", Series::AFTER, points(false)),
        ("with", Series::BEFORE, points(true)),
    ] {
        if !points.is_empty() {
            figure
                .series
                .push(Series::new(label, Mark::Points, colour, points));
        }
    }
    FigureGrid::new("", 1, vec![figure])
}

fn traces(examined: &Examined, joint: usize, finding: &EpisodeFinding) -> FigureGrid {
    let before = finding
        .since
        .checked_sub(1)
        .map(|episode| trace(examined, joint, finding, episode));
    let after = trace(examined, joint, finding, finding.since);
    let panels: Vec<Figure> = before.into_iter().chain([after]).collect();
    FigureGrid::new("", panels.len(), panels)
}

fn trace(examined: &Examined, joint: usize, finding: &EpisodeFinding, episode: usize) -> Figure {
    let recorded = &examined.recorded;
    let rows = busiest(examined, joint, &recorded.episodes[episode]);
    let start = recorded.time_s[recorded.episodes[episode].start];
    let line = |column: &[f64]| -> Vec<(f64, f64)> {
        let stride = rows.len().div_ceil(MOST_POINTS).max(1);
        let shown = rows
            .clone()
            .step_by(stride)
            .filter(|row| column[*row].is_finite());
        shown
            .map(|row| (recorded.time_s[row] - start, column[row]))
            .collect()
    };
    let mut figure = Figure::new(
        format!(
            "{}, episode {}",
            recorded.names[joint], recorded.labels[episode]
        ),
        "time [s]",
        format!("[{}]", words::symbol(recorded.unit_of(joint))),
    );
    if let Some(command) = recorded.command.get(joint) {
        figure.line("command", 6, line(command));
    }
    if let Fault::Swapped { with } = finding.fault {
        figure.line(
            format!("command of {}", recorded.names[with]),
            4,
            line(&recorded.command[with]),
        );
    }
    figure.line("position", Series::BEFORE, line(&recorded.position[joint]));
    figure.series.retain(|series| !series.points.is_empty());
    figure
}

/// The seconds of an episode in which the command moves most.
fn busiest(examined: &Examined, joint: usize, rows: &Range<usize>) -> Range<usize> {
    let recorded = &examined.recorded;
    let times = &recorded.time_s[rows.clone()];
    let Some(command) = recorded.command.get(joint) else {
        return rows.clone();
    };
    let step = (times[times.len() - 1] - times[0]) / times.len().max(2) as f64;
    let count = ((SHOWN_S / step.max(1e-6)) as usize).clamp(2, rows.len().max(2));
    if count >= rows.len() {
        return rows.clone();
    }
    let moved = |start: usize| {
        (start..start + count - 1)
            .map(|row| (command[row + 1] - command[row]).abs())
            .sum::<f64>()
    };
    let starts = (rows.start..=rows.end - count).step_by((count / 4).max(1));
    let best = starts
        .map(|start| (moved(start), start))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let start = best.map_or(rows.start, |best| best.1);
    start..start + count
}
