//! The results in a folder: which files an earlier run of a command wrote, and new ones in their place.

use std::path::{Path, PathBuf};

use super::index;
use super::output::replace_all;
use super::own::{Listing, read_all};
use super::{INDEX, NewFile, ResultKind, WriteRule};
use crate::error::Error;

/// What became of the files in a folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WrittenResult {
    /// Files that were written.
    pub written: Vec<PathBuf>,
    /// Files of an earlier run of the same command that this one does not write: they are gone.
    pub removed: Vec<PathBuf>,
    /// Files under a name of the command that neither this run nor an earlier one wrote.
    pub foreign: Vec<PathBuf>,
}

/// Writes the files of a result and the index of the folder, and takes away what an earlier run of the same
/// command wrote there and this one does not: all or nothing. It ends where `stop` says so.
///
/// # Errors
/// A file that the rule refuses; the folder cannot be written to; `stop` said so.
pub fn write_result(
    folder: &Path,
    kind: &ResultKind,
    files: &[NewFile<'static>],
    rule: &WriteRule,
    stop: &dyn Fn() -> bool,
) -> Result<WrittenResult, Error> {
    let outputs: Vec<PathBuf> = kind.outputs().map(|name| folder.join(name)).collect();
    rule.check(&outputs)?;
    let mut results = read_all(folder);
    let is_new = |name: &str| files.iter().any(|(new, _)| *new == name);
    let is_there = |name: &str| folder.join(name).symlink_metadata().is_ok();
    let names = kind.files.iter().copied();
    let stale = names.filter(|name| !is_new(name) && is_there(name));
    let (own, foreign) = rule.partition(folder, stale.collect(), kind.outputs());
    let new = files.iter().find(|(name, _)| *name == kind.result);
    let new = new
        .and_then(|(_, content)| Listing::parse(std::str::from_utf8(content).ok()?, kind.command));
    results.retain(|(own, _)| own != kind);
    results.extend(new.map(|new| (*kind, new)));
    let mut files = files.to_vec();
    files.push((INDEX, index::page(&results)?.into_bytes()));
    let places = |names: &[&str]| names.iter().map(|name| folder.join(name)).collect();
    Ok(WrittenResult {
        written: replace_all(folder, &files, &own, stop)?,
        removed: places(&own),
        foreign: places(&foreign),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::files::{Overwrite, Record, UNSEALED, sealed_json};

    const KIND: ResultKind = ResultKind::IDENTIFICATION;

    /// A result with these further files.
    fn files(names: &[&'static str], number: u32) -> Vec<NewFile<'static>> {
        let content = |name: &&'static str| (*name, number.to_string().into_bytes());
        let mut files: Vec<NewFile<'static>> = names.iter().map(content).collect();
        let mut record = Record::new("1", KIND.command, Vec::new(), Vec::new());
        record = record.with_outputs(&files);
        assert_eq!(record.result_sha256, UNSEALED);
        let result = json!({"number": number, "provenance": record});
        files.push((KIND.result, sealed_json(&result).unwrap().into_bytes()));
        files
    }

    fn write(
        folder: &Path,
        files: &[NewFile<'static>],
        overwrite: Overwrite,
    ) -> Result<WrittenResult, Error> {
        let rule = WriteRule::new(KIND.command, Vec::new(), overwrite);
        write_result(folder, &KIND, files, &rule, &|| false)
    }

    #[test]
    fn what_was_changed_is_neither_removed_nor_replaced_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let whole = ["identified.toml", "identify.html", "rejected.toml"];
        let first = write(folder.path(), &files(&whole, 1), Overwrite::Own).unwrap();
        assert_eq!(first.written.len(), 5, "with the index");
        assert!(first.removed.is_empty() && first.foreign.is_empty());
        let second = write(folder.path(), &files(&whole[..2], 2), Overwrite::Own).unwrap();
        assert_eq!(second.removed, [path("rejected.toml")]);
        assert!(!path("rejected.toml").exists());
        std::fs::write(path("rejected.toml"), "mine").unwrap();
        let refused = write(folder.path(), &files(&whole[..2], 3), Overwrite::Own).unwrap_err();
        assert_eq!(refused.name(), "exists");
        assert_eq!(
            std::fs::read_to_string(path("identified.toml")).unwrap(),
            "2"
        );
        let third = write(folder.path(), &files(&whole[..2], 3), Overwrite::Any).unwrap();
        assert_eq!(third.foreign, [path("rejected.toml")]);
        assert!(third.removed.is_empty() && path("rejected.toml").exists());
    }

    /// A result may list whatever somebody wrote into it.
    #[test]
    fn a_file_elsewhere_that_a_result_lists_stays() {
        let above = tempfile::tempdir().unwrap();
        let (folder, outside) = (above.path().join("result"), above.path().join("outside"));
        std::fs::write(&outside, "1").unwrap();
        write(&folder, &files(&["identified.toml"], 1), Overwrite::Own).unwrap();
        let listing = files(&["../outside", "identified.toml"], 1);
        let (_, json) = listing.last().unwrap();
        std::fs::write(folder.join(KIND.result), json).unwrap();
        let written = write(&folder, &files(&["identified.toml"], 2), Overwrite::Own).unwrap();
        assert!(written.removed.is_empty() && outside.exists());
    }

    #[test]
    fn a_result_of_a_version_without_answers_is_in_the_index() {
        let folder = tempfile::tempdir().unwrap();
        write(
            folder.path(),
            &files(&["identified.toml"], 1),
            Overwrite::Own,
        )
        .unwrap();
        let page = std::fs::read_to_string(folder.path().join(INDEX)).unwrap();
        assert!(page.contains("Version 1 wrote it, without an answer in a line."));
        assert!(page.contains("href=\"identified.json\"") && !page.contains("identify.html"));
        assert_eq!(index(folder.path()).unwrap(), Some(page));
    }
}
