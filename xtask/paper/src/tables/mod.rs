//! The paper's simulation, end to end, its published figures next to ours.

mod figures;
mod identifiability;
mod ladder;
mod sections;
mod sensitivity;
mod sweeps;
mod table2;
mod table3;
#[cfg(test)]
mod tests;
mod verdict;

use std::path::PathBuf;

use anyhow::{Result, ensure};
use xtask_output::{Layout, Output};

use crate::monte_carlo::MonteCarlo;
use crate::published::Paper;
use crate::scenario::{Scenario, nominal_device};
use sweeps::Seeds;

use crate::experiment::{self, Extent};

/// Arguments of `reproduce-tables`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask reproduce-tables --runs 200 --out target/mine")]
pub struct Arguments {
    /// First seed; run k uses seed + k.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Runs of the Monte-Carlo tables.
    #[arg(long, default_value_t = 1000)]
    runs: usize,
    /// Nominal device (default: the one that the paper's tables imply).
    #[arg(long)]
    device: Option<PathBuf>,
    /// Folder for tables, figures and report.
    #[arg(long, default_value = "target/reproduction")]
    out: PathBuf,
    /// Few runs and seeds: a check that everything works, in seconds.
    #[arg(long)]
    quick: bool,
    /// Use the denominators 2.9 mm (joint 4: 2.6 mm) of the input drums' terms throughout, instead
    /// of the drum distances as printed.
    #[arg(long)]
    paper_preset: bool,
}

/// Everything that the sections are made from.
struct Results {
    paper: Paper,
    scenario: Scenario,
    run: crate::run::Run,
    runs: MonteCarlo,
    preset_run: crate::run::Run,
    preset_runs: MonteCarlo,
    seeds: Seeds,
}

/// Runs the main job.
pub fn reproduce(arguments: &Arguments) -> Result<()> {
    ensure!(
        arguments.runs >= 20,
        "--runs must be at least 20: quantiles of fewer say nothing"
    );
    let (runs, sweep_seeds) = if arguments.quick {
        (40, 6)
    } else {
        (arguments.runs, 40)
    };
    let paper = Paper::load()?;
    let nominal = nominal_device(arguments.device.as_deref())?;
    let scenario = Scenario::paper(nominal.clone(), &paper, arguments.paper_preset)?;
    let preset = Scenario::paper(nominal.clone(), &paper, true)?;
    let assigned = paper.table3.iter();
    let assigned = assigned.map(|row| (row.name.clone(), row.assigned));
    let assigned: Vec<(String, f64)> = assigned.collect();
    let monte_carlo = |name: &str, scenario: &Scenario| {
        MonteCarlo::new(name, scenario, &assigned, arguments.seed, runs)
    };
    let results = Results {
        run: crate::run::run(&scenario, arguments.seed)?,
        runs: monte_carlo("both steps, eq. (1) as printed", &scenario)?,
        preset_run: crate::run::run(&preset, arguments.seed)?,
        preset_runs: monte_carlo("both steps, --paper-preset", &preset)?,
        seeds: Seeds {
            first: arguments.seed,
            count: sweep_seeds,
        },
        paper,
        scenario,
    };
    let mut output = Output::new(Layout::in_folders("tables"));
    sections::summary(&mut output, &results)?;
    sections::table1(&mut output, &results)?;
    sections::identifiability(&mut output, &results, arguments.seed)?;
    sections::table2(&mut output, &results)?;
    sections::table3(&mut output, &results)?;
    sections::figures(&mut output, &results)?;
    sections::choices(&mut output, &results)?;
    sections::sensitivity(&mut output, &results, &nominal)?;
    let extent = if arguments.quick {
        Extent::QUICK
    } else {
        Extent::IN_TABLES
    };
    experiment::sections(&mut output, nominal, &results.paper, arguments.seed, extent)?;
    let quick = arguments.quick.then_some(" --quick");
    let preset = arguments.paper_preset.then_some(" --paper-preset");
    let flags = [quick, preset].map(Option::unwrap_or_default).concat();
    let seed = arguments.seed;
    let command = format!("cargo xtask reproduce-tables --seed {seed} --runs {runs}{flags}");
    let lead = format!(
        "Simulated calibration of the paper's 7-DOF device ({} runs; made by `{command}`, version {}). \
         The paper's figures are next to ours, as printed. Lengths, home pose, ratios and drum \
         distances are not printed in the paper; docs/assumptions.md says where ours come from. From \"The recorded motion\" on it is the paper's \
         experiment, with {} seeds where `cargo xtask reproduce-experiment` takes 200. {}",
        results.runs.samples.len(),
        env!("CARGO_PKG_VERSION"),
        extent.seeds,
        experiment::LEAD,
    );
    let title = "Baser & Konukseven's simulation, reproduced";
    output.write(&arguments.out, title, &lead)
}
