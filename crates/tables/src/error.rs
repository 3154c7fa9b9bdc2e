//! What is wrong with a table or a mapping file, its place, and what to do next.

/// A refusal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableError {
    /// Name of the fault, for programs; stays the same between releases.
    pub kind: &'static str,
    /// What is wrong.
    pub what: String,
    /// The file that it is in.
    pub file: String,
    /// Line, or row of an array, counted from 1.
    pub line: Option<u64>,
    /// Column, counted from 1.
    pub column: Option<u64>,
    /// What to do.
    pub next: String,
}

impl TableError {
    pub(crate) fn new(
        kind: &'static str,
        what: impl Into<String>,
        file: &str,
        next: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            what: what.into(),
            file: file.to_owned(),
            line: None,
            column: None,
            next: next.into(),
        }
    }

    pub(crate) fn at(mut self, line: u64, column: Option<u64>) -> Self {
        self.line = Some(line);
        self.column = column;
        self
    }

    /// A binary file that does not hold together.
    pub(crate) fn damaged(format: &str, what: impl std::fmt::Display, file: &str) -> Self {
        Self::new(
            "damaged",
            format!("the {format} data is damaged or cut off ({what})"),
            file,
            "copy or save the file again",
        )
    }

    /// More than is kept in memory.
    pub(crate) fn too_large(file: &str) -> Self {
        let gibibytes = haptical_data::MOST_MEMORY_BYTES >> 30;
        let what = format!("its content fills {gibibytes} GiB of memory, the most that is used");
        Self::new(
            "too-large",
            what,
            file,
            "split the file, or leave out what is not needed",
        )
    }
}

impl std::fmt::Display for TableError {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "{}", self.file)?;
        if let Some(line) = self.line {
            write!(to, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(to, ":{column}")?;
        }
        write!(to, ": {}; {}", self.what, self.next)
    }
}

impl std::error::Error for TableError {}
