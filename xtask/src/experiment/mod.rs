//! The paper's experiment on a virtual device: the truth is the device that the authors identified.

mod force;
mod improvement;
mod truth;

use std::path::PathBuf;

use anyhow::{Result, ensure};
use haptical_model::Device;

use crate::output::{Layout, Output};
use crate::progress::Progress;
use crate::tables::paper::Paper;
use crate::tables::scenario::{Scenario, nominal_device};

/// Arguments of `reproduce-experiment`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask reproduce-experiment --seeds 50 --out target/mine")]
pub(crate) struct Arguments {
    /// First seed; calibration k uses seed + k.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Calibrations of each kind.
    #[arg(long, default_value_t = 200)]
    seeds: usize,
    /// Nominal device (default: the one that the paper's tables imply).
    #[arg(long)]
    device: Option<PathBuf>,
    /// Folder for tables, figures and report.
    #[arg(long, default_value = "target/experiment")]
    out: PathBuf,
    /// Few seeds: a check that everything works, in seconds.
    #[arg(long)]
    quick: bool,
}

/// Runs the job.
pub(crate) fn reproduce(arguments: &Arguments) -> Result<()> {
    ensure!(
        arguments.seeds >= 20,
        "--seeds must be at least 20: quantiles of fewer say nothing"
    );
    let seeds = if arguments.quick { 20 } else { arguments.seeds };
    let paper = Paper::load()?;
    let nominal = truth::nominal(nominal_device(arguments.device.as_deref())?);
    let progress = Progress::new("improvement", improvement::CASES);
    let cases = improvement::cases(&nominal, &paper, arguments.seed, seeds, &progress)?;
    let mut output = Output::new(Layout {
        stem: "experiment",
        figures: "figures/",
        tables: "tables/",
    });
    output.section("Improvement of the distance");
    let table = improvement::table(&cases, &paper)?;
    output.terminal_table(&table, &[0, 1, 2, 4, 6, 8]);
    output.table("improvement", table)?;
    force_section(&mut output, &nominal, &paper, arguments.seed, seeds)?;
    let command = format!(
        "cargo xtask reproduce-experiment --seed {} --seeds {seeds}{}",
        arguments.seed,
        if arguments.quick { " --quick" } else { "" },
    );
    let lead = format!(
        "The paper's experiment on a virtual device (made by `{command}`, version {}). There is no hardware: the \
         truth is the device that the authors identified (Tables 4 and 5, with the minus sign of k10 that the print \
         lost), with the lengths and drives that docs/assumptions.md infers.",
        env!("CARGO_PKG_VERSION"),
    );
    let title = "Baser & Konukseven's experiment on a virtual device";
    for text in output.write(&arguments.out, title, &lead)? {
        println!("{text}");
    }
    println!("report: {}", arguments.out.join("report.html").display());
    Ok(())
}

/// Gain of the loops that are shown.
const GAIN: f64 = 1.0;
/// Deviation of alpha7 that no distance shows \[rad\]: Table 3 assigns it.
const ALPHA7_RAD: f64 = 1.7e-3;

fn force_section(
    output: &mut Output,
    nominal: &Device,
    paper: &Paper,
    seed: u64,
    seeds: usize,
) -> Result<()> {
    let mut scenario = Scenario::paper(nominal.clone(), paper, false)?;
    scenario.truth = truth::true_device(&scenario.nominal, paper)?;
    let mut twisted = scenario.clone();
    let alpha7 = nominal.parameter("alpha7")?;
    alpha7.set(&mut twisted.truth, alpha7.value(nominal) + ALPHA7_RAD);
    let mut kinds = Vec::new();
    let progress = Progress::new("forces", 3 * seeds);
    for (name, scenario, gain) in [
        ("no loop (G = 0)", &scenario, 0.0),
        ("G = 1", &scenario, GAIN),
        ("G = 1, alpha7 off by 1.7 mrad", &twisted, GAIN),
    ] {
        kinds.push(force::Kind {
            name: name.to_owned(),
            samples: force::samples(scenario, seed, seeds, gain, &progress),
        });
    }
    output.section("Force control: the virtual wall");
    let table = force::table(&kinds)?;
    output.terminal_table(&table, &[0, 1, 2, 4, 5, 6, 7]);
    output.table("forces", table)
}
