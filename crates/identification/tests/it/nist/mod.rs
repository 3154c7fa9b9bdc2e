//! The 27 certified problems of the NIST Statistical Reference Datasets, solved from both starts.

pub(crate) mod relative;
mod score;
mod set;
