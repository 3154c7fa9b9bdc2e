//! A device with cable drives: device file, parameters with names and units, predictions.

mod recording;

pub use recording::Recording;
