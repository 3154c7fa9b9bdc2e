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
/// Nats of odds of 4 : 1.
const FOUR_NATS: f64 = 1.386_294_361_119_890_6;

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
         recording was; {} rows at most, both recordings judged together. The chosen recording starts as warm as the plan \
         says, up to 0.3 K, the others start cold, as the first one did. The device follows the chosen motion exactly; the force \
         of its hand is off by a quarter of a usual one. Settled means: named, and rightly.\n",
        arguments.count,
        arguments.rows,
        arguments.seed,
        suites.join(", "),
        found.len(),
        arguments.rows
    )?;
    page += "| further recording | settled | 95 % interval | named wrongly | open |\n";
    page += "| :--- | ---: | :--- | ---: | ---: |\n";
    let kinds: [(&str, OutcomeOf); 3] = [
        ("chosen by `plan --settle`", |one| &one.chosen),
        ("motions at random", |one| &one.at_random),
        ("by hand, as before", |one| &one.by_hand),
    ];
    for (name, of) in kinds {
        row(&mut page, name, Counts::of(found.iter().map(of)))?;
    }
    for promise in [Promise::Sure, Promise::Enough, Promise::Less, Promise::None] {
        let own = found.iter().filter(|one| Promise::of(one) == promise);
        let name = format!("chosen, {}", promise.words());
        row(&mut page, &name, Counts::of(own.map(|one| &one.chosen)))?;
    }
    let apart = found.iter().filter(|one| Promise::of(one) != Promise::None);
    let apart = Counts::of(apart.map(|one| &one.chosen));
    row(
        &mut page,
        "chosen, all but those of which the plan promises too little for some pair",
        apart,
    )?;
    let all = Counts::of(found.iter().map(|one| &one.chosen));
    let share = |counts: Counts| 100.0 * counts.settled as f64 / counts.all().max(1) as f64;
    writeln!(
        page,
        "\nBar: the chosen recording settles {:.0} %. {}: {:.0} % of all; {:.0} % of those of which it promises enough for \
         every pair.\n",
        100.0 * BAR,
        if share(all) >= 100.0 * BAR {
            "Met"
        } else {
            "NOT met"
        },
        share(all),
        share(apart)
    )?;
    page += "| trial | truth | candidates | odds promised | chosen | at random | by hand |\n";
    page += "| :--- | :--- | :--- | ---: | :--- | :--- | :--- |\n";
    for one in found {
        let odds = match one.expected_nats {
            _ if one.has_inseparable => "too little for some".to_owned(),
            Some(nats) if nats < 0.0 => format!("1 : {:.1}", (-nats).exp()),
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

/// What a plan promises of the worst pair of candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Promise {
    /// Odds of 20 : 1 or more.
    Sure,
    /// Odds that a name needs.
    Enough,
    Less,
    /// Of some pairs no motion is expected to let the true one be named, or there is no plan.
    None,
}

impl Promise {
    fn of(one: &Settled) -> Self {
        match one.expected_nats {
            Some(nats) if !one.has_inseparable && nats >= TWENTY_NATS => Self::Sure,
            Some(nats) if !one.has_inseparable && nats >= FOUR_NATS => Self::Enough,
            Some(_) if !one.has_inseparable => Self::Less,
            _ => Self::None,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Sure => "where odds of 20 : 1 or more are promised for every pair",
            Self::Enough => "where 4 : 1 to 20 : 1 are promised (a name needs 4 : 1)",
            Self::Less => "where less is promised",
            Self::None => {
                "where too little is promised for some pair by every motion, or there is no plan"
            }
        }
    }
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
