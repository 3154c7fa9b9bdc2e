//! Which rows of files side by side make a row of the log.

use haptical_data::{nearest, usual_distance_ns};

use super::cells::number_of;
use super::{Source, source};
use crate::error::TableError;
use crate::mapping::{Mapping, Matching, RowRules, Unit};
use crate::table::Table;

/// The rows of a run.
pub(super) struct Matched {
    /// Rows before any were left out, counted from 0: those that are taken.
    pub(super) rows: Vec<usize>,
    /// For each file its row of each of them; none where no row is near in time.
    of_file: Vec<Vec<Option<usize>>>,
    pub(super) warnings: Vec<String>,
}

impl Matched {
    /// A file's rows, row by row of the log.
    pub(super) fn of(&self, file: usize) -> impl Iterator<Item = Option<usize>> + '_ {
        let rows = self.of_file.get(file).map_or(&[][..], Vec::as_slice);
        rows.iter().copied()
    }
}

/// Matches the rows of the files of a run.
pub(super) fn rows(run: &[Table], mapping: &Mapping) -> Result<Matched, TableError> {
    let lengths = lengths(run, mapping)?;
    let rules = &mapping.rows;
    let all = || run.iter().flat_map(|table| &table.columns);
    let longest = lengths.iter().flatten().copied().max();
    // a mapping of values alone has as many rows as the files
    let longest = longest.or_else(|| all().map(|column| column.cells.len()).max());
    let longest = longest.unwrap_or(0);
    let length_of = |file: usize| lengths[file].unwrap_or(longest);
    let mut warnings = Vec::new();
    let mut of_file: Vec<Vec<Option<usize>>> = match rules.matching {
        Matching::Row | Matching::Repeat => {
            let repeated = |file: usize| {
                let own = length_of(file);
                let is_repeat = rules.matching == Matching::Repeat;
                let times = longest / own.max(1);
                match own * times == longest && own > 0 && (times == 1 || is_repeat) {
                    true => Ok((0..longest).map(|row| Some(row / times)).collect()),
                    false => Err(unequal(run, &lengths, is_repeat)),
                }
            };
            (0..run.len()).map(repeated).collect::<Result<_, _>>()?
        }
        Matching::Time => by_time(run, rules, &mut warnings)?,
    };
    let (first, every) = (rules.first.unwrap_or(1) - 1, rules.every.unwrap_or(1));
    let all = of_file.first().map_or(0, Vec::len);
    let rows: Vec<usize> = (first..all).step_by(every).collect();
    for file in &mut of_file {
        *file = rows.iter().map(|&row| file[row]).collect();
    }
    if rows.is_empty() {
        let what = format!("no row is taken: the file has {all}");
        return Err(TableError::new(
            "no-rows",
            what,
            &run[0].file,
            "correct `first` in [rows]",
        ));
    }
    Ok(Matched {
        rows,
        of_file,
        warnings,
    })
}

fn unequal(run: &[Table], lengths: &[Option<usize>], is_repeat: bool) -> TableError {
    let named = run.iter().zip(lengths);
    let named =
        named.filter_map(|(table, length)| Some(format!("{} has {}", table.file, (*length)?)));
    let what = format!(
        "rows that do not match: {}",
        named.collect::<Vec<String>>().join(", ")
    );
    let next = match is_repeat {
        true => "with match = \"repeat\" the longest has a multiple of the others' rows",
        false => {
            "say match = \"repeat\" in [rows] where a row stands for several, or match = \"time\""
        }
    };
    TableError::new("row-count", what, &run[0].file, next)
}

/// The columns that the mapping takes from files.
fn sources(run: &[Table], mapping: &Mapping) -> Result<Vec<Source>, TableError> {
    let mut found = Vec::new();
    for rule in &mapping.column {
        for from in rule.from.names() {
            found.push(source(run, rule.file, from)?);
        }
    }
    if let Some(orientation) = &mapping.orientation {
        for from in &orientation.from {
            found.push(source(run, orientation.file, from)?);
        }
    }
    Ok(found)
}

