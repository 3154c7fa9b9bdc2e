//! Blind trials of the diagnosis: truths are sealed, answers fixed, then both are compared.
//! docs/blind-checks.md says what is sealed and when.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::missing_errors_doc,
    reason = "a command talks to its terminal, and its errors are texts for a person"
)]

mod batch;
mod calibration;
mod closing;
mod compiled;
mod measure;
mod plan;
mod quick;
mod rehearsal;
mod report;
mod seed;
mod settle;
mod speed;
mod subject;
#[cfg(test)]
mod tests;
mod threads;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haptical_report::write_atomically;
use serde::Serialize;
use serde_json::json;
use xtask_blind::Suite;
use xtask_output::{Layout, Output, root};

use batch::{Batch, Case};
pub use settle::{Arguments as SettleArguments, settle};

use measure::Measure;
use plan::Plan;
use report::record::Run;
use seed::SeedRule;

/// Arguments of `blind-check`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: cargo xtask blind-check --suite s1 --first 17 --count 1 --seed 5")]
pub struct Arguments {
    /// Suites: s0, s1, s1n, s2, s3, s4, s5, s6, s7, s8, s10, sf, sfw, sfu, sp, spw, spc, se, sr, sm, sc, sw, sl, slp, sla, moving,
    /// moving-memory, moving-admission (default: all).
    #[arg(long, value_delimiter = ',')]
    suite: Vec<String>,
    /// Trials of each suite (default: as many as a scored batch has).
    #[arg(long, conflicts_with = "quick")]
    count: Option<u64>,
    /// Share of the trials of a scored batch.
    #[arg(long, default_value_t = 1.0, conflicts_with_all = ["quick", "count"])]
    share: f64,
    /// Index of the first trial of each suite.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// A number for a development batch, or `commit`: the first 8 digits of the commit that froze the
    /// thresholds.
    #[arg(long, default_value = "1")]
    seed: SeedRule,
    /// Folder for scores, figures and report.
    #[arg(long, default_value = "target/blind-check")]
    out: PathBuf,
    /// A few trials of each suite, and gross errors alone are failures: for continuous integration.
    #[arg(long, conflicts_with = "record")]
    quick: bool,
    /// Trials at once (default: one per core).
    #[arg(long)]
    jobs: Option<usize>,
    /// Writes each trial, truth included, to a folder of its own below this one.
    #[arg(long)]
    dump: Option<PathBuf>,
    /// Writes each trial as `--dump` does, and ends: nothing is diagnosed.
    #[arg(long, conflicts_with_all = ["dump", "record"])]
    write: Option<PathBuf>,
    /// Adds a row to docs/blind-checks.md; for a scored batch alone.
    #[arg(long)]
    record: bool,
}

/// Runs the job.
pub fn check(arguments: &Arguments) -> Result<()> {
    let plan = Plan::new(arguments)?;
    let seed = arguments.seed.seed(&root())?;
    let is_scored = seed.frozen_by.is_some() && plan.is_whole();
    ensure!(
        is_scored || !arguments.record,
        "--record is for scored batches: --seed commit, every suite, all of its trials"
    );
    let jobs = threads::jobs(arguments.jobs);
    ensure!(jobs > 0, "--jobs is 0: a batch needs one at least");
    let trials = plan.trials();
    let is_loop = |(suite, _): &(Suite, u64)| matches!(suite, Suite::Loop | Suite::LoopPairs);
    let asks_c = !arguments.quick && trials.iter().any(is_loop);
    let haptical = asks_c.then(compiled::command).flatten();
    let batch = Batch {
        seed: seed.value,
        trials,
        jobs,
        haptical,
    };
    if let Some(folder) = arguments.dump.as_ref().or(arguments.write.as_ref()) {
        batch.dump(folder)?;
    }
    if let Some(folder) = &arguments.write {
        println!("trials: {}", folder.display());
        return Ok(());
    }
    let run = Run {
        date: seed::today(),
        commit: seed::head(&root()),
        frozen_by: seed.frozen_by.clone().unwrap_or_else(|| "none".to_owned()),
        seed: seed.value,
        changes_since: seed.changes_since,
        counts: plan.words(),
    };
    let (cases, repeats) = tried(&batch, &arguments.out)?;
    let mut measures = report::bars::measures(&cases);
    measures.extend(report::payloads::payloads(&cases));
    measures.extend(speed::in_batch(&cases));
    if !arguments.quick && arguments.suite.is_empty() {
        measures.extend(speed::alone(seed.value)?);
    }
    publish(arguments, &run, is_scored, &cases, &measures)?;
    if arguments.record {
        report::record::append(&root(), &run, &measures)?;
        println!("recorded in {}", report::record::LOG);
    }
    if arguments.quick {
        quick::assert_sound(&cases, repeats)?;
    }
    ensure!(repeats, "the same trial had two answers");
    Ok(())
}

/// Seals, diagnoses, opens; and whether the first trials had the same answers twice.
fn tried(batch: &Batch, out: &Path) -> Result<(Vec<Case>, bool)> {
    let sealed = batch.seal()?;
    let commitments = batch.commitments(&sealed);
    write_json(&out.join("commitments.json"), &commitments)?;
    let rehearsal = batch.rehearse()?;
    eprintln!("{}", rehearsal.words(batch));
    let fixed = batch.diagnose(&sealed)?;
    write_json(&out.join("answers.json"), &batch.answers(&fixed))?;
    let repeats = rehearsal.agrees(&fixed);
    let cases = batch.open(&commitments, sealed, fixed)?;
    write_json(&out.join("scores.json"), &cases)?;
    Ok((cases, repeats))
}

fn publish(
    arguments: &Arguments,
    run: &Run,
    is_scored: bool,
    cases: &[Case],
    measures: &[Measure],
) -> Result<()> {
    let mut output = Output::new(Layout {
        stem: "summary",
        figures: "",
        tables: "tables/",
    });
    report::write(&mut output, cases, measures)?;
    output.value("run", json!(run));
    output.value("is_scored", json!(is_scored));
    let title = if is_scored {
        "Blind check of the diagnosis"
    } else {
        "Blind check of the diagnosis: development batch"
    };
    let kind = match (is_scored, run.frozen_by.as_str()) {
        (true, commit) => format!(
            "Scored batch: its seed is the first 8 digits of {commit}, the commit that froze the \
             thresholds; {} commits have changed the diagnosis since.",
            run.changes_since
        ),
        (false, "none") => {
            "Not a scored batch: its seed was chosen, and the thresholds may have been set on it."
                .to_owned()
        }
        (false, _) => "Not a scored batch, but a part of one.".to_owned(),
    };
    let lead = format!(
        "{kind} Seed {}, {} trials ({}), commit {}, {}. docs/blind-checks.md says what was sealed and when.",
        run.seed,
        cases.len(),
        run.counts,
        run.commit,
        run.date
    );
    output.terminal(kind);
    output.write(&arguments.out, title, &lead)
}

fn write_json(path: &Path, what: &impl Serialize) -> Result<()> {
    let mut bytes = serde_json::to_vec_pretty(what)?;
    bytes.push(b'\n');
    write_atomically(path, &bytes).with_context(|| path.display().to_string())
}
