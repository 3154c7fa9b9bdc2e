//! Where rows come from: a file that grows, a folder into which files arrive, a pipe.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{File, Metadata};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::SystemTime;

use haptical_data::{LogShape, known_file, write_log_to};

use super::growing::{Growing, MAGIC};
use super::lines::Cutter;
use super::{Watch, WatchEvent};
use crate::error::Error;
use crate::files::Source;
use crate::log::Log;

/// Bytes that are read at a time.
const PIECE_BYTES: usize = 1 << 18;
/// Pieces of a pipe that wait to be judged.
const WAITING_PIECES: usize = 4;
/// Ends of names of logs in a folder.
const LOGS: [&str; 8] = [
    ".csv", ".csv.gz", ".jsonl", ".ndjson", ".mcap", ".parquet", ".db3", ".txt",
];

/// A source of rows.
#[derive(Debug)]
pub struct Feed(Kind);

#[derive(Debug)]
enum Kind {
    File(Box<Tail>),
    Folder(Folder),
    Pipe(Pipe),
}

/// What a look at the source brought.
#[derive(Debug, Default)]
pub struct Fed {
    /// What happened.
    pub events: Vec<WatchEvent>,
    /// Whether there was something new.
    pub grew: bool,
    /// Whether nothing more can come.
    pub ended: bool,
}

impl Feed {
    /// Rows of a file that may grow, or of the files of a folder.
    ///
    /// # Errors
    /// There is no such file or folder.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let meta = std::fs::metadata(path).map_err(|error| unreadable(&error, path))?;
        Ok(Self(match meta.is_dir() {
            true => Kind::Folder(Folder::new(path)),
            false => Kind::File(Box::new(Tail::new(path))),
        }))
    }

    /// Rows of a reader such as standard input, read by a thread of its own.
    pub fn pipe(mut reader: impl Read + Send + 'static, name: &str) -> Self {
        let (sender, pieces) = sync_channel(WAITING_PIECES);
        std::thread::spawn(move || {
            let mut piece = vec![0; PIECE_BYTES];
            loop {
                match reader.read(&mut piece) {
                    Ok(0) => return,
                    Ok(count) if sender.send(Ok(piece[..count].to_vec())).is_err() => return,
                    Ok(_) => {}
                    Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                    Err(error) => {
                        let _ = sender.send(Err(error));
                        return;
                    }
                }
            }
        });
        Self(Kind::Pipe(Pipe {
            pieces,
            cutter: Cutter::default(),
            name: name.to_owned(),
            has_begun: false,
        }))
    }

    /// Judges what has come since the last look, a piece of it at most. With `is_last` files count as complete.
    ///
    /// # Errors
    /// As [`Watch::text`]; a source that cannot be read.
    pub fn look(&mut self, watch: &mut Watch, is_last: bool) -> Result<Fed, Error> {
        match &mut self.0 {
            Kind::File(tail) => tail.look(watch, is_last),
            Kind::Folder(folder) => folder.look(watch, is_last),
            Kind::Pipe(pipe) => pipe.look(watch),
        }
    }
}

#[derive(Debug)]
struct Pipe {
    pieces: Receiver<std::io::Result<Vec<u8>>>,
    cutter: Cutter,
    name: String,
    has_begun: bool,
}

impl Pipe {
    fn look(&mut self, watch: &mut Watch) -> Result<Fed, Error> {
        if !std::mem::replace(&mut self.has_begun, true) {
            watch.begin(&self.name);
        }
        let mut fed = Fed::default();
        match self.pieces.try_recv() {
            Ok(Ok(piece)) => {
                fed.grew = true;
                let parts = self.cutter.take(&piece);
                let left_out = std::mem::take(&mut self.cutter.left_out);
                fed.events = watch.parts(parts, left_out)?;
            }
            Ok(Err(error)) => {
                let next = "check where it comes from";
                return Err(Error::unreadable(&error, Path::new(&self.name), next));
            }
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => {
                fed.ended = true;
                fed.events.extend(half_line(&self.cutter, &self.name));
            }
        }
        Ok(fed)
    }
}

pub(super) fn unreadable(error: &std::io::Error, path: &Path) -> Error {
    Error::unreadable(error, path, "check the path and its permissions")
}

/// Says that a last line without an end is not judged.
fn half_line(cutter: &Cutter, name: &str) -> Option<WatchEvent> {
    let text = format!("{name}: the last line has no end and is not judged");
    (cutter.waiting() > 0).then(|| WatchEvent::note(text))
}

