//! Arms that a controller moves: recordings of joints, torques and commands with an effect of masses, friction, sensors or
//! surroundings.

mod arms;
mod change;
mod control;
mod course;
mod files;
mod kinds;
mod laws;
mod log;
mod plan;
mod plant;
mod rigid;
mod run;
mod sensors;
mod specimen;
mod trial;

#[cfg(test)]
mod tests;

pub use files::write_moving;
pub(crate) use trial::{draw, with_memory};
