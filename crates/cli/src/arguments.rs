//! The command line: subcommands, flags, their help, and what is said of a wrong one.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::{ContextKind, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum};
use haptical_calibration::Degree;

use crate::failure::Failure;
use crate::{STATUS_BAD_INPUT, terminal};

/// Calibrates a cable-driven haptic device from its own logs.
#[derive(Debug, Parser)]
#[command(
    name = "haptical",
    version,
    about,
    after_help = "\
Example:
  haptical init demo
  haptical identify --device demo/device.toml --log demo/log.csv --out demo/result

Exit status: 0 done; 2 bad arguments or input; 3 nothing can be identified from these numbers."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Identify the parameters of a device from a log
    #[command(after_help = "\
Example:
  haptical identify --device device.toml --log log.csv.gz --out result

Writes result/identified.toml (a device file again), result/identified.json and
result/report.html: all three or none.")]
    Identify(IdentifyArguments),
    /// Check a device file and a log, and say what the log could identify
    #[command(after_help = "\
Example:
  haptical check device.toml log.csv.gz")]
    Check(CheckArguments),
    /// Write a template device file and a small simulated log of it
    #[command(after_help = "\
Example:
  haptical init demo

Writes demo/device.toml and demo/log.csv.")]
    Init(InitArguments),
    /// Print a completion script for a shell
    #[command(after_help = "\
Example:
  haptical completions bash > ~/.local/share/bash-completion/completions/haptical")]
    Completions {
        /// Shell that the script is for
        shell: clap_complete::Shell,
    },
}

#[derive(Debug, Args)]
pub(crate) struct IdentifyArguments {
    /// Device file (TOML)
    #[arg(long, value_name = "FILE")]
    pub(crate) device: PathBuf,
    /// Log (CSV, plain or gzip)
    #[arg(long, value_name = "FILE")]
    pub(crate) log: PathBuf,
    /// Folder for the three result files; made if it is missing
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Print identified.json instead of the summary
    #[arg(long)]
    pub(crate) json: bool,
    /// Order of the identification
    #[arg(long, value_enum, default_value_t = MethodName::Joint)]
    pub(crate) method: MethodName,
    /// Share of the rows that the fit does not see, 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value = "0.2", value_parser = share)]
    pub(crate) held_out: f64,
    /// Degree of the polynomial of a parallelogram: a number, or `evidence` for the degree up to
    /// 14 that the Bayes criterion favours
    #[arg(long, value_name = "N|evidence", default_value = "evidence", value_parser = degree)]
    pub(crate) degree: Degree,
    /// Sizes of the noise: the device file's, or estimated from the residuals
    #[arg(long, value_enum, default_value_t = NoiseName::Estimated)]
    pub(crate) noise: NoiseName,
    /// Denominator of the input drum's term of equation (1) for all joints with drums, in place of
    /// the device file's
    #[arg(long, value_name = "METRES", value_parser = positive, conflicts_with = "paper_preset")]
    pub(crate) input_drum_denominator_m: Option<f64>,
    /// Input drum denominators that the paper's tables imply: 2.9 mm, joint 4: 2.6 mm
    #[arg(long)]
    pub(crate) paper_preset: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// Device file (TOML)
    pub(crate) device: PathBuf,
    /// Log (CSV, plain or gzip)
    pub(crate) log: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct InitArguments {
    /// Folder for the two files; made if it is missing
    #[arg(default_value = ".")]
    pub(crate) dir: PathBuf,
    /// Overwrite files that exist
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Transmissions from external encoders, then kinematics
    TwoStep,
    /// Everything at once
    Joint,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum NoiseName {
    /// The device file's figures
    Stated,
    /// The residuals' own size, channel by channel
    Estimated,
}

/// Highest polynomial degree: beyond it the powers of the angle lose all digits.
const HIGHEST_DEGREE: usize = 24;

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=0.5).contains(&share) => Ok(share),
        _ => Err("a share from 0 to 0.5 is expected".to_owned()),
    }
}

fn degree(text: &str) -> Result<Degree, String> {
    if text == "evidence" {
        return Ok(Degree::UpTo(14));
    }
    match text.parse::<usize>() {
        Ok(degree) if (1..=HIGHEST_DEGREE).contains(&degree) => Ok(Degree::Fixed(degree)),
        _ => Err(format!(
            "a degree from 1 to {HIGHEST_DEGREE}, or `evidence`, is expected"
        )),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length.is_finite() && length > 0.0 => Ok(length),
        _ => Err("a length in m above 0 is expected".to_owned()),
    }
}

/// Prints help and version, or says what is wrong with the command line.
pub(crate) fn explain(error: &clap::Error, wants_json: bool) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            match terminal::write_output(error.render().to_string().as_bytes()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(failure) => failure.report(false),
            }
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand if !wants_json => {
            terminal::write_message(&error.render().to_string());
            ExitCode::from(STATUS_BAD_INPUT)
        }
        _ => failure_of(error).report(wants_json),
    }
}

fn failure_of(error: &clap::Error) -> Failure {
    let diagnose = error
        .get(ContextKind::InvalidSubcommand)
        .is_some_and(|word| word.to_string() == "diagnose");
    if diagnose {
        return Failure::command_line(
            "not-supported",
            "`diagnose` is not supported yet",
            "`haptical identify` writes the residuals before and after identification; see \
             `haptical --help`",
        );
    }
    let text = error.render().to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or("wrong arguments");
    let rest: Vec<&str> = lines.collect();
    let usage = rest.iter().position(|line| line.starts_with("Usage:"));
    let (details, usage) = rest.split_at(usage.unwrap_or(rest.len()));
    let (tips, details): (Vec<&str>, Vec<&str>) = details
        .iter()
        .partition(|line| line.starts_with("tip:") || line.starts_with("For more information"));
    let mut what = first.trim_start_matches("error: ").to_owned();
    for detail in details {
        what.push(' ');
        what.push_str(detail);
    }
    let mut next: Vec<&str> = tips;
    next.extend(usage.first());
    if next.is_empty() {
        next.push("see `haptical --help`");
    }
    Failure::command_line("arguments", what, next.join("; "))
}
