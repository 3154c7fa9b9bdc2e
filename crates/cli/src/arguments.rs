//! The command line: subcommands, flags, their help, and refusals of a wrong one.

#[cfg(test)]
mod fuzz_tests;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use haptical_calibration::Degree;
use haptical_diagnosis::effect_names;
use haptical_effects::structure::JOINT_COMPLIANCE;

use crate::export::ExportArguments;
use crate::failure::{self, Failure};
use crate::flags::{DeviceOptions, HoldOptions, OverwriteOptions};
use crate::result::ResultCommand;
use crate::{STATUS_BAD_INPUT, STATUS_SUCCESS, terminal};

/// Calibrates a cable-driven haptic device from its own logs.
#[derive(Debug, Parser)]
#[command(
    name = "haptical",
    version,
    about,
    after_help = "\
Example:
  haptical init demo --example gap
  haptical identify --device demo/device.toml --log demo/log.csv --out demo/result
  haptical diagnose --device demo/device.toml --log demo/log.csv --validate demo/second.csv --out demo/gap

Alone, `haptical` says what can be done with the files of this folder.

Exit status: 0 done; 1 a result is not what its inputs give (`verify` alone); 2 bad arguments or input;
3 nothing can be identified from these numbers; 4 the calibration is no longer true
(`watch`), or something was found (`doctor`);
130 interrupted by Ctrl-C.",
    args_conflicts_with_subcommands = true
)]
pub(crate) struct Arguments {
    /// Without a command: print what this folder has and what can be done with it as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Identify the parameters of a device from a log
    #[command(after_help = "\
Example:
  haptical identify --device device.toml --log log.csv.gz --out result
  haptical identify --device arm.urdf --log motion.csv --validate other.csv --with dynamics --out result

Writes result/identified.toml (a device file again), result/identified.json,
result/identify.html (tables and figures) and result/report.html, an index of the
results in the folder: all or none of them. A fit that is worse than the device file on
rows that it did not see is written to result/rejected.toml, and identified.toml holds
the device with new joint offsets, or as it was, whichever is better.

With `--with dynamics` the log has times, positions and torques of a moving arm, and identified.toml
other masses, centres, inertias, armatures, friction, torque offsets and delay: the feasible set that is
nearest to the device's own and has the sums that the motion fixes. `haptical export` writes them into
URDF and MJCF.

Files of an earlier `haptical identify` are overwritten, and one that is not written again is
removed; a file of these names that none wrote, or that was changed since, is refused before
any work unless --force is given.")]
    Identify(IdentifyArguments),
    /// Identify, then say which effect causes what is left between model and measurement
    #[command(after_help = diagnose_help())]
    Diagnose(DiagnoseArguments),
    /// Say what is wrong with a recording of many episodes: which joint, what, since when
    #[command(after_help = crate::doctor::HELP)]
    Doctor(crate::doctor::DoctorArguments),
    /// Simulate a log of a device that a hand moves, with effects that its model leaves out
    #[command(after_help = crate::simulate::help())]
    Simulate(crate::simulate::SimulateArguments),
    /// Check a device file and a log, and say what the log could identify
    #[command(after_help = "\
Example:
  haptical check device.toml log.csv.gz")]
    Check(CheckArguments),
    /// Write an example to begin with: a device, a log of it, and the next command
    #[command(after_help = "\
Example:
  haptical init demo                      a template device file and a log of it
  haptical init demo --example gap        two recordings with a gap to find")]
    Init(crate::init::InitArguments),
    /// Write a calibrated device as numbers for a control loop (Rust, C, JSON, ROS 2) or for a simulator (URDF, MJCF)
    #[command(after_help = "\
Examples:
  haptical export --device result/identified.toml --format c-header --out model.h
  haptical export --device result/identified.toml --format mjcf --out model.xml
  haptical export --device result/identified.toml --format urdf --urdf robot.urdf --for moveit --out calibrated.urdf
  haptical export --device result/identified.toml --format ros2-control --out robot.ros2_control.xacro
  haptical export --device result/identified.toml --format mjcf --mjcf robot.xml --tip tool --out calibrated.xml")]
    Export(ExportArguments),
    /// Write the commands that make a corrected arm go where a path wants it
    #[command(after_help = crate::correct::HELP)]
    Correct(crate::correct::CorrectArguments),
    /// Write recordings of other makers as a log
    #[command(after_help = crate::import::HELP)]
    Import(crate::import::ImportArguments),
    /// Say which rig tells which parameters, and choose the poses to measure next
    #[command(after_help = crate::plan::help())]
    Plan(crate::plan::PlanArguments),
    /// Write a page that plays a log: the arm, its errors, a slider
    #[command(after_help = "\
Example:
  haptical play --device device.toml --model identified.toml --log log.csv.gz --out page.html

Writes one HTML file without outside references.")]
    Play(crate::play::PlayArguments),
    /// Work out the uncertainty of the handle's position, with the certificates of the instruments
    #[command(after_help = crate::report::HELP)]
    Report(crate::report::ReportArguments),
    /// Recompute a result from its inputs, and compare every number
    #[command(after_help = crate::verify::HELP)]
    Verify(crate::verify::VerifyArguments),
    /// Judge a log as it grows: is the calibration still true, since when not, which effect
    #[command(after_help = crate::watch::HELP)]
    Watch(crate::watch::WatchArguments),
    /// Print a completion script for a shell
    #[command(after_help = "\
Example:
  haptical completions bash > ~/.local/share/bash-completion/completions/haptical")]
    Completions {
        /// Shell that the script is for
        shell: clap_complete::Shell,
    },
}

