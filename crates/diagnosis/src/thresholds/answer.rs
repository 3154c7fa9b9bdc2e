//! What is written of a gap: its curve, its reduction, its instants.

// `answer::p_spline`
/// Parts that rows are cut into, in order of time.
pub(crate) const PARTS: usize = 40;
/// Folds: part k is held out in fold k modulo this.
pub(crate) const FOLDS: usize = 5;
/// Penalties that are tried, in what the data say of a coefficient on average: 10^-4 to 10^4.
pub(crate) const PENALTIES: i32 = 16;
/// Pull of every coefficient to 0, in the same unit: it decides what neither data nor penalty do.
pub(crate) const PULL: f64 = 1e-6;

// `answer::shrink::reduction`
/// Share of a gap that is all of it \[%\], but for rounding.
pub(crate) const ALL_PERCENT: f64 = 99.95;

// `answer::shrink::second`
/// Share of the squares beyond which a constant is a zero of its own.
pub(crate) const ZERO_SHARE: f64 = 0.5;

// `answer::gap`
/// A channel keeps a gap of its own beyond this many times its noise, and this share of the gap's squares.
pub(crate) const KEPT_FLOORS: f64 = 2.0;
pub(crate) const KEPT_SHARE: f64 = 0.1;
