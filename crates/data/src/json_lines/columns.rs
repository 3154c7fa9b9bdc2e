//! Objects of JSON, one after another, as columns: keys within keys are joined by points, elements are numbered from 1.

use std::collections::BTreeMap;
use std::fmt;

use serde_json::Value;

use crate::size::{MOST_COLUMNS, MOST_MEMORY_BYTES, TEXT_BYTES};

/// A value of an object.
#[derive(Debug, Clone, PartialEq)]
pub enum JsonCell {
    /// The object lacks the key, or it is `null`.
    None,
    /// A number, or whether something is so (1 or 0).
    Number(f64),
    /// A text.
    Text(String),
}

/// Why an object is not added.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum JsonRefusal {
    /// The objects so far have more different keys than a log has columns.
    TooManyKeys,
    /// Another reason, in words.
    NoRow(String),
}

impl fmt::Display for JsonRefusal {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyKeys => write!(
                to,
                "the objects so far have more than {MOST_COLUMNS} different keys, the most that are read"
            ),
            Self::NoRow(what) => to.write_str(what),
        }
    }
}

impl std::error::Error for JsonRefusal {}

impl From<String> for JsonRefusal {
    fn from(what: String) -> Self {
        Self::NoRow(what)
    }
}

/// Objects of JSON as columns of equal length, at most [`MOST_COLUMNS`].
///
/// ```
/// use haptical_data::{JsonCell, JsonColumns};
///
/// let mut columns = JsonColumns::default();
/// columns.push(r#"{"t": 0.5, "arm": {"q": [1, 2]}}"#, 1)?;
/// assert_eq!(columns.names, ["arm.q[1]", "arm.q[2]", "t"]);
/// assert_eq!(columns.cells[1], [JsonCell::Number(2.0)]);
/// assert!(columns.push("[1, 2]", 2).is_err());
/// # Ok::<(), haptical_data::JsonRefusal>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct JsonColumns {
    /// Names: those of an object by the alphabet, each below those of the objects before.
    pub names: Vec<String>,
    /// A cell for each row of each column.
    pub cells: Vec<Vec<JsonCell>>,
    /// Line of each row.
    pub lines: Vec<u64>,
    by_name: BTreeMap<String, usize>,
    text_bytes: u64,
}

impl JsonColumns {
    /// Adds the object that a line is.
    ///
    /// # Errors
    /// It is no object, it gives a key twice, or all rows together have too many keys or fill the memory.
    pub fn push(&mut self, line: &str, number: u64) -> Result<(), JsonRefusal> {
        let value: Value = serde_json::from_str(line)
            .map_err(|error| format!("the line is no JSON object: {error}"))?;
        if !value.is_object() {
            return Err("the line is JSON, but no object".to_owned().into());
        }
        self.add(&mut String::new(), &value)?;
        self.lines.push(number);
        for column in &mut self.cells {
            column.resize(self.lines.len(), JsonCell::None);
        }
        self.check_memory()
    }

    fn check_memory(&self) -> Result<(), JsonRefusal> {
        let cells = (self.lines.len() * self.cells.len()) as u64;
        if cells * size_of::<JsonCell>() as u64 + self.text_bytes <= MOST_MEMORY_BYTES {
            return Ok(());
        }
        let gibibytes = MOST_MEMORY_BYTES >> 30;
        let what =
            format!("the objects so far fill {gibibytes} GiB of memory, the most that is used");
        Err(what.into())
    }

    /// The place of a column.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Adds a whole column.
    pub(super) fn add_column(&mut self, name: String, cells: Vec<JsonCell>) {
        self.by_name.insert(name.clone(), self.names.len());
        self.names.push(name);
        self.cells.push(cells);
    }

    /// Keeps the columns whose names are so.
    pub(super) fn retain(&mut self, is_kept: impl Fn(&str) -> bool) {
        let names = std::mem::take(&mut self.names);
        let cells = std::mem::take(&mut self.cells);
        self.by_name.clear();
        for (name, cells) in names.into_iter().zip(cells) {
            if is_kept(&name) {
                self.add_column(name, cells);
            }
        }
    }

    fn add(&mut self, path: &mut String, value: &Value) -> Result<(), JsonRefusal> {
        let length = path.len();
        match value {
            Value::Null => {}
            Value::Bool(value) => self.set(path, JsonCell::Number(f64::from(u8::from(*value))))?,
            Value::Number(number) => {
                let number = number.as_f64().filter(|number| number.is_finite());
                let number = number.ok_or_else(|| format!("`{path}` is beyond the numbers"))?;
                self.set(path, JsonCell::Number(number))?;
            }
            Value::String(text) => {
                self.text_bytes += TEXT_BYTES + text.len() as u64;
                self.set(path, JsonCell::Text(text.clone()))?;
            }
            Value::Array(values) => {
                for (index, value) in values.iter().enumerate() {
                    path.push_str(&format!("[{}]", index + 1));
                    self.add(path, value)?;
                    path.truncate(length);
                }
            }
            Value::Object(values) => {
                for (key, value) in values {
                    if length > 0 {
                        path.push('.');
                    }
                    path.push_str(key);
                    self.add(path, value)?;
                    path.truncate(length);
                }
            }
        }
        Ok(())
    }

    fn set(&mut self, name: &str, cell: JsonCell) -> Result<(), JsonRefusal> {
        let row = self.lines.len();
        let column = match self.by_name.get(name) {
            Some(&column) => column,
            None if self.names.len() == MOST_COLUMNS => return Err(JsonRefusal::TooManyKeys),
            None => {
                // keys within keys may make long names of a short line; each is kept twice
                self.text_bytes += 2 * (TEXT_BYTES + name.len() as u64);
                self.check_memory()?;
                self.add_column(name.to_owned(), vec![JsonCell::None; row]);
                self.names.len() - 1
            }
        };
        let cells = &mut self.cells[column];
        if cells.len() > row {
            return Err(format!("`{name}` is given twice").into());
        }
        cells.push(cell);
        Ok(())
    }
}
