//! The one error type of this crate.

use std::path::PathBuf;

/// Why a table, figure or file cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A row has more or fewer cells than the table has columns.
    #[error("table \"{table}\": a row has {got} cells, the table has {expected} columns")]
    RowWidth {
        /// Title of the table.
        table: String,
        /// Number of columns.
        expected: usize,
        /// Number of cells in the row.
        got: usize,
    },
    /// A number is NaN or infinite.
    #[error("{place}: item {index} is not finite: {value}")]
    NonFinite {
        /// Place of the number: table and column, or figure and series.
        place: String,
        /// Its position there, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A logarithmic axis meets a number that is zero or negative.
    #[error("{place}: item {index} is {value}, a logarithmic axis needs numbers above 0")]
    NotPositive {
        /// Figure and series.
        place: String,
        /// Position in the series, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// The given range of an axis is empty or not finite.
    #[error("figure \"{figure}\": the {axis} range from {low} to {high} is empty")]
    EmptyRange {
        /// Title of the figure.
        figure: String,
        /// "x" or "y".
        axis: &'static str,
        /// Lower end as given.
        low: f64,
        /// Upper end as given.
        high: f64,
    },
    /// A figure has neither points nor ranges, a grid no figures, or a category list no names.
    #[error("figure \"{figure}\" has no {missing}")]
    Empty {
        /// Title of the figure or grid.
        figure: String,
        /// What is missing.
        missing: &'static str,
    },
    /// The points of a band or of intervals are not in the order that the mark needs.
    #[error("figure \"{figure}\", series \"{series}\": {got} points, the mark needs {needed}")]
    PointCount {
        /// Title of the figure.
        figure: String,
        /// Label of the series.
        series: String,
        /// Number of points.
        got: usize,
        /// The allowed numbers, in words.
        needed: &'static str,
    },
    /// Title, legend and labels leave too little room for the plot.
    #[error(
        "figure \"{figure}\": {width_px:.0} by {height_px:.0} px are left for the plot, needed are {needed_width_px:.0} by {needed_height_px:.0}"
    )]
    TooSmall {
        /// Title of the figure.
        figure: String,
        /// Width left, in px.
        width_px: f64,
        /// Height left, in px.
        height_px: f64,
        /// Smallest width, in px.
        needed_width_px: f64,
        /// Smallest height, in px.
        needed_height_px: f64,
    },
    /// The size asked of a picture is outside what the drawing library can address.
    #[error(
        "a picture of {width_px} by {height_px} px is asked for, each side may be 1 to {largest_px}"
    )]
    PictureSize {
        /// Width asked for, in px.
        width_px: u32,
        /// Height asked for, in px.
        height_px: u32,
        /// Largest side, in px.
        largest_px: u32,
    },
    /// The CSV library refused a record.
    #[error("table \"{table}\" as CSV: {message}")]
    Csv {
        /// Title of the table.
        table: String,
        /// The message of the library.
        message: String,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file to be written.
        path: PathBuf,
        /// The answer of the operating system.
        source: std::io::Error,
    },
}

impl ReportError {
    pub(crate) fn empty(figure: &str, missing: &'static str) -> Self {
        let figure = figure.to_owned();
        Self::Empty { figure, missing }
    }

    pub(crate) fn too_small(figure: &str, left_px: (f64, f64), needed_px: (f64, f64)) -> Self {
        Self::TooSmall {
            figure: figure.to_owned(),
            width_px: left_px.0.max(0.0),
            height_px: left_px.1.max(0.0),
            needed_width_px: needed_px.0,
            needed_height_px: needed_px.1,
        }
    }
}
