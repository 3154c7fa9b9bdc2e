//! Blind trials of the diagnosis: truths are sealed, answers fixed, then both are compared.
//! docs/blind-checks.md says what is sealed and when.

mod bars;
mod batch;
mod measure;
mod plan;
mod seed;
mod speed;
mod subject;
mod threads;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use haptical_report::write_atomically;
use serde::Serialize;

use batch::Batch;
use plan::Plan;
use seed::SeedRule;

/// Arguments of `blind-check`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: cargo xtask blind-check --suite s1 --first 17 --count 1 --seed 5")]
pub(crate) struct Arguments {
    /// Suites: s0, s1, s1n, s2, s3, s4, s5, s6, s7, s8, s10, sf (default: all).
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
    /// Writes each trial, truth included, to a folder below this one.
    #[arg(long)]
    dump: Option<PathBuf>,
    /// Adds a row to docs/blind-checks.md; for a scored batch alone.
    #[arg(long)]
    record: bool,
}

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Runs the job.
pub(crate) fn check(arguments: &Arguments) -> Result<()> {
    let plan = Plan::new(arguments)?;
    let seed = arguments.seed.seed(&root())?;
    let jobs = match arguments.jobs {
        Some(jobs) => jobs,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    ensure!(jobs > 0, "--jobs is 0: a batch needs one at least");
    let batch = Batch {
        seed: seed.value,
        trials: plan.trials(),
        jobs,
    };
    let out = &arguments.out;
    let sealed = batch.seal()?;
    let commitments = batch.commitments(&sealed);
    write_json(&out.join("commitments.json"), &commitments)?;
    let fixed = batch.diagnose(&sealed)?;
    let repeats = fixed
        .first()
        .map_or(Ok(true), |first| batch.repeats(first))?;
    let cases = batch.open(&commitments, sealed, fixed)?;
    write_json(&out.join("scores.json"), &cases)?;
    let mut measures = bars::measures(&cases);
    measures.extend(speed::in_batch(&cases));
    if !arguments.quick && arguments.suite.is_empty() {
        measures.extend(speed::alone(seed.value)?);
    }
    for measure in &measures {
        println!(
            "{:44} {:60} {:28} {:22} {:18} {}",
            measure.group,
            measure.name,
            measure.value.words(),
            measure.value.interval(),
            measure
                .bar
                .map_or(String::new(), |bar| bar.words(&measure.value)),
            measure.verdict()
        );
    }
    println!("repeats: {repeats}");
    Ok(())
}

fn write_json(path: &Path, what: &impl Serialize) -> Result<()> {
    let mut bytes = serde_json::to_vec_pretty(what)?;
    bytes.push(b'\n');
    write_atomically(path, &bytes).with_context(|| path.display().to_string())
}
