//! The file that `--out` names, with files named after it: checked before any work, then written with a record of how they came about.

use std::path::{Path, PathBuf};

use haptical::files::{
    Fingerprint, NewFile, OutputFile, WriteRule, file_name, make_folder, sealed_json,
};
use haptical_data::{LogShape, write_log};
use haptical_model::Recording;
use serde::Serialize;

use crate::failure::Failure;
use crate::flags::folder_and_name;
use crate::interrupt::{Writing, write_all};

/// End of the name of the record: a log cannot say itself how it came about.
pub(crate) const RECORD: &str = ".provenance.json";

/// The file, its place, and what may be written.
pub(crate) struct Outputs<'a> {
    out: &'a Path,
    folder: &'a Path,
    pub(crate) name: &'a str,
    rule: WriteRule,
}

impl<'a> Outputs<'a> {
    /// Refuses to go on where a file must not be written: the log, its record, or one whose name is the log's with one of these ends.
    pub(crate) fn check(out: &'a Path, rule: WriteRule, ends: &[&str]) -> Result<Self, Failure> {
        let (folder, name) = folder_and_name(out)?;
        let outputs = Self {
            out,
            folder,
            name,
            rule,
        };
        let mut all = vec![outputs.place(RECORD), out.to_owned()];
        all.extend(ends.iter().map(|end| outputs.place(end)));
        outputs.rule.check(&all)?;
        Ok(outputs)
    }

    /// Name of a further file.
    pub(crate) fn name(&self, end: &str) -> String {
        format!("{}{end}", self.name)
    }

    /// Path of a further file.
    pub(crate) fn place(&self, end: &str) -> PathBuf {
        self.folder.join(self.name(end))
    }

    /// Writes the file as a log.
    pub(crate) fn write_log(&self, recording: &Recording, shape: &LogShape) -> Result<(), Failure> {
        let writing = Writing::begin();
        let _folder = make_folder(self.folder)?;
        writing.go_on(self.out)?;
        Ok(write_log(self.out, recording, shape)?)
    }

    /// What a record says of the file that was written.
    pub(crate) fn written(&self) -> Result<OutputFile, Failure> {
        let hashed = Fingerprint::of_file(self.out)
            .map_err(|error| Failure::internal(format!("the log that was written: {error}")))?;
        Ok(hashed.output(&file_name(self.out)))
    }

    /// Writes these files and a record: all or none.
    pub(crate) fn write(
        &self,
        files: Vec<NewFile<'_>>,
        record: &impl Serialize,
    ) -> Result<(), Failure> {
        let name = self.name(RECORD);
        let mut files: Vec<NewFile<'_>> = files;
        files.push((&name, sealed_json(record)?.into_bytes()));
        write_all(&self.rule, self.folder, &files).map(|_| ())
    }
}
