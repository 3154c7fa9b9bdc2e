//! Some rows of a recording for what need not see all of them.

use std::collections::BTreeMap;

use haptical_model::Recording;

/// Rows from which a search begins where that on some of them ended, and how many these are of each kind.
const LONG: usize = 4000;
const SOME: usize = 2000;

/// At most so many rows, spread evenly.
pub(crate) fn spread_rows(rows: usize, most: usize) -> Vec<usize> {
    let count = rows.min(most);
    (0..count).map(|index| index * rows / count).collect()
}

/// Some rows of a long recording; none for a short one, or one of so many kinds of rows that these are most of it.
pub(crate) fn some_of_long(recording: &Recording) -> Option<Recording> {
    if recording.len() < LONG {
        return None;
    }
    let rows = some_of_each_kind(recording, SOME, usize::MAX);
    (2 * rows.len() <= recording.len()).then(|| recording.select(&rows))
}

/// At most so many rows of each kind and about so many in all, ascending.
///
/// Of each kind they are spread evenly: a log of one clock may have every hundredth row read by the tracker, and evenly
/// spread rows would miss all of these.
pub(crate) fn some_of_each_kind(recording: &Recording, most: usize, in_all: usize) -> Vec<usize> {
    let mut kinds: BTreeMap<Kind<'_>, Vec<usize>> = BTreeMap::new();
    for row in 0..recording.len() {
        let kind = Kind::of(recording, row);
        kinds.entry(kind).or_default().push(row);
    }
    let most = most.min(in_all.div_ceil(kinds.len().max(1)));
    let some = |rows: &Vec<usize>| {
        let spread = spread_rows(rows.len(), most).into_iter();
        spread.map(|place| rows[place]).collect::<Vec<usize>>()
    };
    let mut rows: Vec<usize> = kinds.values().flat_map(some).collect();
    rows.sort_unstable();
    rows
}

/// What a row is about, and which readings it has.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Kind<'r> {
    run: i64,
    /// Hand, tool, touched point and plane.
    ids: [Option<&'r str>; 4],
    /// A bit for each column of readings; columns beyond the last bit share them.
    readings: u64,
}

impl<'r> Kind<'r> {
    fn of(recording: &'r Recording, row: usize) -> Self {
        let id = |ids: &'r Option<Vec<String>>| ids.as_ref().map(|ids| ids[row].as_str());
        let position = recording.position_m.iter().flatten();
        let orientation = recording.orientation_wxyz.iter().flatten();
        let others = recording.cable_m.iter().chain(&recording.output).flatten();
        let mut readings = 0;
        for (place, column) in position.chain(orientation).chain(others).enumerate() {
            readings |= u64::from(column[row].is_finite()) << (place % 64);
        }
        Self {
            run: recording.run_at(row),
            ids: [
                &recording.hand,
                &recording.tool,
                &recording.contact,
                &recording.plane,
            ]
            .map(id),
            readings,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tracker that reads every fiftieth row of a fast log, beside every row that an even spread would take.
    #[test]
    fn rows_with_rare_readings_are_among_some() {
        let rows = 2 * LONG;
        let seen = |row: usize| if row % 50 == 7 { 0.1 } else { f64::NAN };
        let mut recording = Recording {
            line: (2..rows as u64 + 2).collect(),
            joint: vec![vec![0.0; rows]],
            position_m: Some([(); 3].map(|()| (0..rows).map(seen).collect())),
            ..Recording::default()
        };
        let some = some_of_long(&recording).unwrap();
        let of_some = some.position_m.as_ref().map(|axes| &axes[0]).unwrap();
        let read = of_some.iter().filter(|value| value.is_finite()).count();
        assert_eq!((read, some.len()), (rows / 50, rows / 50 + SOME));
        assert!(some.line.is_sorted());
        recording.run = Some((0..rows as i64).collect());
        assert!(some_of_long(&recording).is_none());
    }
}
