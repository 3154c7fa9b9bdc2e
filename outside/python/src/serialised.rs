//! What serde serialises as objects of Python: dictionaries have the names of identified.json.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};
use serde_json::{Number, Value};

use crate::failure::Failure;

/// A serialised value. Lists of numbers under the keys `arrays` are arrays, NaN where there is no number; other
/// lists are lists.
pub(crate) fn python<'py>(
    py: Python<'py>,
    value: &Value,
    arrays: &[&str],
) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::Number(number) => scalar(py, number),
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(entries) => {
            let list = PyList::empty(py);
            for entry in entries {
                list.append(python(py, entry, arrays)?)?;
            }
            list.into_any()
        }
        Value::Object(entries) => {
            let dictionary = PyDict::new(py);
            for (key, entry) in entries {
                let entry = match entry {
                    Value::Array(numbers) if arrays.contains(&key.as_str()) => array(py, numbers),
                    _ => python(py, entry, arrays)?,
                };
                dictionary.set_item(key, entry)?;
            }
            dictionary.into_any()
        }
    })
}

/// What serialises as a table, as a dictionary to which more may be added.
pub(crate) fn dictionary<'py>(
    py: Python<'py>,
    serialised: serde_json::Result<Value>,
    arrays: &[&str],
) -> PyResult<Bound<'py, PyDict>> {
    let value = serialised.map_err(|error| Failure::value(error.to_string()))?;
    Ok(python(py, &value, arrays)?.cast_into::<PyDict>()?)
}

fn scalar<'py>(py: Python<'py>, number: &Number) -> Bound<'py, PyAny> {
    match (number.as_u64(), number.as_i64()) {
        (Some(whole), _) => PyInt::new(py, whole).into_any(),
        (None, Some(whole)) => PyInt::new(py, whole).into_any(),
        (None, None) => PyFloat::new(py, number.as_f64().unwrap_or(f64::NAN)).into_any(),
    }
}

fn array<'py>(py: Python<'py>, numbers: &[Value]) -> Bound<'py, PyAny> {
    let numbers = numbers
        .iter()
        .map(|number| number.as_f64().unwrap_or(f64::NAN));
    PyArray1::from_vec(py, numbers.collect()).into_any()
}
