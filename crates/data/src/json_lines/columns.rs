//! Objects of JSON, one after another, as columns: keys within keys are joined by points, elements are numbered from 1.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::size::{MOST_MEMORY_BYTES, TEXT_BYTES};

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

/// Objects of JSON as columns of equal length.
///
/// ```
/// use haptical_data::{JsonCell, JsonColumns};
///
/// let mut columns = JsonColumns::default();
/// columns.push(r#"{"t": 0.5, "arm": {"q": [1, 2]}}"#, 1)?;
/// assert_eq!(columns.names, ["arm.q[1]", "arm.q[2]", "t"]);
/// assert_eq!(columns.cells[1], [JsonCell::Number(2.0)]);
/// assert!(columns.push("[1, 2]", 2).is_err());
/// # Ok::<(), String>(())
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
    /// In words: it is no object, it gives a key twice, or all rows together fill the memory.
    pub fn push(&mut self, line: &str, number: u64) -> Result<(), String> {
        let value: Value = serde_json::from_str(line)
            .map_err(|error| format!("the line is no JSON object: {error}"))?;
        if !value.is_object() {
            return Err("the line is JSON, but no object".to_owned());
        }
        self.add(&mut String::new(), &value)?;
        self.lines.push(number);
        for column in &mut self.cells {
            column.resize(self.lines.len(), JsonCell::None);
        }
        let cells = (self.lines.len() * self.cells.len()) as u64;
        if cells * size_of::<JsonCell>() as u64 + self.text_bytes > MOST_MEMORY_BYTES {
            let gibibytes = MOST_MEMORY_BYTES >> 30;
            return Err(format!(
                "the objects so far fill {gibibytes} GiB of memory, the most that is used"
            ));
        }
        Ok(())
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

    fn add(&mut self, path: &mut String, value: &Value) -> Result<(), String> {
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

    fn set(&mut self, name: &str, cell: JsonCell) -> Result<(), String> {
        let row = self.lines.len();
        let column = match self.by_name.get(name) {
            Some(&column) => column,
            None => {
                self.add_column(name.to_owned(), vec![JsonCell::None; row]);
                self.names.len() - 1
            }
        };
        let cells = &mut self.cells[column];
        if cells.len() > row {
            return Err(format!("`{name}` is given twice"));
        }
        cells.push(cell);
        Ok(())
    }
}
