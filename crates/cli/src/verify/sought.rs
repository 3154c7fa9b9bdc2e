//! Finds the inputs of a result and checks that they are the recorded ones.

use std::path::{Path, PathBuf};

use haptical::files::{Fingerprint, InputFile, Source, reason};

use super::recorded::Recorded;
use crate::failure::Failure;

/// An input with the recorded bytes.
pub(super) struct Found {
    pub(super) source: Source,
    pub(super) recorded: InputFile,
}

/// Where the inputs of a result are looked for.
pub(super) struct Search<'a> {
    pub(super) result: &'a Recorded,
}

impl Search<'_> {
    /// The input of a flag: where the user says that it is, or else where its recorded name leads.
    pub(super) fn find(
        &self,
        flag: &str,
        name: &Path,
        given: Option<&Path>,
    ) -> Result<Found, Failure> {
        let recorded = self.recorded(flag)?;
        let source = |path: PathBuf| Source {
            path,
            label: recorded.file.clone(),
            text: None,
        };
        if let Some(path) = given {
            let is_it = hash(path)? == recorded.sha256;
            return if is_it {
                let source = source(path.to_owned());
                Ok(Found { source, recorded })
            } else {
                Err(self.changed(&recorded, path))
            };
        }
        let places = self.places(name);
        let mut other = None;
        for path in &places {
            // Pipes and devices have no end to be hashed to.
            if !path.is_file() {
                continue;
            }
            if hash(path)? == recorded.sha256 {
                let source = source(path.clone());
                return Ok(Found { source, recorded });
            }
            other.get_or_insert(path);
        }
        Err(match other {
            Some(path) => self.changed(&recorded, path),
            None => self.missing(&recorded, &places),
        })
    }

    fn recorded(&self, flag: &str) -> Result<InputFile, Failure> {
        let input = self.result.inputs.iter().find(|input| input.flag == flag);
        input.cloned().ok_or_else(|| {
            Failure::bad_input(
                "provenance",
                format!("its provenance has no SHA-256 of the file of --{flag}"),
                self.result.path.display().to_string(),
                "run the command that wrote it again",
            )
        })
    }

    /// Paths that the recorded name may mean, each once: as it stands and its last part, from the
    /// current folder, the result's folder and the one above.
    fn places(&self, name: &Path) -> Vec<PathBuf> {
        let folder = &self.result.folder;
        let above = folder.join("..");
        let folders = [Path::new(""), folder, &above];
        let last = name.file_name().map_or(name, Path::new);
        let mut places: Vec<PathBuf> = Vec::new();
        for name in [name, last] {
            for folder in folders {
                let place = folder.join(name);
                if !places.contains(&place) {
                    places.push(place);
                }
            }
        }
        places
    }

    fn changed(&self, recorded: &InputFile, path: &Path) -> Failure {
        let InputFile {
            flag,
            file,
            bytes,
            sha256,
        } = recorded;
        Failure::bad_input(
            "changed-input",
            format!("this is not the file that the result was made from as --{flag}"),
            path.display().to_string(),
            format!(
                "give the one that was called {file} ({bytes} bytes, SHA-256 {sha256}) with --{flag}, \
                 or run `haptical {}` again",
                self.result.command.name()
            ),
        )
    }

    fn missing(&self, recorded: &InputFile, places: &[PathBuf]) -> Failure {
        let looked: Vec<String> = places
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        Failure::bad_input(
            "missing-input",
            format!(
                "the file that the result was made from as --{} is not there",
                recorded.flag
            ),
            looked.join(", "),
            format!(
                "give its place with --{}; its SHA-256 is {}",
                recorded.flag, recorded.sha256
            ),
        )
    }
}

/// SHA-256 of a regular file.
fn hash(path: &Path) -> Result<String, Failure> {
    let refuse = |what: String| {
        let place = path.display().to_string();
        Failure::bad_input(
            "unreadable",
            what,
            place,
            "check the path and its permissions",
        )
    };
    let unreadable = |error: std::io::Error| refuse(format!("cannot be read: {}", reason(&error)));
    let there = std::fs::metadata(path).map_err(unreadable)?;
    if !there.is_file() {
        return Err(refuse("it is no regular file".to_owned()));
    }
    Ok(Fingerprint::of_file(path).map_err(unreadable)?.sha256)
}
