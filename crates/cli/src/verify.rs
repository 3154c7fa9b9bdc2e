//! `haptical verify`: recomputes results from their inputs and compares every number.

mod compare;
pub(crate) mod recorded;
mod said;
pub(crate) mod sought;

use std::path::{Path, PathBuf};

use clap::Args;
use haptical::files::{INDEX, NewFile, index, is_index};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::result::Inputs;
use crate::terminal;
use crate::{STATUS_BAD_INPUT, STATUS_SUCCESS};

use self::compare::{Agreement, FileVerdict, Written, compare};
use self::recorded::{Candidate, MOST_FURTHER_BYTES, Recorded, read_bytes};
use self::said::{CheckedResult, Finding, Verification};

/// Exit status where a result is not what its inputs give.
const STATUS_DIFFERS: u8 = 1;

/// Example, meaning and exit status, for `--help`.
pub(crate) const HELP: &str = "\
Example:
  haptical verify result

Reads the provenance in every identified.json, gap.json and plan.json in the folder and in the folders in
it, finds the inputs, checks their SHA-256, computes the result again in memory, and compares every file
of it: the same bytes, or the same numbers (another machine: within 1e-9 of each, 1e-6 in a diagnosis),
or what differs, with both values. Inputs are looked for by their recorded names from the current folder, the result's folder
and the one above it; a gap.json or a model also in the folders beside the result's. The index, report.html, is compared with the results. Nothing is written.

Exit status: 0 every result is what its inputs give; 1 one is not; 2 that cannot be decided for one: bad
arguments, no provenance, an input that is missing or not the recorded one; 3 nothing can be identified.";

/// Flags of `haptical verify`.
#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Folder with results of `identify`, `diagnose` or `plan`, or an identified.json, gap.json or plan.json
    result: PathBuf,
    /// Where the device file is now
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// Where the rig file is now
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Where the log is now; of several, each in turn
    #[arg(long, value_name = "FILE")]
    log: Vec<PathBuf>,
    /// Where the diagnosis that a plan settles is now
    #[arg(long, value_name = "FILE")]
    settle: Option<PathBuf>,
    /// Where the model identified earlier is now
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Where the second log is now
    #[arg(long, value_name = "FILE")]
    validate: Option<PathBuf>,
    /// Where the gap.json is now whose causes were fitted
    #[arg(long, value_name = "FILE")]
    with: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<u8, Failure> {
    let results = recorded::read(&arguments.result)?;
    refuse_needless(arguments, &results)?;
    let progress = Progress::start("computing again");
    let is_only = results.len() == 1;
    let (mut findings, mut held) = (Vec::new(), Vec::new());
    for (path, result) in results {
        progress.say(format!("computing {} again", path.display()));
        let checked = match &result {
            Ok(result) => check(result, arguments, &progress),
            Err(failure) => Err(failure.clone()),
        };
        findings.push(match checked {
            Err(failure) if is_only => return Err(failure),
            Err(failure) => Finding::refused(&path, &failure),
            Ok(checked) => Finding::Checked(checked),
        });
        let holds = findings.last().is_some_and(Finding::holds);
        held.extend(result.ok().map(|result| (result, holds)));
    }
    let verification = Verification::new(findings, indexes(&held)?);
    drop(progress);
    terminal::tell(arguments.json, &verification, verification.text())?;
    Ok(match verification.verdict {
        Agreement::Differs => STATUS_DIFFERS,
        Agreement::Undecided => STATUS_BAD_INPUT,
        _ => STATUS_SUCCESS,
    })
}

impl VerifyArguments {
    /// The place of the input of a flag, the one of this number among its own, where the user says it.
    fn given(&self, flag: &str, number: usize) -> Option<&Path> {
        if flag == "log" {
            return self.log.get(number).map(PathBuf::as_path);
        }
        let path = match flag {
            "device" => &self.device,
            "rig" => &self.rig,
            "settle" => &self.settle,
            "model" => &self.model,
            "with" => &self.with,
            _ => &self.validate,
        };
        path.as_deref()
    }
}

