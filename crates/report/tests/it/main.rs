//! Integration tests of haptical-report.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "helpers of tests may stop a test; clippy exempts only the tests themselves"
)]

mod arm;
mod bar_rows;
mod colour;
mod document;
mod figure;
mod figure_geometry;
mod file;
mod heat_map;
mod picture;
mod table;
