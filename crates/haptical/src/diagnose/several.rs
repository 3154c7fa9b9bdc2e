//! Several logs of one device, judged together.

use std::borrow::Cow;

use haptical_calibration::channels;
use haptical_model::{NotJoined, Recording};
use serde::Serialize;

use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// A log that was judged together with others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct LogRead {
    file: String,
    rows: usize,
}

/// Which logs were read, where there are several.
pub(super) fn read(logs: &[&Log]) -> Vec<LogRead> {
    let of = |log: &&Log| LogRead {
        file: log.source().label.clone(),
        rows: log.recording.len(),
    };
    let several = Some(logs).filter(|logs| logs.len() > 1);
    several.unwrap_or_default().iter().map(of).collect()
}

/// `a.csv (6000 rows), b.csv (3000 rows), judged together`; none for a single log.
pub(super) fn words(logs: &[LogRead]) -> Option<String> {
    let word = |log: &LogRead| format!("{} ({} rows)", log.file, log.rows);
    let words: Vec<String> = logs.iter().map(word).collect();
    (!words.is_empty()).then(|| format!("{}, judged together", words.join(", ")))
}

/// The logs as one recording, each with runs of its own.
pub(crate) fn joined<'l>(logs: &[&'l Log]) -> Result<Cow<'l, Recording>, Error> {
    let (&first, others) = logs
        .split_first()
        .ok_or_else(|| Error::internal("a diagnosis without a log"))?;
    if others.is_empty() {
        return Ok(Cow::Borrowed(first.recording.as_ref()));
    }
    for (index, log) in logs.iter().enumerate() {
        if logs[..index].iter().any(|other| is_same(other, log)) {
            let said =
                "the same log is given twice: its rows would count twice; give each recording once";
            return Err(Error::of_file("same-log", said, &log.source().path));
        }
    }
    let recordings: Vec<&Recording> = logs.iter().map(|log| log.recording.as_ref()).collect();
    Recording::joined(&recordings)
        .map(Cow::Owned)
        .map_err(|refused| not_joined(&refused, logs))
}

fn not_joined(refused: &NotJoined, logs: &[&Log]) -> Error {
    let path = |index: usize| logs.get(index).map(|log| log.source().path.as_path());
    let (what, at) = match refused {
        NotJoined::Column {
            column,
            with,
            without,
        } => {
            let there = path(*with).unwrap_or("".as_ref()).display();
            let what = format!(
                "it has no {column}, and {there} has: logs that are judged together have the same sensors"
            );
            (what, *without)
        }
        NotJoined::Joints { index, .. } => (refused.to_string(), *index),
    };
    let next = "record both with the same sensors, leave the column out of the log that has it, or diagnose the logs one \
                by one";
    Error::in_file("other-columns", what, path(at).unwrap_or("".as_ref()), next)
}

/// A copy that was compressed or renamed has the same readings.
fn is_same(first: &Log, second: &Log) -> bool {
    let hash = |log: &Log| log.input("log").map(|file| file.sha256);
    let same_file = hash(first).is_some() && hash(first) == hash(second);
    same_file || first.recording == second.recording
}

/// Rows of the fit say nothing of rows that the fit did not see: the second log must be another one.
pub(super) fn refuse_same_log(first: &Log, second: &Log) -> Result<(), Error> {
    if !is_same(first, second) {
        return Ok(());
    }
    let said = "the log of --validate is that of --log: the fit has seen every row of it; give --validate another recording of the \
                same device, or leave it out: then blocks of the log are held back from the fit";
    Err(Error::of_file("same-log", said, &second.source().path))
}

/// A second log without any reading of what the first one shows is told from the first.
pub(super) fn refuse_without_readings(
    device: &Device,
    first: &Recording,
    second: &Log,
) -> Result<(), Error> {
    let shown = |log: &Recording| channels(&device.model, log);
    let (Ok(known), Err(_)) = (shown(first), shown(&second.recording)) else {
        return Ok(());
    };
    let mut names: Vec<String> = known.iter().map(|channel| channel.name()).collect();
    names.dedup();
    let names = names.join(", ");
    let what =
        format!("the log of --validate has no reading of a sensor; that of --log has {names}");
    let next = "give --validate a recording with the same sensors, or leave it out: then blocks of the log are held back from the fit";
    Err(Error::in_file(
        "no-readings",
        what,
        &second.source().path,
        next,
    ))
}
