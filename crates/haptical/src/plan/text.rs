//! A plan as text for a terminal.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use haptical_design::{
    Criterion, NextPoses, ParameterStatus, Plan, Remedy, RigIdentifiability, Suggestion,
};
use haptical_identification::Status;
use haptical_report::{Cell, Column, Table};

use super::Planned;
use crate::error::Error;
use crate::identify::intervals::of_scales;
use crate::lines::labelled;

/// Remedies that are named for a parameter.
const REMEDIES: usize = 3;

/// The plan as text.
pub(super) fn write(text: &mut impl std::fmt::Write, plan: &Planned) -> std::fmt::Result {
    let first = format!("{}: {}", plan.device, plan.answer);
    writeln!(text, "{}", labelled("", &first, 0))?;
    if let Some(next) = plan.next_poses() {
        writeln!(text, "{}", said(next, plan.plan.measured_poses))?;
    }
    for rig in plan.rigs() {
        for (index, line) in brief(rig).iter().enumerate() {
            let label = if index == 0 { "" } else { "  " };
            text.write_str(&labelled(label, line, label.len()))?;
        }
    }
    text.write_str(&labelled("", &plan.named_rows, 0))?;
    // a table of this many columns in each row is never refused
    let table = table(plan).map_err(|_| std::fmt::Error)?;
    writeln!(
        text,
        "\nWhat {} poses of average worth would tell: the standard deviation, or why there is none",
        plan.plan.poses
    )?;
    writeln!(text, "{}", table.to_terminal())
}

/// The plan in a line.
pub(super) fn answer(plan: &Plan) -> String {
    let rigs = plan.rigs.iter().map(|rig| {
        let (measure, count) = (&rig.measure, rig.parameters.len());
        format!("{measure} tells {} of {count} parameters", rig.rank)
    });
    let poses = plan.next_poses.iter().map(|next| {
        let (count, candidates, measure) = (next.count, next.candidates, &next.measure);
        format!("{count} poses are chosen of {candidates} for {measure}")
    });
    let parts: Vec<String> = rigs.chain(poses).collect();
    parts.join("; ") + "."
}

/// Parameters against rigs.
fn table(plan: &Planned) -> Result<Table, Error> {
    let mut columns = vec![Column::new("parameter", ""), Column::new("unit", "")];
    columns.extend(plan.rig_names().map(|name| Column::new(name, "")));
    let rows = parameters(plan).into_iter().map(|(name, unit)| {
        let word = |rig| find(rig, &name).map_or_else(|| "not there".to_owned(), word);
        let words = plan.rigs().iter().map(word).map(Cell::from);
        let head = [Cell::from(&name), unit.into()];
        head.into_iter().chain(words).collect()
    });
    Ok(Table::new("", columns).with_rows(rows)?)
}

/// Names and units of all rigs' parameters, in the order in which they come.
pub(super) fn parameters(plan: &Planned) -> Vec<(String, String)> {
    let mut seen = BTreeSet::new();
    let entries = plan.rigs().iter().flat_map(|rig| &rig.parameters);
    let new = entries.filter(|entry| seen.insert(entry.name.clone()));
    new.map(|entry| (entry.name.clone(), entry.unit.clone()))
        .collect()
}

pub(super) fn find<'r>(rig: &'r RigIdentifiability, name: &str) -> Option<&'r ParameterStatus> {
    rig.parameters.iter().find(|entry| entry.name == name)
}

/// A cell in words.
pub(super) fn word(entry: &ParameterStatus) -> String {
    let name = entry.status.name();
    match &entry.status {
        Status::Identifiable { standard_deviation } => format!("{standard_deviation:.2e}"),
        Status::Weak { standard_deviation } => format!("{name} {standard_deviation:.2e}"),
        Status::Invisible | Status::Dependent { .. } => name.to_owned(),
    }
}

/// What a rig counts, and what all its lengths rest on.
fn heading(rig: &RigIdentifiability) -> Vec<String> {
    let mut lines = vec![format!(
        "{}: {} of {} parameters; readings a pose: {}",
        rig.measure,
        rig.rank,
        rig.parameters.len(),
        rig.readings_per_pose
    )];
    let scales = of_scales(&rig.length_scales);
    lines.extend((!scales.is_empty()).then(|| scales.trim_start().to_owned()));
    lines
}

