//! `haptical verify`: recomputes a result from its inputs and compares every number.

mod compare;
mod recorded;
mod said;
mod sought;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use haptical::files::NewFile;

use crate::failure::Failure;
use crate::result::Inputs;
use crate::terminal::{self, Progress};

use self::compare::{Agreement, FileVerdict, Written, compare};
use self::recorded::Recorded;
use self::said::{CheckedResult, Verification};

/// Exit status where a result is not what its inputs give.
const STATUS_DIFFERS: u8 = 1;

/// Example, meaning and exit status, for `--help`.
pub(crate) const HELP: &str = "\
Example:
  haptical verify result

Reads the provenance in result/identified.json, gap.json or plan.json, finds the inputs, checks their
SHA-256, computes the result again in memory, and compares every file of it: the same bytes, or the
same numbers within 1e-9 of each (another machine), or what differs, with both values. Inputs are
looked for by their recorded names from the current folder, the result's folder and the one above it.
Nothing is written.

Exit status: 0 the result is what its inputs give; 1 it is not; 2 that cannot be decided: bad arguments,
no provenance, an input that is missing or not the recorded one; 3 nothing can be identified.";

/// Flags of `haptical verify`.
#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Folder that `identify`, `diagnose` or `plan` wrote, or identified.json, gap.json or plan.json in it
    result: PathBuf,
    /// Where the device file is now
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// Where the rig file is now
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Where the log is now
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Where the model identified earlier is now
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Where the second log is now
    #[arg(long, value_name = "FILE")]
    validate: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<ExitCode, Failure> {
    let results = recorded::read(&arguments.result)?;
    refuse_needless(arguments, &results)?;
    let progress = Progress::start("computing again");
    let mut checked = Vec::new();
    for result in &results {
        checked.push(check(result, &results, arguments, &progress)?);
    }
    drop(progress);
    let verification = Verification::new(checked);
    if arguments.json {
        terminal::write_json(&verification)?;
    } else {
        terminal::write_output(verification.text().as_bytes())?;
    }
    Ok(if verification.holds() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(STATUS_DIFFERS)
    })
}

impl VerifyArguments {
    /// The place of the input of a flag, where the user says it.
    fn given(&self, flag: &str) -> Option<&Path> {
        let path = match flag {
            "device" => &self.device,
            "rig" => &self.rig,
            "log" => &self.log,
            "model" => &self.model,
            _ => &self.validate,
        };
        path.as_deref()
    }
}

/// A flag for an input that no result had is a mistake.
fn refuse_needless(arguments: &VerifyArguments, results: &[Recorded]) -> Result<(), Failure> {
    let is_input = |flag: &str| {
        let mut inputs = results.iter().flat_map(|result| &result.provenance.inputs);
        inputs.any(|input| input.flag == flag)
    };
    let is_needless = |flag: &&&str| arguments.given(flag).is_some() && !is_input(flag);
    match ["rig", "model", "validate"].iter().find(is_needless) {
        None => Ok(()),
        Some(flag) => Err(Failure::command_line(
            "arguments",
            format!("the result was made without --{flag}"),
            format!("leave --{flag} out"),
        )),
    }
}

/// Makes a result again, under the names and the version that it recorded, and compares its files.
fn check(
    result: &Recorded,
    results: &[Recorded],
    arguments: &VerifyArguments,
    progress: &Progress,
) -> Result<CheckedResult, Failure> {
    let (mut sources, mut inputs) = (Vec::new(), Vec::new());
    for (flag, name) in result.command.inputs() {
        let (source, input) = sought::find(result, flag, name, arguments.given(flag))?;
        sources.push((flag, source));
        inputs.push(input);
    }
    let version = &result.provenance.haptical_version;
    let made = result.command.make(version, &Inputs(sources), progress)?;
    let files = made.files.iter();
    let files = files.map(|file| verdict(result, results, file));
    Ok(CheckedResult {
        result: result.path.display().to_string(),
        command: result.command.name(),
        recorded_version: version.clone(),
        inputs,
        files: files.collect::<Result<_, _>>()?,
    })
}

/// Compares one file of a result.
fn verdict(
    result: &Recorded,
    results: &[Recorded],
    (name, recomputed): &NewFile<'static>,
) -> Result<FileVerdict, Failure> {
    if *name == result.command.result_file() {
        return Ok(compare(name, Some(result.written()), recomputed));
    }
    let written = result.other_file(name, recomputed.len())?;
    let is_not_kept = match &written {
        None => result.is_alone,
        // The report of the other command has the same name.
        Some(Written { bytes, is_changed }) => {
            *is_changed && results.iter().any(|other| other.lists(name, bytes))
        }
    };
    Ok(if is_not_kept {
        FileVerdict::new(name, Agreement::NotKept)
    } else {
        compare(name, written, recomputed)
    })
}
