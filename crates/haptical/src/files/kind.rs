//! The commands that leave a result in a folder, and the names of their files.

use std::path::{Path, PathBuf};

use super::{NewFile, Overwrite, WriteRule, write_result};
use crate::error::Error;

/// Name of the index of the results in a folder.
pub const INDEX: &str = "report.html";
/// The last one is written only where a fit is rejected.
pub(crate) const IDENTIFICATION_FILES: [&str; 4] = [
    "identified.toml",
    "identified.json",
    "identify.html",
    "rejected.toml",
];
/// The third is written with a second log only, the fourth where a cause is named that is part of a device; of the last
/// three, a repaired log with its list, none or two.
pub(crate) const DIAGNOSIS_FILES: [&str; 7] = [
    "gap.json",
    "gap.html",
    "predictions.csv",
    "corrected.toml",
    "repaired.csv",
    "repaired.csv.gz",
    "repaired.json",
];
/// The last one is written where poses are asked for only.
pub(crate) const PLAN_FILES: [&str; 4] = ["plan.json", "plan.html", "rigs.svg", "poses.csv"];

/// A command that leaves a result in a folder, and the names of its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResultKind {
    /// Subcommand.
    pub command: &'static str,
    /// What its result is called in the index.
    pub title: &'static str,
    /// The file with the provenance.
    pub result: &'static str,
    /// The page for people.
    pub page: &'static str,
    /// All files that it may write, these two among them; the index is shared.
    pub files: &'static [&'static str],
}

impl ResultKind {
    /// Of `haptical identify`.
    pub const IDENTIFICATION: Self = Self {
        command: "identify",
        title: "Identification",
        result: IDENTIFICATION_FILES[1],
        page: IDENTIFICATION_FILES[2],
        files: &IDENTIFICATION_FILES,
    };
    /// Of `haptical diagnose`.
    pub const DIAGNOSIS: Self = Self {
        command: "diagnose",
        title: "Diagnosis",
        result: DIAGNOSIS_FILES[0],
        page: DIAGNOSIS_FILES[1],
        files: &DIAGNOSIS_FILES,
    };
    /// Of `haptical plan`.
    pub const PLAN: Self = Self {
        command: "plan",
        title: "Plan",
        result: PLAN_FILES[0],
        page: PLAN_FILES[1],
        files: &PLAN_FILES,
    };
    /// All kinds, in the order of the index.
    pub const ALL: [Self; 3] = [Self::IDENTIFICATION, Self::DIAGNOSIS, Self::PLAN];

    /// Writes the files of a result and the index of the folder, in the place of those of an earlier run: all of them or none.
    ///
    /// # Errors
    /// As [`write_result`]; a file that no earlier run wrote, or that was changed since.
    pub(crate) fn write(
        &self,
        folder: &Path,
        files: &[NewFile<'static>],
    ) -> Result<Vec<PathBuf>, Error> {
        let rule = WriteRule::new(self.command, Vec::new(), Overwrite::Own);
        Ok(write_result(folder, self, files, &rule, &|| false)?.written)
    }

    /// Names of the files that are written, that of the index among them.
    pub fn outputs(&self) -> impl Iterator<Item = &'static str> {
        self.files.iter().copied().chain([INDEX])
    }
}
