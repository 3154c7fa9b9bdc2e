//! Recordings: from a file (CSV, Parquet, MCAP) or from a dictionary of columns.

use std::path::PathBuf;

use haptical::data::Cells;
use haptical::files::Source;
use haptical::{Device, Log as Read};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::failure::Failure;

/// A recording that was taken from Python, still to be checked.
#[derive(Debug)]
pub(crate) enum Log {
    File(PathBuf),
    Columns(Vec<(String, Column)>),
}

/// Cells of one column.
#[derive(Debug)]
pub(crate) enum Column {
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    Texts(Vec<String>),
}

/// Name of a recording in memory in messages.
const IN_MEMORY: &str = "the log";
/// The column of times in seconds.
const TIME: &str = "t_s";

/// Takes one log, or several in a list or a tuple.
pub(crate) fn logs_of(logs: &Bound<'_, PyAny>) -> PyResult<Vec<Log>> {
    if logs.is_instance_of::<PyList>() || logs.is_instance_of::<PyTuple>() {
        let all = logs.try_iter()?.map(|log| log_of(&log?));
        return all.collect();
    }
    Ok(vec![log_of(logs)?])
}

/// Takes a path or a dictionary of columns.
pub(crate) fn log_of(log: &Bound<'_, PyAny>) -> PyResult<Log> {
    let Ok(columns) = log.cast::<PyDict>() else {
        return match log.extract::<PathBuf>() {
            Ok(path) => Ok(Log::File(path)),
            Err(_) if log.is_instance_of::<PyList>() => {
                let text = "there is a list where one log is expected; join the logs, or give them to diagnose or fleet";
                Err(Failure::value(text).into())
            }
            Err(_) => {
                let kind = log.get_type().name()?;
                Err(Failure::value(format!(
                    "the log is of the type {kind}; give a path, a dictionary of columns or a frame"
                ))
                .into())
            }
        };
    };
    let numpy = log.py().import("numpy")?;
    let mut taken = Vec::new();
    for (name, cells) in columns {
        let name: String = name.extract().map_err(|_| {
            Failure::value(format!("the key {name} of the log is no name of a column"))
        })?;
        let cells = column(&numpy, &name, &cells)?;
        taken.push((name, cells));
    }
    Ok(Log::Columns(taken))
}

/// Numbers where the array is of numbers, texts where it is of texts; None and NaN are no readings.
fn column(numpy: &Bound<'_, PyModule>, name: &str, cells: &Bound<'_, PyAny>) -> PyResult<Column> {
    let array = numpy.call_method1("asarray", (cells,))?;
    let (kind, dimensions): (String, usize) = (
        array.getattr("dtype")?.getattr("kind")?.extract()?,
        array.getattr("ndim")?.extract()?,
    );
    if dimensions != 1 {
        return Err(Failure::value(format!(
            "column `{name}` has {dimensions} dimensions; give one number or text for each row"
        ))
        .into());
    }
    match kind.as_str() {
        "f" => {
            let numbers = array.call_method1("astype", ("float64",))?;
            Ok(Column::Numbers(numbers.cast::<PyArray1<f64>>()?.to_vec()?))
        }
        "i" | "u" | "b" => {
            let integers = array.call_method1("astype", ("int64",))?;
            Ok(Column::Integers(
                integers.cast::<PyArray1<i64>>()?.to_vec()?,
            ))
        }
        "U" | "O" | "T" => {
            let cells: Vec<Bound<'_, PyAny>> = array.call_method0("tolist")?.extract()?;
            let text = |cell: &Bound<'_, PyAny>| -> PyResult<String> {
                let is_nan = cell.extract::<f64>().is_ok_and(f64::is_nan);
                if cell.is_none() || is_nan {
                    Ok(String::new())
                } else {
                    Ok(cell.str()?.to_string())
                }
            };
            Ok(Column::Texts(
                cells.iter().map(text).collect::<PyResult<_>>()?,
            ))
        }
        // dates that the log's times are not taken from say as little as a text
        "M" | "m" if name != TIME => {
            let texts = array.call_method1("astype", ("str",))?;
            Ok(Column::Texts(texts.call_method0("tolist")?.extract()?))
        }
        _ => {
            let dtype = array.getattr("dtype")?.str()?;
            Err(Failure::value(format!(
                "column `{name}` is of the type {dtype}; give numbers (times in seconds) or texts"
            ))
            .into())
        }
    }
}

impl Log {
    /// Reads it as a log of a device.
    pub(crate) fn read(&self, device: &Device) -> Result<Read, Failure> {
        if let Self::File(path) = self {
            return Ok(Read::open(&Source::by_path(path), device)?);
        }
        Ok(Read::from_columns(&self.cells(), IN_MEMORY, device)?)
    }

    /// The cells of columns in memory; none of a file.
    pub(crate) fn cells(&self) -> Vec<(&str, Cells<'_>)> {
        let Self::Columns(columns) = self else {
            return Vec::new();
        };
        let all = columns.iter().map(|(name, column)| {
            let cells = match column {
                Column::Numbers(cells) => Cells::Numbers(cells),
                Column::Integers(cells) => Cells::Integers(cells),
                Column::Texts(cells) => Cells::Texts(cells),
            };
            (name.as_str(), cells)
        });
        all.collect()
    }
}
