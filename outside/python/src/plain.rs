//! Dictionaries of Python as TOML: a device that a program made is read as a device file is.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString, PyTuple};
use toml::{Table, Value};

use crate::failure::Failure;

/// Deepest nesting: a device file has three levels.
const MOST_LEVELS: usize = 32;

/// The text of a TOML document with these entries.
pub(crate) fn toml_text(dictionary: &Bound<'_, PyDict>) -> PyResult<String> {
    let table = table(dictionary, 0)?;
    let text = toml::to_string(&table).map_err(|error| Failure::value(error.to_string()))?;
    Ok(text)
}

fn table(dictionary: &Bound<'_, PyDict>, level: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, entry) in dictionary {
        let key: String = key
            .extract()
            .map_err(|_| Failure::value(format!("the key {key} of a device is no text")))?;
        if !entry.is_none() {
            let entry = value(&entry, &key, level + 1)?;
            table.insert(key, entry);
        }
    }
    Ok(table)
}

fn value(entry: &Bound<'_, PyAny>, key: &str, level: usize) -> PyResult<Value> {
    if level > MOST_LEVELS {
        return Err(Failure::value(format!(
            "`{key}` is nested more than {MOST_LEVELS} levels deep"
        ))
        .into());
    }
    if let Ok(truth) = entry.cast::<PyBool>() {
        return Ok(Value::Boolean(truth.is_true()));
    }
    if let Ok(text) = entry.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(dictionary) = entry.cast::<PyDict>() {
        return table(dictionary, level).map(Value::Table);
    }
    if entry.cast::<PyList>().is_ok()
        || entry.cast::<PyTuple>().is_ok()
        || entry.hasattr("tolist")?
    {
        // NumPy's arrays and numbers become lists and numbers of Python
        let plain = if entry.hasattr("tolist")? {
            entry.call_method0("tolist")?
        } else {
            entry.clone()
        };
        if plain.cast::<PyList>().is_ok() || plain.cast::<PyTuple>().is_ok() {
            let entries = plain.try_iter()?;
            let entries: PyResult<Vec<Value>> = entries
                .map(|entry| value(&entry?, key, level + 1))
                .collect();
            return entries.map(Value::Array);
        }
        return number(&plain, key);
    }
    number(entry, key)
}

fn number(entry: &Bound<'_, PyAny>, key: &str) -> PyResult<Value> {
    if let Ok(integer) = entry.extract::<i64>() {
        return Ok(Value::Integer(integer));
    }
    if let Ok(number) = entry.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    let kind = entry.get_type().name()?;
    Err(Failure::value(format!(
        "`{key}` is of the type {kind}; give a number, a text, a list or a dictionary"
    ))
    .into())
}
