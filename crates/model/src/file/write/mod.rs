//! Writes device files: a whole one, or changes in the text of one.

pub(crate) mod changes;
pub(crate) mod masses;
pub(crate) mod surroundings;
pub(crate) mod whole;
