//! The recording that tells candidates apart.

// `settle::choose`
/// Rounds in which chosen pieces are exchanged for others.
pub(crate) const EXCHANGE_ROUNDS: usize = 2;
/// What an exchange must gain \[nats\].
pub(crate) const LEAST_EXCHANGE_NATS: f64 = 1e-6;

// `settle::gram`
/// What keeps directions that no row shows from being divided by: a share of a column's squared length.
pub(crate) const RIDGE: f64 = 1e-9;

// `settle::question`
/// Candidates that are compared at most: each costs as many comparisons as there are others.
pub(crate) const MOST_CANDIDATES: usize = 5;
