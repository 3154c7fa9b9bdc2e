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
    let is_there = |path: &&Path| path.as_os_str().is_empty() || path.exists();
    let existing = folder.ancestors().find(is_there).unwrap_or(folder);
    match existing.as_os_str().is_empty() || existing.is_dir() {
        true => Ok(()),
        false => {
            let why = format!("{} is not a folder", existing.display());
            Err(unwritable(folder, &why))
        }
    }
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

/// Writes all files and takes `stale` ones away: first into a temporary folder, then each is renamed into its place, so that a
/// full disk or an interruption while writing leaves nothing half-written. It ends where `stop` says so. Where a file cannot be
/// put into its place, those before it are put back as they were.
///
/// # Errors
/// The folder cannot be written to, or `stop` said so.
pub(super) fn replace_all(
    folder: &Path,
    files: &[NewFile<'_>],
    stale: &[&str],
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
        .tempdir_in(folder);
    let stage = stage.map_err(refuse)?;
    let [new, before] = ["new", "before"].map(|name| stage.path().join(name));
    for inner in [&new, &before] {
        std::fs::create_dir(inner).map_err(refuse)?;
    }
    // a name may lie in a folder of its own
    let parents = files
        .iter()
        .filter_map(|(name, _)| Path::new(name).parent());
    let _inner: Vec<MadeFolders> = (parents.filter(|parent| !parent.as_os_str().is_empty()))
        .map(|parent| {
            for inner in [&new, &before] {
                std::fs::create_dir_all(inner.join(parent)).map_err(refuse)?;
            }
            make_folder(&folder.join(parent))
        })
        .collect::<Result<_, _>>()?;
    for (name, content) in files {
        go_on()?;
        let mut file = std::fs::File::create(new.join(name)).map_err(refuse)?;
        file.write_all(content).map_err(refuse)?;
        file.sync_all().map_err(refuse)?;
    }
    go_on()?;
    let mut moved = Moved {
        folder,
        before: &before,
        names: Vec::new(),
    };
    for (name, _) in files {
        moved.replace(name, &new).map_err(refuse)?;
    }
    for name in stale {
        moved.take_away(name).map_err(refuse)?;
    }
    // from here on nothing is put back
    moved.names.clear();
    stage.close().map_err(refuse)?;
    Ok(files.iter().map(|(name, _)| folder.join(name)).collect())
}

/// Files of a folder that were replaced or taken away; they are put back when it is dropped.
struct Moved<'a> {
    folder: &'a Path,
    /// Where what was there is kept.
    before: &'a Path,
    names: Vec<&'a str>,
}

impl<'a> Moved<'a> {
    fn replace(&mut self, name: &'a str, new: &Path) -> std::io::Result<()> {
        let place = self.folder.join(name);
        let kept = self.before.join(name);
        if place.symlink_metadata().is_ok() && std::fs::hard_link(&place, &kept).is_err() {
            // some file systems know no second name
            std::fs::copy(&place, &kept)?;
        }
        std::fs::rename(new.join(name), place)?;
        self.names.push(name);
        Ok(())
    }

    fn take_away(&mut self, name: &'a str) -> std::io::Result<()> {
        std::fs::rename(self.folder.join(name), self.before.join(name))?;
        self.names.push(name);
        Ok(())
    }
}

impl Drop for Moved<'_> {
    fn drop(&mut self) {
        for name in &self.names {
            let (place, kept) = (self.folder.join(name), self.before.join(name));
            let _ = match kept.symlink_metadata() {
                Ok(_) => std::fs::rename(kept, place),
                Err(_) => std::fs::remove_file(place),
            };
        }
    }
}

/// What the system says, without the name of a temporary file that nobody has heard of.
pub fn reason(error: &std::io::Error) -> String {
    let inner = error.get_ref().and_then(|inner| inner.source());
    let inner = inner.and_then(|inner| inner.downcast_ref::<std::io::Error>());
    inner.unwrap_or(error).to_string()
}

fn unwritable(folder: &Path, why: &str) -> Error {
    let next = "give a folder that can be written to and has room";
    Error::in_file("unwritable", format!("cannot write: {why}"), folder, next)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// `stop` is asked once for each file and once more before any is in its place.
    #[test]
    fn what_cannot_be_put_into_its_place_brings_the_others_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("old"), "before").unwrap();
        let asked = Cell::new(0);
        let block_the_last = || {
            asked.set(asked.get() + 1);
            if asked.get() == 4 {
                std::fs::create_dir(path("blocked")).unwrap();
            }
            false
        };
        let files = ["old", "new", "blocked"].map(|name| (name, b"after".to_vec()));
        let refused = replace_all(folder.path(), &files, &[], &block_the_last).unwrap_err();
        assert_eq!(refused.name(), "unwritable");
        assert_eq!(std::fs::read_to_string(path("old")).unwrap(), "before");
        assert!(!path("new").exists());
        let left = std::fs::read_dir(folder.path()).unwrap();
        assert_eq!(left.count(), 2, "the file and the folder in the way");
    }

    #[test]
    fn a_stale_file_goes_with_the_others_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let stale = folder.path().join("stale");
        std::fs::write(&stale, "before").unwrap();
        let files = [("new", b"after".to_vec())];
        assert!(replace_all(folder.path(), &files, &["stale", "gone"], &|| false).is_err());
        assert!(stale.exists() && !folder.path().join("new").exists());
        replace_all(folder.path(), &files, &["stale"], &|| false).unwrap();
        assert!(!stale.exists() && folder.path().join("new").exists());
    }
}
