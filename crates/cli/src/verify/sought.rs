//! Finds the inputs of a result and checks that they are the recorded ones.

use std::path::{Path, PathBuf};

use haptical::files::{Fingerprint, InputFile, Source};
use serde::Serialize;

use super::recorded::Recorded;
use crate::failure::Failure;

/// Inputs that are results themselves, often in a folder beside that of the result.
const OF_OTHER_RESULTS: [&str; 2] = ["with", "model"];
/// Folders beside a result that are looked into.
const MOST_BESIDE: usize = 1000;

/// An input with the recorded bytes.
#[derive(Debug, Serialize)]
pub(crate) struct FoundInput {
    pub(crate) flag: String,
    /// Recorded name.
    file: String,
    /// Its place.
    pub(crate) found: String,
    sha256: String,
}

/// The input of a flag, the one of its number among those of the flag, at the place that the user gives, or else where
/// its recorded name leads.
pub(crate) fn find(
    result: &Recorded,
    (flag, number): (&str, usize),
    name: &Path,
    given: Option<&Path>,
) -> Result<(Source, FoundInput), Failure> {
    let inputs = result.provenance.inputs.iter();
    let mut inputs = inputs.filter(|input| input.flag == flag);
    let recorded = inputs.nth(number).ok_or_else(|| {
        let what = format!("its provenance has no SHA-256 of the file of --{flag}");
        let next = "run the command that wrote it again";
        Failure::in_file("provenance", what, &result.path, next)
    })?;
    let places = given.map_or_else(
        || places(result.folder(), name),
        |path| vec![path.to_owned()],
    );
    let mut other = None;
    for path in &places {
        // Pipes and devices have no end to be hashed to.
        if given.is_none() && !path.is_file() {
            continue;
        }
        if hash(path)? == recorded.sha256 {
            return Ok(found(path, recorded));
        }
        other.get_or_insert(path);
    }
    if given.is_none() && OF_OTHER_RESULTS.contains(&flag) {
        for path in beside(result.folder(), name) {
            if hash(&path)? == recorded.sha256 {
                return Ok(found(&path, recorded));
            }
        }
    }
    let (file, bytes, sha256) = (&recorded.file, recorded.bytes, &recorded.sha256);
    let command = result.command.kind().command;
    Err(match other {
        Some(path) => {
            let said = format!(
                "this is not the file that the result was made from as --{flag}; give the one that was called {file} ({bytes} bytes, \
                 SHA-256 {sha256}) with --{flag}, or run `haptical {command}` again"
            );
            Failure::of_file("changed-input", said, path)
        }
        None => {
            let looked = places.iter().map(|path| path.display().to_string());
            let looked = looked.collect::<Vec<_>>().join(", ");
            let what = format!("the file that the result was made from as --{flag} is not there");
            let next = format!("give its place with --{flag}; its SHA-256 is {sha256}");
            Failure::bad_input("missing-input", what, looked, next)
        }
    })
}

fn found(path: &Path, recorded: &InputFile) -> (Source, FoundInput) {
    let source = Source {
        path: path.to_owned(),
        label: recorded.file.clone(),
        text: None,
    };
    let input = FoundInput {
        flag: recorded.flag.clone(),
        file: recorded.file.clone(),
        found: path.display().to_string(),
        sha256: recorded.sha256.clone(),
    };
    (source, input)
}

/// Paths that the recorded name may mean, each once: the name and its last part, from the
/// current folder, the result's folder and the one above.
fn places(folder: &Path, name: &Path) -> Vec<PathBuf> {
    let above = folder.join("..");
    let last = name.file_name().map_or(name, Path::new);
    let mut places: Vec<PathBuf> = Vec::new();
    for name in [name, last] {
        for place in [Path::new(""), folder, &above].map(|folder| folder.join(name)) {
            if !places.contains(&place) {
                places.push(place);
            }
        }
    }
    places
}

/// Files of the recorded name's last part in the folders beside a result's, in order of their names: of an absolute path no
/// more than that part is recorded.
fn beside(folder: &Path, name: &Path) -> Vec<PathBuf> {
    let last = name.file_name().map_or(name, Path::new);
    let Ok(entries) = std::fs::read_dir(folder.join("..")) else {
        return Vec::new();
    };
    let folders = entries.take(MOST_BESIDE).filter_map(Result::ok);
    let mut files: Vec<PathBuf> = folders
        .map(|entry| entry.path().join(last))
        .filter(|path| path.is_file())
        .collect();
    files.sort_unstable();
    files
}

/// SHA-256 of a regular file.
fn hash(path: &Path) -> Result<String, Failure> {
    let next = "check the path and its permissions";
    let unreadable = |error: std::io::Error| Failure::unreadable(&error, path, next);
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        let what = "it is no regular file";
        return Err(Failure::in_file("unreadable", what, path, next));
    }
    Ok(Fingerprint::of_file(path).map_err(unreadable)?.sha256)
}
