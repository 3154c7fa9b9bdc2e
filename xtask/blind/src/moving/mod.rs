//! Arms that a controller moves: recordings of joints, torques and commands with an effect of masses, friction, sensors or
//! surroundings.

mod admission;
mod arms;
mod change;
mod files;
mod kinds;
mod laws;
mod motion;
mod plan;
mod scene;
mod sensors;
mod sloppy;
mod trial;

#[cfg(test)]
mod tests;

pub(crate) use admission::draw as with_faults;
pub use files::write_moving;
pub(crate) use trial::{draw, with_memory};
