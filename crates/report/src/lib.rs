//! Tables, SVG figures and self-contained HTML pages, written as text and never as a side effect.
//!
//! A [`Table`] turns into terminal text, Markdown, CSV, JSON and HTML; a [`Figure`] or
//! [`FigureGrid`], [`BarRows`] and [`HeatMap`] into SVG; a [`Document`] collects both into one HTML file. The same input gives
//! the same bytes. Only [`write_atomically`] touches the file system.

mod axis;
mod bar_rows;
mod canvas;
mod cell;
mod clip;
mod document;
mod draw;
mod error;
mod figure;
mod file;
mod heat_map;
mod layout;
mod legend;
mod panel;
mod series;
mod table;
mod table_formats;
mod text;

pub use bar_rows::{BarRow, BarRows};
pub use cell::{Cell, Column};
pub use document::{Block, Document, Section, Tone};
pub use error::ReportError;
pub use figure::{Figure, FigureGrid};
pub use file::write_atomically;
pub use heat_map::{HeatCell, HeatMap};
pub use series::{Mark, Series, histogram};
pub use table::Table;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
