//! Least squares on guarded QR: rank, truncated solutions and covariance, or a typed refusal.
//!
#![doc = include_str!("../README.md")]

mod aligned;
mod basis;
mod covariance;
mod error;
mod fold;
mod golden;
mod hats;
mod lanes;
mod matrix;
mod normal;
mod ordered;
mod panel;
mod pivoted;
mod reduction;
mod scatter;
mod sparse;
mod step;
mod triangle;

pub use aligned::Aligned;
pub use basis::OrthonormalBasis;
pub use error::LinalgError;
pub use golden::golden_section;
pub use hats::hat_functions;
pub use lanes::{dot, take_off};
pub use matrix::Matrix;
pub use normal::information::{Information, MOST_LEVERAGE};
pub use normal::{NormalEquations, NormalSolution};
pub use ordered::{Dependence, OrderedColumns, OrderedRank};
pub use reduction::Reduction;
pub use scatter::{jackknife_sd, sum_sd};
pub use sparse::{Direction, SparseColumns};
pub use step::Solution;
pub use triangle::{TILE_ROWS, Triangle};

/// Singular values of any finite matrix, largest first.
///
/// # Errors
/// [`LinalgError`] for an empty matrix, an entry that is not finite, or no convergence.
pub fn singular_values(matrix: &Matrix) -> Result<Vec<f64>, LinalgError> {
    matrix.check()?;
    pivoted::singular_values(matrix)
}

/// Relative size below which a direction counts as absent: columns are scaled to unit norm first,
/// so rounding leaves about 1e-16 times the condition number of what was kept, while the weakest
/// direction that any measurement can use is far above it.
pub const RANK_TOLERANCE: f64 = 1e-9;
