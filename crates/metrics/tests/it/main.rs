//! Integration tests of haptical-metrics.

mod bootstrap;
mod improvement;
mod inference;
mod pose;
mod quantile;