impl Command {
    /// The command as one that makes a result, where it is one.
    pub(crate) fn into_result(self) -> Option<Box<dyn ResultCommand>> {
        match self {
            Self::Identify(arguments) => Some(Box::new(arguments)),
            Self::Diagnose(arguments) => Some(Box::new(arguments)),
            Self::Plan(arguments) => Some(Box::new(arguments)),
            _ => None,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct IdentifyArguments {
    /// Device file (TOML, URDF or MJCF)
    #[arg(long, value_name = "FILE")]
    pub(crate) device: PathBuf,
    #[command(flatten)]
    pub(crate) device_options: DeviceOptions,
    /// Log (CSV, Parquet, MCAP, .db3 or JSON lines)
    #[arg(long, value_name = "FILE")]
    pub(crate) log: PathBuf,
    /// Folder for the result files; made if it is missing
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteOptions,
    /// Print identified.json instead of the summary
    #[arg(long)]
    pub(crate) json: bool,
    /// Order of the identification
    #[arg(long, value_enum, default_value_t = MethodName::Joint)]
    pub(crate) method: MethodName,
    /// Share of the rows that the fit does not see, 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value = "0.2", value_parser = share, allow_negative_numbers = true)]
    pub(crate) held_out: f64,
    /// Check by folds instead: fold k holds out the rows k, k + N, ..., each fitted without its own rows
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=100), conflicts_with = "held_out")]
    pub(crate) folds: Option<u64>,
    /// Fit this effect too, together with geometry and drives: a law of `haptical diagnose --list`, at one joint or at every
    /// joint that can have it; or the causes of a gap.json. Repeatable. The word `dynamics` alone: inertias, friction,
    /// armatures, offsets and one delay from torques, in the place of geometry and drives
    #[arg(long, value_name = "EFFECT[@JOINT]|GAP.JSON|dynamics", value_hint = ValueHint::AnyPath)]
    pub(crate) with: Vec<String>,
    /// With `--with dynamics`: a log that is predicted and not fitted
    #[arg(long, value_name = "FILE")]
    pub(crate) validate: Option<PathBuf>,
    /// With `--with dynamics`: edge of the low pass of torques and model, in the place of the one that the log's noise asks for
    #[arg(long, value_name = "HERTZ", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) band_hz: Option<f64>,
    #[command(flatten)]
    pub(crate) hold: HoldOptions,
    /// Degree of the polynomial of a parallelogram: a number, or `evidence` for the degree up to
    /// 14 that the Bayes criterion favours
    #[arg(long, value_name = "N|evidence", default_value = "evidence", value_parser = degree, allow_negative_numbers = true)]
    pub(crate) degree: Degree,
    /// Sizes of the noise: the device file's, or estimated from the residuals
    #[arg(long, value_enum, default_value_t = NoiseName::Estimated)]
    pub(crate) noise: NoiseName,
    /// What large residuals cost; a robust loss names the readings that it distrusts
    #[arg(long, value_enum, default_value_t = LossName::Auto)]
    pub(crate) loss: LossName,
    /// Denominator of the input drum's term of equation (1) for all joints with drums, in place of
    /// the device file's
    #[arg(long, value_name = "METRES", value_parser = positive, allow_negative_numbers = true, conflicts_with = "paper_preset")]
    pub(crate) input_drum_denominator_m: Option<f64>,
    /// Input drum denominators that the paper's tables imply: 2.9 mm, joint 4: 2.6 mm
    #[arg(long)]
    pub(crate) paper_preset: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DiagnoseArguments {
    /// Device file (TOML, URDF or MJCF)
    #[arg(
        long,
        value_name = "FILE",
        required = false,
        required_unless_present = "list",
        default_value_if("list", "true", "-")
    )]
    pub(crate) device: PathBuf,
    #[command(flatten)]
    pub(crate) device_options: DeviceOptions,
    /// Log (CSV, Parquet, MCAP, .db3 or JSON lines); give it again for further recordings of the device with the same columns: they are
    /// judged together
    #[arg(
        long,
        value_name = "FILE",
        required = false,
        required_unless_present = "list",
        default_value_if("list", "true", "-")
    )]
    pub(crate) log: Vec<PathBuf>,
    /// Folder for the result files; made if it is missing
    #[arg(
        long,
        value_name = "DIR",
        required = false,
        required_unless_present = "list",
        default_value_if("list", "true", "-")
    )]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteOptions,
    /// Diagnose against a model identified earlier: what the device deviates from it is part of
    /// the gap
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Second log of the same device, on which the shrink is measured; without it contiguous blocks
    /// of the log are held out
    #[arg(long, value_name = "FILE")]
    pub(crate) validate: Option<PathBuf>,
    /// Effects to leave out of the catalogue, separated by commas
    #[arg(
        long,
        value_name = "EFFECT",
        value_delimiter = ',',
        value_parser = PossibleValuesParser::new(effect_names()),
        hide_possible_values = true
    )]
    pub(crate) without: Vec<String>,
    /// Let the base model have this too: what joints yield to their torque
    #[arg(long, value_name = "EFFECT", value_parser = [JOINT_COMPLIANCE.name])]
    pub(crate) with: Vec<String>,
    #[command(flatten)]
    pub(crate) hold: HoldOptions,
    /// What large residuals cost in the fit of the base model
    #[arg(long, value_enum, default_value_t = LossName::Auto)]
    pub(crate) loss: LossName,
    /// Write the log without what is its own fault, as repaired.csv (or .csv.gz) with the list repaired.json: lost counts added
    /// back, late channels brought to their times, drifts of sensors taken out, wild readings emptied; then diagnose it again.
    /// Only for causes of the log that the verdict names
    #[arg(long)]
    pub(crate) repair: bool,
    /// Print the effects that can be named, with their numbers; needs no device and no log
    #[arg(long)]
    pub(crate) list: bool,
    /// Print gap.json instead of the summary, or the list as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// Device file (TOML, URDF or MJCF)
    pub(crate) device: PathBuf,
    #[command(flatten)]
    pub(crate) device_options: DeviceOptions,
    #[command(flatten)]
    pub(crate) hold: HoldOptions,
    /// Log (CSV, Parquet, MCAP, .db3 or JSON lines)
    pub(crate) log: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    pub(crate) json: bool,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LossName {
    /// Least squares, unless single readings lie farther out than noise explains: then Tukey's
    Auto,
    /// Least squares
    Squares,
    /// Linear beyond 1.3 standard deviations
    Huber,
    /// Logarithmic
    Cauchy,
    /// Readings beyond 4.7 standard deviations do not count
    Tukey,
    /// Student's t with 4 degrees of freedom
    StudentT,
}

