//! An uncertainty budget: contributions with sensitivities, combined by the law of JCGM 100 and checked by that of JCGM 101.

mod combined;
mod distribution;
mod simulated;

pub use combined::{Combined, Group, combined, covariance_of};
pub use distribution::{Distribution, Input, degrees_of_reliability};
pub use simulated::{Agreement, Simulated, agreement, simulated};
