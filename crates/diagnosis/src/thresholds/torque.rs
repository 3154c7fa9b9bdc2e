//! Torques of the drives and the hand's force (docs/diagnosis-force.md).

/// What an assumed mass may be wrong by, relative. Choice.
pub(crate) const MASS_SD: f64 = 0.1;
/// What an assumed mass may be wrong by at least \[kg\]. Choice.
pub(crate) const LEAST_MASS_SD_KG: f64 = 5e-3;
/// What an assumed centre of mass may be wrong by along each axis \[m\].
pub(crate) const CENTRE_SD_M: f64 = 2e-3;
/// What the mass and the first moments of a plausible rod may be wrong by, relative, where the file has no mass. Choice.
pub(crate) const ROD_SD: f64 = 1.0;
/// Probability of any name on torques without an effect, and of any link whose file is right. Choice.
pub(crate) const FAMILY_WISE_P: f64 = 1e-3;
/// Least torque of a link's weight that is another, over a row's noise.
pub(crate) const LEAST_WEIGHT: f64 = 0.2;
/// Least size of an effect: its mean square over that of a row's noise. Errors of the angles and of the geometry
/// that are no effects on torques leave less than this.
pub(crate) const LEAST_SHARE_OF_NOISE: f64 = 0.04;
/// Least share of its columns that the base model must leave.
pub(crate) const LEAST_RETAINED: f64 = 0.05;
/// Least part of what is left that a further effect must explain.
pub(crate) const SHARE_OF_REST: f64 = 0.1;
/// Effects that are named at most.
pub(crate) const MOST_NAMES: usize = 3;
/// Harmonic errors of angles that are allowed for in addition to the named effects.
pub(crate) const MOST_RIPPLES: usize = 4;
/// Steps of the search for a transition. Cost.
pub(crate) const TRANSITION_STEPS: usize = 8;
/// Factor that the search for a transition goes to each side. Choice.
pub(crate) const TRANSITION_REACH: f64 = 3.2;
/// Part of a hysteresis that neither a bias nor a gain of the sensor explains.
pub(crate) const LEAST_LOOP: f64 = 0.5;
/// Orders of cogging that one joint may have: more of them would follow any function of its angle.
pub(crate) const MOST_ORDERS: usize = 2;
/// Delay of the encoders against the torques \[s\].
pub(crate) const DELAY_SD_S: f64 = 2e-2;
/// Rounds in which the scales' columns settle; each leaves the square of a scale's error.
pub(crate) const SCALE_ROUNDS: usize = 2;
/// Smallest uncertainty of a torque's scale.
pub(crate) const LEAST_SCALE_SD: f64 = 1e-4;
/// Slow energy beyond noise, in its standard deviations, that is a gap.
pub(crate) const OMNIBUS_DEVIATIONS: f64 = 6.0;
/// Least structure that is a gap: its mean square over that of a row's noise, all channels together. Angles and
/// lengths that other effects falsify leave less.
pub(crate) const LEAST_STRUCTURE: f64 = 0.2;
/// A gap that wrong angles may cause is said to be dropped where a torque shows so many times its noise.
pub(crate) const SAID_BEYOND: f64 = 2.0;
/// Part of the structure that named effects may leave.
pub(crate) const UNEXPLAINED_SHARE: f64 = 0.1;
/// Standard deviations of slow energy above noise that are noise still.
pub(crate) const NOISE_DEVIATIONS: f64 = 4.0;
/// A force that does not pass the sensor, and readings of the sensor that are wrong by no law of the catalogue,
/// are one equation: neither is likelier.
pub(crate) const GRIP_PROBABILITY: f64 = 0.5;
/// Probability that an effect on torques is one of the catalogue.
pub(crate) const LISTED_PROBABILITY: f64 = 0.97;
/// Times the torque that wrong angles cause by which a finding must stand out.
pub(crate) const BEYOND_WRONG_ANGLES: f64 = 3.0;
/// Deviations of a torque's scale from the drive's stated one that are a gap, whether or not they have a name.
pub(crate) const STRAINED: f64 = 5.0;
/// Part of the structure that a free force at the handle may leave.
pub(crate) const GRIP_LEFT: f64 = 0.1;
/// Torques in addition to the force's three directions that the test needs.
pub(crate) const SPARE_CHANNELS: usize = 2;
/// Residuals of positions over their noise that are a gap.
pub(crate) const POSITION_GAP: f64 = 1.5;
/// Strain of the geometry, per parameter, that torques alone do not cause.
pub(crate) const STRAIN: f64 = 0.5;
/// The same where a link's weight is in question, which a falsified geometry changes first.
pub(crate) const WEIGHT_STRAIN: f64 = 0.25;
/// What a calibrated length may still be wrong by \[m\].
pub(crate) const LENGTH_SD_M: f64 = 2e-3;
/// What a calibrated angle may still be wrong by \[rad\].
pub(crate) const ANGLE_SD_RAD: f64 = 1e-2;
/// One over the variance of a force of which nothing is known \[1/N^2\].
pub(crate) const FORCE_PRIOR: f64 = 1e-6;
/// Time that one block averages \[s\]: short against a motion, long against the sampling.
pub(crate) const BLOCK_S: f64 = 0.1;
/// Most rows of a block.
pub(crate) const LONGEST_BLOCK_ROWS: usize = 400;
/// Blocks of a window, within which what is left of a gap hardly changes.
pub(crate) const WINDOW_BLOCKS: usize = 4;
/// Readings per parameter of the base model that are enough.
pub(crate) const READINGS_PER_PARAMETER: usize = 8;
/// What the base model itself may be wrong by, over a torque's root mean square: postures are means of half blocks.
pub(crate) const MODEL_SD: f64 = 1e-3;
/// Standard deviation of the hand's force where nothing is known of it \[N\].
pub(crate) const UNKNOWN_FORCE_SD_N: f64 = 30.0;
/// Standard deviation of a torque of which nothing is known \[N m\].
pub(crate) const UNKNOWN_TORQUE_SD_NM: f64 = 10.0;

// `force::along`
/// Part of the largest inertial column below which one is rounding alone.
pub(crate) const COLUMN_ROUNDING: f64 = 1e-9;

// `force::asked`
/// Part of the rows, the last ones, that a fit does not see whose effects are tried on them.
pub(crate) const UNSEEN_PART: f64 = 1.0 / 3.0;

// `force::base`
/// Part of a column's square that every column has as knowledge beforehand: inertial parameters that only sums of
/// which show have a smallest solution.
pub(crate) const KNOWN_BEFOREHAND: f64 = 1e-9;

// `force::recorded`
/// Rows farther apart than this are more likely stamped in milliseconds \[s\].
pub(crate) const MILLISECONDS_S: f64 = 2.0;
/// Share of the force's square below which its changes are none.
pub(crate) const CONSTANT_FORCE: f64 = 1e-6;

// `force::rows`
/// Part of the largest variance below which a combination of harmonics is rounding alone.
pub(crate) const ABSENT_HARMONIC: f64 = 1e-12;
/// Squared share of a direction that must survive a projection to count.
pub(crate) const SURVIVING: f64 = 1e-6;

// `force::select`
/// Step of a derivative by the logarithm of a shape's number.
pub(crate) const SHAPE_STEP: f64 = 0.05;
