//! Recordings of a device that a hand moves through time, with effects that its model leaves out.

pub(crate) mod channels;
pub(crate) mod clearance;
pub(crate) mod hand_path;
pub(crate) mod rests;
pub(crate) mod scene;
pub(crate) mod settings;
pub(crate) mod simulate;
