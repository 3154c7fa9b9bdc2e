//! The rows of a problem in the processor's lanes, where the chain allows it.

pub(crate) mod all_rows;
pub(crate) mod cable;
pub(crate) mod capstan;
pub(crate) mod columns;
pub(crate) mod pass;
pub(crate) mod plan;
pub(crate) mod transmission;
