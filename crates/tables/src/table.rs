//! A table as it was found: named columns of numbers or texts, each with a length of its own.

use crate::error::TableError;

/// The columns of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// The file, for messages.
    pub file: String,
    /// The columns, in the file's order.
    pub columns: Vec<Column>,
    /// Whether the file names its columns; else they are called `#1`, `#2`, ...
    pub is_named: bool,
    /// Line of each row of a text; empty for arrays, whose rows are counted from 1.
    pub lines: Vec<u64>,
    /// How the file was read, in words: what a person should know, or correct in the mapping file.
    pub notes: Vec<String>,
    /// How a text was read.
    pub dialect: Option<Dialect>,
    /// Order of Euler angles, such as `xyz`, where the file says it.
    pub euler: Option<String>,
}

/// How a text separates and writes its cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dialect {
    /// Between cells; a blank for any number of blanks.
    pub separator: char,
    /// Decimal sign: a point or a comma.
    pub decimal: char,
    /// Whether the text is Latin-1 instead of UTF-8.
    pub is_latin1: bool,
    /// Whether the line below the names has units.
    pub has_units: bool,
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name; of an element of a list or an array `name[2]`, counted from 1.
    pub name: String,
    /// Its unit, where the file says one.
    pub unit: Option<String>,
    /// Its cells.
    pub cells: Cells,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers; `NaN` is no reading.
    Numbers(Vec<f64>),
    /// Texts; an empty one is no reading.
    Texts(Vec<String>),
}

impl Cells {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers, if they are.
    pub fn numbers(&self) -> Option<&[f64]> {
        match self {
            Self::Numbers(cells) => Some(cells),
            Self::Texts(_) => None,
        }
    }
}

impl Column {
    /// A column of numbers.
    pub(crate) fn numbers(name: impl Into<String>, cells: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: None,
            cells: Cells::Numbers(cells),
        }
    }
}

impl Table {
    /// Line of a row, for messages.
    pub(crate) fn line(&self, row: usize) -> u64 {
        self.lines.get(row).copied().unwrap_or(row as u64 + 1)
    }

    /// The place of a column by its name, or by its number as `#3`.
    ///
    /// # Errors
    /// There is no such column, or there are two.
    pub fn find(&self, name: &str) -> Result<usize, TableError> {
        let refuse = |what: String, next: String| {
            Err(TableError::new("missing-column", what, &self.file, next))
        };
        let number = name.strip_prefix('#');
        if let Some(number) = number.and_then(|number| number.parse::<usize>().ok()) {
            return match number.checked_sub(1) {
                Some(index) if index < self.columns.len() => Ok(index),
                _ => refuse(
                    format!(
                        "there is no column {name}, the table has {}",
                        self.columns.len()
                    ),
                    "columns are numbered from #1".to_owned(),
                ),
            };
        }
        if !self.is_named {
            return refuse(
                format!("the table has no header, so no column has the name `{name}`"),
                "name columns as #1, #2, ...".to_owned(),
            );
        }
        let mut found = self
            .columns
            .iter()
            .enumerate()
            .filter(|(_, own)| own.name == name);
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(index),
            (Some((first, _)), Some((second, _))) => refuse(
                format!("two columns are called `{name}`"),
                format!("name one of them as #{} or #{}", first + 1, second + 1),
            ),
            (None, _) => refuse(
                format!("there is no column `{name}`"),
                format!("the table has: {}", self.names()),
            ),
        }
    }

    /// The first names, for messages.
    pub(crate) fn names(&self) -> String {
        const MOST: usize = 40;
        let names: Vec<&str> = self
            .columns
            .iter()
            .take(MOST)
            .map(|own| own.name.as_str())
            .collect();
        names.join(", ")
    }
}
