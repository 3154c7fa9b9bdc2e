//! Checks on values that every log must pass: order of runs and times, sign of distances.

use std::collections::BTreeMap;

use haptical_model::Recording;

use crate::column::Role;
use crate::error::place::Place;
use crate::error::{DataError, Fault};

/// The place of a cell of the column with `role`.
pub(crate) fn cell_of(columns: &[(String, Role)], role: Role, file: &str, line: u64) -> Box<Place> {
    match columns
        .iter()
        .enumerate()
        .find(|(_, (_, other))| *other == role)
    {
        Some((index, (name, _))) => Place::cell(file, line, index + 1, name),
        None => Place::line(file, line),
    }
}

/// Refuses runs that are interrupted and times that do not increase within a run.
pub(crate) fn check(
    recording: &Recording,
    columns: &[(String, Role)],
    file: &str,
) -> Result<(), DataError> {
    let mut ended: BTreeMap<i64, u64> = BTreeMap::new();
    let mut run = None;
    let mut previous: Option<(u64, f64)> = None;
    let mut previous_line = 0;
    for (row, &line) in recording.line.iter().enumerate() {
        let this = recording.run.as_ref().map(|runs| runs[row]);
        if this != run && row > 0 {
            if let Some(run) = run {
                ended.insert(run, previous_line);
            }
            if let Some((run, &previous_line)) = this.and_then(|run| ended.get_key_value(&run)) {
                let at = cell_of(columns, Role::Run, file, line);
                return Err(at.error(Fault::RunNotContiguous {
                    run: *run,
                    previous_line,
                }));
            }
            previous = None;
        }
        run = this;
        previous_line = line;
        // An empty cell has no time to compare; the next time is compared with the last known.
        let time = recording.time_s.as_ref().map(|times| times[row]);
        let Some(time_s) = time.filter(|time| !time.is_nan()) else {
            continue;
        };
        if let Some((previous_line, previous_s)) = previous.replace((line, time_s))
            && time_s <= previous_s
        {
            let at = cell_of(columns, Role::Time, file, line);
            return Err(at.error(Fault::TimeOrder {
                time_s,
                previous_line,
                previous_s,
            }));
        }
    }
    Ok(())
}

/// Refuses negative cable distances.
pub(crate) fn check_distances(
    recording: &Recording,
    columns: &[(String, Role)],
    file: &str,
) -> Result<(), DataError> {
    for (cable, distances) in recording.cable_m.iter().enumerate() {
        let rows = recording.line.iter().zip(distances.iter().flatten());
        if let Some((&line, &value_m)) = rows.into_iter().find(|(_, value)| **value < 0.0) {
            let at = cell_of(columns, Role::Cable(cable), file, line);
            return Err(at.error(Fault::NegativeDistance { value_m }));
        }
    }
    Ok(())
}
