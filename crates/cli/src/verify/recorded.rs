//! Reads a result and what it says of how it came about.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Parser;
use haptical::files::{Fingerprint, InputFile, OutputFile, is_seal_whole, reason};
use haptical::{Diagnosed, Found, Planned};
use serde::Deserialize;
use serde_json::Value;

use crate::arguments::{Arguments, Command, DiagnoseArguments, IdentifyArguments, failure_of};
use crate::failure::Failure;
use crate::plan::PlanArguments;

/// Largest result that is read; a result takes some hundred kilobytes.
const LARGEST_RESULT_BYTES: u64 = 64 << 20;
/// A file beside it may be this much longer than what is computed before it counts as another file.
const MOST_FURTHER_BYTES: u64 = 1 << 20;
/// What to do where the result says too little.
const AGAIN: &str = "run `haptical identify`, `diagnose` or `plan` again";

/// A result as it was found.
pub(super) struct Recorded {
    /// The file with the provenance.
    pub(super) path: PathBuf,
    pub(super) folder: PathBuf,
    /// Given as a file: files beside it need not be there.
    pub(super) stands_alone: bool,
    pub(super) text: String,
    /// Version that wrote it.
    pub(super) version: String,
    pub(super) command: RecordedCommand,
    pub(super) inputs: Vec<InputFile>,
    outputs: Vec<OutputFile>,
    result_sha256: String,
}

/// The command that wrote it, with its options; paths are the recorded names.
pub(super) enum RecordedCommand {
    Identify(Box<IdentifyArguments>),
    Diagnose(Box<DiagnoseArguments>),
    Plan(Box<PlanArguments>),
}

impl RecordedCommand {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Identify(_) => "identify",
            Self::Diagnose(_) => "diagnose",
            Self::Plan(_) => "plan",
        }
    }

    /// Name of the file that holds the provenance.
    pub(super) fn result_file(&self) -> &'static str {
        match self {
            Self::Identify(_) => Found::FILES[1],
            Self::Diagnose(_) => Diagnosed::FILES[0],
            Self::Plan(_) => Planned::FILES[0],
        }
    }
}

/// What is read of the provenance.
#[derive(Deserialize)]
struct Fields {
    haptical_version: String,
    command: String,
    arguments: Vec<String>,
    inputs: Vec<InputFile>,
    outputs: Vec<OutputFile>,
    result_sha256: String,
}

impl Recorded {
    /// Whether the file is as it was written.
    pub(super) fn is_seal_whole(&self) -> bool {
        is_seal_whole(&self.text, &self.result_sha256)
    }

    /// Whether the result says that it wrote this file.
    pub(super) fn lists(&self, name: &str, bytes: &[u8]) -> bool {
        let listed = self.outputs.iter().find(|output| output.file == name);
        listed.is_some_and(|output| output.sha256 == Fingerprint::from_bytes(bytes).sha256)
    }
}

/// Reads the results in a folder, or the one that is given.
pub(super) fn read(given: &Path) -> Result<Vec<Recorded>, Failure> {
    let refuse = |what: String, next: &str| {
        Failure::bad_input("no-result", what, given.display().to_string(), next)
    };
    let there = std::fs::metadata(given).map_err(|error| {
        refuse(
            format!("cannot be read: {}", reason(&error)),
            "give the folder that `haptical identify`, `diagnose` or `plan` wrote",
        )
    })?;
    if !there.is_dir() {
        return Ok(vec![read_one(given, true)?]);
    }
    let names = [Found::FILES[1], Diagnosed::FILES[0], Planned::FILES[0]];
    let paths = names.map(|name| given.join(name));
    let results = paths
        .iter()
        .filter(|path| path.exists())
        .map(|path| read_one(path, false))
        .collect::<Result<Vec<Recorded>, Failure>>()?;
    if results.is_empty() {
        return Err(refuse(
            format!("there is none of {}", names.join(", ")),
            "give the folder that `haptical identify`, `diagnose` or `plan` wrote",
        ));
    }
    Ok(results)
}

