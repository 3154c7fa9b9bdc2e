//! Integration tests of the simulator, one module per subject.

mod counts;
mod deviations;
mod device;
mod errors;
mod golden;
mod haptic7;
mod noise;
mod poses;
mod predictions;
mod properties;
mod statistics;
mod streams;
