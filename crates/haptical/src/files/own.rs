//! Whether a command wrote a file that is there, by the hashes in results, exports and pages.

use std::path::Path;

use serde_json::Value;

use super::{Fingerprint, OutputFile, ResultKind, is_seal_whole};

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
}

/// The JSON of a command, the other files that it says it wrote, and whether nobody changed it since.
pub(super) fn provenance(text: &str, command: &str) -> Option<(Value, Vec<OutputFile>, bool)> {
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
pub(super) fn is_listed(path: &Path, name: &str, outputs: &[OutputFile]) -> bool {
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
