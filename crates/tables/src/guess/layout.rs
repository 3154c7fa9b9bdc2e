//! How several files belong together: each a run, or side by side.

use crate::mapping::{Matching, Unit};
use crate::table::Table;

/// The files of a run, and how their rows are matched.
pub(super) struct Arrangement {
    pub(super) files_per_run: usize,
    pub(super) matching: Matching,
    /// Columns of time and their units, for matching by time.
    pub(super) time: Vec<(String, String)>,
    pub(super) why: String,
}

impl Arrangement {
    pub(super) fn of(tables: &[Table]) -> Self {
        let alone = |why: &str| Self {
            files_per_run: 1,
            matching: Matching::Row,
            time: Vec::new(),
            why: why.to_owned(),
        };
        if tables.len() < 2 {
            return alone("one file");
        }
        // columns are found by their names, whatever their order
        let names = |table: &Table| -> Vec<String> {
            let names = table.columns.iter().map(|column| column.name.clone());
            let mut names: Vec<String> = names.collect();
            if table.is_named {
                names.sort();
            }
            names
        };
        let stems = |table: &Table| -> Vec<String> {
            let names = table.columns.iter();
            let mut stems: Vec<String> = names
                .map(|column| super::names::words(&column.name).join(" "))
                .collect();
            stems.sort();
            stems
        };
        let first = names(&tables[0]);
        let is_in_other_units = |table: &Table| {
            table.is_named && names(table) != first && stems(table) == stems(&tables[0])
        };
        if let Some(other) = tables[1..].iter().find(|table| is_in_other_units(table)) {
            return alone(&format!(
                "CHECK: `{}` has the columns of the first file in other units: import it with a mapping of its own",
                other.file
            ));
        }
        // the first file whose columns are the first one's again begins the second run
        let again = tables
            .iter()
            .skip(1)
            .position(|table| names(table) == first)
            .map(|place| place + 1);
        match again {
            Some(1) => return alone("all files have the same columns, so each is a run"),
            Some(files) if tables.len().is_multiple_of(files) => {
                return Self::side_by_side(&tables[..files]);
            }
            _ => {}
        }
        Self::side_by_side(tables)
    }

    fn side_by_side(run: &[Table]) -> Self {
        let lengths: Vec<usize> = run
            .iter()
            .map(|table| {
                table
                    .columns
                    .iter()
                    .map(|column| column.cells.len())
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        let files_per_run = run.len();
        let own = |matching: Matching, time: Vec<(String, String)>, why: String| Self {
            files_per_run,
            matching,
            time,
            why,
        };
        if lengths.iter().all(|length| *length == longest) && !clocks_differ(run) {
            let why = format!("the files have different columns and {longest} rows each");
            return own(Matching::Row, Vec::new(), why);
        }
        let times: Vec<(String, String)> = run.iter().filter_map(time_of).collect();
        if times.len() == run.len() {
            let why = "the files have different columns and times, and each has a column of time"
                .to_owned();
            return own(Matching::Time, times, why);
        }
        let is_multiple = lengths
            .iter()
            .all(|length| *length > 0 && longest.is_multiple_of(*length));
        let counted: Vec<String> = lengths.iter().map(usize::to_string).collect();
        match is_multiple {
            true => own(
                Matching::Repeat,
                Vec::new(),
                format!(
                    "the files have {} rows: a row of the shorter stands for several of the longest",
                    counted.join(" and ")
                ),
            ),
            false => own(
                Matching::Row,
                Vec::new(),
                format!(
                    "the files have {} rows, which do NOT match: correct this",
                    counted.join(" and ")
                ),
            ),
        }
    }
}

/// Whether two files with as many rows were read at other times: since their first rows, by more than half a step.
fn clocks_differ(run: &[Table]) -> bool {
    let since_first = |table: &Table| -> Option<Vec<f64>> {
        let (name, unit) = time_of(table)?;
        let factor = Unit::parse(&unit)?.factor;
        let column = table.columns.iter().find(|column| column.name == name)?;
        let times = column.cells.numbers()?;
        let first = times.first()?;
        Some(times.iter().map(|time| factor * (time - first)).collect())
    };
    let all: Option<Vec<Vec<f64>>> = run.iter().map(since_first).collect();
    let Some([first, others @ ..]) = all.as_deref() else {
        return false;
    };
    let half_step = 0.5 * first.last().copied().unwrap_or(0.0) / first.len().max(2) as f64;
    others.iter().any(|other| {
        let mut pairs = first.iter().zip(other);
        pairs.any(|(own, other)| (own - other).abs() > half_step.abs())
    })
}

/// The column of time of a file, and its unit.
fn time_of(table: &Table) -> Option<(String, String)> {
    let mut columns = table.columns.iter();
    let column = columns.find(|column| super::names::is_time(&column.name))?;
    Some((column.name.clone(), super::units::time_unit(column)))
}
