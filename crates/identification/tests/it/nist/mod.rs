//! The 27 certified problems of the NIST Statistical Reference Datasets, solved from both starts.

mod fixture;
mod models;
mod score;
