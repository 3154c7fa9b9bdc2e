//! Rows of a problem and the base model that is fitted to them.

// `fit::problem`
/// Edges of the band that are tried, widest first \[Hz\]: an arm's motion is below the first, and where positions are coarse the
/// noise of their accelerations asks for a narrower one.
pub(crate) const EDGES_HZ: [f64; 6] = [20.0, 12.0, 8.0, 5.0, 3.0, 2.0];
/// Edge of the band, at most this share of the log's rate.
pub(crate) const EDGE_OF_RATE: f64 = 0.1;
/// Lowest rate of a log \[Hz\], and what rounded stamps may take off it, as a share.
pub(crate) const LEAST_RATE_HZ: f64 = 20.0;
pub(crate) const RATE_ROUNDED: f64 = 0.01;
/// Fewest rows of a joint.
pub(crate) const LEAST_JOINT_ROWS: usize = 30;
/// A joint that moves slower than this share of its fastest rests: friction that sticks is not known there.
pub(crate) const RESTING_SHARE: f64 = 0.02;
/// A joint whose fastest motion is slower than this share of the fastest joint's, and than `STILL`, is at rest.
pub(crate) const STILL: f64 = 1e-3;

// `fit::base`
/// Speeds within which Coulomb friction turns over that are tried, \[rad/s\] or \[m/s\].
pub(crate) const TURNOVERS: [f64; 10] = [
    0.0015, 0.003, 0.005, 0.0075, 0.011, 0.017, 0.025, 0.04, 0.07, 0.12,
];
/// Times by which Coulomb friction may lead the motion, and lag it where negative, that are tried \[s\]. It lags by its memory (Hess and
/// Soom 1990); where a simulator holds it back by a soft constraint it leads (docs/assumptions.md, A185).
pub(crate) const LEADS_S: [f64; 7] = [0.0, 0.003, 0.006, 0.009, 0.012, -0.003, -0.006];
/// Travel over which every friction may build up: the joint's at its fastest in so many seconds.
pub(crate) const BRISTLE_S: f64 = 1e-4;
/// Noise of a fitted armature's acceleration, over that of a row, from which on it counts.
pub(crate) const LOUD_ARMATURE: f64 = 0.3;

/// Share of its dry friction that a joint's torque may be off by: no law of friction holds to the last digit (A319).
pub(crate) const OF_FRICTION: f64 = 0.01;

// `adjusted`
/// Shares of a body's deviation that are tried until it is one that a body can have, largest first.
pub(crate) const SHARES_OF_DEVIATION: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

// `fit::column`
/// Zeros in a row that end a span.
pub(crate) const GAP_ROWS: usize = 8;

// `fit::trimmed`
/// Share of the times that agree, at least.
pub(crate) const LEAST_AGREEING: f64 = 0.6;
/// Concentration steps.
pub(crate) const CONCENTRATION_STEPS: usize = 8;
/// A time that lies this many standard deviations beyond noise is outside.
pub(crate) const OUTSIDE_SDS: f64 = 6.0;
/// Mean square of what agrees, at most, in squares of noise.
pub(crate) const AGREEING_SQUARE: f64 = 2.0;
/// Share of the friction of the device's file by which what is fitted differs where that is said.
pub(crate) const OTHER_FRICTION: f64 = 0.25;