/// A file that grows; it may be cut, or replaced by another of its name.
#[derive(Debug)]
struct Tail {
    path: PathBuf,
    open: Option<(File, u64)>,
    offset: u64,
    cutter: Cutter,
    /// Size at the last look of a file that is read as a whole, or whether it was read.
    size: Option<u64>,
    is_done: bool,
    growing: Growing,
}

impl Tail {
    fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            open: None,
            offset: 0,
            cutter: Cutter::default(),
            size: None,
            is_done: false,
            growing: Growing::default(),
        }
    }

    fn name(&self) -> String {
        Source::given(&self.path).label
    }

    fn look(&mut self, watch: &mut Watch, is_last: bool) -> Result<Fed, Error> {
        let refuse = |error: std::io::Error| unreadable(&error, &self.path);
        let mut fed = Fed::default();
        let there = std::fs::metadata(&self.path).ok();
        if self.open.is_none() {
            let Some(meta) = &there else {
                fed.ended = is_last;
                return Ok(fed);
            };
            let file = File::open(&self.path).map_err(refuse)?;
            self.open = Some((file, identity(meta)));
            self.offset = 0;
            self.cutter = Cutter::default();
            watch.begin(&self.name());
        }
        let Some((file, own)) = &mut self.open else {
            return Ok(fed);
        };
        let size = file.metadata().map_err(refuse)?.len();
        if size < self.offset {
            let name = Source::given(&self.path).label;
            let text = format!("{name}: the file was cut; its rows from here on follow");
            fed.events.push(WatchEvent::note(text));
            self.open = None;
            fed.grew = true;
            return Ok(fed);
        }
        if self.offset == 0 {
            let first = first_bytes(file).map_err(refuse)?;
            if first.starts_with(MAGIC) {
                return self.growing(watch, size, is_last);
            }
            if is_binary(&first) {
                return self.whole(watch, size, is_last);
            }
            if let Some((what, next)) = known_file(&first) {
                let is_said = std::mem::replace(&mut self.is_done, true);
                let text = format!("{}: this is {what}, which is no log: {next}", self.name());
                fed.events
                    .extend((!is_said).then(|| WatchEvent::note(text)));
                fed.ended = is_last;
                return Ok(fed);
            }
        }
        file.seek(SeekFrom::Start(self.offset)).map_err(refuse)?;
        let mut piece = Vec::with_capacity(PIECE_BYTES.min((size - self.offset) as usize));
        let mut part = file.take(PIECE_BYTES as u64);
        part.read_to_end(&mut piece).map_err(refuse)?;
        let is_replaced = there.as_ref().is_some_and(|meta| identity(meta) != *own);
        if piece.is_empty() {
            if is_replaced {
                let text = format!("{}: another file has taken its place", self.name());
                fed.events.extend(half_line(&self.cutter, &self.name()));
                fed.events.push(WatchEvent::note(text));
                self.open = None;
                fed.grew = true;
            } else if is_last {
                fed.events.extend(half_line(&self.cutter, &self.name()));
                fed.ended = true;
            }
            return Ok(fed);
        }
        fed.grew = true;
        self.offset += piece.len() as u64;
        let parts = self.cutter.take(&piece);
        let left_out = std::mem::take(&mut self.cutter.left_out);
        fed.events.extend(watch.parts(parts, left_out)?);
        Ok(fed)
    }

    /// An MCAP file, which may be one that is being written.
    fn growing(&mut self, watch: &mut Watch, size: u64, is_last: bool) -> Result<Fed, Error> {
        if self.is_done {
            return Ok(Fed {
                ended: is_last,
                ..Fed::default()
            });
        }
        let is_still = self.size.replace(size) == Some(size);
        let shape = LogShape::from(&watch.device.model);
        let new = (self.growing).look(&self.path, &shape, (size, is_still, is_last))?;
        let mut fed = Fed::default();
        self.is_done = new.is_whole || is_last;
        fed.grew = !new.text.is_empty();
        let why_none = new.why_none.map(|why| format!("no rows yet: {why}"));
        fed.events.extend(why_none.map(WatchEvent::note));
        fed.events
            .extend(in_pieces(watch, Cutter::behind(new.behind), &new.text)?);
        Ok(fed)
    }

    /// A file that cannot be read by lines: once, when it no longer grows.
    fn whole(&mut self, watch: &mut Watch, size: u64, is_last: bool) -> Result<Fed, Error> {
        let mut fed = Fed::default();
        let is_still = self.size.replace(size) == Some(size);
        if self.is_done || !(is_still || is_last) {
            fed.ended = self.is_done && is_last;
            return Ok(fed);
        }
        let log = Log::read(&self.path, &watch.device)?;
        let mut text = Vec::new();
        let shape = LogShape::from(&watch.device.model);
        write_log_to(&mut text, &log.recording, &shape)?;
        self.is_done = true;
        fed.events = in_pieces(watch, Cutter::default(), &text)?;
        fed.grew = true;
        Ok(fed)
    }
}