/// Highest polynomial degree: beyond it the powers of the angle lose all digits.
const HIGHEST_DEGREE: usize = 24;

/// A number that satisfies a condition; `wanted` says which.
pub(crate) fn number(text: &str, is_allowed: fn(f64) -> bool, wanted: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| is_allowed(*number));
    number.ok_or_else(|| format!("{wanted} is expected"))
}

fn share(text: &str) -> Result<f64, String> {
    let is_share = |share| (0.0..=0.5).contains(&share);
    number(text, is_share, "a share from 0 to 0.5")
}

fn is_positive(number: f64) -> bool {
    number.is_finite() && number > 0.0
}

fn degree(text: &str) -> Result<Degree, String> {
    if text == "evidence" {
        return Ok(Degree::UpTo(14));
    }
    let degree = text.parse().ok();
    let degree = degree.filter(|degree| (1..=HIGHEST_DEGREE).contains(degree));
    let wanted = || format!("a degree from 1 to {HIGHEST_DEGREE}, or `evidence`, is expected");
    degree.map(Degree::Fixed).ok_or_else(wanted)
}

/// A number above 0.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    number(text, is_positive, "a number above 0")
}

/// A number that a seed can be.
pub(crate) fn whole_number(text: &str) -> Result<u64, String> {
    let refuse = |_| format!("a whole number from 0 to {} is expected", u64::MAX);
    text.parse().map_err(refuse)
}

