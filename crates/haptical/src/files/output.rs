//! Writes a set of files into a folder: all of them or none.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// A file name and its content.
pub type NewFile<'a> = (&'a str, Vec<u8>);

/// Refuses a folder that cannot be written to, as far as that shows without writing.
///
/// # Errors
/// Something that is no folder is in the way.
pub fn check_folder(folder: &Path) -> Result<(), Error> {
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

/// Refuses files to write that would replace an input, or what is no file, before any work.
///
/// # Errors
/// The first output that would.
pub fn check_outputs(outputs: &[PathBuf], inputs: &[&Path]) -> Result<(), Error> {
    for output in outputs {
        let Ok(there) = std::fs::metadata(output) else {
            continue;
        };
        let refuse = |what: String, next: &str| {
            let place = output.display().to_string();
            Err(Error::bad_input("unwritable", what, place, next))
        };
        // Renaming a file over a device or a pipe would replace it.
        if !there.is_file() {
            let kind = if there.is_dir() {
                "a folder"
            } else {
                "no regular file"
            };
            return refuse(
                format!("cannot write: it is {kind}"),
                "give the name of a file",
            );
        }
        let same = |input: &&&Path| {
            let places = (output.canonicalize(), input.canonicalize());
            matches!(places, (Ok(output), Ok(input)) if output == input)
        };
        if let Some(input) = inputs.iter().find(same) {
            return refuse(
                format!("it would overwrite the input {}", input.display()),
                "give another --out",
            );
        }
    }
    Ok(())
}

/// Folders that were made for output; those that are empty when it is dropped are removed again.
#[derive(Debug)]
pub struct MadeFolders(Vec<PathBuf>);

/// Makes a folder with those above it.
///
/// # Errors
/// The system does not let make it.
pub fn make_folder(folder: &Path) -> Result<MadeFolders, Error> {
    let missing = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
    let made = folder.ancestors().take_while(missing);
    let made = MadeFolders(made.map(Path::to_owned).collect());
    if !made.0.is_empty() {
        std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &reason(&error)))?;
    }
    Ok(made)
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Writes all files: first into a temporary folder, then each is renamed into its place, so that a full
/// disk or an interruption while writing leaves nothing half-written. It ends where `stop` says so.
///
/// # Errors
/// The folder cannot be written to, or `stop` said so.
pub fn write_all(
    folder: &Path,
    files: &[NewFile<'_>],
    stop: &dyn Fn() -> bool,
) -> Result<Vec<PathBuf>, Error> {
    let go_on = || match stop() {
        true => Err(Error::interrupted(folder)),
        false => Ok(()),
    };
    let refuse = |error: std::io::Error| unwritable(folder, &reason(&error));
    let _made = make_folder(folder)?;
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
        go_on()?;
        let mut file = std::fs::File::create(stage.path().join(name)).map_err(refuse)?;
        file.write_all(content).map_err(refuse)?;
        file.sync_all().map_err(refuse)?;
    }
    go_on()?;
    let mut written = Vec::new();
    for (name, _) in files {
        let place = folder.join(name);
        std::fs::rename(stage.path().join(name), &place).map_err(refuse)?;
        written.push(place);
    }
    stage.close().map_err(refuse)?;
    Ok(written)
}

/// What the system says, without the name of a temporary file that nobody has heard of.
pub fn reason(error: &std::io::Error) -> String {
    let inner = error.get_ref().and_then(|inner| inner.source());
    let inner = inner.and_then(|inner| inner.downcast_ref::<std::io::Error>());
    inner.unwrap_or(error).to_string()
}

fn unwritable(folder: &Path, why: &str) -> Error {
    Error::bad_input(
        "unwritable",
        format!("cannot write: {why}"),
        folder.display().to_string(),
        "give a folder that can be written to and has room",
    )
}
