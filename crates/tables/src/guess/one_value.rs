//! Files with one value a line, which have the columns of a log one below the other: they are named, and not taken apart.

use std::collections::BTreeSet;

use super::names::is_time;
use crate::table::{Cells, Column, Table};

/// What to do with a file that has one value a line; none of other files.
pub(super) fn advice(table: &Table) -> Option<String> {
    let (texts, numbers): (Vec<&Column>, Vec<&Column>) = (table.columns.iter())
        .filter(|column| !is_time(&column.name))
        .partition(|column| matches!(column.cells, Cells::Texts(_)));
    let [number] = numbers[..] else {
        return None;
    };
    let name = |column: &Column| column.name.replace('\'', "");
    let (index, value) = (
        table.columns.iter().find(|entry| is_time(&entry.name)),
        name(number),
    );
    if texts.is_empty() && index.is_none() && !table.is_named {
        return Some(
            "The file has one value a line and no names. Write the values of a row into one line, such as with NumPy: \
             savetxt('rows.txt', loadtxt(FILE).reshape(-1, VALUES_IN_A_ROW))."
                .to_owned(),
        );
    }
    let names = texts.iter().find(|column| repeats(column))?;
    let (names, index) = (name(names), index.map(name));
    Some(match index {
        Some(index) => format!(
            "The file has one value a line, and `{names}` says whose. Make a column of each name, such as with pandas: \
             read_csv(FILE).pivot(index='{index}', columns='{names}', values='{value}').to_csv('rows.csv')."
        ),
        None => format!(
            "The file has one value a line, and column `{names}` says whose. Make a column of each name, and write the values that \
             belong together into one line."
        ),
    })
}

/// Whether each of a few names is there several times.
fn repeats(column: &Column) -> bool {
    let Cells::Texts(cells) = &column.cells else {
        return false;
    };
    let names: BTreeSet<&String> = cells.iter().collect();
    names.len() > 1 && 2 * names.len() <= cells.len()
}
