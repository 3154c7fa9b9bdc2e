//! What is a gap, and what effects may leave of it.

// `examine`
/// Edges of the band in which a spring between motor and link is looked for once more \[Hz\].
pub(crate) const SPRING_EDGES_HZ: [f64; 2] = [8.0, 5.0];
/// A noise with a memory is at most this many times a white one that is as large at its fastest: more is a disturbance of a colour of its own.
pub(crate) const MOST_OF_MEMORY: f64 = 4.0;
/// Effects that a second recording may refute, until no more are looked for in their place.
pub(crate) const MOST_REFUTED: usize = 4;

// `examined`
/// A channel's rest is a gap beyond this share of the square of its noise, and beyond `GAP_SDS` standard deviations of such a
/// square by chance: a sound arm's friction is no law to the last digit.
pub(crate) const ALLOWED_REST: f64 = 0.21;
pub(crate) const GAP_SDS: f64 = 4.0;
/// Rivals nearer than this are not distinguishable: ln 100 (Kass & Raftery 1995) \[nats\].
pub(crate) const NEAR_RIVAL_NATS: f64 = 4.605;
/// Share of what the base model leaves beyond noise that effects may leave.
pub(crate) const UNEXPLAINED: f64 = 0.02;
/// And of each joint's root mean square, beyond twice its noise.
pub(crate) const LEFT_OF_JOINT: f64 = 0.1;
pub(crate) const QUIET_NOISES: f64 = 2.0;
/// An effect whose law is exact leaves noise of a torque's dependence on the posture: more than this share of a rest is another law's.
pub(crate) const LEFT_OF_POSTURE: f64 = 0.5;
/// Share of a rest that friction by the position explains where it is nothing else, and most that it may explain of the gap where effects are
/// named next to it. What stays of a second recording is at most so many times what stays of the first.
pub(crate) const ALL_FRICTION: f64 = 0.9;
pub(crate) const MOST_FRICTION: f64 = 0.5;
pub(crate) const FRICTION_OF_SECOND: f64 = 1.5;
/// Share of the squares that such effects leave of some torque's gap, and most of another one's.
pub(crate) const MOST_OF_CLOSED: f64 = 0.25;
pub(crate) const NO_WORSE: f64 = 1.1;
/// Share of a free function's square that the fit leaves: of less than this what it takes off is not stated, whose digits would be those of
/// the processor's rounding.
pub(crate) const CLEAR: f64 = 1e-5;
/// Pieces of a joint's range over which its friction may have levels of their own.
pub(crate) const FRICTION_KNOTS: usize = 24;
/// But they may leave this share of the gap, and of a channel's squares: the levers of a spring, and the bodies that carry a load, are off
/// themselves by some percent. No further effect is seen in it (A318).
pub(crate) const LEFT_BY_LAW: f64 = 2.5e-3;
/// Share of what the base model leaves beyond noise that effects may leave which explain a part of it (A311).
pub(crate) const LEFT_BY_PART: f64 = 0.1;
/// Torques lack gravity's part where that of the nominal bodies explains this share of the gap, with a factor in this range: bodies are
/// known to some percent.
pub(crate) const GRAVITY_EXPLAINS: f64 = 0.8;
pub(crate) const GRAVITY_OFF: std::ops::Range<f64> = -1.2..-0.8;
/// Share of a channel's gap that counts as closed: less is no part.
pub(crate) const LEAST_PART: f64 = 0.2;
/// A joint with less than this share of the gap may keep it: that is another gap than the one that has a name.
pub(crate) const PART_OF_GAP: f64 = 0.01;
/// What an effect of one joint's torque may explain at most, over what the base model leaves there.
pub(crate) const MOST_OF_GAP: f64 = 4.0;
/// Share of a second recording's squares beyond noise that effects may leave of it.
pub(crate) const LEFT_OF_SECOND: f64 = 0.1;
/// The same with a spring between motor and link, which is known to first order alone (A201).
pub const OF_SECOND_BESIDE_SPRING: f64 = 0.6;

// `dependence`
/// Degree of a function of the quantity alone, and of each factor of a product with another one.
pub(crate) const QUANTITY_DEGREE: usize = 8;
pub(crate) const PRODUCT_DEGREE: usize = 3;

// `unseen`
/// Parts in time that sums are kept of.
pub const PARTS: usize = 10;
/// Fits, each without every fifth part.
pub(crate) const FOLDS: usize = 5;
