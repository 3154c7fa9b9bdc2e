//! The findings of `haptical verify`, for people and for programs.

use std::fmt::Write as _;

use haptical::files::VERSION;
use serde::Serialize;

use super::compare::{Agreement, Difference, FileVerdict};
use super::sought::FoundInput;

/// Differences of a file that the terminal lists; `--json` has more.
const LISTED: usize = 10;

/// All results of a folder.
#[derive(Debug, Serialize)]
pub(super) struct Verification {
    /// The weakest agreement of all files: `same-bytes`, `same-numbers` or `differs`.
    verdict: Agreement,
    haptical_version: &'static str,
    results: Vec<CheckedResult>,
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

impl Verification {
    pub(super) fn new(results: Vec<CheckedResult>) -> Self {
        let files = || results.iter().flat_map(|result| &result.files);
        let verdict = if files().any(|file| !file.holds()) {
            Agreement::Differs
        } else if files().any(|file| file.agreement == Agreement::SameNumbers) {
            Agreement::SameNumbers
        } else {
            Agreement::SameBytes
        };
        Self {
            verdict,
            haptical_version: VERSION,
            results,
        }
    }

    pub(super) fn holds(&self) -> bool {
        self.verdict != Agreement::Differs
    }

    /// Whether each file that differs was changed after it was written.
    fn was_changed(&self) -> bool {
        let files = self.results.iter().flat_map(|result| &result.files);
        let mut failing = files.filter(|file| !file.holds());
        failing.all(|file| file.changed_since_written)
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for result in &self.results {
            result.write(&mut text);
        }
        let last = match self.verdict {
            Agreement::SameBytes => "Verified: these inputs give the same bytes.",
            Agreement::SameNumbers => {
                "Verified: these inputs give the same numbers within 1e-9 of each, not the same bytes, as on \
                 another machine."
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
        let Self {
            result,
            command,
            recorded_version,
            ..
        } = self;
        let _ = writeln!(
            text,
            "{result}: haptical {command}, written by version {recorded_version}"
        );
        if recorded_version != VERSION {
            let _ = writeln!(text, "  recomputed by another version: {VERSION}");
        }
        for input in &self.inputs {
            let (flag, found) = (&input.flag, &input.found);
            let _ = writeln!(text, "  --{flag} {found}: the recorded bytes");
        }
        let width = self.files.iter().map(|file| file.file.len()).max();
        for file in &self.files {
            let name = format!("{:<1$}", file.file, width.unwrap_or_default());
            let _ = writeln!(text, "  {name}  {}", file.sentence());
            for Difference {
                place,
                recorded,
                recomputed,
            } in file.differences.iter().take(LISTED)
            {
                let _ = writeln!(
                    text,
                    "    {place}: recorded {recorded}, recomputed {recomputed}"
                );
            }
            if file.difference_count > LISTED {
                let _ = writeln!(text, "    and {} more", file.difference_count - LISTED);
            }
        }
        text.push('\n');
    }
}

impl FileVerdict {
    fn sentence(&self) -> String {
        let changed = if self.changed_since_written {
            ", changed after it was written"
        } else {
            ""
        };
        match self.agreement {
            Agreement::SameBytes => "the same bytes".to_owned(),
            Agreement::SameNumbers => format!(
                "the same numbers, the largest relative difference is {:.1e}",
                self.largest_relative_difference.unwrap_or_default()
            ),
            Agreement::Differs if self.difference_count == 1 => format!("differs{changed}"),
            Agreement::Differs => {
                format!("differs in {} values{changed}", self.difference_count)
            }
            Agreement::Missing => "missing".to_owned(),
            Agreement::NotKept => "not kept with this result".to_owned(),
        }
    }
}
