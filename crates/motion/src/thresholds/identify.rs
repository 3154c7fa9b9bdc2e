//! Identification of masses and friction.

// `identify`
/// Standard deviation of friction and offsets that is known beforehand, in torques' root mean squares: nothing.
pub(crate) const LOOSE_SD: f64 = 1e3;
/// Share of a torque that the noise of the positions may make up within the band.
pub(crate) const POSITION_NOISE: f64 = 0.01;
/// Standard deviation of an armature that is known beforehand, as a share of the stated one.
pub(crate) const ARMATURE_SD: f64 = 1.0;

// `identify::shape`
/// Standard deviation of the logarithm of a body's size that is known where its numbers are given, and where they are assumed.
pub(crate) const GIVEN_BODY_SD: f64 = 0.5;
pub(crate) const ASSUMED_BODY_SD: f64 = 1.0;
/// Least second moment about the centre of a nominal body, as a share of their sum: a body that is flatter is thickened.
pub(crate) const FLATTEST_BODY: f64 = 1e-3;

// `identify::fit`
/// Rounds of the fit of friction, delay and weights after which it has not converged. Cost.
pub(crate) const FIT_ROUNDS: usize = 40;
/// Steps of the delay in each. Cost.
pub(crate) const DELAY_STEPS: usize = 10;
/// Fall of the cost below which a round or a step is the last \[variances of the noise\]: numbers are within a tenth of their standard
/// deviations. Choice.
pub(crate) const LEAST_FALL: f64 = 0.01;
/// Longest delay that is looked for, in steps of the log, and in seconds.
pub(crate) const LONGEST_DELAY_STEPS: f64 = 10.0;
pub(crate) const LONGEST_DELAY_S: f64 = 0.05;
/// Least standard deviation of a row, as a share of the torque's root mean square.
pub(crate) const LEAST_ROW_SD: f64 = 1e-6;

// `identify::friction`
/// Speeds within which friction turns over that are tried \[rad/s\], \[m/s\].
pub(crate) const FRICTION_SPEEDS: [f64; 11] = [
    0.0015, 0.003, 0.005, 0.0075, 0.011, 0.017, 0.025, 0.04, 0.07, 0.12, 0.2,
];
/// Travels over which it builds up that are tried \[rad\], \[m\]: the shortest is an encoder's count, the longest a soft seal.
pub(crate) const FRICTION_TRAVELS: [f64; 10] =
    [3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1];
/// Rounds in which each joint's law is chosen with those of the others, until none changes. Cost.
pub(crate) const FRICTION_ROUNDS: usize = 40;
/// A law with a memory is taken where it explains this much more \[nats\] per row of a joint: both laws are of three numbers, and
/// the one without a memory is what simulators have.
pub(crate) const MEMORY_NATS_PER_ROW: f64 = 0.005;
/// Half a step either way for the derivative by the logarithm of a law's size.
pub(crate) const FRICTION_LOG_STEP: f64 = 0.2;
/// Farthest that a law's size is from the one that was tried: half of the way to the next.
pub(crate) const FARTHEST_LOG_SIZE: f64 = 0.6;

// `identify::numbers`
/// Half a step either way for the derivative by the delay, as a share of the log's step.
pub(crate) const DELAY_DIFFERENCE: f64 = 0.5;

// `identify::loaded`
/// What it explains beyond its number, at least \[nats\], rows with a memory counted as what they say.
pub(crate) const LOADED_NATS: f64 = 16.0;

// `identify::feasible`
/// Steps of Gauss and Newton, and when they end: the change of a coordinate.
pub(crate) const GAUSS_NEWTON_STEPS: usize = 60;
pub(crate) const COORDINATE_TOLERANCE: f64 = 1e-9;
/// What the rounding of its numbers may take off the least eigenvalue of a body, many times over.
pub(crate) const EIGENVALUE_ROUNDING: f64 = 1e-11;
/// The same of a second moment, which is a difference of inertias, as a share of them.
pub(crate) const MOMENT_ROUNDING: f64 = 1e-14;

// `identify::instruments`
/// Samples that are looked at for a period.
pub(crate) const PERIOD_SAMPLES: usize = 1500;
/// Share of the motion's variance that a period leaves at most.
pub(crate) const PERIOD_LEAVES: f64 = 0.01;
/// Share that has to be left at a shorter lag, so that a lag is a period and not a step.
pub(crate) const SHORTER_LAG_LEAVES: f64 = 0.5;
/// Share of the motion's variance that commands leave at most.
pub(crate) const COMMANDS_LEAVE: f64 = 0.05;
/// Rows that say how much later than its command a joint is, at most. Cost.
pub(crate) const COMMAND_ROWS: usize = 20_000;
/// Longest lag between command and position that is tried \[s\].
pub(crate) const LONGEST_LAG_S: f64 = 0.2;

// `identify::bias`
/// Draws of the noise: their mean is taken.
pub(crate) const NOISE_DRAWS: u64 = 3;

// `identify::chosen`
/// Share of a standard deviation from which a bias is worth the larger intervals of instruments.
pub(crate) const WORTHWHILE_BIAS: f64 = 0.25;
/// Instruments by which the median number is this many times less certain than by least squares say too little.
pub(crate) const MOST_WIDENING: f64 = 3.0;

// `identify::result`
/// Half width of a normal 95 % interval in standard deviations.
pub(crate) const NORMAL_95: f64 = 1.96;

// `identify::estimate`
/// Largest correlation of a score with the row before that is taken off it (Andrews & Monahan 1992).
pub(crate) const MOST_MEMORY: f64 = 0.97;
