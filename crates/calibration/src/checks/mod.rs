//! Checks of a recording before a fit, and the rows that are held out.

pub(crate) mod held_out;
pub(crate) mod otherwise;
pub(crate) mod postures;
pub(crate) mod ran_away;
pub(crate) mod reach;
pub(crate) mod rejection;
pub(crate) mod rig;
mod stuck;
pub(crate) mod sufficiency;
pub(crate) mod tools;
