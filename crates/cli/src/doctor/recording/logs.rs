//! A folder of logs, each an episode, as one recording.

use std::path::{Path, PathBuf};

use super::{Label, Recorded, Unit, ends_with, tables};
use crate::failure::Failure;
use crate::flags::Units;

/// One log's episodes; a log without runs is one.
pub(super) struct Log {
    pub(super) names: Vec<String>,
    pub(super) time_s: Vec<f64>,
    pub(super) position: Vec<Vec<f64>>,
    pub(super) command: Vec<Vec<f64>>,
    /// Of each row.
    pub(super) run: Option<Vec<i64>>,
    pub(super) warnings: Vec<String>,
}

/// Reads the logs, in this order.
pub(super) fn read(files: &[PathBuf], units: Option<Units>) -> Result<Recorded, Failure> {
    let mut all: Option<Recorded> = None;
    let is_one = files.len() == 1;
    for file in files {
        let log = of_file(file)?;
        let (episodes, runs) =
            super::runs(log.run.as_deref().unwrap_or(&vec![0; log.time_s.len()]));
        let name = file
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
            .unwrap_or_default();
        let labels = runs.iter().map(|run| match (is_one, runs.len()) {
            (true, _) => Label::Number(*run),
            (false, 1) => Label::File(name.clone()),
            (false, _) => Label::File(format!("{name}, run {run}")),
        });
        let Some(all) = &mut all else {
            all = Some(Recorded {
                kind: if is_one { "log" } else { "folder of logs" }.to_owned(),
                names: log.names,
                unit: Unit::Radians,
                time_s: log.time_s,
                position: log.position,
                command: log.command,
                episodes,
                described_rows: Vec::new(),
                labels: labels.collect(),
                warnings: log.warnings,
            });
            continue;
        };
        if log.names != all.names || log.command.len() != all.command.len() {
            let said = format!(
                "it has {} joints ({}) and {} commands, the files before it {} ({}) and {}; give the logs of one arm",
                log.names.len(),
                log.names.join(", "),
                log.command.len(),
                all.names.len(),
                all.names.join(", "),
                all.command.len()
            );
            return Err(Failure::of_file("other-device", &said, file));
        }
        let before = all.time_s.len();
        all.episodes.extend(
            episodes
                .into_iter()
                .map(|rows| rows.start + before..rows.end + before),
        );
        all.labels.extend(labels);
        all.time_s.extend(log.time_s);
        for (column, more) in all.position.iter_mut().zip(log.position) {
            column.extend(more);
        }
        for (column, more) in all.command.iter_mut().zip(log.command) {
            column.extend(more);
        }
    }
    let mut all = all.ok_or_else(|| Failure::arguments("no log to read"))?;
    all.unit = Unit::of(&[&all.position, &all.command], units);
    if all.command.is_empty() {
        all.warnings.push(
            "no commands: only lost and repeated rows can be looked for; record them, as command1_rad or on a second topic".to_owned(),
        );
    }
    Ok(all)
}

fn of_file(file: &Path) -> Result<Log, Failure> {
    #[cfg(any(feature = "mcap", feature = "rosbag2"))]
    if ends_with(file, &super::BAGS) {
        return super::bags::read(file);
    }
    let _ = ends_with;
    tables::read(file)
}
