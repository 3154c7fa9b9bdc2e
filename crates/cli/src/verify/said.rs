//! The findings of `haptical verify`, for people and for programs.

use std::fmt::Write as _;
use std::path::Path;

use haptical::files::VERSION;
use serde::Serialize;
use serde_json::Value;

use super::compare::{Agreement, FileVerdict};
use super::sought::FoundInput;
use crate::failure::{self, Failure};

/// Differences of a file that the terminal lists; `--json` has more.
const LISTED: usize = 10;

/// All results of a folder.
#[derive(Debug, Serialize)]
pub(super) struct Verification {
    /// `differs` where a file does, else `undecided` where a result could not be checked, else `same-numbers` or
    /// `same-bytes`.
    pub(super) verdict: Agreement,
    haptical_version: &'static str,
    results: Vec<Finding>,
    /// The index of each folder.
    indexes: Vec<FileVerdict>,
}

/// A result, or why it could not be checked.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Finding {
    Checked(CheckedResult),
    Refused {
        result: String,
        error: Value,
        #[serde(skip)]
        said: String,
    },
}

/// One result.
#[derive(Debug, Serialize)]
pub(super) struct CheckedResult {
    pub(super) result: String,
    pub(super) command: &'static str,
    /// Version that wrote it.
    pub(super) recorded_version: String,
    pub(super) inputs: Vec<FoundInput>,
    pub(super) files: Vec<FileVerdict>,
}

impl Finding {
    pub(super) fn refused(path: &Path, failure: &Failure) -> Self {
        Self::Refused {
            result: path.display().to_string(),
            error: failure::as_json(failure),
            said: failure::lines(failure),
        }
    }

    fn files(&self) -> &[FileVerdict] {
        match self {
            Self::Checked(checked) => &checked.files,
            Self::Refused { .. } => &[],
        }
    }

    /// Whether the result could be checked and is what its inputs give.
    pub(super) fn holds(&self) -> bool {
        matches!(self, Self::Checked(_)) && self.files().iter().all(FileVerdict::holds)
    }
}

impl Verification {
    pub(super) fn new(results: Vec<Finding>, indexes: Vec<FileVerdict>) -> Self {
        let files = || results.iter().flat_map(Finding::files).chain(&indexes);
        let is_refused = |finding: &Finding| matches!(finding, Finding::Refused { .. });
        let verdict = if files().any(|file| !file.holds()) {
            Agreement::Differs
        } else if results.iter().any(is_refused) {
            Agreement::Undecided
        } else if files().any(|file| file.agreement == Agreement::SameNumbers) {
            Agreement::SameNumbers
        } else {
            Agreement::SameBytes
        };
        Self {
            verdict,
            haptical_version: VERSION,
            results,
            indexes,
        }
    }

    /// Whether each file that differs was changed after it was written.
    fn was_changed(&self) -> bool {
        let files = self.results.iter().flat_map(Finding::files);
        let mut failing = files.chain(&self.indexes).filter(|file| !file.holds());
        failing.all(|file| file.changed_since_written)
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for result in &self.results {
            match result {
                Finding::Checked(checked) => checked.write(&mut text),
                Finding::Refused { result, said, .. } => {
                    let _ = writeln!(text, "{result}: not checked\n{said}");
                }
            }
        }
        for index in &self.indexes {
            let _ = writeln!(text, "Index of the results");
            index.write(&mut text, index.file.len());
            text.push('\n');
        }
        let last = match self.verdict {
            Agreement::Undecided => "Not verified: a result could not be checked.",
            Agreement::SameBytes => "Verified: these inputs give the same bytes.",
            Agreement::SameNumbers => {
                "Verified: these inputs give the same numbers, not the same bytes, as on another machine (within 1e-9 of \
                 each, 1e-6 in a diagnosis)."
            }
            _ if self.was_changed() => {
                "Not verified: what differs was changed after it was written, in its numbers or in its form."
            }
            _ => "Not verified: these inputs give something else.",
        };
        text + last + "\n"
    }
}

impl CheckedResult {
    /// `write!` to a String cannot fail.
    fn write(&self, text: &mut String) {
        let (result, command, version) = (&self.result, self.command, &self.recorded_version);
        let _ = writeln!(
            text,
            "{result}: haptical {command}, written by version {version}"
        );
        if version != VERSION {
            let _ = writeln!(text, "  recomputed by another version: {VERSION}");
        }
        for input in &self.inputs {
            let (flag, found) = (&input.flag, &input.found);
            let _ = writeln!(text, "  --{flag} {found}: the recorded bytes");
        }
        let width = self.files.iter().map(|file| file.file.len()).max();
        for file in &self.files {
            file.write(text, width.unwrap_or_default());
        }
        text.push('\n');
    }
}

impl FileVerdict {
    /// Name and finding, then what differs.
    fn write(&self, text: &mut String, width: usize) {
        let name = format!("{:<width$}", self.file);
        let _ = writeln!(text, "  {name}  {}", self.sentence());
        for own in self.differences.iter().take(LISTED) {
            let (place, recorded, recomputed) = (&own.place, &own.recorded, &own.recomputed);
            let _ = writeln!(
                text,
                "    {place}: recorded {recorded}, recomputed {recomputed}"
            );
        }
        if self.difference_count > LISTED {
            let _ = writeln!(text, "    and {} more", self.difference_count - LISTED);
        }
    }

    fn sentence(&self) -> String {
        let changed = match self.changed_since_written {
            true => ", changed after it was written",
            false => "",
        };
        match self.agreement {
            Agreement::SameBytes => "the same bytes".to_owned(),
            Agreement::SameNumbers => format!(
                "the same numbers, the largest relative difference is {:.1e}",
                self.largest_relative_difference.unwrap_or_default()
            ),
            Agreement::Differs if self.difference_count == 1 => format!("differs{changed}"),
            Agreement::Differs => format!("differs in {} values{changed}", self.difference_count),
            Agreement::Missing => "missing".to_owned(),
            Agreement::Undecided => "not checked".to_owned(),
            Agreement::NotKept => "not kept with this result".to_owned(),
        }
    }
}
