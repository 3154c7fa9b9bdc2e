//! Kinds of measurement: one file each, all behind one trait.

pub(crate) mod cable;
pub(crate) mod contact;
pub(crate) mod contact_pair;
pub(crate) mod fixture;
pub(crate) mod kind;
pub(crate) mod orientation;
pub(crate) mod output;
pub(crate) mod plane;
pub(crate) mod plane_pair;
pub(crate) mod position;
pub(crate) mod rotation;
pub(crate) mod sight;
pub(crate) mod touching;
pub(crate) mod tracked;
