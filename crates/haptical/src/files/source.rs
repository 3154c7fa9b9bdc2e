//! The files that a result was made from: names without the machine's folders, sizes, SHA-256.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::OutputFile;
use crate::error::Error;

/// Most that is read of a result.
const LARGEST_TEXT_BYTES: u64 = 64 << 20;

/// A file to read, and the name that results give it.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Where it is.
    pub path: PathBuf,
    /// Its name in results: the path as given if that is relative, otherwise its last part, so that
    /// a result says nothing of the machine's folders.
    pub label: String,
    /// Its content, where it is no file but a text in memory.
    pub text: Option<String>,
}

/// What a result says of a file that it was made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Flag that it was given by, without dashes.
    pub flag: String,
    /// Name as in [`Source::label`].
    pub file: String,
    /// Size.
    pub bytes: u64,
    /// Of the bytes as they were read, before decompression, in hexadecimal digits.
    pub sha256: String,
}

/// Size and SHA-256 of bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fingerprint {
    /// Size.
    pub bytes: u64,
    /// SHA-256.
    pub sha256: String,
}

impl Source {
    /// A file that was given on the command line.
    pub fn given(path: &Path) -> Self {
        Self {
            label: match path.is_absolute() || path.has_root() {
                true => file_name(path),
                false => path.to_string_lossy().into_owned(),
            },
            ..Self::by_path(path)
        }
    }

    /// A file that results and messages call by its whole path.
    pub fn by_path(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            label: path.display().to_string(),
            text: None,
        }
    }

    /// A text in memory, under a name of its own.
    pub fn text(text: impl Into<String>, label: &str) -> Self {
        Self {
            path: PathBuf::from(label),
            label: label.to_owned(),
            text: Some(text.into()),
        }
    }

    /// Its text.
    ///
    /// # Errors
    /// It cannot be read, or is too large.
    pub(crate) fn read_text(&self) -> Result<String, Error> {
        if let Some(text) = &self.text {
            return Ok(text.clone());
        }
        let unreadable = |error: io::Error| {
            Error::unreadable(&error, &self.path, "check the path and its permissions")
        };
        let mut text = String::new();
        let file = File::open(&self.path).map_err(unreadable)?;
        let mut part = file.take(LARGEST_TEXT_BYTES);
        part.read_to_string(&mut text).map_err(unreadable)?;
        Ok(text)
    }

    /// The path as messages give it.
    pub(crate) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// What a result says of this file.
    pub fn input(&self, flag: &str, fingerprint: Fingerprint) -> InputFile {
        InputFile {
            flag: flag.to_owned(),
            file: self.label.clone(),
            bytes: fingerprint.bytes,
            sha256: fingerprint.sha256,
        }
    }

    /// Fingerprint of a file of which the text was read: a byte order mark counts, but a pipe can be
    /// read only once.
    pub fn fingerprint_text(&self, text: &str) -> Fingerprint {
        let is_file = self.text.is_none() && self.path.is_file();
        let again = is_file.then(|| Fingerprint::of_file(&self.path).ok());
        (again.flatten()).unwrap_or_else(|| Fingerprint::from_bytes(text.as_bytes()))
    }

    /// Puts the label in the place of the path in front of warnings; of files that it includes, what the label has of the folder.
    pub fn relabel(&self, warnings: &mut [String]) {
        let path = self.path.display().to_string();
        let name = file_name(&self.path);
        let folders = path.strip_suffix(&name).zip(self.label.strip_suffix(&name));
        for warning in warnings {
            if let Some(rest) = warning.strip_prefix(&path)
                && rest.starts_with([':', ','])
            {
                *warning = format!("{}{rest}", self.label);
            } else if let Some((folder, label)) = folders.filter(|(folder, _)| !folder.is_empty())
                && let Some(rest) = warning.strip_prefix(folder)
            {
                *warning = format!("{label}{rest}");
            }
        }
    }
}

impl InputFile {
    /// The flag and the name as one argument.
    pub fn argument(&self) -> String {
        format!("--{}={}", self.flag, self.file)
    }
}

impl Fingerprint {
    /// What a result says of a file of its own with these bytes.
    pub fn output(self, name: &str) -> OutputFile {
        OutputFile {
            file: name.to_owned(),
            bytes: self.bytes,
            sha256: self.sha256,
        }
    }

    /// Of bytes in memory.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        Self {
            bytes: bytes.len() as u64,
            sha256: hexadecimal(&Sha256::digest(bytes)),
        }
    }

    /// Reads a file from end to end, a piece at a time.
    ///
    /// # Errors
    /// Those of the system.
    pub fn of_file(path: &Path) -> io::Result<Self> {
        let mut reader = HashingReader::new(File::open(path)?);
        io::copy(&mut reader, &mut io::sink())?;
        Ok(reader.fingerprint())
    }
}

/// Passes bytes on and hashes them.
pub(crate) struct HashingReader<R> {
    inner: R,
    hash: Sha256,
    bytes: u64,
}

impl<R: Read> HashingReader<R> {
    pub(crate) fn new(inner: R) -> Self {
        Self {
            inner,
            hash: Sha256::new(),
            bytes: 0,
        }
    }

    /// Of the bytes that were read so far.
    pub(crate) fn fingerprint(self) -> Fingerprint {
        Fingerprint {
            bytes: self.bytes,
            sha256: hexadecimal(&self.hash.finalize()),
        }
    }
}

impl<R: Read> Read for HashingReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.hash.update(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }
}

/// The last part of a path.
pub fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-2, appendix B.1.
    const ABC: &str = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

    #[test]
    fn the_hash_is_that_of_the_standard_by_every_way() {
        assert_eq!(Fingerprint::from_bytes(b"abc").sha256, ABC);
        let mut reader = HashingReader::new(&b"abc"[..]);
        let mut piece = [0; 2];
        assert_eq!(reader.read(&mut piece).unwrap(), 2);
        io::copy(&mut reader, &mut io::sink()).unwrap();
        let found = reader.fingerprint();
        assert_eq!((found.bytes, found.sha256.as_str()), (3, ABC));
    }

    #[test]
    fn the_folders_of_the_machine_stay_out_of_a_label() {
        let label = |path: &str| Source::given(Path::new(path)).label;
        assert_eq!(label("/home/somebody/log.csv"), "log.csv");
        assert_eq!(label("data/log.csv"), "data/log.csv");
        assert_eq!(label("../log.csv"), "../log.csv");
    }

    #[test]
    fn warnings_name_the_label() {
        let source = Source::given(Path::new("/a/log.csv"));
        let said = ["/a/log.csv:3:1: odd", "/b/log.csv: odd", "odd"];
        let mut warnings = said.map(str::to_owned);
        source.relabel(&mut warnings);
        assert_eq!(warnings, ["log.csv:3:1: odd", "/b/log.csv: odd", "odd"]);
        // a file that an MJCF includes
        let mut warnings = ["/a/parts/arm.xml:3:1: odd".to_owned()];
        source.relabel(&mut warnings);
        assert_eq!(warnings, ["parts/arm.xml:3:1: odd"]);
        let source = Source::by_path(Path::new("/a/arm.xml"));
        let mut warnings = ["/a/parts/arm.xml:3:1: odd".to_owned()];
        source.relabel(&mut warnings);
        assert_eq!(warnings, ["/a/parts/arm.xml:3:1: odd"]);
    }
}
