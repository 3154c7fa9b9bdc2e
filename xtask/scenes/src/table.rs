//! A log as columns by name, which scenes make and laws change.

use std::io::Read as _;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use flate2::read::GzDecoder;
use haptical::data::{Cells, LogShape, write_log_to};
use haptical::model::Recording;
use haptical::{Device, Log};

/// Columns whose cells are texts.
const TEXTS: [&str; 4] = ["hand", "contact", "plane", "tool"];

/// Cells of a column; a number that is absent is `NaN`, a text empty.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Column {
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    Texts(Vec<String>),
}

impl Column {
    fn taken(&self, rows: &[usize]) -> Self {
        match self {
            Self::Numbers(cells) => Self::Numbers(rows.iter().map(|row| cells[*row]).collect()),
            Self::Integers(cells) => Self::Integers(rows.iter().map(|row| cells[*row]).collect()),
            Self::Texts(cells) => Self::Texts(rows.iter().map(|row| cells[*row].clone()).collect()),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Integers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    fn cells(&self) -> Cells<'_> {
        match self {
            Self::Numbers(cells) => Cells::Numbers(cells),
            Self::Integers(cells) => Cells::Integers(cells),
            Self::Texts(cells) => Cells::Texts(cells),
        }
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Table {
    pub(crate) columns: Vec<(String, Column)>,
}

impl Table {
    /// A CSV log without quotes, plain or gzip.
    pub(crate) fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let place = || path.display().to_string();
        let bytes = std::fs::read(path).with_context(place)?;
        let mut text = String::new();
        match path.extension().is_some_and(|extension| extension == "gz") {
            true => {
                GzDecoder::new(bytes.as_slice()).read_to_string(&mut text)?;
            }
            false => text = String::from_utf8(bytes)?,
        }
        Self::parse(&text).with_context(place)
    }

    /// The same of a text.
    pub(crate) fn parse(text: &str) -> Result<Self> {
        let mut lines = text.lines();
        let header = lines.next().context("an empty log")?;
        let mut cells: Vec<Vec<&str>> = header.split(',').map(|_| Vec::new()).collect();
        for line in lines {
            for (column, cell) in cells.iter_mut().zip(line.split(',')) {
                column.push(cell);
            }
        }
        let parsed = |name: &str, cells: Vec<&str>| -> Result<Column> {
            Ok(match name {
                "run" => Column::Integers(
                    (cells.iter())
                        .map(|cell| cell.parse())
                        .collect::<Result<_, _>>()?,
                ),
                name if TEXTS.contains(&name) => {
                    Column::Texts(cells.into_iter().map(str::to_owned).collect())
                }
                _ => {
                    let number = |cell: &&str| match cell.is_empty() {
                        true => Ok(f64::NAN),
                        false => cell.parse(),
                    };
                    let numbers = cells.iter().map(number).collect::<Result<_, _>>();
                    Column::Numbers(numbers.with_context(|| name.to_owned())?)
                }
            })
        };
        let columns = header.split(',').zip(cells);
        let columns = columns.map(|(name, cells)| Ok((name.to_owned(), parsed(name, cells)?)));
        Ok(Self {
            columns: columns.collect::<Result<_>>()?,
        })
    }

    /// The rows of a simulated recording.
    pub(crate) fn of(recording: &Recording, device: &haptical::model::Device) -> Result<Self> {
        let mut bytes = Vec::new();
        write_log_to(&mut bytes, recording, &LogShape::from(device))?;
        Self::parse(&String::from_utf8(bytes)?)
    }

    /// As a log of a device; answers call it by `name`.
    pub(crate) fn log(&self, name: &str, device: &Device) -> Result<Log, haptical::Error> {
        let columns = self.columns.iter();
        let columns: Vec<(&str, Cells<'_>)> = columns
            .map(|(name, column)| (name.as_str(), column.cells()))
            .collect();
        Log::from_columns(&columns, name, device)
    }

    /// As CSV; an absent number is an empty cell.
    pub(crate) fn csv(&self) -> String {
        let cell = |column: &Column, row: usize| match column {
            Column::Numbers(cells) if cells[row].is_nan() => String::new(),
            Column::Numbers(cells) => format!("{}", cells[row]),
            Column::Integers(cells) => cells[row].to_string(),
            Column::Texts(cells) => cells[row].clone(),
        };
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
        let mut text = names.join(",") + "\n";
        for row in 0..self.rows() {
            let cells = self.columns.iter().map(|(_, column)| cell(column, row));
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    /// Adds a column of numbers at the end.
    pub(crate) fn push(&mut self, name: impl Into<String>, cells: Vec<f64>) {
        self.columns.push((name.into(), Column::Numbers(cells)));
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(own, _)| own == name)
    }

    pub(crate) fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    pub(crate) fn runs(&self) -> Vec<i64> {
        let own = self.columns.iter().find(|(own, _)| own == "run");
        match own {
            Some((_, Column::Integers(cells))) => cells.clone(),
            _ => vec![0; self.rows()],
        }
    }

    /// The rows at these places, in this order.
    pub(crate) fn taken(&self, rows: &[usize]) -> Self {
        let columns = self.columns.iter();
        let columns = columns.map(|(name, column)| (name.clone(), column.taken(rows)));
        Self {
            columns: columns.collect(),
        }
    }

    pub(crate) fn numbers(&self, name: &str) -> Result<&[f64]> {
        let own = self.columns.iter().find(|(own, _)| own == name);
        match own {
            Some((_, Column::Numbers(cells))) => Ok(cells),
            _ => Err(anyhow!("no column of numbers `{name}`")),
        }
    }

    /// The same, to be changed.
    pub(crate) fn numbers_mut(&mut self, name: &str) -> Result<&mut Vec<f64>> {
        let own = self.columns.iter_mut().find(|(own, _)| own == name);
        match own {
            Some((_, Column::Numbers(cells))) => Ok(cells),
            _ => Err(anyhow!("no column of numbers `{name}`")),
        }
    }
}
