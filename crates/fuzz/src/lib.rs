//! Shared by the fuzz targets in `tests/`: files to start from, and random changes of them.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// One random change of a file: kind, place, and a number.
pub type Edit = (u8, u16, u8);

/// Most changes of one file.
const MOST_EDITS: usize = 5;

/// Words that readers treat in their own ways.
const WORDS: [&str; 28] = [
    "nan",
    "-inf",
    "1e308",
    "-1e308",
    "1e12",
    "1e-300",
    "1e-320",
    "0",
    "-1",
    "99999999999999999999",
    "\"",
    "\"\"\"",
    "[",
    "]",
    "[[joint]]\n",
    "[[link]]\n",
    "{",
    "}",
    "=",
    ",",
    ";",
    "\t",
    "\n",
    "\r",
    "\0",
    "\u{feff}",
    "\u{e9}",
    "#",
];

/// Folder of the project's fixtures.
fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures")
}

/// The files of `fixtures/bad` whose names start with one of `kinds`, and the files `others` of
/// `fixtures`, in the order of their names.
///
/// # Errors
/// From the file system.
pub fn seeds(kinds: &[&str], others: &[&str]) -> std::io::Result<Vec<Vec<u8>>> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(fixtures().join("bad"))?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<std::io::Result<_>>()?;
    let is_kind = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        kinds.iter().any(|kind| name.starts_with(kind))
    };
    paths.retain(is_kind);
    paths.sort();
    paths.extend(others.iter().map(|name| fixtures().join(name)));
    paths.into_iter().map(std::fs::read).collect()
}

/// The file number `pick` with these changes.
///
/// ```
/// use haptical_fuzz::mutated;
///
/// let seeds = [b"a = 1\n".to_vec(), b"b = 2\n".to_vec()];
/// assert_eq!(mutated(&seeds, 3, &[]), b"b = 2\n");
/// assert_eq!(mutated(&seeds, 0, &[(0, 4, b'1' ^ b'7')]), b"a = 7\n");
/// assert_eq!(mutated(&seeds, 0, &[(4, 1, 0)]), b"a");
/// assert_eq!(mutated(&seeds, 0, &[(5, 4, 0)]), b"a = nan1\n");
/// ```
pub fn mutated(seeds: &[Vec<u8>], pick: u16, edits: &[Edit]) -> Vec<u8> {
    let Some(seed) = seeds.get(usize::from(pick) % seeds.len().max(1)) else {
        return Vec::new();
    };
    let mut bytes = seed.clone();
    // Few changes, or nothing but the first complaint of a reader is ever reached.
    let most = 1 + usize::from(pick >> 8) % MOST_EDITS;
    for &(kind, place, number) in edits.iter().take(most) {
        let at = usize::from(place) % (bytes.len() + 1);
        let end = bytes.len().min(at + usize::from(number));
        match kind % 7 {
            0 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= number;
                }
            }
            1 => bytes.insert(at, number),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(end..end, copy);
            }
            4 => bytes.truncate(at),
            5 => {
                let word = WORDS[usize::from(number) % WORDS.len()];
                bytes.splice(at..at, word.bytes());
            }
            _ => bytes[at..end].reverse(),
        }
    }
    bytes
}

/// How long each target runs: none for a number of rounds.
pub fn seconds() -> Option<Duration> {
    let text = std::env::var("HAPTICAL_FUZZ_SECONDS").ok()?;
    text.parse().ok().map(Duration::from_secs)
}

/// The target with its bounds: `$rounds` rounds, or the time that is asked for.
#[macro_export]
macro_rules! bounded {
    ($check:expr, $rounds:expr) => {
        match $crate::seconds() {
            Some(time) => $check.with_test_time(time),
            None => $check.with_iterations($rounds),
        }
    };
}
