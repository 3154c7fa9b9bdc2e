//! Payloads that change between runs (docs/diagnosis-force.md, "Payload").

/// Parts that are left out of a fit in turn, each of blocks that follow each other.
pub(crate) const FOLDS: usize = 10;
/// Blocks that each of two groups of runs must have: a few per fold.
pub(crate) const LEAST_BLOCKS: usize = 30;
/// Runs that are compared with those before them at most. Cost.
pub(crate) const MOST_RUNS: usize = 12;
/// How far two postures of a repeated trajectory differ, over a joint's range: what a controller tracks within, and what
/// changes a weight's torque by no more than noise.
pub(crate) const SAME_POSTURE: f64 = 0.005;
/// Part of a column's square that its number is known to be small by.
pub(crate) const RIDGE: f64 = 1e-9;
/// Degree of the free function of a joint's position that both sides share: springs and cables of an arm. Choice.
pub(crate) const COMMON_DEGREE: i32 = 4;
/// Part of a joint's usual rate within which dry friction changes sides. Choice.
pub(crate) const SLOW: f64 = 0.1;
/// What the centre of a payload may be off the flange by, along each axis \[m\]. Choice.
pub(crate) const FLANGE_REACH_M: f64 = 0.06;
/// Squares over a block's variance that a hypothesis must gain on unseen blocks: twice the logarithm of the odds.
pub(crate) const LEAST_GAIN: f64 = 30.0;
/// Mean gain of a fold over its standard error.
pub(crate) const LEAST_T: f64 = 3.0;
/// Ranks of the folds that do not gain, in sum, where that error is larger. Chance: of ten folds no more than this once in
/// 146 comparisons (Wilcoxon's test of signed ranks), beyond `LEAST_T` standard errors once in 134.
pub(crate) const MOST_RANKS_AGAINST: f64 = 4.0;
/// Folds that must gain.
pub(crate) const LEAST_SHARE_OF_FOLDS: f64 = 0.8;
/// The same of one channel.
pub(crate) const LEAST_GAIN_OF_CHANNEL: f64 = 10.0;
pub(crate) const LEAST_T_OF_CHANNEL: f64 = 2.5;
/// Channels that must show it: a change of one drive alone has other causes.
pub(crate) const LEAST_CHANNELS: usize = 2;
/// Least correlation of a payload's torques with and without changes of the drives beside it.
pub(crate) const ALIKE: f64 = 0.5;
/// What the one may be over the other.
pub(crate) const SIZE_BESIDE: [f64; 2] = [0.5, 2.0];
/// Least mean square on some channel over that of a row's noise: as of other effects on torques.
pub(crate) const LEAST_SIGNAL: f64 = 0.04;
/// Standard deviations by which a size is not zero.
pub(crate) const CERTAIN: f64 = 4.0;
/// Relative standard deviation of a mass below which a fit tells it from its moment.
pub(crate) const FIXED_MASS: f64 = 0.2;
/// Classes of a joint's rate in a free function of it. Choice.
pub(crate) const FREE_BINS: usize = 8;
/// Least gain of a law of friction over that of such a free function.
pub(crate) const LAW_OF_FREE: f64 = 0.7;
/// Most that such a function may still gain beside the law, over the law's gain: friction has no single law.
pub(crate) const LEFT_TO_FREE: f64 = 0.3;
/// Distances of a mass on a link from its joint's axis, over the longest row of the chain: a tail or a bar for a counterweight is longer
/// than the row. Choice.
pub(crate) const LEVER: [f64; 2] = [0.1, 1.5];

// `force::changes::hypothesis`
/// How many kinds of changes of a drive may come with a payload, of offset, friction and gain in this order: a gain resembles its weight.
pub(crate) const KINDS_WITH_PAYLOAD: usize = 2;

// `force::changes::size`
/// The half of an interval's width for a standard deviation from as many folds as `FOLDS` (Student's t with nine degrees of freedom).
pub(crate) const FOLDS_HALF_WIDTH: f64 = 2.26;
/// What two sessions differ by, over what the parts of one do: assumption A180.
pub(crate) const SESSION_FACTOR: f64 = 5.0;
/// An inertia that leaves a mass wider than by this factor's logarithm does not show.
pub(crate) const KNOWN_INERTIA: f64 = 1.1;
