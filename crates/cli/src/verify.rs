//! `haptical verify`: recomputes a result from its inputs and compares every number.

mod compare;
mod recorded;
mod said;
mod sought;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use haptical::files::{NewFile, Source};
use haptical::{Device, Diagnose, Equipment, Log, diagnose_as, identify_as, plan_as};

use crate::failure::Failure;
use crate::terminal::{self, Progress};

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
    let progress = Progress::start("computing again");
    let mut checked = Vec::new();
    for result in &results {
        let (inputs, files) = recompute(result, arguments)?;
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
) -> Result<(Vec<Found>, Vec<NewFile<'static>>), Failure> {
    let mut inputs = Inputs {
        search: Search { result },
        found: Vec::new(),
    };
    let version = &result.version;
    let files = match &result.command {
        RecordedCommand::Identify(options) => {
            let device = inputs.find("device", &options.device, &arguments.device)?;
            let log = inputs.find("log", &options.log, &arguments.log)?;
            let rig = inputs.option("rig", &options.device_options.rig, &arguments.rig)?;
            let equipment = Equipment {
                rig,
                ..options.equipment()
            };
            let device = Device::open(&device, &equipment)?;
            let log = Log::open(&log, &device)?;
            identify_as(version, &device, &log, &options.request())?.files()?
        }
        RecordedCommand::Diagnose(options) => {
            let device = inputs.find("device", &options.device, &arguments.device)?;
            let log = inputs.find("log", &options.log, &arguments.log)?;
            let rig = inputs.option("rig", &options.device_options.rig, &arguments.rig)?;
            let model = inputs.option("model", &options.model, &arguments.model)?;
            let second = inputs.option("validate", &options.validate, &arguments.validate)?;
            let equipment = Equipment {
                rig,
                ..options.device_options.equipment()
            };
            let device = Device::open(&device, &equipment)?;
            let log = Log::open(&log, &device)?;
            let plain = Equipment::default();
            let model = model
                .map(|source| Device::open(&source, &plain))
                .transpose()?;
            let second = second
                .map(|source| Log::open(&source, &device))
                .transpose()?;
            let request = Diagnose {
                without: options.without.clone(),
                model: model.as_ref(),
                validate: second.as_ref(),
                ..Diagnose::default()
            };
            diagnose_as(version, &device, &log, &request)?.files()?
        }
        RecordedCommand::Plan(options) => {
            let device = inputs.find("device", &options.device, &arguments.device)?;
            let rig = inputs.option("rig", &options.device_options.rig, &arguments.rig)?;
            let log = inputs.option("log", &options.log, &arguments.log)?;
            let equipment = Equipment {
                rig,
                ..options.device_options.equipment()
            };
            let device = Device::open(&device, &equipment)?;
            let log = log.map(|source| Log::open(&source, &device)).transpose()?;
            let request = options.request(&device)?;
            plan_as(version, &device, &request, log.as_ref(), &|_| ())?.files()?
        }
    };
    Ok((inputs.found, files))
}

/// The inputs that were found, in the order in which they were asked for.
struct Inputs<'a> {
    search: Search<'a>,
    found: Vec<Found>,
}

impl Inputs<'_> {
    fn find(
        &mut self,
        flag: &str,
        recorded: &Path,
        given: &Option<PathBuf>,
    ) -> Result<Source, Failure> {
        let found = self.search.find(flag, recorded, given.as_deref())?;
        let source = found.source.clone();
        self.found.push(found);
        Ok(source)
    }

    fn option(
        &mut self,
        flag: &str,
        recorded: &Option<PathBuf>,
        given: &Option<PathBuf>,
    ) -> Result<Option<Source>, Failure> {
        let recorded = recorded.as_deref();
        recorded
            .map(|path| self.find(flag, path, given))
            .transpose()
    }
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
