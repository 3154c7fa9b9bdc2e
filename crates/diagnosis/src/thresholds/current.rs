//! What a motor's current leaves of its torque.

// `current::rows`
/// Blocks of rows at least, and contiguous parts of them, each of which is predicted by a fit to the others. Choice.
pub(crate) const LEAST_BLOCKS: usize = 240;
pub(crate) const PARTS: usize = 12;
/// Noise at least, over the root mean square of the torque: shares of noiseless logs stay finite. Choice.
pub(crate) const LEAST_NOISE: f64 = 1e-4;
/// Variance of the torque over that of its noise from which it varies. Choice.
pub(crate) const LEAST_VARIATION: f64 = 4.0;
/// Range of temperatures at least \[K\]. Choice.
pub(crate) const LEAST_WARMING_K: f64 = 1.0;
/// Most and least share of the blocks beyond a limit, and how many limits are tried. Choice: one of fewer blocks shows too little, one of
/// more is the rule.
pub(crate) const LIMIT_SHARES: [f64; 2] = [0.4, 0.005];
pub(crate) const LIMITS: usize = 40;
/// Share of the voltage that a speed leaves at least. Choice: more than the supply gives no motor takes.
pub(crate) const LEAST_LEFT: f64 = 0.01;
/// Share of noise in the squares of the current's slope, which lowers a delay by as much. Choice: it is below what the law gets wrong.
pub(crate) const NOISE_OF_SLOPE: f64 = 0.01;

/// Readings beyond this are none: sums of squares stay finite. Choice.
pub(crate) const LARGEST_READING: f64 = 1e100;

// `current::choose`
/// Gain on unseen parts in its standard deviations. Chance: one law in 700.
pub(crate) const SURE_SD: f64 = 3.0;
/// The same at least \[nats\]: a rival without it is e^10 times less likely. Choice.
pub(crate) const LEAST_NATS: f64 = 10.0;
/// Share of the torque's squares that a law must explain: half a percent of its size. Choice: noise of the current lowers its torque constant
/// by as much where it is 7 % of the current.
pub(crate) const LEAST_SHARE: f64 = 2.5e-5;

// `current::answer`
/// Share of the torque's squares beyond noise that is a gap without a law: 3 % of its size. Choice: filtered noise and the ripple of sensors
/// leave as much, and both have a memory, so that second differences do not show them.
pub(crate) const LEAST_GAP: f64 = 9e-4;
/// Excess over the noise's variance that is more than chance, times the root of the number of blocks. Calculated: five standard deviations,
/// 2.0 each, of a variance by second differences, whose correlations are -2/3 and 1/6.
pub(crate) const CHANCE: f64 = 10.0;
/// Squared correlation of torque and current from which the torque follows the current. Choice.
pub(crate) const FOLLOWS: f64 = 0.5;
/// Share of a gap that named laws close on unseen parts. Choice: of sinusoids a delay imitates 0.81 of friction.
pub(crate) const LEAST_CLOSED: f64 = 0.9;
/// Student's quantile for the twelve parts over that of the normal distribution. Calculated.
pub(crate) const STUDENT: f64 = 1.123;
/// Relative standard deviation of a size by what its law gets wrong. Choice: that of a delay in the catalogue.
pub(crate) const LAW_ERROR: f64 = 0.015;
