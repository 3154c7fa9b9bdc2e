//! Reads a result and its record of how it came about.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Parser;
use haptical::files::{Fingerprint, InputFile, OutputFile, ResultKind, is_seal_whole};
use serde::Deserialize;
use serde_json::Value;

use super::compare::Written;
use crate::arguments::{Arguments, Command, failure_of};
use crate::failure::Failure;
use crate::result::ResultCommand;

/// Largest result that is read; a result takes some hundred kilobytes.
const LARGEST_RESULT_BYTES: u64 = 64 << 20;
/// Another file of the result may be this much longer than what is computed before it counts as unknown.
pub(crate) const MOST_FURTHER_BYTES: u64 = 1 << 20;
/// Folders that are looked through.
const MOST_FOLDERS: usize = 10_000;
/// What to do where the result says too little.
const AGAIN: &str = "run `haptical identify`, `diagnose` or `plan` again";
/// What to do where it is none.
const GIVE_FILE: &str = "give identified.json, gap.json, plan.json or their folder";
const GIVE_FOLDER: &str = "give the folder that `haptical identify`, `diagnose` or `plan` wrote";

/// A result as it was found.
pub(crate) struct Recorded {
    /// The file with the provenance.
    pub(crate) path: PathBuf,
    /// Given as a file: the other files need not be there.
    pub(crate) is_alone: bool,
    text: String,
    pub(crate) provenance: Provenance,
    /// The command that wrote it, with its options; paths are the recorded names.
    pub(crate) command: Box<dyn ResultCommand>,
}

/// What is read of the provenance.
#[derive(Deserialize)]
pub(crate) struct Provenance {
    pub(crate) haptical_version: String,
    command: String,
    arguments: Vec<String>,
    pub(crate) inputs: Vec<InputFile>,
    outputs: Vec<OutputFile>,
    result_sha256: String,
}

impl Recorded {
    pub(crate) fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The file with the provenance.
    pub(super) fn written(&self) -> Written {
        Written {
            bytes: self.text.as_bytes().to_vec(),
            is_changed: !is_seal_whole(&self.text, &self.provenance.result_sha256),
        }
    }

    /// Another file of the result; none where there is no regular file. Of what is longer than expected, a part.
    pub(super) fn other_file(
        &self,
        name: &str,
        expected: usize,
    ) -> Result<Option<Written>, Failure> {
        let path = self.folder().join(name);
        if !path.is_file() {
            return Ok(None);
        }
        let most = expected as u64 + MOST_FURTHER_BYTES;
        let bytes = read_bytes(&path, most, "check its permissions")?;
        let sha256 = Fingerprint::from_bytes(&bytes).sha256;
        let is_changed = self.listed(name).is_none_or(|own| own.sha256 != sha256);
        Ok(Some(Written { bytes, is_changed }))
    }

    /// Whether the result says that it wrote a file of this name.
    pub(crate) fn names(&self, name: &str) -> bool {
        self.listed(name).is_some()
    }

    fn listed(&self, name: &str) -> Option<&OutputFile> {
        let mut outputs = self.provenance.outputs.iter();
        outputs.find(|output| output.file == name)
    }
}

/// A result that was found, or why it cannot be checked.
pub(crate) type Candidate = (PathBuf, Result<Recorded, Failure>);

/// Reads the results in a folder and in the folders in it, or the one that is given; none is an error.
pub(crate) fn read(given: &Path) -> Result<Vec<Candidate>, Failure> {
    let there = std::fs::metadata(given)
        .map_err(|error| Failure::unreadable(&error, given, GIVE_FOLDER).with_name("no-result"))?;
    if !there.is_dir() {
        return Ok(vec![(given.to_owned(), read_one(given, true))]);
    }
    let mut results = Vec::new();
    for folder in folders(given)? {
        let paths = ResultKind::ALL.map(|kind| folder.join(kind.result));
        let there = paths.into_iter().filter(|path| path.exists());
        results.extend(there.map(|path| (path.clone(), read_one(&path, false))));
    }
    if results.is_empty() {
        let names = ResultKind::ALL.map(|kind| kind.result).join(", ");
        let what = format!("there is none of {names} in it or in a folder in it");
        return Err(Failure::in_file("no-result", what, given, GIVE_FOLDER));
    }
    Ok(results)
}

