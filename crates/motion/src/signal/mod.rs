//! A recording's columns at even steps: pieces, derivatives, one low pass, and the noise beside it.

pub(crate) mod line;
pub(crate) mod link;
pub(crate) mod local_polynomial;
pub(crate) mod low_pass;
pub(crate) mod memory;
pub(crate) mod noise;
pub(crate) mod samples;
pub(crate) mod sampling;
pub(crate) mod states;
pub(crate) mod stretches;