fn read_one(path: &Path, stands_alone: bool) -> Result<Recorded, Failure> {
    let text = read_text(path)?;
    let refuse = |kind, what: String, next: &str| {
        Failure::bad_input(kind, what, path.display().to_string(), next)
    };
    let value: Value = serde_json::from_str(&text).map_err(|error| not_json(path, &error))?;
    let Some(provenance) = value.get("provenance").filter(|_| value.is_object()) else {
        let next = "give identified.json, gap.json, plan.json or their folder";
        let what = "it is no result of `haptical identify`, `diagnose` or `plan`";
        return Err(
            match value.get("haptical_version").and_then(Value::as_str) {
                Some(version) => no_provenance(path, version),
                None => refuse("no-result", what.to_owned(), next),
            },
        );
    };
    if provenance.get("command").is_none() {
        let version = value.get("haptical_version").and_then(Value::as_str);
        return Err(no_provenance(path, version.unwrap_or("unknown")));
    }
    let fields: Fields = serde_json::from_value(provenance.clone()).map_err(|error| {
        let why = error.to_string().replace("a sequence", "a list");
        let what = format!("its provenance cannot be used: {why}");
        refuse("provenance", what, AGAIN)
    })?;
    if !["identify", "diagnose", "plan"].contains(&fields.command.as_str()) {
        let what = format!("what `haptical {}` writes is not verified", fields.command);
        let next = "give a result of `haptical identify`, `diagnose` or `plan`; others are made again \
                    with their recorded arguments";
        return Err(refuse("no-result", what, next));
    }
    let command = replay(&fields).map_err(|what| {
        let version = &fields.haptical_version;
        let what = format!("its recorded command, of version {version}, cannot be run: {what}");
        refuse("provenance", what, AGAIN)
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(Recorded {
        path: path.to_owned(),
        folder: folder.to_owned(),
        stands_alone,
        text,
        version: fields.haptical_version,
        command,
        inputs: fields.inputs,
        outputs: fields.outputs,
        result_sha256: fields.result_sha256,
    })
}

fn no_provenance(path: &Path, version: &str) -> Failure {
    Failure::bad_input(
        "provenance",
        format!("it does not say what it was made from; it was written by version {version}"),
        path.display().to_string(),
        AGAIN,
    )
}

/// The recorded words, read as a command line is read.
fn replay(fields: &Fields) -> Result<RecordedCommand, String> {
    let words = ["haptical", fields.command.as_str(), "--out=."];
    let words = words
        .into_iter()
        .chain(fields.arguments.iter().map(String::as_str));
    match Arguments::try_parse_from(words).map(|arguments| arguments.command) {
        Ok(Command::Identify(arguments)) => Ok(RecordedCommand::Identify(Box::new(arguments))),
        Ok(Command::Diagnose(arguments)) => Ok(RecordedCommand::Diagnose(Box::new(arguments))),
        Ok(Command::Plan(arguments)) => Ok(RecordedCommand::Plan(Box::new(arguments))),
        Err(error) if error.use_stderr() => Err(failure_of(&error).what().to_owned()),
        _ => Err(format!("`{}` gives no result", fields.command)),
    }
}

fn read_text(path: &Path) -> Result<String, Failure> {
    let refuse = |kind, what: String, next: &str| {
        Failure::bad_input(kind, what, path.display().to_string(), next)
    };
    let unreadable = |error: std::io::Error| {
        let what = format!("cannot be read: {}", reason(&error));
        refuse("unreadable", what, "check the path and its permissions")
    };
    // A pipe might wait for ever.
    if !path.is_file() {
        let next = "give identified.json, gap.json, plan.json or their folder";
        return Err(refuse(
            "no-result",
            "it is no regular file".to_owned(),
            next,
        ));
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST_RESULT_BYTES + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST_RESULT_BYTES {
        let what = format!("larger than {} MiB", LARGEST_RESULT_BYTES >> 20);
        let next = "give identified.json, gap.json, plan.json or their folder";
        return Err(refuse("too-large", what, next));
    }
    String::from_utf8(bytes).map_err(|_| {
        let next = "give identified.json, gap.json, plan.json or their folder";
        refuse("not-text", "not a text in UTF-8".to_owned(), next)
    })
}

fn not_json(path: &Path, error: &serde_json::Error) -> Failure {
    let extension = path.extension().unwrap_or_default();
    let next = if extension == "json" {
        "it was cut off or changed after it was written: run the command that wrote it again"
    } else {
        "give the folder, or identified.json, gap.json or plan.json in it"
    };
    let said = error.to_string();
    let said = said
        .split_once(" at line ")
        .map_or(&*said, |(what, _)| what);
    Failure::placed(
        "not-json",
        format!("not JSON: {said}"),
        path,
        (error.line() as u64, error.column() as u64),
        next,
    )
}

/// The bytes of a file beside the result; none where there is no regular file.
pub(super) fn read_beside(path: &Path, expected: usize) -> Result<Option<Vec<u8>>, Failure> {
    if !path.is_file() {
        return Ok(None);
    }
    let unreadable = |error: std::io::Error| {
        Failure::bad_input(
            "unreadable",
            format!("cannot be read: {}", reason(&error)),
            path.display().to_string(),
            "check its permissions",
        )
    };
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    // One more than is compared: what is longer differs all the same.
    let most = expected as u64 + MOST_FURTHER_BYTES;
    file.take(most)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    Ok(Some(bytes))
}