/// A number that rows can be counted by.
pub(crate) fn one_or_more(text: &str) -> Result<NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "a whole number from 1 is expected".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    number(text, is_positive, "a length in m above 0")
}

/// Prints help and version, or says what is wrong with the command line.
pub(crate) fn explain(error: &clap::Error, wants_json: bool) -> u8 {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            match terminal::write_output(error.render().to_string().as_bytes()) {
                Ok(()) => STATUS_SUCCESS,
                Err(refused) => failure::report(&refused, false),
            }
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand if !wants_json => {
            terminal::write_message(&error.render().to_string());
            STATUS_BAD_INPUT
        }
        _ => failure::report(&failure_of(error), wants_json),
    }
}

/// The refusal of a wrong command line.
pub(crate) fn failure_of(error: &clap::Error) -> Failure {
    if let Some(failure) = unknown_effect(error) {
        return failure;
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
    let first = [first.trim_start_matches("error: ")];
    let mut what = [&first, &*details].concat().join(" ");
    let tips = tips.iter().filter_map(|tip| tip.strip_prefix("tip: "));
    let next = tips.chain(usage.first().copied());
    let mut next: Vec<String> = next.map(str::to_owned).collect();
    // "invalid value 'x' for '--degree <N>': a degree ... is expected", "... [possible values: ...]"
    if error.kind() == ErrorKind::ValueValidation
        && let Some((before, expected)) = what.rsplit_once("': ")
    {
        next.insert(0, expected.to_owned());
        what = format!("{before}'");
    } else if let Some((before, values)) = what.clone().split_once(" [possible values: ") {
        let values = values.trim_end_matches(']');
        next.insert(0, format!("possible values: {values}"));
        what = before.to_owned();
    }
    if what.ends_with("cannot be used with '--json'") {
        next =
            vec!["write --json after the command: `haptical check DEVICE LOG --json`".to_owned()];
    }
    if what.contains("a value is required") {
        next.push("write the value after the flag".to_owned());
    }
    if next.is_empty() {
        next.push("see the command's --help".to_owned());
    }
    Failure::command_line("arguments", what, next.join("; "))
}

/// A name that `--without` does not know.
fn unknown_effect(error: &clap::Error) -> Option<Failure> {
    let argument = error.get(ContextKind::InvalidArg)?.to_string();
    let is_name = error.kind() == ErrorKind::InvalidValue && argument.starts_with("--without");
    let name = error.get(ContextKind::InvalidValue)?.to_string();
    if !is_name {
        return None;
    }
    let nearest = match error.get(ContextKind::SuggestedValue) {
        Some(ContextValue::String(name)) => Some(name),
        Some(ContextValue::Strings(names)) => names.last(),
        _ => None,
    };
    let next = match nearest {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!("the names are: {}", effect_names().join(", ")),
    };
    let what = format!("there is no effect `{name}` in the catalogue");
    Some(Failure::command_line("unknown-effect", what, next))
}

/// Width of a line of the list of names, in characters.
const NAMES_WIDTH: usize = 90;

/// Example, files and the names that `--without` takes.
fn diagnose_help() -> String {
    let mut text = "\
Example:
  haptical diagnose --device device.toml --log log.csv.gz --validate log2.csv.gz --out gap

Writes gap/gap.json, gap/gap.html (a page) and gap/report.html, an index of the results in the folder,
with --validate gap/predictions.csv too: all or none. Files of an earlier `haptical diagnose` are
overwritten, and one that is not written again is removed; others need --force.

--repair also writes gap/repaired.csv (.csv.gz of a log that is gzip) where the verdict names a fault of the
log: columns that had none keep every byte. gap/repaired.json lists what was changed: column, lines, how
much, for which cause. Lost counts are added from their row to the end of the run; a late channel is
interpolated at the times of its rows, and its cells are emptied where nothing was recorded; drifts of cable
and external encoders are taken out; wild readings are emptied. What the device does stays in the log.
Nothing is written where there is nothing to repair, or the verdict is ambiguous or unknown.

Names of effects:
"
    .to_owned();
    let mut line = String::new();
    for name in effect_names() {
        if !line.is_empty() && line.len() + name.len() + 1 > NAMES_WIDTH {
            text.push_str(&format!("  {line}\n"));
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(name);
    }
    text.push_str(&format!("  {line}"));
    text
}
