//! A TOML file to text: not too large, and UTF-8.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::DeviceFileError;

/// Largest file that is read \[MiB\]: two hundred times the file of a 7-joint device.
const LARGEST_MEBIBYTES: u64 = 1;

/// Reads a device file, or another TOML file, as text. A byte order mark is dropped.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("device.toml");
/// std::fs::write(&path, "[device]\nname = \"arm\"\n")?;
/// assert_eq!(haptical_model::read_toml_text(&path)?, "[device]\nname = \"arm\"\n");
/// std::fs::write(&path, vec![b'#'; (1 << 20) + 1])?;
/// let error = haptical_model::read_toml_text(&path).unwrap_err();
/// assert!(error.to_string().ends_with("larger than 1 MiB, the most that is read"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DeviceFileError::Unreadable`] from the file system, [`DeviceFileError::TooLarge`] above 1 MiB,
/// [`DeviceFileError::NotText`] for what is not UTF-8.
pub fn read_toml_text(path: &Path) -> Result<String, DeviceFileError> {
    read_text_file(path, LARGEST_MEBIBYTES)
}

/// Reads a file of at most `mebibytes` MiB as text. A byte order mark is dropped.
///
/// # Errors
/// As [`read_toml_text`].
pub fn read_text_file(path: &Path, mebibytes: u64) -> Result<String, DeviceFileError> {
    let largest = mebibytes << 20;
    let unreadable = |source| DeviceFileError::Unreadable {
        path: path.to_owned(),
        source,
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(largest + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if bytes.len() as u64 > largest {
        return Err(DeviceFileError::TooLarge {
            path: path.to_owned(),
            mebibytes,
        });
    }
    let not_text = |advice| DeviceFileError::NotText {
        path: path.to_owned(),
        advice,
    };
    if let Some(advice) = what_it_is(&bytes) {
        return Err(not_text(advice));
    }
    let text = String::from_utf8(bytes).map_err(|_| not_text("save it as UTF-8"))?;
    Ok(text
        .strip_prefix('\u{feff}')
        .map_or_else(|| text.clone(), str::to_owned))
}

/// What a file that is taken for TOML probably is.
fn what_it_is(bytes: &[u8]) -> Option<&'static str> {
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    if starts(b"\xff\xfe") || starts(b"\xfe\xff") {
        Some("it looks like UTF-16: save it as UTF-8")
    } else if starts(b"\x1f\x8b") {
        Some("it is compressed with gzip: decompress it; only logs may be compressed")
    } else if bytes.contains(&0) {
        Some("it holds zero bytes (NUL): save it as UTF-8, or copy it again")
    } else {
        None
    }
}
