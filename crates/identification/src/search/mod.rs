//! A search: its state, and the linearised problem at one point.

pub(crate) mod curvature;
mod linear;
pub(crate) mod state;
mod triangle;
