//! Effects that a calibrated model lacks: what each is, what it adds to the measured channels, its numbers.
//!
#![doc = include_str!("../README.md")]

pub mod base_model;
pub mod cable;
mod clock;
pub mod command;
mod context;
pub mod correction;
pub mod device;
mod effect;
mod error;
pub mod external_encoder;
pub mod force;
mod laws;
mod listing;
pub mod motor_encoder;
mod need;
pub mod noise;
mod parameter;
mod registry;
pub mod signal;
mod spec;
pub mod structure;
#[cfg(test)]
mod tests;
pub mod transmission;
mod unit;

pub use clock::{Ahead, OtherClock};
pub use context::{
    CableGeometry, Context, Line, Stream, Touches, joint_origin_m, runs_of, streams,
};
pub use effect::Effect;
pub use error::ContextError;
pub use laws::under_load;
pub use listing::{Entry, entries, markdown};
pub use need::Need;
pub use parameter::{Further, Parameter, Role};
pub use registry::{
    catalogue, drive_catalogue, law, names, parameter, plausible_range, spec, specs,
};
pub use signal::Signal;
pub use spec::{Absorbed, Family, Follows, Form, Hook, LawError, LogFault, Shape, Spec};
pub use unit::Unit;
