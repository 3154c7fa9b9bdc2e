//! The page of `settle-check`.

use std::fmt::Write as _;

use anyhow::Result;
use haptical_metrics::wilson_interval;

use super::trial::{Outcome, Settled};
use super::{Arguments, BAR, Counts, SUITES};

/// The outcome of one of the further recordings.
type OutcomeOf = fn(&Settled) -> &Outcome;

/// Nats of odds of 20 : 1.
const TWENTY_NATS: f64 = 2.995_732_273_553_991;

/// Figures, and every trial that was not settled.
pub(super) fn page(arguments: &Arguments, found: &[Settled], drawn: usize) -> Result<String> {
    let mut page = String::new();
    let suites: Vec<&str> = SUITES.iter().map(|suite| suite.name()).collect();
    writeln!(page, "# The next recording\n")?;
    writeln!(
        page,
        "`cargo xtask settle-check --count {} --rows {} --seed {} --out docs/evidence/settle.md` writes this page. Of {drawn} \
         trials of the suites {} in turn {} are ambiguous. Each is recorded again by the true device: along the motion \
         that `plan --settle` chooses, along as many motions drawn at random from the same ones, and by hand, as the first \
         recording was; {} rows at most, both recordings judged together. The device follows the chosen motion exactly; the \
         force of its hand is off by a quarter of a usual one. Settled means: named, and rightly.\n",
        arguments.count,
        arguments.rows,
        arguments.seed,
        suites.join(", "),
        found.len(),
        arguments.rows
    )?;
    writeln!(
        page,
        "| further recording | settled | 95 % interval | named wrongly | open |"
    )?;
    writeln!(page, "| :--- | ---: | :--- | ---: | ---: |")?;
    let kinds: [(&str, OutcomeOf); 3] = [
        ("chosen by `plan --settle`", |one| &one.chosen),
        ("motions at random", |one| &one.at_random),
        ("by hand, as before", |one| &one.by_hand),
    ];
    for (name, of) in kinds {
        row(&mut page, name, Counts::of(found.iter().map(of)))?;
    }
    let promised = |one: &&Settled| {
        !one.has_inseparable && one.expected_nats.is_some_and(|nats| nats >= TWENTY_NATS)
    };
    let kept: Vec<&Settled> = found.iter().filter(promised).collect();
    row(
        &mut page,
        "chosen, where odds of 20 : 1 or more are promised for every pair",
        Counts::of(kept.iter().map(|one| &one.chosen)),
    )?;
    row(
        &mut page,
        "chosen, where the plan says that some cannot be told apart, or promises less",
        Counts::of(
            found
                .iter()
                .filter(|one| !promised(one))
                .map(|one| &one.chosen),
        ),
    )?;
    let counts = Counts::of(found.iter().map(|one| &one.chosen));
    let share = counts.settled as f64 / counts.all().max(1) as f64;
    writeln!(
        page,
        "\nBar: the chosen recording settles {:.0} %. {}: {:.0} %.\n",
        100.0 * BAR,
        if share >= BAR { "Met" } else { "NOT met" },
        100.0 * share
    )?;
    writeln!(
        page,
        "| trial | truth | candidates | odds promised | chosen | at random | by hand |"
    )?;
    writeln!(page, "| :--- | :--- | :--- | ---: | :--- | :--- | :--- |")?;
    for one in found {
        let odds = match one.expected_nats {
            _ if one.has_inseparable => "some cannot be told apart".to_owned(),
            Some(nats) if nats > 6.9 => "over 1000 : 1".to_owned(),
            Some(nats) => format!("{:.1} : 1", nats.exp()),
            None => "none".to_owned(),
        };
        writeln!(
            page,
            "| {} {} | {} | {} | {odds} | {} | {} | {} |",
            one.suite,
            one.index,
            one.name,
            one.candidates.join(", "),
            word(&one.chosen),
            word(&one.at_random),
            word(&one.by_hand)
        )?;
    }
    Ok(page)
}

fn row(page: &mut String, name: &str, counts: Counts) -> Result<()> {
    let all = counts.all();
    let interval = match all {
        0 => "none".to_owned(),
        _ => {
            let interval = wilson_interval(counts.settled, all, 0.95)?;
            format!(
                "{:.0} to {:.0} %",
                100.0 * interval.low,
                100.0 * interval.high
            )
        }
    };
    writeln!(
        page,
        "| {name} | {} of {all} | {interval} | {} | {} |",
        counts.settled, counts.wrong, counts.open
    )?;
    Ok(())
}

fn word(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Settled => "settled".to_owned(),
        Outcome::Wrong(name) => format!("WRONG: {name}"),
        Outcome::Open(verdict) => verdict.clone(),
    }
}
