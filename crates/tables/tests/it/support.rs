//! Shorthands that several tests share.

use haptical_tables::{
    Applied, Cells, Mapping, Reading, Table, TableError, apply, guess, table_from_bytes,
};

pub(crate) fn table(text: &str) -> Table {
    read(text, &Reading::default()).unwrap()
}

pub(crate) fn read(text: &str, reading: &Reading) -> Result<Table, TableError> {
    table_from_bytes(text.as_bytes().to_vec(), "table.txt", reading)
}

/// Column names and cells of a table of numbers.
pub(crate) fn numbers(table: &Table) -> Vec<(&str, &[f64])> {
    let columns = table.columns.iter();
    columns
        .map(|column| (column.name.as_str(), column.cells.numbers().unwrap()))
        .collect()
}

pub(crate) fn log(texts: &[&str], mapping: &str) -> Result<Applied, TableError> {
    let mapping = Mapping::from_toml(mapping, "columns.toml")?;
    let tables = texts.iter().enumerate().map(|(file, text)| {
        let name = format!("{}.txt", file + 1);
        table_from_bytes(text.as_bytes().to_vec(), &name, &mapping.table)
    });
    let tables: Vec<Table> = tables.collect::<Result<_, _>>()?;
    apply(&tables, &mapping)
}

pub(crate) fn column(log: &Applied, name: &str) -> Vec<f64> {
    let found = log.columns.iter().find(|(own, _)| own == name);
    let found = found.unwrap_or_else(|| panic!("no {name}"));
    found.1.numbers().unwrap().to_vec()
}

pub(crate) fn texts(log: &Applied, name: &str) -> Vec<String> {
    let found = log.columns.iter().find(|(own, _)| own == name).unwrap();
    match &found.1 {
        Cells::Texts(texts) => texts.clone(),
        Cells::Numbers(_) => panic!("{name} are numbers"),
    }
}

#[track_caller]
pub(crate) fn close(found: &[f64], wanted: &[f64], within: f64) {
    assert_eq!(found.len(), wanted.len(), "{found:?} {wanted:?}");
    for (a, b) in found.iter().zip(wanted) {
        let same = (a.is_nan() && b.is_nan()) || (a - b).abs() <= within;
        assert!(same, "{found:?} {wanted:?}");
    }
}

/// Log names and sources of a proposal, with their units.
pub(crate) fn proposed(
    texts: &[&str],
    joints: &[(&str, bool)],
) -> Vec<(String, String, Option<String>)> {
    let tables: Vec<_> = texts.iter().map(|text| table(text)).collect();
    let joints: Vec<(String, bool)> = joints
        .iter()
        .map(|(name, slides)| ((*name).to_owned(), *slides))
        .collect();
    // what is left to a person
    let text = guess(&tables, &joints).replace("counts_per_turn = 0 ", "counts_per_turn = 4096 ");
    let mapping =
        Mapping::from_toml(&text, "columns.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
    let rules = mapping.column.into_iter();
    rules
        .map(|rule| {
            (
                rule.log.names()[0].clone(),
                rule.from.names()[0].clone(),
                rule.unit,
            )
        })
        .collect()
}

#[track_caller]
pub(crate) fn is(text: &str, wanted: &[(&str, &str, &str)]) {
    let found = proposed(&[text], &[]);
    let found: Vec<(&str, &str, &str)> = found
        .iter()
        .map(|(log, from, unit)| (log.as_str(), from.as_str(), unit.as_deref().unwrap_or("")))
        .collect();
    assert_eq!(found, wanted, "{text}");
}
