//! Numbers that decide, each with its meaning and how it was set.
//!
//! "Real arm": twelve motions of an SO-101 at 50 Hz (docs/real-arms.md).

/// Rows that a joint needs.
pub(crate) const FEWEST_ROWS: usize = 200;
/// Steps in time from which rows are no longer neighbours.
pub(crate) const GAP_STEPS: f64 = 3.0;
/// A command that moves by less is still, in counts of the sensor and \[rad\].
pub(crate) const STILL_COUNTS: f64 = 4.0;
pub(crate) const STILL_RANGE: f64 = 1e-3;
/// How far from a whole turn a step of one row is a wrap \[rad\].
pub(crate) const WRAP: f64 = 0.6;
/// Correlation with the command, at the best lag, below which a joint does not follow it.
pub(crate) const SAME_MOTION: f64 = 0.2;
/// And with the command turned round beyond which it moves against it: of a wave, half a period of lag is a turned sign too.
pub(crate) const OPPOSITE: f64 = 0.85;
pub(crate) const DEGREES_PER_RADIAN: f64 = 180.0 / std::f64::consts::PI;

/// Contiguous parts of a log that are held out in turn.
pub(crate) const FOLDS: usize = 8;
/// A delay or a lag beyond this is no servo's \[s\].
pub(crate) const MOST_LAG_S: f64 = 0.3;
/// What an effect must close of the gap's squares on unseen rows.
pub(crate) const LEAST_SHARE: f64 = 0.01;
/// The same of a droop that no torque is known of: sines and cosines of all angles follow much.
pub(crate) const LEAST_DROOP_SHARE: f64 = 0.1;
/// One of delay and lag alone is enough where it leaves no more of the unseen squares than this many times what both do.
pub(crate) const AS_GOOD: f64 = 1.02;
/// And the other alone is refused where it leaves more than this many times: a loop's stick and slip favours the one or the other
/// by a few percent (real arm: up to 1.4).
pub(crate) const REFUSED: f64 = 2.0;
/// A gain on unseen rows is sure if it is this many standard deviations over the folds, or if all folds but one gain.
pub(crate) const SURE_SD: f64 = 2.0;
/// An answer needs causes that close this share of the gap's squares on unseen rows.
pub(crate) const CLOSED: f64 = 0.3;
/// Where more than this share is left, the answer says that a part of the gap is named.
pub(crate) const ALL_CLOSED: f64 = 0.95;
/// A gap is one where its size is this many times the floor.
pub(crate) const ABOVE_FLOOR: f64 = 1.5;
/// Offset beyond this many counts.
pub(crate) const OFFSET_COUNTS: f64 = 1.0;
/// A gain that is nearer to 1 may be the droop under gravity.
pub(crate) const DROOP_GAIN: f64 = 0.3;
/// Range of motion over which gravity's torque would not look like a constant \[rad\].
pub(crate) const WIDE_RAD: f64 = 1.0;

/// Changes: what the regression's likelihood must gain \[nats\]. The largest gain of a delay on the real arm is 5, of an
/// offset 420, and a fault of 17 degrees has 4000 and more.
pub(crate) const DELAY_NATS: f64 = 15.0;
pub(crate) const LEVEL_NATS: f64 = 50.0;
/// A delay must explain this share of what a regression of its own after the change does.
pub(crate) const SHARE_OF_FREE: f64 = 0.75;
/// An offset or a gain must leave less than this share of the squares that the servo's laws leave without it.
/// Of the real arm without a fault the least is 0.62.
pub(crate) const LEVEL_LEAVES: f64 = 0.5;
/// An offset that is no friction, in widths of the friction's band.
pub(crate) const BEYOND_BAND: f64 = 1.5;
/// The instant lies where the likelihood is within this of its largest \[nats\].
pub(crate) const PLACE_NATS: f64 = 4.6;
/// Or within this share of it.
pub(crate) const PLACE_SHARE: f64 = 0.05;
/// Rows are as likely as the likeliest within this \[nats\], or this share of it: a joint that rests shows no delay.
pub(crate) const SAME_NATS: f64 = 2.0;
/// See [`SAME_NATS`].
pub(crate) const SAME_SHARE: f64 = 0.004;
/// Beyond this they are a rest \[s\].
pub(crate) const LONG_REST_S: f64 = 2.0;
/// Part of the log on either side of a change by itself \[s\]: a loop that is not linear is for so long.
pub(crate) const NEAR_S: f64 = 6.0;
/// The joint must move in this share of it.
pub(crate) const NEAR_MOVES: f64 = 0.5;
/// Changes of one joint at most.
pub(crate) const MOST_CHANGES: usize = 3;
