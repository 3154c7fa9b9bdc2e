//! A search: its state, and the linearised problem at one point.

mod linear;
pub(crate) mod state;
mod triangle;
