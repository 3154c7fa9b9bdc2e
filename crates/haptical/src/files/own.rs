//! Whether a command wrote a file that is there, by the hashes in results, exports and pages.

use std::path::Path;

use serde_json::Value;

use super::{Fingerprint, OutputFile, ResultKind, file_name, is_seal_whole, is_sealed_by};
use crate::error::Error;

/// Largest result that is read; a result takes some hundred kilobytes.
const LARGEST_RESULT_BYTES: u64 = 64 << 20;
/// Largest file that is looked through for its own hash; a page that plays a log takes some megabytes.
const LARGEST_TEXT_BYTES: u64 = 512 << 20;

/// A result as it lies in a folder, or is about to.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) kind: ResultKind,
    pub(super) value: Value,
    /// Whether nobody changed it since it was written.
    pub(super) is_whole: bool,
    pub(super) outputs: Vec<OutputFile>,
}

impl Recorded {
    /// None where there is no such file, or where it is none of this command.
    fn read(folder: &Path, kind: ResultKind) -> Option<Self> {
        let path = folder.join(kind.result);
        let there = std::fs::metadata(&path).ok()?;
        if !there.is_file() || there.len() > LARGEST_RESULT_BYTES {
            return None;
        }
        Self::parse(&std::fs::read_to_string(path).ok()?, kind)
    }

    pub(super) fn parse(text: &str, kind: ResultKind) -> Option<Self> {
        let (value, outputs, is_whole) = provenance(text, kind.command)?;
        Some(Self {
            kind,
            value,
            is_whole,
            outputs,
        })
    }

    /// The results in a folder.
    pub(super) fn read_all(folder: &Path) -> Vec<Self> {
        let read = |kind| Self::read(folder, kind);
        ResultKind::ALL.into_iter().filter_map(read).collect()
    }

    /// Whether this run wrote a file of the folder as it is now.
    pub(super) fn wrote(&self, folder: &Path, name: &str) -> bool {
        if name == self.kind.result {
            return self.is_whole;
        }
        is_listed(&folder.join(name), name, &self.outputs)
    }
}

/// The JSON of a command, the other files that it says it wrote, and whether nobody changed it since.
fn provenance(text: &str, command: &str) -> Option<(Value, Vec<OutputFile>, bool)> {
    let value: Value = serde_json::from_str(text).ok()?;
    let provenance = value.get("provenance")?;
    if provenance.get("command")?.as_str()? != command {
        return None;
    }
    let outputs = serde_json::from_value(provenance.get("outputs")?.clone()).ok()?;
    let is_whole = is_seal_whole(text, provenance.get("result_sha256")?.as_str()?);
    Some((value, outputs, is_whole))
}

/// Whether a file is there with the bytes that are listed under a name.
fn is_listed(path: &Path, name: &str, outputs: &[OutputFile]) -> bool {
    let is_as_long = |listed: &&OutputFile| {
        std::fs::metadata(path).is_ok_and(|there| there.is_file() && there.len() == listed.bytes)
    };
    let mut outputs = outputs.iter();
    let listed = outputs.find(|output| output.file == name);
    listed.filter(is_as_long).is_some_and(|listed| {
        Fingerprint::of_file(path).is_ok_and(|found| found.sha256 == listed.sha256)
    })
}

/// Text of a regular file that is no larger than what a command writes.
pub(super) fn own_text(path: &Path) -> Option<String> {
    let there = std::fs::metadata(path).ok()?;
    let is_small = there.is_file() && there.len() <= LARGEST_TEXT_BYTES;
    is_small.then(|| std::fs::read_to_string(path).ok())?
}

/// Refuses to overwrite a file that holds its own hash, [`sealed_text`](super::sealed_text) or
/// [`sealed_json`](super::sealed_json), unless the command wrote it as it is.
///
/// # Errors
/// The file is there and is none that the command wrote, or was changed since.
pub fn check_own_file(file: &Path, command: &str) -> Result<(), Error> {
    let is_own = |text: &str| {
        let in_json = || {
            let value: Value = serde_json::from_str(text).ok()?;
            let is_of_command = value.get("command")?.as_str()? == command;
            Some(is_of_command && is_seal_whole(text, value.get("result_sha256")?.as_str()?))
        };
        is_sealed_by(text, &format!("haptical {command}")) || in_json().unwrap_or(false)
    };
    let is_there = file.symlink_metadata().is_ok();
    match is_there && !own_text(file).is_some_and(|text| is_own(&text)) {
        true => Err(not_own(file, command)),
        false => Ok(()),
    }
}

/// Refuses to overwrite a file or the record of it, unless the command wrote both as they are.
///
/// # Errors
/// One of them is there and is none that the command wrote, or was changed since.
pub fn check_own_record(file: &Path, record: &Path, command: &str) -> Result<(), Error> {
    let found = own_text(record).and_then(|text| provenance(&text, command));
    if record.symlink_metadata().is_ok() && !found.as_ref().is_some_and(|(_, _, whole)| *whole) {
        return Err(not_own(record, command));
    }
    let is_own = found.is_some_and(|(_, outputs, _)| is_listed(file, &file_name(file), &outputs));
    match file.symlink_metadata().is_ok() && !is_own {
        true => Err(not_own(file, command)),
        false => Ok(()),
    }
}

/// The refusal to overwrite a file that a command did not write.
pub fn not_own(file: &Path, command: &str) -> Error {
    let what = format!(
        "the file is there, and no earlier `haptical {command}` wrote it, or it was changed since"
    );
    Error::in_file(
        "exists",
        what,
        file,
        "give another --out, or --force to overwrite it",
    )
}
