//! Projections, steps and ridges of the fits.

// `engine::blocks`
/// Squared share of a direction that must survive a projection to count.
pub(crate) const SURVIVING: f64 = 1e-9;

// `engine::descent`
/// Step of a width over the width itself: more than what a reversal at a row makes it, so that rows that are crossed together count
/// together.
pub(crate) const WIDTH_STEP: f64 = 0.01;

// `engine::least`
/// Share of a column's square that must lie across others for it to be one of its own.
pub(crate) const INDEPENDENT: f64 = 1e-6;
/// Share of a column's square that keeps dependent ones solvable.
pub(crate) const LEAST_SQUARES_RIDGE: f64 = 1e-11;

// `engine::onto_touches`
/// Share of the mean square of the three directions that is added to each: where the handle cannot move, no joint does.
pub(crate) const TOUCHES_RIDGE: f64 = 1e-3;

// `engine::prepared`
/// Noise deviations, all readings together, below which a plausible deviation of a parameter shows in none.
pub(crate) const UNSEEN_NOISES: f64 = 1e-6;

// `engine::regression`
/// Share of a column's length below which it is projected a second time: above it one pass leaves at most ten times the
/// rounding. A long log has ten thousand blocks, and its base model a hundred columns.
pub(crate) const AGAIN_BELOW: f64 = 0.1;

// `engine::system`
/// Share of a column that must lie across those before it for a direction of its own.
pub(crate) const ABSENT_DIRECTION: f64 = 1e-7;

// `select::scan`
/// Share of an effect's longest column below which another is the rounding of nothing: a tilt that no reading shows has a direction too,
/// which is chance.
pub(crate) const ROUNDING: f64 = 1e-12;

// `start_values`
/// Squared standard deviations by which a shape must fit better than those before it: a likelihood ratio of 100.
pub(crate) const BETTER_SHAPE: f64 = 9.21;

// `noise::colour`
/// Step in which the turning point is looked for.
pub(crate) const COLOUR_STEP: f64 = 0.01;
