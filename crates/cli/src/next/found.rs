//! What a folder has: devices, rigs, logs and results.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use haptical::GapFile;
use haptical::files::Source;
use serde::Serialize;

/// Entries of a folder that are looked at.
const MOST_ENTRIES: usize = 1000;
/// Bytes of a file that are read to see what it is.
const MOST_BYTES: u64 = 1 << 18;
/// Files of results: no devices to begin with.
const OF_RESULTS: [&str; 3] = ["identified.toml", "corrected.toml", "rejected.toml"];

/// What a folder has, each sorted by name.
#[derive(Debug, Default, Serialize)]
pub(super) struct Found {
    /// Device files.
    pub(super) devices: Vec<String>,
    /// Files of sensors alone.
    pub(super) rigs: Vec<String>,
    /// Logs.
    pub(super) logs: Vec<FoundLog>,
    /// Tables whose columns are no log's.
    pub(super) tables: Vec<String>,
    /// Folders of LeRobot data sets.
    pub(super) data_sets: Vec<String>,
    /// Folders with `identified.toml`.
    pub(super) fits: Vec<String>,
    /// Folders with `gap.json`.
    pub(super) gaps: Vec<FoundGap>,
}

/// A diagnosis.
#[derive(Debug, Serialize)]
pub(super) struct FoundGap {
    pub(super) folder: String,
    pub(super) verdict: String,
    /// Whether a recording can be chosen that tells its candidates apart.
    pub(super) is_open: bool,
    /// Whether there is a device with its causes.
    pub(super) has_model: bool,
}

/// A log, and what it has.
#[derive(Debug, Serialize)]
pub(super) struct FoundLog {
    pub(super) name: String,
    /// Something beside the joints' own encoders: what a geometry can be fitted to.
    pub(super) has_references: bool,
    /// Torques, or commands, in time: what the diagnosis of a moving arm takes.
    pub(super) has_drives: bool,
}

/// What a file is.
enum Kind {
    Device,
    Rig,
    Log(FoundLog),
    Table,
}

impl Found {
    /// Looks into a folder, and for results into the folders in it. What cannot be read is not there.
    pub(super) fn in_folder(folder: &Path) -> Self {
        let mut found = Self::default();
        for name in names(folder) {
            let path = folder.join(&name);
            if path.is_dir() {
                found.add_results(&path, &name);
                continue;
            }
            match kind(&path, &name) {
                Some(Kind::Device) => found.devices.push(name),
                Some(Kind::Rig) => found.rigs.push(name),
                Some(Kind::Log(log)) => found.logs.push(log),
                Some(Kind::Table) => found.tables.push(name),
                None => {}
            }
        }
        found.add_results(folder, ".");
        found
    }

    fn add_results(&mut self, folder: &Path, name: &str) {
        if folder.join("meta/info.json").is_file() {
            self.data_sets.push(name.to_owned());
        }
        if folder.join("identified.toml").is_file() {
            self.fits.push(name.to_owned());
        }
        let path = folder.join("gap.json");
        if let Some(verdict) = verdict(&path) {
            self.gaps.push(FoundGap {
                folder: name.to_owned(),
                verdict,
                is_open: GapFile::open(&Source::by_path(&path)).is_ok(),
                has_model: folder.join("corrected.toml").is_file(),
            });
        }
    }
}

/// Names in a folder that are text and not hidden, sorted.
fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .take(MOST_ENTRIES)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.'))
        .collect();
    names.sort_unstable();
    names
}

fn kind(path: &Path, name: &str) -> Option<Kind> {
    let lower = name.to_ascii_lowercase();
    let bare = lower.strip_suffix(".gz").unwrap_or(&lower);
    match bare.rsplit_once('.')?.1 {
        "urdf" => Some(Kind::Device),
        "xml" => begins(path)?.contains("<mujoco").then_some(Kind::Device),
        "toml" if OF_RESULTS.contains(&bare) || bare.ends_with(".truth.toml") => None,
        "toml" => of_toml(&begins(path)?),
        "csv" | "tsv" | "txt" => of_table(path, name, lower.ends_with(".gz")),
        "parquet" | "mcap" | "db3" | "jsonl" | "ndjson" => Some(Kind::Log(FoundLog {
            name: name.to_owned(),
            has_references: true,
            has_drives: true,
        })),
        _ => None,
    }
}

fn begins(path: &Path) -> Option<String> {
    let mut bytes = Vec::new();
    let file = File::open(path).ok()?;
    file.take(MOST_BYTES).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

fn of_toml(text: &str) -> Option<Kind> {
    let table: toml::Table = text.parse().ok()?;
    let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
    if has(&["device", "joint"]) {
        return Some(Kind::Device);
    }
    let sensors = [
        "tracker",
        "contact",
        "contact_pair",
        "plane",
        "cable",
        "cable_encoder",
        "fixture",
        "tool",
    ];
    has(&sensors).then_some(Kind::Rig)
}

fn of_table(path: &Path, name: &str, is_packed: bool) -> Option<Kind> {
    let file = File::open(path).ok()?;
    let reader: Box<dyn Read> = match is_packed {
        true => Box::new(MultiGzDecoder::new(file)),
        false => Box::new(file),
    };
    let mut header = String::new();
    BufReader::new(reader.take(MOST_BYTES))
        .read_line(&mut header)
        .ok()?;
    let columns: Vec<&str> = header.split(',').map(str::trim).collect();
    let some = |starts: &[&str]| {
        let is_one = |column: &&str| starts.iter().any(|start| column.starts_with(start));
        columns.iter().any(is_one)
    };
    if !some(&["theta1_", "position1_"]) {
        // the tables that results have beside them are not data
        let is_data = !name.contains(".residuals.") && columns.len() > 1;
        return is_data.then_some(Kind::Table);
    }
    let references = ["out", "cable", "x_m", "contact", "plane", "fixture", "hand"];
    Some(Kind::Log(FoundLog {
        name: name.to_owned(),
        has_references: some(&references),
        has_drives: columns.contains(&"t_s") && some(&["torque", "force", "command"]),
    }))
}

/// The verdict of a diagnosis, `None` where there is none.
fn verdict(path: &Path) -> Option<String> {
    let file = File::open(path).ok()?;
    let read: serde_json::Value = serde_json::from_reader(BufReader::new(file)).ok()?;
    Some(read.get("verdict")?.as_str()?.to_owned())
}
