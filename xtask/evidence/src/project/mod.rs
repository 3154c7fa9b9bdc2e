//! Evidence about the project itself: its tests, its dependencies, its formats, its Python module.

pub(crate) mod cargo_test;
pub(crate) mod licences;
pub(crate) mod python;
pub(crate) mod quality;
