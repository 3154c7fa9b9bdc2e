//! An MCAP file that is still being written: read again from its first byte each time it has grown by a part, its new rows judged.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use haptical_data::{DataError, LoadedLog, LogShape, write_log_to};
use haptical_model::Recording;

use crate::error::Error;

/// First bytes of an MCAP file, and its last ones when it is complete.
pub(super) const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Share of its size by which a file has to grow until it is read again: the work of a whole recording is that of reading it
/// some twenty times.
const GROWTH: f64 = 0.05;
/// What waits, as its pose may come after it \[s\].
const WAITING_S: f64 = 1.0;

/// How far such a file was read.
#[derive(Debug, Default)]
pub(super) struct Growing {
    /// Bytes at the last reading.
    read_bytes: u64,
    /// Rows that were judged.
    rows: usize,
    is_whole: bool,
    /// Why there are no rows yet, as it was said last.
    said: Option<String>,
}

/// New rows as a text with a header, and whether there are no more to come.
#[derive(Debug, Default)]
pub(super) struct NewRows {
    pub(super) text: Vec<u8>,
    /// Rows before them.
    pub(super) behind: usize,
    pub(super) is_whole: bool,
    /// Why there are none, where that was not said before.
    pub(super) why_none: Option<String>,
}

impl Growing {
    /// The rows that are new in a file of so many bytes; `is_still` says that it had as many at the last look, `is_last` that there
    /// is no further one.
    ///
    /// # Errors
    /// A file that is damaged, at the last look also one without rows.
    pub(super) fn look(
        &mut self,
        path: &Path,
        shape: &LogShape,
        (bytes, is_still, is_last): (u64, bool, bool),
    ) -> Result<NewRows, Error> {
        let has_grown = bytes as f64 >= (1.0 + GROWTH) * self.read_bytes as f64;
        let is_new = bytes > self.read_bytes;
        if self.is_whole || !(is_last || is_new && (is_still || has_grown)) {
            return Ok(NewRows {
                is_whole: self.is_whole,
                ..NewRows::default()
            });
        }
        let unreadable = |error| super::follow::unreadable(&error, path);
        let whole = is_complete(path, bytes).map_err(unreadable)?;
        let file = File::open(path).map_err(unreadable)?;
        let name = path.display().to_string();
        let read = read_messages(BufReader::new(file).take(bytes), &name, !whole, shape);
        self.read_bytes = bytes;
        let log = match read {
            Ok(log) => log,
            // the first messages of each topic may not be there yet
            Err(error) if !whole && !is_last => {
                let why = error.to_string();
                let is_new = self.said.as_ref() != Some(&why);
                self.said = Some(why.clone());
                return Ok(NewRows {
                    why_none: is_new.then_some(why),
                    ..NewRows::default()
                });
            }
            Err(error) => return Err(Error::from(error)),
        };
        let recording = log.recording;
        let end = match whole || is_last {
            true => recording.len(),
            false => settled(&recording),
        };
        self.is_whole = whole;
        let (mut text, behind) = (Vec::new(), self.rows);
        if end > self.rows {
            let rows: Vec<usize> = (self.rows..end).collect();
            write_log_to(&mut text, &recording.select(&rows), shape)?;
            self.rows = end;
        }
        Ok(NewRows {
            text,
            behind,
            is_whole: whole,
            why_none: None,
        })
    }
}

/// The rows of the messages that are there.
#[cfg(feature = "mcap")]
fn read_messages(
    reader: impl Read,
    name: &str,
    is_growing: bool,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let options = haptical_data::BagOptions {
        is_growing,
        ..haptical_data::BagOptions::default()
    };
    haptical_data::read_bag_from(reader, name, &options, shape)
}

/// Says that this build reads no MCAP.
#[cfg(not(feature = "mcap"))]
fn read_messages(
    reader: impl Read,
    name: &str,
    _is_growing: bool,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    haptical_data::read_log_from(reader, name, shape)
}

/// Rows that no later message can belong to.
fn settled(recording: &Recording) -> usize {
    let times = recording.time_s.as_deref().unwrap_or_default();
    let last = times.last().copied().unwrap_or(f64::NEG_INFINITY);
    times.partition_point(|time| *time <= last - WAITING_S)
}

/// Whether a file ends as a complete one does.
fn is_complete(path: &Path, bytes: u64) -> std::io::Result<bool> {
    use std::io::{Seek, SeekFrom};
    let end = MAGIC.len() as u64;
    if bytes < 2 * end {
        return Ok(false);
    }
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(bytes - end))?;
    let mut last = vec![0; MAGIC.len()];
    file.read_exact(&mut last)?;
    Ok(last == MAGIC)
}

#[cfg(all(test, feature = "mcap"))]
mod tests {
    use super::*;

    /// The file as it was at each of its sizes: rows wait for their poses, why there are none is said once, and each row comes once.
    #[test]
    fn each_row_of_a_file_that_grows_comes_once() {
        let fixtures = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/tests/fixtures");
        let bytes = std::fs::read(format!("{fixtures}/none.mcap")).unwrap();
        let joint = |name: &str| haptical_data::JointShape {
            name: name.to_owned(),
            prismatic: false,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
        };
        let shape = LogShape {
            joints: vec![joint("shoulder"), joint("elbow")],
            cable_count: 0,
            hands: Vec::new(),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bag.mcap");
        let rows = |new: &NewRows| String::from_utf8_lossy(&new.text).lines().count();
        let mut growing = Growing::default();
        let (mut said, mut judged) = (0, 0);
        for size in [200, 1500, 4000, 8000, bytes.len()] {
            std::fs::write(&path, &bytes[..size]).unwrap();
            let new = growing
                .look(&path, &shape, (size as u64, false, false))
                .unwrap();
            said += usize::from(new.why_none.is_some());
            assert_eq!(new.behind, judged);
            judged += rows(&new).saturating_sub(1);
            assert_eq!(new.is_whole, size == bytes.len());
        }
        // half a second long, so that all wait for the end
        assert_eq!((judged, said), (40, 1));
        std::fs::write(&path, &bytes[..8000]).unwrap();
        let last = Growing::default()
            .look(&path, &shape, (8000, true, true))
            .unwrap();
        assert!((10..40).contains(&rows(&last)), "{}", rows(&last));
    }
}