/// A line for each measurement that would tell more, and one for what none of those tried tells.
fn brief(rig: &RigIdentifiability) -> Vec<String> {
    let mut lines = heading(rig);
    let mut told: Vec<(String, Vec<String>)> = Vec::new();
    let mut rest: Vec<&str> = Vec::new();
    for suggestion in &rig.suggestions {
        let Some(best) = suggestion.remedies.first() else {
            rest.push(&suggestion.parameter);
            continue;
        };
        let measure = measured(best);
        let (sd, unit) = (best.standard_deviation, &suggestion.unit);
        let parameter = format!("{} (sd {sd:.1e} {unit})", suggestion.parameter);
        match told.iter_mut().find(|(own, _)| *own == measure) {
            Some((_, parameters)) => parameters.push(parameter),
            None => told.push((measure, vec![parameter])),
        }
    }
    for (measure, parameters) in told {
        lines.push(format!("{measure} would tell {}", parameters.join(", ")));
    }
    if !rest.is_empty() {
        lines.push(format!(
            "nothing that was tried tells {}: they act like others or not at all, and keep their values (--out writes \
             plan.html, which has each one's reason)",
            rest.join(", ")
        ));
    }
    lines
}

/// The parameters that a rig does not identify, each with its reason, and measurements that would.
pub(super) fn lines(rig: &RigIdentifiability) -> Vec<String> {
    let mut lines = heading(rig);
    lines.extend(rig.suggestions.iter().map(suggested));
    lines
}

/// A measurement, and the one in whose place it is.
fn measured(remedy: &Remedy) -> String {
    let instead = remedy.instead_of.as_ref();
    let instead = instead.map(|own| format!(" instead of {own}"));
    format!("{}{}", remedy.measure, instead.unwrap_or_default())
}

fn suggested(suggestion: &Suggestion) -> String {
    let remedies = suggestion.remedies.iter().take(REMEDIES).map(|remedy| {
        let (measure, sd) = (measured(remedy), remedy.standard_deviation);
        format!("{measure} (sd {sd:.2e} {})", suggestion.unit)
    });
    let remedies: Vec<String> = remedies.collect();
    let own = &suggestion.parameter;
    let reason = match suggestion.not_told_from.as_slice() {
        [other] => format!(
            "{own} and {other} cannot be distinguished with this rig ({})",
            suggestion.reason
        ),
        _ => suggestion.reason.clone(),
    };
    match remedies.is_empty() {
        true => format!("{reason}; nothing that was tried with this rig identifies it"),
        false => format!("{reason}; adding {} would tell it", remedies.join(", or ")),
    }
}

/// The chosen poses in words.
pub(super) fn said(next: &NextPoses, measured: usize) -> String {
    let besides = match measured {
        0 => String::new(),
        _ => format!(" in addition to {measured} that were measured"),
    };
    let mut text = format!(
        "{} of {} poses{besides} for {}, {} parameters, {} exchanges.\n",
        next.count,
        next.candidates,
        next.measure,
        next.parameters.len(),
        next.exchanges
    );
    let mut compare = |what: &str, own: f64, random: Option<f64>| {
        let random = random.map(|random| format!(" (as many at random: {random:.4e})"));
        let _ = writeln!(text, "  {what}: {own:.4e}{}", random.unwrap_or_default());
    };
    let (own, random) = (&next.figures, next.random.as_ref());
    let what = "geometric mean of sd over plausible size";
    let of_random = random.map(|random| random.geometric_mean_sd);
    compare(what, own.geometric_mean_sd, of_random);
    compare("observability O1", own.o1, random.map(|random| random.o1));
    if let Some(value) = own.root_mean_square {
        let task = match next.criterion {
            Criterion::TaskPosition => {
                Some("handle position error in the region by noise, rms [m]")
            }
            Criterion::TaskForce => Some("force direction error in the region by noise, rms [rad]"),
            _ => None,
        };
        let what = task.unwrap_or("root mean square of sd over plausible size");
        let of_random = random.and_then(|random| random.root_mean_square);
        compare(what, value, of_random);
        if task.is_some() {
            text += "  Errors of numbers that this rig does not tell, listed above, come on top of it.\n";
        }
    }
    text
}