/// Rows of each file: those of the columns that are used; none of a file without one.
fn lengths(run: &[Table], mapping: &Mapping) -> Result<Vec<Option<usize>>, TableError> {
    let mut lengths: Vec<Option<usize>> = vec![None; run.len()];
    for (file, column) in sources(run, mapping)? {
        let table = &run[file];
        let own = table.columns[column].cells.len();
        match lengths[file] {
            None => lengths[file] = Some(own),
            Some(length) if length == own => {}
            Some(length) => {
                let name = &table.columns[column].name;
                let what =
                    format!("column `{name}` has {own} rows, the columns before it {length}");
                let next = "give arrays of different lengths as files of their own, or say transpose = true in [table]";
                return Err(TableError::new("row-count", what, &table.file, next));
            }
        }
    }
    Ok(lengths)
}

fn refuse<T>(what: String, file: &str, next: &str) -> Result<T, TableError> {
    Err(TableError::new("no-time", what, file, next))
}

/// The rows of each file that are nearest to those of the first.
fn by_time(
    run: &[Table],
    rules: &RowRules,
    warnings: &mut Vec<String>,
) -> Result<Vec<Vec<Option<usize>>>, TableError> {
    let names = rules.time.names();
    if names.len() != 1 && names.len() != run.len() {
        let what = format!(
            "{} columns of time in [rows] for {} files",
            names.len(),
            run.len()
        );
        return refuse(
            what,
            &run[0].file,
            "name the column of time of each file, time = [\"t\", \"stamp\"]",
        );
    }
    let units = rules.time_unit.names();
    if units.len() > 1 && units.len() != run.len() {
        let what = format!(
            "{} units of time in [rows] for {} files",
            units.len(),
            run.len()
        );
        return refuse(
            what,
            &run[0].file,
            "give one time_unit, or one for each file",
        );
    }
    let unit = |file: usize| {
        let word = units.get(file).or(units.first());
        (word.and_then(|word| Unit::parse(word))).map_or(1.0, |unit| unit.factor)
    };
    let mut times = Vec::new();
    for (file, table) in run.iter().enumerate() {
        let column = table.find(names.get(file).unwrap_or(&names[0]))?;
        let count = table.columns[column].cells.len();
        let own: Result<Vec<f64>, TableError> = (0..count)
            .map(|row| match number_of(table, column, row)? {
                time if time.is_finite() => Ok(time),
                _ => {
                    let what = "a row without a time".to_owned();
                    let refusal: Result<f64, TableError> =
                        refuse(what, &table.file, "delete the row");
                    refusal.map_err(|error| error.at(table.line(row), Some(column as u64 + 1)))
                }
            })
            .collect();
        times.push(own?);
    }
    // in the file's own unit, so that times since 1970 lose nothing but their last digit
    let zero_s = times[0].first().copied().unwrap_or(0.0) * unit(0);
    let stamps = times.iter().enumerate().map(|(file, own)| {
        let zero = zero_s / unit(file);
        let since_ns = |time: &f64| ((time - zero) * unit(file) * 1e9).round() as i64;
        own.iter().map(since_ns).collect()
    });
    let stamps: Vec<Vec<i64>> = stamps.collect();
    if let Some(row) = stamps[0].windows(2).position(|pair| pair[1] <= pair[0]) {
        let what = "the time does not increase".to_owned();
        let next = "sort the rows by time, and delete repeated ones";
        return refuse(what, &run[0].file, next)
            .map_err(|error: TableError| error.at(run[0].line(row + 1), None));
    }
    let most = rules.within_s.map(|within_s| (within_s * 1e9) as u64);
    let most = most.unwrap_or(usual_distance_ns(&stamps[0]) / 2);
    let mut of_file = vec![
        (0..stamps[0].len())
            .map(Some)
            .collect::<Vec<Option<usize>>>(),
    ];
    for (table, own) in run.iter().zip(&stamps).skip(1) {
        let found = nearest(&stamps[0], own, most);
        if found.of_row.iter().all(Option::is_none) {
            let what = format!(
                "no row is within {} s of one of {}",
                most as f64 / 1e9,
                run[0].file
            );
            return refuse(
                what,
                &table.file,
                "correct time, time_unit or within_s in [rows]",
            );
        }
        if found.left_out > 0 {
            warnings.push(format!(
                "{}: {} of {} rows are left out: another is nearer in time, or no row of {} is near",
                table.file, found.left_out, own.len(), run[0].file
            ));
        }
        if found.farthest_ns > 0 {
            let away_s = found.farthest_ns as f64 / 1e9;
            warnings.push(format!(
                "{}: rows are up to {away_s} s away from those of {}; in motion that is an error",
                table.file, run[0].file
            ));
        }
        of_file.push(found.of_row);
    }
    Ok(of_file)
}