/// Judges a whole text.
fn in_pieces(watch: &mut Watch, mut cutter: Cutter, text: &[u8]) -> Result<Vec<WatchEvent>, Error> {
    let mut events = Vec::new();
    for piece in text.chunks(PIECE_BYTES) {
        events.extend(watch.parts(cutter.take(piece), 0)?);
    }
    Ok(events)
}

/// What tells a file from another of its name.
#[cfg(unix)]
fn identity(meta: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::ino(meta)
}

/// What tells a file from another of its name: nothing that is stable here, so that only a cut is seen.
#[cfg(not(unix))]
fn identity(_: &Metadata) -> u64 {
    0
}

/// The bytes by which a file of a program is known.
fn first_bytes(file: &mut File) -> std::io::Result<Vec<u8>> {
    let mut first = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(16).read_to_end(&mut first)?;
    Ok(first)
}

/// Whether a file is gzip, Parquet or SQLite.
fn is_binary(first: &[u8]) -> bool {
    const WHOLE: [&[u8]; 3] = [b"\x1f\x8b", b"PAR1", b"SQLite format 3"];
    WHOLE.iter().any(|magic| first.starts_with(magic))
}

/// A folder into which logs arrive; they are judged in the order of their times of change, then of their names.
#[derive(Debug)]
struct Folder {
    path: PathBuf,
    done: BTreeSet<OsString>,
    now: Option<(OsString, Tail)>,
}

impl Folder {
    fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            done: BTreeSet::new(),
            now: None,
        }
    }

    /// The next file that was not judged, and whether there is another one behind it.
    fn next(&mut self) -> Result<Option<OsString>, Error> {
        let unreadable = |error: std::io::Error| {
            Error::unreadable(&error, &self.path, "check the folder and its permissions")
        };
        let mut waiting: Vec<(SystemTime, OsString)> = Vec::new();
        let mut there = BTreeSet::new();
        for entry in std::fs::read_dir(&self.path).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let name = entry.file_name();
            let text = name.to_string_lossy().to_lowercase();
            let is_log = !text.starts_with('.') && LOGS.iter().any(|end| text.ends_with(end));
            // gone between the listing and this look
            let Ok(meta) = entry.metadata() else { continue };
            if !is_log || !meta.is_file() {
                continue;
            }
            there.insert(name.clone());
            if !self.done.contains(&name) {
                waiting.push((meta.modified().unwrap_or(SystemTime::UNIX_EPOCH), name));
            }
        }
        self.done.retain(|name| there.contains(name));
        let now = self.now.as_ref().map(|(name, _)| name);
        let others = waiting.into_iter().filter(|(_, name)| Some(name) != now);
        Ok(others.min().map(|(_, name)| name))
    }

    fn look(&mut self, watch: &mut Watch, is_last: bool) -> Result<Fed, Error> {
        let next = self.next()?;
        let Some((name, tail)) = &mut self.now else {
            let ended = next.is_none() && is_last;
            self.now = next.map(|name| {
                let tail = Tail::new(&self.path.join(&name));
                (name, tail)
            });
            return Ok(Fed {
                grew: self.now.is_some(),
                ended,
                ..Fed::default()
            });
        };
        // a file is complete when another one has come after it
        let mut fed = match tail.look(watch, is_last || next.is_some()) {
            Ok(fed) => fed,
            // a file of another device, or one that is damaged, ends no watch of a folder
            Err(error) if watch.model.is_some() => Fed {
                events: vec![WatchEvent::note(format!("left out: {error}"))],
                grew: true,
                ended: true,
            },
            Err(error) => return Err(error),
        };
        if fed.ended || (tail.is_done && next.is_some()) {
            self.done.insert(name.clone());
            self.now = None;
            fed.grew = true;
            fed.ended = false;
        }
        Ok(fed)
    }
}
