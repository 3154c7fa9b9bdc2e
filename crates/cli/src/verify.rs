//! `haptical verify`: recomputes a result from its inputs and compares every number.

mod compare;
mod leaves;
mod recorded;
mod said;
mod sought;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::device_source::{DeviceOptions, Equipment};
use crate::failure::Failure;
use crate::output_files::NewFile;
use crate::terminal::{self, Progress};
use crate::{diagnose, identify, plan};

use self::compare::{FileVerdict, Written, compare};
use self::recorded::{Recorded, RecordedCommand};
use self::said::{CheckedResult, Verification};
use self::sought::{Found, Search};

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

Exit status: 0 the result is what its inputs give; 1 it is not; 2 that cannot be told: bad arguments,
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
    let progress = Progress::start("reading");
    let mut checked = Vec::new();
    for result in &results {
        let (inputs, files) = recompute(result, arguments, &progress)?;
        let files = files
            .iter()
            .map(|file| verdict(result, &results, file))
            .collect::<Result<Vec<FileVerdict>, Failure>>()?;
        checked.push(CheckedResult::new(result, &inputs, files));
    }
    drop(progress);
    let verification = Verification::new(checked);
    let text = if arguments.json {
        verification.json()?
    } else {
        verification.text()
    };
    terminal::write_output(text.as_bytes())?;
    Ok(if verification.holds() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(STATUS_DIFFERS)
    })
}

/// A flag for an input that no result had is a mistake.
fn refuse_needless(arguments: &VerifyArguments, results: &[Recorded]) -> Result<(), Failure> {
    let given = [
        ("rig", &arguments.rig),
        ("model", &arguments.model),
        ("validate", &arguments.validate),
    ];
    for (flag, path) in given {
        let is_input = |result: &Recorded| result.inputs.iter().any(|input| input.flag == flag);
        if path.is_some() && !results.iter().any(is_input) {
            return Err(Failure::command_line(
                "arguments",
                format!("the result was made without --{flag}"),
                format!("leave --{flag} out"),
            ));
        }
    }
    Ok(())
}

/// Finds the inputs and makes the files of the result again, under the names and the version that it
/// recorded.
fn recompute(
    result: &Recorded,
    arguments: &VerifyArguments,
    progress: &Progress,
) -> Result<(Vec<Found>, Vec<NewFile<'static>>), Failure> {
    let search = Search { result };
    let find = |flag: &str, recorded: &Path, given: &Option<PathBuf>| {
        search.find(flag, recorded, given.as_deref())
    };
    match &result.command {
        RecordedCommand::Identify(options) => {
            let device = find("device", &options.device, &arguments.device)?;
            let log = find("log", &options.log, &arguments.log)?;
            let (equipment, rig) = equipped(&options.device_options, &arguments.rig, &search)?;
            let sources = [device.source.clone(), log.source.clone()];
            let version = &result.version;
            let outcome = identify::outcome(options, &sources, &equipment, version, progress)?;
            let found = [Some(device), Some(log), rig];
            Ok((found.into_iter().flatten().collect(), outcome.files))
        }
        RecordedCommand::Diagnose(options) => {
            let device = find("device", &options.device, &arguments.device)?;
            let log = find("log", &options.log, &arguments.log)?;
            let further = |flag: &str, recorded: &Option<PathBuf>, given| {
                let found = recorded.as_deref().map(|path| find(flag, path, given));
                found.transpose()
            };
            let model = further("model", &options.model, &arguments.model)?;
            let validate = further("validate", &options.validate, &arguments.validate)?;
            let (equipment, rig) = equipped(&options.device_options, &arguments.rig, &search)?;
            let source = |found: &Option<Found>| found.as_ref().map(|found| found.source.clone());
            let sources = diagnose::Sources {
                device: device.source.clone(),
                equipment,
                log: log.source.clone(),
                model: source(&model),
                validate: source(&validate),
            };
            let outcome = diagnose::outcome(&options.without, &sources, &result.version, progress)?;
            let found = [Some(device), Some(log), rig, model, validate];
            Ok((found.into_iter().flatten().collect(), outcome.files))
        }
        RecordedCommand::Plan(options) => {
            let device = find("device", &options.device, &arguments.device)?;
            let log = options.log.as_deref();
            let log = log
                .map(|path| find("log", path, &arguments.log))
                .transpose()?;
            let (equipment, rig) = equipped(&options.device_options, &arguments.rig, &search)?;
            let sources = plan::Sources {
                device: device.source.clone(),
                equipment,
                log: log.as_ref().map(|found| found.source.clone()),
            };
            let outcome = plan::outcome(options, &sources, &result.version, progress)?;
            let found = [Some(device), rig, log];
            Ok((found.into_iter().flatten().collect(), outcome.files))
        }
    }
}

/// The device's equipment as recorded, and where its rig file was found.
fn equipped(
    options: &DeviceOptions,
    given: &Option<PathBuf>,
    search: &Search<'_>,
) -> Result<(Equipment, Option<Found>), Failure> {
    let rig = options.rig.as_deref();
    let find = |path| search.find("rig", path, given.as_deref());
    let rig = rig.map(find).transpose()?;
    let equipment = Equipment {
        chain: options.chain.clone(),
        rig: rig.as_ref().map(|found| found.source.clone()),
    };
    Ok((equipment, rig))
}

/// What is said of one file of a result.
fn verdict(
    result: &Recorded,
    results: &[Recorded],
    (name, recomputed): &NewFile<'static>,
) -> Result<FileVerdict, Failure> {
    if *name == result.command.result_file() {
        let written = Written {
            bytes: result.text.as_bytes().to_vec(),
            is_changed: !result.is_seal_whole(),
        };
        return Ok(compare(name, Some(written), recomputed));
    }
    let path = result.folder.join(name);
    let Some(bytes) = recorded::read_beside(&path, recomputed.len())? else {
        return Ok(if result.stands_alone {
            FileVerdict::not_kept(name)
        } else {
            compare(name, None, recomputed)
        });
    };
    // The report of the other command has the same name.
    let belongs = |other: &Recorded| other.lists(name, &bytes);
    let is_changed = !belongs(result);
    if is_changed && results.iter().any(belongs) {
        return Ok(FileVerdict::not_kept(name));
    }
    Ok(compare(
        name,
        Some(Written { bytes, is_changed }),
        recomputed,
    ))
}
