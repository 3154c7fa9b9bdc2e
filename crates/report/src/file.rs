//! Writing a file so that a reader sees either the old or the new content, never a part.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::ReportError;

/// Writes `bytes` to `path` through a temporary file in the same folder and a rename.
///
/// Missing parent folders are created. A file that exists is replaced; a symbolic link at `path` is
/// replaced, not followed. When anything fails the temporary file is removed and an existing file
/// keeps its content.
///
/// # Errors
/// [`ReportError::Write`] with the path and the answer of the operating system.
///
/// # Examples
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("results/table.csv");
/// haptical_report::write_atomically(&path, b"a,b\n")?;
/// assert_eq!(std::fs::read(&path)?, b"a,b\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let failure = |source| ReportError::Write {
        path: path.to_owned(),
        source,
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    std::fs::create_dir_all(&folder).map_err(failure)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".haptical-");
    // A temporary file is private by default; a result is as readable as any other new file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(&folder).map_err(failure)?;
    file.write_all(bytes).map_err(failure)?;
    file.as_file().sync_all().map_err(failure)?;
    file.persist(path).map_err(|error| failure(error.error))?;
    Ok(())
}
