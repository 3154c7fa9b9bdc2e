//! Writes a set of files into a folder: all of them or none.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A file name and its content.
pub(crate) type NewFile<'a> = (&'a str, Vec<u8>);

/// Refuses a folder that cannot be written to, as far as that can be told without writing.
pub(crate) fn check_folder(folder: &Path) -> Result<(), Failure> {
    let existing = folder
        .ancestors()
        .find(|path| path.as_os_str().is_empty() || path.exists());
    match existing {
        Some(path) if path.as_os_str().is_empty() || path.is_dir() => Ok(()),
        _ => {
            let blocking = existing.unwrap_or(folder).display().to_string();
            Err(unwritable(folder, &format!("{blocking} is not a folder")))
        }
    }
}

/// Writes all files: first beside their places, then each is renamed into its place, so that a full
/// disk or an interruption while writing leaves nothing half-written.
pub(crate) fn write_all(folder: &Path, files: &[NewFile<'_>]) -> Result<Vec<PathBuf>, Failure> {
    let is_new = !folder.exists();
    let result = stage_and_rename(folder, files);
    if result.is_err() && is_new {
        // Only an empty folder is removed by this.
        let _ = std::fs::remove_dir(folder);
    }
    result
}

fn stage_and_rename(folder: &Path, files: &[NewFile<'_>]) -> Result<Vec<PathBuf>, Failure> {
    let refuse = |error: std::io::Error| unwritable(folder, &error.to_string());
    std::fs::create_dir_all(folder).map_err(refuse)?;
    for (name, _) in files {
        if folder.join(name).is_dir() {
            return Err(unwritable(folder, &format!("{name} is a folder there")));
        }
    }
    let stage = tempfile::Builder::new()
        .prefix(".haptical-")
        .tempdir_in(folder)
        .map_err(refuse)?;
    for (name, content) in files {
        let mut file = std::fs::File::create(stage.path().join(name)).map_err(refuse)?;
        file.write_all(content).map_err(refuse)?;
        file.sync_all().map_err(refuse)?;
    }
    let mut written = Vec::new();
    for (name, _) in files {
        let place = folder.join(name);
        std::fs::rename(stage.path().join(name), &place).map_err(refuse)?;
        written.push(place);
    }
    stage.close().map_err(refuse)?;
    Ok(written)
}

fn unwritable(folder: &Path, why: &str) -> Failure {
    Failure::bad_input(
        "unwritable",
        format!("cannot write: {why}"),
        folder.display().to_string(),
        "give a folder that can be written to",
    )
}
