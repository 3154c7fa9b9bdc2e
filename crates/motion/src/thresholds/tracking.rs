//! Delays between command and torque.

// `tracking::rows`
/// Most readings of a log that are looked at: where the commands move most.
pub(crate) const MOST_READINGS: usize = 30_000;
/// Most rows of a joint, and fewest.
pub(crate) const MOST_ROWS: usize = 800;
pub(crate) const LEAST_ROWS: usize = 60;
/// Delays that are tried: from a command that is early to one that is late \[s\].
pub(crate) const EARLIEST_S: f64 = -0.02;
pub(crate) const LATEST_S: f64 = 0.1;

// `tracking::fit`
/// Delays that are tried at first \[s\].
pub(crate) const DELAYS_S: [f64; 7] = [EARLIEST_S, 0.0, 0.01, 0.02, 0.04, 0.07, LATEST_S];
/// Distances of the parabolas through the best of them \[s\].
pub(crate) const PARABOLAS_S: [f64; 4] = [4e-3, 1e-3, 2.5e-4, 1e-4];
/// Distance over which the sharpness of the best one is looked at \[s\].
pub(crate) const SHARPNESS_S: f64 = 5e-4;

// `tracking`
/// A command that is heard within this share of a step of the log, or within this time, is heard in time (A192).
pub(crate) const IN_TIME_STEPS: f64 = 0.5;
pub(crate) const IN_TIME_S: f64 = 2e-3;
/// A delay is beyond that by so many of its standard deviations.
pub(crate) const SURELY_LATE_SDS: f64 = 2.0;
/// It explains more than any law without one, at least \[nats\].
pub(crate) const LEAST_NATS: f64 = 16.0;
/// Share of the energy beyond noise, between command and torque, that a delay may leave: what leaves more is not the delay's.
pub(crate) const LEFT_BY_DELAY: f64 = 0.25;
/// Share of the joints whose torques a law has to explain.
pub(crate) const LEAST_OF_JOINTS: f64 = 0.5;
