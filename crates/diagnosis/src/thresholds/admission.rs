//! Whether a log may be answered (A310).

/// Share of what a channel varies by that the model, causes included, may miss. Choice: a device file's lengths are known to a few
/// percent, and readings of no relation to the joints are missed by all of it.
pub(crate) const MOST_MISSED: f64 = 0.2;
/// The same of an encoder on a joint: the cables of a wrist in play leave a third of a small motion.
pub(crate) const MOST_MISSED_BY_ENCODER: f64 = 0.4;
/// How far the fitted chain may be from the device file's along the log, as a share of what the handle moves by, where it has numbers that no
/// device has: less is another description of the same chain.
pub(crate) const MOST_APART: f64 = 0.05;
/// Least root mean square by which a channel varies to be asked \[rad or m\]: below it a wrong zero or play is a large part of it.
pub(crate) const LEAST_SPREAD: f64 = 0.01;
/// Share of the variance of the largest torque that links, friction and rotor explain at least: torques of another log leave more.
pub(crate) const FOLLOWED: f64 = 0.5;
/// Noises of its torque by which fitted friction drives a joint, as none does.
pub(crate) const DRIVING_NOISES: f64 = 2.0;
/// Least length of a motion whose torques are judged \[s\]: of 2 s of an elastic rope three causes had names.
pub(crate) const LEAST_MOTION_S: f64 = 4.0;
/// Standard deviations of the noise, by second differences, from which a step to one value and back is none of the motion, and one from
/// which a single reading stands alone.
pub(crate) const DROPOUT_SDS: f64 = 8.0;
pub(crate) const SPIKE_SDS: f64 = 15.0;
/// The same of readings among which there are such, and rows on either side whose median they are compared with.
pub(crate) const WILD_SDS: f64 = 6.0;
pub(crate) const SPIKE_REACH: usize = 4;
/// Fewest moments with such readings, and most of these in a moment: an arm that rings has them in stretches.
pub(crate) const LEAST_WILD_MOMENTS: usize = 5;
pub(crate) const MOST_WILD_ROWS: usize = 6;
/// Most times that they are looked for, those found before left out.
pub(crate) const MOST_WILD_PASSES: usize = 4;
/// Median distance of what is read around moments at a value from that value, over that of all readings: below, the channel is about it.
pub(crate) const LEAST_DROPOUT_LEVEL: f64 = 0.3;
/// The least of the torque's standard deviation that such a reading is off by.
pub(crate) const SPIKE_OF_TORQUE: f64 = 0.1;
/// Share of them that lies in the lowest fifth of the joint's speed or load where they are the arm's and no wrong readings: by chance it is 0.2.
pub(crate) const MOST_AT_LOW: f64 = 0.6;
/// Fewest such readings, their least share and their largest.
pub(crate) const LEAST_DROPOUTS: usize = 3;
pub(crate) const LEAST_DROPOUT_SHARE: f64 = 0.002;
/// The same of single wild readings: a knock is one, too.
pub(crate) const LEAST_SPIKE_SHARE: f64 = 0.005;
pub(crate) const MOST_DROPOUT_SHARE: f64 = 0.5;
/// Least share of the rows of a moving joint that repeat a torque beyond what its steps do by chance, times so much, and the largest: beyond it
/// the torque is written less often than the log has rows.
pub(crate) const LEAST_HELD_SHARE: f64 = 0.01;
pub(crate) const HELD_OVER_CHANCE: f64 = 3.0;
pub(crate) const MOST_HELD_SHARE: f64 = 0.25;
/// Most rows of a moment that is filled in between its neighbours, in a torque.
pub(crate) const FILLED_ROWS: usize = 4;
/// Most rows of one moment: a joint that rests reads one value for longer.
pub(crate) const LONGEST_DROPOUT_ROWS: usize = 25;
/// Readings that are needed for each fitted number.
pub(crate) const READINGS_PER_NUMBER: f64 = 3.0;

/// Most of a channel's residual that causes leave where nothing says how large its noise is. Choice: a displacement under a false name left
/// two thirds and more.
pub(crate) const MOST_LEFT: f64 = 0.5;
