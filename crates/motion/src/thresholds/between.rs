//! Encoders on links, next to those of their motors.

// `between::rows`
/// Edges of the band of the rows \[Hz\] where a load has little noise, and where it is a drive's torque: above the second one the noise of
/// its current, over a stiffness, is larger than what the encoder shows of it (A166). At most this share of the log's rate.
pub(crate) const LINKS_EDGE_HZ: f64 = 20.0;
pub(crate) const DRIVES_EDGE_HZ: f64 = 8.0;
pub(crate) const EDGE_OF_RATE: f64 = 0.1;
/// Most rows of a joint: longer logs keep every second one, or fewer.
pub(crate) const MOST_ROWS: usize = 4000;
/// Fewest rows of a joint.
pub(crate) const LEAST_ROWS: usize = 60;
/// A recording in which no joint moves faster than this is at rest \[rad/s\].
pub(crate) const STILL_RAD_PER_S: f64 = 1e-3;

// `between::terms`
/// What a term explains beyond its numbers, at least \[nats\].
pub(crate) const LEAST_NATS: f64 = 12.0;
/// Half a play is at least this share of what the gear yields in a standard deviation of the load: a smaller one is what a spring's law gets
/// wrong.
pub(crate) const LEAST_PLAY: f64 = 0.1;
/// Shortest delay in steps of the log: what damps a gear, over its stiffness, lags as well (A168).
pub(crate) const LEAST_DELAY_STEPS: f64 = 0.05;
/// Loads below these shares of their root mean square may be no load: the bodies' masses are not known better, and a link that flies
/// through its play is unloaded.
pub(crate) const FLIGHT_SHARES: [f64; 4] = [0.03, 0.06, 0.12, 0.25];
/// Shares by which a gear may be harder at the root mean square of its load than at rest that are tried.
pub(crate) const HARDENING_SHARES: [f64; 6] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0];

// `between::choose`
/// Most terms at once.
pub(crate) const MOST_TERMS: usize = 12;
/// Largest share of rows in which a play may leave the place of its link open.
pub(crate) const MOST_FLIGHT: f64 = 0.35;
/// Steps either way in the search for the share of a spring that hardens, and their size.
pub(crate) const FINER_STEPS: i32 = 16;
pub(crate) const FINER_STEP: f64 = 1.1;

// `between::fit`
/// Rounds of the fit of the noise and of a delay's second order after which it has not converged. Cost.
pub(crate) const FIT_ROUNDS: usize = 200;
/// Change of twice the logarithm of the likelihood by a round that is the last: numbers are within a tenth of their standard deviations.
/// Choice.
pub(crate) const LEAST_FALL: f64 = 0.01;
/// Largest correlation of neighbouring rows that is looked for.
pub(crate) const MOST_CORRELATED: f64 = 0.95;
/// What is added to the square of each column, over it, and the least square that counts there.
pub(crate) const RIDGE: f64 = 1e-10;
pub(crate) const LEAST_SQUARE: f64 = 1e-200;

// `between::answer`
/// A spring beside a play is reported from this many standard deviations on.
pub(crate) const SURE_YIELD_SDS: f64 = 3.0;
/// Relative standard deviation of how a spring hardens, whose law is no gear's to the last digit.
pub(crate) const HARDENING_SD: f64 = 0.5;
/// Rivals further behind are not reported \[nats\].
pub(crate) const FAR_RIVAL_NATS: f64 = 12.0;

// `between`
/// Shares of the energy beyond noise that effects may leave, on rows that were fitted and on others.
pub(crate) const LEFT: f64 = 0.02;
pub(crate) const LEFT_UNSEEN: f64 = 0.1;
/// A joint with less than this share of the gap, and without an effect, may keep it.
pub(crate) const PART_OF_GAP: f64 = 0.01;
/// Square of what passes for noise over the noise: rounding is not white.
pub(crate) const NOISE_SQUARE: f64 = 1.5;

// `between::own`
/// Energy beyond noise, over that of noise, that passes for noise.
pub(crate) const NOISE_ENERGY: f64 = 0.5;
