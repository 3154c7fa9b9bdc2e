//! The report of a batch: bars, suites, pictures, the trials that went wrong.

mod admission;
pub(crate) mod bars;
pub(crate) mod closed;
pub(crate) mod figures;
mod measured;
pub(crate) mod moving;
pub(crate) mod payloads;
pub(crate) mod record;
pub(crate) mod wrong;

use anyhow::Result;
use haptical_report::{Cell, Table};
use serde_json::json;
use xtask_blind::{Rate, Suite, TrialScore, rows, summarise};
use xtask_output::{Output, cells};

use self::wrong::Fault;
use crate::batch::Case;
use crate::calibration::{probabilities, reliability_bins};
use crate::measure::Measure;

/// Suites in which not seeing a small effect is no fault.
const SMALL: [&str; 2] = ["s1n", "s5"];

/// Everything, section by section.
pub(crate) fn write(output: &mut Output, cases: &[Case], measures: &[Measure]) -> Result<()> {
    bars(output, measures)?;
    suites(output, cases)?;
    calibration(output, cases)?;
    confusions(output, cases)?;
    if let Some(figure) = figures::ladder(cases) {
        output.section("Power");
        let caption = "Suite s5: the same effects at seven sizes, with 95 % intervals.";
        output.figure("ladder", caption, &figure)?;
    }
    parameters(output, cases)?;
    if let Some(table) = moving::table(cases)? {
        output.section("Moving arms");
        output.table("moving", table)?;
    }
    let open = closed::table(cases)?;
    if !open.rows().is_empty() {
        output.section("Loops that are not closed, or counted apart");
        output.table("loops", open)?;
    }
    wrong_ones(output, cases)?;
    Ok(())
}

fn bars(output: &mut Output, measures: &[Measure]) -> Result<()> {
    output.section("Bars");
    let judged: Vec<&Measure> = measures.iter().filter(|one| one.bar.is_some()).collect();
    let met = judged.iter().filter(|one| one.met == Some(true)).count();
    output.words(format!(
        "{met} of {} figures with a bar meet it. Intervals are Wilson's at 95 %, of figures that are no \
         shares by bootstrap over the trials.",
        judged.len()
    ));
    let columns = "of | figure | measured | 95 % interval | bar | ";
    let mut table = Table::with_heads("", columns);
    for one in measures {
        let bar = one.bar.map_or(String::new(), |bar| bar.words(&one.value));
        table.push(cells! {
            one.group, one.name.clone(), one.value.words(), one.value.interval(), bar,
            one.verdict(),
        })?;
    }
    output.terminal(lines(measures));
    output.table("bars", table)?;
    output.value("measures", json!(measures));
    Ok(())
}

/// The table of bars with a line for each heading, no wider than it must be.
fn lines(measures: &[Measure]) -> String {
    let mut lines = Vec::new();
    let mut group = "";
    for one in measures {
        if one.group != group {
            group = one.group;
            lines.push(group.to_owned());
        }
        let bar = one.bar.map_or(String::new(), |bar| bar.words(&one.value));
        let (name, value, interval) = (&one.name, one.value.words(), one.value.interval());
        let line = format!(
            "  {name:54} {value:20} {interval:19} {bar:15} {}",
            one.verdict()
        );
        lines.push(line.trim_end().to_owned());
    }
    lines.join("\n")
}

fn suites(output: &mut Output, cases: &[Case]) -> Result<()> {
    output.section("Suites");
    let heads = "suite | what | trials | no answer | detected | named | right | wrong name alone | unknown | joint right \
                 | false causes";
    let mut table = Table::with_heads("", heads);
    let mut present: Vec<&str> = cases.iter().map(|case| case.suite).collect();
    present.dedup();
    let mut summaries = Vec::new();
    for suite in present {
        let of_suite: Vec<&Case> = cases.iter().filter(|case| case.suite == suite).collect();
        let scores = of_suite.iter().filter_map(|case| case.score.clone());
        let scores: Vec<TrialScore> = scores.collect();
        let summary = summarise(suite, &scores);
        let wrong = scores.iter().map(|score| score.confidently_wrong);
        table.push(cells! {
            suite, Suite::named(suite).map_or("", Suite::about), of_suite.len() => 0,
            (of_suite.len() - scores.len()) => 0, percent(&summary.detected),
            percent(&summary.named), percent(&summary.right), percent(&Rate::of_cases(wrong)),
            percent(&summary.unknown), percent(&summary.joint_right),
            summary.false_causes_per_trial => 2,
        })?;
        summaries.push(summary);
    }
    let note = "Shares of all trials that were answered; joint: of those whose effect was found, or whose gap \
                lies in one.";
    output.table("suites", table.with_note(note))?;
    output.value("suites", json!(summaries));
    Ok(())
}

