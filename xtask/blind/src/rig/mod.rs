//! A device in motion and what its sensors read.

pub(crate) mod devices;
pub(crate) mod drive;
pub(crate) mod dynamics;
pub(crate) mod geometry;
pub(crate) mod motion;
pub(crate) mod noise;
pub(crate) mod readings;
pub(crate) mod scene;
pub(crate) mod surroundings;
