//! Whether a command wrote a file that is there, by the hashes in results, exports and pages.

use std::path::Path;

use serde_json::Value;

use super::{Fingerprint, OutputFile, ResultKind, file_name, is_seal_whole};

/// Largest result that is read; a result takes some hundred kilobytes.
const LARGEST_RESULT_BYTES: u64 = 64 << 20;
/// Largest file that is looked through for its own hash; a page that plays a log takes some megabytes.
const LARGEST_TEXT_BYTES: u64 = 512 << 20;

/// A JSON file of a command, and the other files that it says were written with it.
#[derive(Debug)]
pub(super) struct Listing {
    pub(super) value: Value,
    /// Whether nobody changed it since it was written.
    pub(super) is_whole: bool,
    pub(super) outputs: Vec<OutputFile>,
}

impl Listing {
    /// None of a text that is none of this command.
    pub(super) fn parse(text: &str, command: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(text).ok()?;
        let provenance = value.get("provenance")?;
        if provenance.get("command")?.as_str()? != command {
            return None;
        }
        Some(Self {
            outputs: serde_json::from_value(provenance.get("outputs")?.clone()).ok()?,
            is_whole: is_seal_whole(text, provenance.get("result_sha256")?.as_str()?),
            value,
        })
    }

    /// Whether a file is there with the bytes that are listed under its name.
    pub(super) fn has(&self, path: &Path) -> bool {
        let name = file_name(path);
        let listed = self.outputs.iter().find(|output| output.file == name);
        listed.is_some_and(|listed| {
            let there = std::fs::metadata(path);
            there.is_ok_and(|there| there.is_file() && there.len() == listed.bytes)
                && Fingerprint::of_file(path).is_ok_and(|found| found.sha256 == listed.sha256)
        })
    }
}

/// The results in a folder, by kind.
pub(super) fn read_all(folder: &Path) -> Vec<(ResultKind, Listing)> {
    let read = |kind: ResultKind| {
        let text = text_of(&folder.join(kind.result), LARGEST_RESULT_BYTES)?;
        Some((kind, Listing::parse(&text, kind.command)?))
    };
    ResultKind::ALL.into_iter().filter_map(read).collect()
}

/// Text of a regular file that is no larger than what a command writes.
pub(super) fn own_text(path: &Path) -> Option<String> {
    text_of(path, LARGEST_TEXT_BYTES)
}

fn text_of(path: &Path, most_bytes: u64) -> Option<String> {
    let there = std::fs::metadata(path).ok()?;
    let is_small = there.is_file() && there.len() <= most_bytes;
    is_small.then(|| std::fs::read_to_string(path).ok())?
}
