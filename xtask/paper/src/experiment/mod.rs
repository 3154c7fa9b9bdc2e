//! The paper's experiment on a virtual device: the truth is the device that the authors identified.

mod force;
mod gap_kinds;
mod gap_section;
mod improvement;
mod own_gap;
mod recorded;
mod recorded_figures;
mod truth;

use std::path::PathBuf;

use anyhow::{Result, ensure};
use haptical_model::Device;
use xtask_output::{Layout, Output};

pub use truth::chebyshev;
pub(crate) use truth::power_series;

use crate::published::Paper;
use crate::scenario::nominal_device;

/// Arguments of `reproduce-experiment`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask reproduce-experiment --seeds 50 --out target/mine")]
pub struct Arguments {
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
pub fn reproduce(arguments: &Arguments) -> Result<()> {
    ensure!(
        arguments.seeds >= 20,
        "--seeds must be at least 20: quantiles of fewer say nothing"
    );
    let extent = if arguments.quick {
        Extent::QUICK
    } else {
        Extent {
            seeds: arguments.seeds,
            every_gap: true,
        }
    };
    let paper = Paper::load()?;
    let nominal = nominal_device(arguments.device.as_deref())?;
    let mut output = Output::new(Layout::in_folders("experiment"));
    sections(&mut output, nominal, &paper, arguments.seed, extent)?;
    let command = format!(
        "cargo xtask reproduce-experiment --seed {} --seeds {}{}",
        arguments.seed,
        extent.seeds,
        if arguments.quick { " --quick" } else { "" },
    );
    let lead = format!(
        "The paper's experiment on a virtual device (made by `{command}`, version {}). {LEAD}",
        env!("CARGO_PKG_VERSION"),
    );
    let title = "Baser & Konukseven's experiment on a virtual device";
    output.write(&arguments.out, title, &lead)
}

/// What every report of the experiment says first.
pub(crate) const LEAD: &str = "There is no hardware: the truth is the device that the authors identified (Tables 4 and \
     5, with the minus sign of k10 that the print lost), with the lengths and drives that docs/assumptions.md infers.";

/// How much of the experiment is made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// Calibrations of each kind.
    pub(crate) seeds: usize,
    /// Every effect of the paper's own gap, or a few.
    pub(crate) every_gap: bool,
}

impl Extent {
    /// A check that everything works.
    pub(crate) const QUICK: Self = Self {
        seeds: 20,
        every_gap: false,
    };
    /// In the report of the tables, which has much else to do.
    pub(crate) const IN_TABLES: Self = Self {
        seeds: 40,
        every_gap: true,
    };
}

pub(crate) fn sections(
    output: &mut Output,
    nominal: Device,
    paper: &Paper,
    seed: u64,
    extent: Extent,
) -> Result<()> {
    let nominal = truth::nominal(nominal);
    recorded_section(output, &nominal, paper, seed)?;
    improvement::section(output, &nominal, paper, seed, extent.seeds)?;
    let scenario = truth::recorded(&nominal, paper)?;
    gap_section::gap_section(output, &scenario, paper, seed, extent.every_gap)?;
    force::force_section(output, &nominal, paper, seed, extent.seeds)
}

fn recorded_section(output: &mut Output, nominal: &Device, paper: &Paper, seed: u64) -> Result<()> {
    let scenario = truth::recorded(nominal, paper)?;
    let recorded = recorded::Recorded::new(&scenario, seed)?;
    output.section("The recorded motion");
    let percent = |device: &Device| -> Result<f64> {
        let before = recorded.distance_rms_m(&scenario.nominal)?;
        Ok(100.0 * (1.0 - recorded.distance_rms_m(device)? / before))
    };
    output.words(format!(
        "{} rows of a hand-guided motion at 1 kHz, 200 random samples of it for each step. Over the whole motion the \
         distance improves by {:.2} % (paper: {} %), by {:.1} % with kinematics refitted alone and by {:.1} % with \
         the transmissions alone (paper, \"without transmission errors\": {} %).",
        recorded.recording.len(),
        percent(&recorded.run.kinematics.device)?,
        paper.text.improvement_full_percent,
        percent(&recorded.alone)?,
        percent(&recorded.compensated)?,
        paper.text.improvement_kinematics_only_percent,
    ));
    output.grid(
        "figure9",
        "Figure 9: identified transmissions over measurements",
        &recorded_figures::figure9(&recorded)?,
    )?;
    output.table("table4", recorded_figures::table4(&recorded, paper)?)?;
    let most = recorded_figures::polynomial_difference_rad(&recorded, paper)?;
    output.words(format!(
        "The fourth transmission as a polynomial differs from that of Table 4, its k10 mended, by at most {:.3} mrad \
         over the range of the motion. R_e and r_o cannot be separated on a limited range: only the sum of their \
         effects means something.",
        1e3 * most
    ));
    let table = recorded_figures::table5(&recorded, &scenario, paper)?;
    let no = haptical_report::Cell::from("no");
    let missed = table.rows().iter().filter(|row| row.last() == Some(&no));
    let (missed, all) = (missed.count(), table.rows().len());
    output.table("table5", table)?;
    output.words(format!(
        "{} of {all} intervals hold the truth. Those of the paper's second step take the angles of the first as exact \
         and are too short for the parameters that its noise reaches; a joint fit (`haptical identify`) carries it over.",
        all - missed
    ));
    output.grid(
        "figure10",
        "Figure 10: distance and its errors over the motion; at rest at home at both ends",
        &recorded_figures::figure10(&recorded, &scenario)?,
    )
}
