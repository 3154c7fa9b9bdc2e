//! The findings on a terminal.

use std::path::Path;

use haptical::servo::Use;
use haptical_report::Table;

use super::Examined;
use super::words;
use crate::failure::Failure;

pub(super) fn text(examined: &Examined, out: Option<&Path>) -> Result<String, Failure> {
    let mut said = String::new();
    said += &format!("{}\n\n", headline(examined));
    said += &format!("{}\n", joints(examined)?.to_terminal());
    let findings = findings(examined)?;
    if !findings.rows().is_empty() {
        said += &format!("{}\n", findings.to_terminal());
    }
    let episodes = episodes(examined)?;
    if !episodes.rows().is_empty() {
        said += &format!("{}\n", episodes.to_terminal());
    }
    said += "Not tested:\n";
    for words in words::not_tested(examined) {
        said += &format!("  {words}\n");
    }
    if let Some(out) = out {
        said += &format!(
            "\nWrote {}, doctor.json and comment.md.\n",
            out.join("doctor.html").display()
        );
    }
    Ok(said)
}

/// A line a joint: how it answers as a rule, and what was found.
pub(super) fn joints(examined: &Examined) -> Result<Table, Failure> {
    let unit = words::symbol(examined.recorded.unit);
    let heads = format!(
        "joint | moves [{unit}] | offset [{unit}] | follows after [ms] | equal readings [%] | found"
    );
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let decimals = if unit == "rad" { 4 } else { 2 };
    let middle = |values: &mut dyn Iterator<Item = f64>| {
        let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let rows = (examined.report.joints.iter().zip(&examined.recorded.names)).map(
        |(joint_report, name)| {
            let found = joint_report.findings.iter().map(|finding| {
                let kind = finding
                    .fault
                    .effect()
                    .replace("joint-", "")
                    .replace("servo-", "")
                    .replace("command-", "");
                format!("{kind} {}", words::place(finding, &examined.recorded))
            });
            let found: Vec<String> = found.collect();
            vec![
                name.as_str().into(),
                number(
                    middle(&mut joint_report.ranges.iter().map(|range| range[0])),
                    decimals - 1,
                )
                .into(),
                number(middle(&mut joint_report.levels.iter().copied()), decimals).into(),
                number(joint_report.answer_s.map(|s| 1e3 * s), 0).into(),
                format!("{:.0}", 100.0 * joint_report.repeated).into(),
                if found.is_empty() {
                    "nothing".to_owned()
                } else {
                    found.join(", ")
                }
                .into(),
            ]
        },
    );
    Ok(Table::with_heads("", &heads).with_rows(rows)?)
}

/// Each joint's findings.
pub(super) fn findings(examined: &Examined) -> Result<Table, Failure> {
    let recorded = &examined.recorded;
    let mut table = Table::with_heads("", "joint | what | where | probability");
    for (joint, (joint_report, name)) in
        (examined.report.joints.iter().zip(&recorded.names)).enumerate()
    {
        for finding in &joint_report.findings {
            table.push(vec![
                name.as_str().into(),
                words::what(joint, finding, recorded).into(),
                words::place(finding, recorded).into(),
                format!("{:.0} %", 100.0 * finding.probability).into(),
            ])?;
        }
    }
    Ok(table)
}

/// The episodes that are not simply used; neighbours with one cause are a row.
pub(super) fn episodes(examined: &Examined) -> Result<Table, Failure> {
    let all = examined.report.episodes.iter().enumerate();
    let all: Vec<(usize, Use, String)> = all
        .map(|(episode, episode_verdict)| {
            (
                episode,
                episode_verdict.verdict,
                words::why(examined, episode),
            )
        })
        .collect();
    let mut table = Table::with_heads("", "episode | verdict | why");
    for group in all.chunk_by(|a, b| (a.1, &a.2) == (b.1, &b.2)) {
        let ((first, verdict, why), (last, ..)) = (&group[0], &group[group.len() - 1]);
        let label = |episode: &usize| examined.recorded.labels[*episode].to_string();
        let episodes = match first == last {
            true => label(first),
            false => format!("{} to {}", label(first), label(last)),
        };
        if *verdict != Use::Use {
            table.push(vec![
                episodes.into(),
                words::verdict(*verdict).into(),
                why.as_str().into(),
            ])?;
        }
    }
    Ok(table)
}

/// The answer in one sentence.
pub(super) fn headline(examined: &Examined) -> String {
    let report = &examined.report;
    let count = |count: usize, one: &str| match count {
        1 => format!("1 {one}"),
        _ => format!("{count} {one}s"),
    };
    let episodes = count(report.episodes.len(), "episode");
    let joints = count(report.joints.len(), "joint");
    let with = report
        .joints
        .iter()
        .filter(|joint| !joint.findings.is_empty())
        .count();
    let of = |verdict: Use| {
        report
            .episodes
            .iter()
            .filter(|episode_verdict| episode_verdict.verdict == verdict)
            .count()
    };
    let verdicts = || {
        let (usable, look, leave) = (of(Use::Use), of(Use::Look), of(Use::LeaveOut));
        format!("Of {episodes} use {usable}, look at {look}, leave out {leave}.")
    };
    let without_commands = examined.recorded.command.is_empty();
    let apart = report.joints.iter().filter(|joint| !joint.follows).count();
    let apart = match apart {
        0 => String::new(),
        1 => " One joint does not follow its command, and was not compared with it.".to_owned(),
        _ => format!(
            " {apart} joints do not follow their commands, and were not compared with them."
        ),
    };
    let said = match (report.is_sound(), with) {
        (true, _) if without_commands => {
            format!(
                "No rows are lost or repeated in {episodes} of {joints}; without commands nothing else could be looked for."
            )
        }
        (true, _)
            if report
                .joints
                .iter()
                .all(|joint| !joint.not_tested.is_empty()) =>
        {
            format!(
                "Nothing was found in {episodes} of {joints}, but what changes between them could not be looked for."
            )
        }
        (true, _) => format!("Nothing was found in {episodes} of {joints}."),
        (false, 0) => format!(
            "Rows are lost, repeated or without readings; no joint has a finding. {}",
            verdicts()
        ),
        (false, 1) => format!("1 of {joints} has a finding. {}", verdicts()),
        (false, _) => format!("{with} of {joints} have a finding. {}", verdicts()),
    };
    said + &apart
}
