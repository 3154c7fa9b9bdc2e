//! The place in a file at which something was found.

use std::fmt;

use crate::read::cell::shortened;

/// A place in a log: the file, and the line and column where they are known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Place {
    /// The file, as its caller named it.
    pub file: String,
    /// Line of the file, counted from 1, blank lines included.
    pub line: Option<u64>,
    /// Name of the column in the header, shortened if it is long.
    pub column: Option<String>,
    /// Position of the column in the header, counted from 1.
    pub column_number: Option<usize>,
}

impl Place {
    /// The file as a whole.
    pub(crate) fn file(file: &str) -> Box<Self> {
        Box::new(Self {
            file: file.to_owned(),
            ..Self::default()
        })
    }

    /// One line of the file.
    pub(crate) fn line(file: &str, line: u64) -> Box<Self> {
        Box::new(Self {
            line: Some(line),
            ..*Self::file(file)
        })
    }

    /// One column of a file that has no line of a header: 1-based number, name.
    pub(crate) fn column(file: &str, number: usize, name: &str) -> Box<Self> {
        Box::new(Self {
            line: None,
            ..*Self::cell(file, 1, number, name)
        })
    }

    /// One cell: line, 1-based column number, column name.
    pub(crate) fn cell(file: &str, line: u64, number: usize, name: &str) -> Box<Self> {
        Box::new(Self {
            column: Some(shortened(name)),
            column_number: Some(number),
            ..*Self::line(file, line)
        })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(formatter, ", line {line}")?;
        }
        match (self.column_number, &self.column) {
            (Some(number), Some(name)) => write!(formatter, ", column {number} `{name}`"),
            (Some(number), None) => write!(formatter, ", column {number}"),
            (None, Some(name)) => write!(formatter, ", column `{name}`"),
            (None, None) => Ok(()),
        }
    }
}
