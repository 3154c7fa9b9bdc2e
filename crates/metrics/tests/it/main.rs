//! Integration tests of haptical-metrics.

mod bootstrap;
mod coverage;
mod improvement;
mod inference;
mod pose;
mod quadratic_form;
mod quantile;
