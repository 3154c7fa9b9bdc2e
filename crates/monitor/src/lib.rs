//! Whether residuals are still what they were: a sequential test with a stated rate of false alarms, and since when not.
//!
#![doc = include_str!("../README.md")]

mod block;
mod change;
mod course;
mod detector;
mod error;
mod monitor;
mod reference;
mod unclipped;

pub use change::{Change, Shape, change};
pub use course::Course;
pub use detector::{Detector, RATES};
pub use error::MonitorError;
pub use monitor::{ComponentState, Event, Monitor, Phase, RING_BLOCKS, Settings, Shift};
pub use reference::{Feature, Reference};
