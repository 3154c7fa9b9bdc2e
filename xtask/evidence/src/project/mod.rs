//! Evidence about the project itself: its tests, its dependencies, its formats, its Python module.

mod cargo_test;
pub(crate) mod formats;
pub(crate) mod fuzz;
pub(crate) mod licences;
pub(crate) mod python;
pub(crate) mod quality;
