//! Which effects some rows show: they are selected, compared with their rivals and judged, whatever the rows are of.
//!
#![doc = include_str!("../README.md")]

mod admission;
mod gain;
mod question;
mod rivals;
mod select;
mod thresholds;
mod verdict;

#[cfg(test)]
mod tests;

pub use admission::{Admission, Answered, Check};
pub use gain::{Closed, Gain, closed_share};
pub use question::{
    Backward, Forward, InPlace, Less, Needless, Other, Others, Proposal, Proposals, Ruled, Ruling,
    Without,
};
pub use rivals::{Rival, Rivals, nearest, probability, rivals};
pub use select::{Kept, select, without_needless};
pub use thresholds::NAMED_PROBABILITY;
pub use verdict::{Evidence, Verdict, verdict};

/// Texts of the files with the numbers that decide.
pub const THRESHOLDS: [&str; 1] = [include_str!("thresholds.rs")];
