//! What is said of a finding.

use haptical::servo::{EpisodeFinding, Fault, RowFault, RowFaultKind, Side, Use};

use super::Examined;
use super::recording::{Recorded, Unit};

pub(super) fn verdict(verdict: Use) -> &'static str {
    match verdict {
        Use::Use => "use",
        Use::Look => "look",
        Use::LeaveOut => "leave out",
    }
}

/// Symbol of the recording's unit.
pub(super) fn symbol(unit: Unit) -> &'static str {
    match unit {
        Unit::Radians => "rad",
        Unit::Degrees => "deg",
        Unit::Percent => "%",
        Unit::Unknown => "unit not known",
    }
}

/// A number in the recording's unit.
pub(super) fn size(value: f64, unit: Unit) -> String {
    match unit {
        Unit::Radians => format!("{value:.3} rad ({:.1} deg)", value.to_degrees()),
        Unit::Degrees => format!("{value:.1} deg"),
        Unit::Percent => format!("{value:.1} %"),
        Unit::Unknown => format!("{value:.1} (its unit is not known)"),
    }
}

/// What is wrong, without where.
pub(super) fn what(joint: usize, finding: &EpisodeFinding, recorded: &Recorded) -> String {
    let unit = recorded.unit_of(joint);
    match &finding.fault {
        Fault::Offset { size: by, side, .. } => {
            let side = match side {
                Some(Side::Position) => "; the measured positions moved, the commands did not",
                Some(Side::Command) => "; the commands moved, the measured positions did not",
                None => "",
            };
            let direction = match (finding.since, *by > 0.0) {
                (0, true) => "above its command",
                (0, false) => "below its command",
                (_, true) => "more than in the episodes before, against its command",
                (_, false) => "less than in the episodes before, against its command",
            };
            format!(
                "offset: it reads {} {direction}{side}",
                size(by.abs(), unit)
            )
        }
        Fault::Gain { factor, .. } => {
            format!("gain: its position changes {factor:.2} times as much as before")
        }
        Fault::Latency { delay_s, sd_s } => {
            let direction = if *delay_s > 0.0 { "later" } else { "earlier" };
            // the end of what was looked for
            let least = if *sd_s >= delay_s.abs() {
                "at least "
            } else {
                ""
            };
            format!(
                "delay: it follows {least}{:.0} ms {direction}",
                1e3 * delay_s.abs()
            )
        }
        Fault::Dead { at } => format!(
            "dead: it stays at {} while its command moves",
            size(*at, unit)
        ),
        Fault::Swapped { with } => format!(
            "swapped: it follows the command of {}, and that joint this one's",
            recorded.names[*with]
        ),
        Fault::Clipped {
            at,
            is_upper,
            share,
        } => format!(
            "clipped: it never reads {} than {}, where its command goes beyond ({:.0} % of the rows)",
            if *is_upper { "more" } else { "less" },
            size(*at, unit),
            100.0 * share
        ),
        _ => "unknown".to_owned(),
    }
}

/// Which episodes have it.
pub(super) fn place(finding: &EpisodeFinding, recorded: &Recorded) -> String {
    let label = |episode: usize| recorded.labels[episode].to_string();
    match (finding.since, finding.until) {
        (0, None) => "in all episodes".to_owned(),
        (since, None) => format!("since episode {}", label(since)),
        (since, Some(until)) if since == until => format!("in episode {}", label(since)),
        (since, Some(until)) => format!("in episodes {} to {}", label(since), label(until)),
    }
}

pub(super) fn rows(fault: &RowFault) -> String {
    let (rows, of) = (fault.rows, fault.of);
    let said = match fault.kind {
        RowFaultKind::Lost => format!("lost rows: {rows} of {of} are missing by their times"),
        RowFaultKind::Jump => format!(
            "lost rows: all joints and commands jump as over {rows} rows or more, though the times go on evenly"
        ),
        RowFaultKind::Short => {
            format!("lost rows: the data set says {of} rows, {rows} of them are missing")
        }
        RowFaultKind::Missing => format!("dropouts: a joint has no reading in {rows} of {of} rows"),
        RowFaultKind::Repeated => {
            format!("repeated rows: {rows} of {of} repeat all positions of the row before")
        }
    };
    match fault.first_s {
        Some(first_s) => format!("{said}, first at {first_s:.2} s"),
        None => said,
    }
}

/// Why an episode has its verdict.
pub(super) fn why(examined: &Examined, episode: usize) -> String {
    let verdict = &examined.report.episodes[episode];
    let joints = verdict.findings.iter().map(|[joint, index]| {
        let finding = &examined.report.joints[*joint].findings[*index];
        format!(
            "{}: {}",
            examined.recorded.names[*joint],
            what(*joint, finding, &examined.recorded)
        )
    });
    let rows = verdict
        .rows
        .iter()
        .map(|row| rows(&examined.report.rows[*row]));
    joints.chain(rows).collect::<Vec<_>>().join("; ")
}

/// What was not looked for, and why.
pub(super) fn not_tested(examined: &Examined) -> Vec<String> {
    let mut by_reason: Vec<(String, Vec<&str>)> = Vec::new();
    for (joint, name) in examined.report.joints.iter().zip(&examined.recorded.names) {
        for why in &joint.not_tested {
            match by_reason.iter_mut().find(|(reason, _)| reason == why) {
                Some((_, names)) => names.push(name),
                None => by_reason.push((why.clone(), vec![name])),
            }
        }
    }
    let all = examined.recorded.names.len();
    let mut words: Vec<String> = (by_reason.into_iter())
        .map(|(why, names)| match names.len() == all {
            true => format!("all joints: {why}"),
            false => format!("{}: {why}", names.join(", ")),
        })
        .collect();
    if !examined.report.short.is_empty() {
        let labels = examined
            .report
            .short
            .iter()
            .take(20)
            .map(|episode| examined.recorded.labels[*episode].to_string());
        words.push(format!(
            "{} of too few rows: {}",
            if examined.report.short.len() == 1 {
                "an episode"
            } else {
                "episodes"
            },
            labels.collect::<Vec<_>>().join(", ")
        ));
    }
    words.push(format!(
        "offsets below {}, gains between 0.83 and 1.2 (0.77 and 1.3 of joints that hardly move), delays below half a row or above seven rows",
        size(examined.recorded.unit.least_offset(), examined.recorded.unit)
    ));
    words.push("gains and delays that all episodes share, or that begin in the first three or the last two episodes".to_owned());
    words.push("repeated rows of recordings with more than 133 rows a second".to_owned());
    words.push(
        "the cause of what a joint does in all episodes alike (lag, play, droop, friction): `haptical diagnose` names it".to_owned(),
    );
    words.push("camera images, and whether a task was done".to_owned());
    words
}