/// A folder and those in it, in order of their names; links are not followed, and hidden ones are left out.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        let refuse = |error| Failure::unreadable(&error, &folder, "check its permissions");
        let mut inner = Vec::new();
        for entry in std::fs::read_dir(&folder).map_err(refuse)? {
            let entry = entry.map_err(refuse)?;
            let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            if !is_hidden && entry.file_type().map_err(refuse)?.is_dir() {
                inner.push(entry.path());
            }
        }
        inner.sort_unstable_by(|a, b| b.cmp(a));
        open.extend(inner);
        found.push(folder);
        if found.len() > MOST_FOLDERS {
            let what = format!("it has more than {MOST_FOLDERS} folders in it");
            let first = found.swap_remove(0);
            return Err(Failure::in_file("no-result", what, &first, GIVE_FOLDER));
        }
    }
    Ok(found)
}

fn read_one(path: &Path, is_alone: bool) -> Result<Recorded, Failure> {
    let text = read_text(path)?;
    let refuse = |kind, what: String, next: &str| Failure::in_file(kind, what, path, next);
    let value: Value = serde_json::from_str(&text).map_err(|error| not_json(path, &error))?;
    let version = value.get("haptical_version").and_then(Value::as_str);
    let provenance = match value.get("provenance") {
        Some(provenance) if provenance.get("command").is_some() => provenance.clone(),
        found => {
            let version = version.or(found.map(|_| "unknown")).ok_or_else(|| {
                let what = "it is no result of `haptical identify`, `diagnose` or `plan`";
                refuse("no-result", what.to_owned(), GIVE_FILE)
            })?;
            let what = format!(
                "it does not say what it was made from; it was written by version {version}"
            );
            return Err(refuse("provenance", what, AGAIN));
        }
    };
    let provenance: Provenance = serde_json::from_value(provenance).map_err(|error| {
        let why = error.to_string().replace("a sequence", "a list");
        let what = format!("its provenance cannot be used: {why}");
        refuse("provenance", what, AGAIN)
    })?;
    let name = &provenance.command;
    if !["identify", "diagnose", "plan"].contains(&name.as_str()) {
        let next = "give a result of `haptical identify`, `diagnose` or `plan`; others are made again \
                    with their recorded arguments";
        let what = format!("what `haptical {name}` writes is not verified");
        return Err(refuse("no-result", what, next));
    }
    let command = replay(&provenance).map_err(|what| {
        let version = &provenance.haptical_version;
        let what = format!("its recorded command, of version {version}, cannot be run: {what}");
        refuse("provenance", what, AGAIN)
    })?;
    Ok(Recorded {
        path: path.to_owned(),
        is_alone,
        text,
        provenance,
        command,
    })
}

/// The recorded words, read as a command line is read.
fn replay(provenance: &Provenance) -> Result<Box<dyn ResultCommand>, String> {
    let name = provenance.command.as_str();
    let arguments = provenance.arguments.iter().map(String::as_str);
    let words = ["haptical", name, "--out=."].into_iter().chain(arguments);
    let none = || format!("`{name}` gives no result");
    match Arguments::try_parse_from(words) {
        Ok(arguments) => (arguments.command.and_then(Command::into_result)).ok_or_else(none),
        Err(error) if error.use_stderr() => Err(failure_of(&error).what().to_owned()),
        Err(_) => Err(none()),
    }
}

/// The first bytes of a file.
pub(crate) fn read_bytes(path: &Path, most: u64, next: &str) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(most).read_to_end(&mut bytes))
        .map_err(|error| Failure::unreadable(&error, path, next))?;
    Ok(bytes)
}

fn read_text(path: &Path) -> Result<String, Failure> {
    let refuse = |kind, what: &str| Failure::in_file(kind, what, path, GIVE_FILE);
    // A pipe might wait for ever.
    if !path.is_file() {
        return Err(refuse("no-result", "it is no regular file"));
    }
    let next = "check the path and its permissions";
    let bytes = read_bytes(path, LARGEST_RESULT_BYTES + 1, next)?;
    if bytes.len() as u64 > LARGEST_RESULT_BYTES {
        let what = format!("larger than {} MiB", LARGEST_RESULT_BYTES >> 20);
        return Err(refuse("too-large", &what));
    }
    String::from_utf8(bytes).map_err(|_| refuse("not-text", "not a text in UTF-8"))
}

fn not_json(path: &Path, error: &serde_json::Error) -> Failure {
    let next = if path.extension().is_some_and(|end| end == "json") {
        "it was cut off or changed after it was written: run the command that wrote it again"
    } else {
        "give the folder, or identified.json, gap.json or plan.json in it"
    };
    let text = error.to_string();
    let what = text
        .split_once(" at line ")
        .map_or(&*text, |(what, _)| what);
    let place = (error.line() as u64, error.column() as u64);
    Failure::placed("not-json", format!("not JSON: {what}"), path, place, next)
}
