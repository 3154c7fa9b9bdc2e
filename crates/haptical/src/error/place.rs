//! The place of a fault: file, line, column.

/// Where it is; `file` may also be words such as "the command line".
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Place {
    /// File, or words.
    pub file: String,
    /// Line, from 1.
    pub line: Option<u64>,
    /// Column of the cell in a log, of the character in a device file; from 1.
    pub column: Option<u64>,
    /// Header of a log's column.
    pub column_name: Option<String>,
    /// Section of the device file that it is in; a rig file may hold that section instead.
    pub(super) section: Option<String>,
    /// Joints that the log has columns of, the first ones, where the device has more.
    pub(super) joint_columns: Option<usize>,
}

impl Place {
    /// Boxed, so that a `Result` with a failure stays small.
    pub(super) fn in_file(file: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            file: file.into(),
            ..Self::default()
        })
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(formatter, ":{line}")?;
            if let Some(column) = self.column {
                write!(formatter, ":{column}")?;
            }
        }
        match &self.column_name {
            Some(name) => write!(formatter, ", column `{name}`"),
            None => Ok(()),
        }
    }
}