fn percent(rate: &Rate) -> Cell {
    match rate.share {
        Some(share) => Cell::Text(format!("{:.1} %", 100.0 * share)),
        None => Cell::Missing,
    }
}

fn calibration(output: &mut Output, cases: &[Case]) -> Result<()> {
    let pairs = probabilities(cases, None);
    let bins = reliability_bins(&pairs);
    if bins.is_empty() {
        return Ok(());
    }
    output.section("Probabilities");
    output.figure(
        "reliability",
        "Stated probability of the first cause, or of unknown, against how often it was so, all suites.",
        &figures::reliability(&bins),
    )?;
    let columns = "mean probability | share that was so | 95 % interval | answers";
    let mut table = Table::with_heads("", columns);
    for bin in &bins {
        table.push(cells! {
            bin.probability => 3, bin.happened.share => 3, bin.happened.ci95 => 2, bin.happened.of => 0,
        })?;
    }
    output.folded_table("reliability", "Reliability table", table)
}

/// A picture of who was taken for whom.
struct Confusion {
    file: &'static str,
    title: &'static str,
    suites: &'static [&'static str],
}

const CONFUSIONS: [Confusion; 8] = rows! {
    Confusion {file title suites}
    "confusion", "Clean, strong single effects, effects in no catalogue", &["s0", "s1", "s3"];
    "confusion-near", "Effects a tenth as strong", &["s1n"];
    "confusion-withheld", "Strong effects, withheld", &["s2"];
    "confusion-twins", "Effects with structural twins", &["s6"];
    "confusion-others", "Noise, impossible magnitudes, force", &["s7", "s10", "sf", "sfw", "sfu", "sp", "spw", "spc"];
    "confusion-measured", "Suites like measured sets", &["se", "sr", "sm", "sc", "sw"];
    "confusion-moving", "Arms that a controller moves", &["moving", "moving-memory"];
    "confusion-admission", "Moving arms with faults of log, file and laws", &["moving-admission"];
};

fn confusions(output: &mut Output, cases: &[Case]) -> Result<()> {
    output.section("Who was taken for whom");
    for Confusion {
        file,
        title,
        suites,
    } in CONFUSIONS
    {
        let wanted = cases.iter().filter(|case| suites.contains(&case.suite));
        let wanted: Vec<&Case> = wanted.collect();
        if let Some((map, caption)) = figures::confusion(title, &wanted) {
            output.heat_map(file, &caption, &map)?;
        }
    }
    Ok(())
}

fn parameters(output: &mut Output, cases: &[Case]) -> Result<()> {
    let scores: Vec<TrialScore> = cases.iter().filter_map(|case| case.score.clone()).collect();
    let by_name = summarise("all", &scores).parameters_covered_by_name;
    if by_name.is_empty() {
        return Ok(());
    }
    output.section("Intervals of parameters");
    let columns = "effect: parameter | intervals that hold the truth | of | 95 % interval";
    let mut table = Table::with_heads("", columns);
    for (name, rate) in &by_name {
        let interval = rate.ci95.map(|ends| ends.map(|end| 100.0 * end));
        table.push(cells! { name.clone(), percent(rate), rate.of => 0, interval => 0 })?;
    }
    output.folded_table("parameters", "By parameter, all suites", table)
}

fn wrong_ones(output: &mut Output, cases: &[Case]) -> Result<()> {
    output.section("Trials that were not answered rightly");
    output.words(
        "Each can be run again with the arguments in its row and the seed of the batch; --dump FOLDER \
         writes its files.",
    );
    let is_small = |case: &Case, fault: Fault| {
        fault == Fault::Missed && (SMALL.contains(&case.suite) || moving::is_weak(case))
    };
    let table = wrong::table("", cases, |case, fault| !is_small(case, fault))?;
    if table.rows().is_empty() {
        output.words("None.");
    } else {
        output.table("wrong", table)?;
    }
    let missed = wrong::table("", cases, is_small)?;
    if !missed.rows().is_empty() {
        let summary = format!("Small effects that were missed: {}", missed.rows().len());
        output.folded_table("missed", &summary, missed)?;
    }
    Ok(())
}
