//! Tables, SVG figures and self-contained HTML pages, written as text and never as a side effect.
//!
//! A [`Table`] turns into terminal text, Markdown, CSV, JSON and HTML; a [`Figure`] or
//! [`FigureGrid`], [`BarRows`], [`HeatMap`] and [`ArmPicture`] into SVG; a [`Document`] collects both into one HTML file. The same input gives
//! the same bytes. Only [`write_atomically`] touches the file system.

mod arm;
mod bar_rows;
mod canvas;
mod colour;
mod digits;
mod document;
mod error;
mod figure;
mod file;
mod heat_map;
mod table;
mod text;

pub use arm::ArmPicture;
pub use bar_rows::{BarRow, BarRows};
pub use digits::earned_decimals;
pub use document::{Block, Document, Link, Section, Tone};
pub use error::ReportError;
pub use figure::series::{Mark, Series, histogram};
pub use figure::{Figure, FigureGrid};
pub use file::write_atomically;
pub use heat_map::{HeatCell, HeatMap};
pub use table::Table;
pub use table::cell::{Cell, Column};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