/// A flag for an input that no result had is a mistake.
fn refuse_needless(arguments: &VerifyArguments, results: &[Candidate]) -> Result<(), Failure> {
    let all = results.iter();
    let read = || all.clone().filter_map(|(_, result)| result.as_ref().ok());
    if read().next().is_none() {
        return Ok(());
    }
    let is_input = |flag: &str| {
        let mut inputs = read().flat_map(|result| &result.provenance.inputs);
        inputs.any(|input| input.flag == flag)
    };
    let is_needless = |flag: &&&str| arguments.given(flag, 0).is_some() && !is_input(flag);
    let mut flags = ["rig", "model", "validate", "settle", "with"].iter();
    let Some(flag) = flags.find(is_needless) else {
        return Ok(());
    };
    let gap = if *flag == "with" {
        "the gap.json of "
    } else {
        ""
    };
    let said = format!("the result was made without {gap}--{flag}; leave --{flag} out");
    Err(Failure::arguments(said))
}

/// Makes a result again, under the names and the version that it recorded, and compares its files.
fn check(
    result: &Recorded,
    arguments: &VerifyArguments,
    progress: &Progress,
) -> Result<CheckedResult, Failure> {
    let (mut sources, mut inputs) = (Vec::new(), Vec::new());
    for (flag, name) in result.command.inputs() {
        let number = sources.iter().filter(|(own, _)| *own == flag).count();
        let given = arguments.given(flag, number);
        let (source, input) = sought::find(result, (flag, number), name, given)?;
        sources.push((flag, source));
        inputs.push(input);
    }
    let version = &result.provenance.haptical_version;
    let made = result.command.make(version, &Inputs(sources), progress)?;
    let files = made.files.iter();
    let files = files.map(|file| verdict(result, file));
    Ok(CheckedResult {
        result: result.path.display().to_string(),
        command: result.command.kind().command,
        recorded_version: version.clone(),
        inputs,
        files: files.collect::<Result<_, _>>()?,
    })
}

/// Compares one file of a result.
fn verdict(
    result: &Recorded,
    (name, recomputed): &NewFile<'static>,
) -> Result<FileVerdict, Failure> {
    if *name == result.command.kind().result {
        return Ok(compare(name, Some(result.written()), recomputed));
    }
    let written = result.other_file(name, recomputed.len())?;
    // another version may have written fewer files
    let may_be_gone = result.is_alone || !result.names(name);
    Ok(if written.is_none() && may_be_gone {
        FileVerdict::new(name, Agreement::NotKept)
    } else {
        compare(name, written, recomputed)
    })
}

/// Compares the index of each folder with its results, where all of them are what they should be.
fn indexes(results: &[(Recorded, bool)]) -> Result<Vec<FileVerdict>, Failure> {
    let mut verdicts = Vec::new();
    let folders = results.chunk_by(|(a, _), (b, _)| a.folder() == b.folder());
    for results in folders {
        let [(first, _), ..] = results else { continue };
        let path = first.folder().join(INDEX);
        // in versions before the index it was the page of a result
        let is_page = results.iter().any(|(result, _)| result.names(INDEX));
        let is_asked = results
            .iter()
            .all(|(result, holds)| *holds && !result.is_alone);
        let Some(expected) = index(first.folder())? else {
            continue;
        };
        if is_asked && !is_page && path.is_file() {
            let most = expected.len() as u64 + MOST_FURTHER_BYTES;
            let bytes = read_bytes(&path, most, "check its permissions")?;
            let is_changed = !is_index(&path);
            let written = Written { bytes, is_changed };
            let name = path.display().to_string();
            verdicts.push(compare(&name, Some(written), expected.as_bytes()));
        }
    }
    Ok(verdicts)
}
