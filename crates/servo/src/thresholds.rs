//! Numbers that decide, each with its meaning and how it was set.
//!
//! "Real arm": twelve motions of an SO-101 at 50 Hz (docs/real-arms.md). A line before a group names the module that uses it.

/// Rows are at most this far apart \[s\]: 20 a second, as for the torques of a motion, with what rounded stamps add.
pub(crate) const LONGEST_STEP_S: f64 = 0.0505;
/// Rows that a joint needs.
pub(crate) const FEWEST_ROWS: usize = 200;
/// Least time that they last \[s\], as of the torques of a motion: of 2 s of a sound arm four joints had causes.
pub(crate) const SHORTEST_S: f64 = 4.0;
/// Steps in time from which rows are no longer neighbours.
pub(crate) const GAP_STEPS: f64 = 3.0;
/// A command that moves by less is still, in counts of the sensor and \[rad\].
pub(crate) const STILL_COUNTS: f64 = 4.0;
pub(crate) const STILL_RANGE: f64 = 1e-3;
/// How far from a whole turn a step of one row is a wrap \[rad\].
pub(crate) const WRAP: f64 = 0.6;
/// A joint that stands still for this share of the rows at the log's end, and for as long, while its command moves by this share of its
/// range, has stopped: within so many counts.
pub(crate) const STOPPED_SHARE: f64 = 0.1;
pub(crate) const STOPPED_S: f64 = 1.0;
pub(crate) const STOPPED_COMMAND: f64 = 0.2;
pub(crate) const STOPPED_COUNTS: f64 = 2.0;
/// Correlation with the command, at the best lag, below which a joint does not follow it.
pub(crate) const SAME_MOTION: f64 = 0.2;
/// And with the command turned round beyond which it moves against it: of a wave, half a period of lag is a turned sign too.
pub(crate) const OPPOSITE: f64 = 0.85;
pub(crate) const DEGREES_PER_RADIAN: f64 = 180.0 / std::f64::consts::PI;

/// Contiguous parts of a log that are held out in turn.
pub(crate) const FOLDS: usize = 8;
/// Rows of a long log that laws are fitted to, or seconds where those have more rows, in so many stretches; what the laws leave of its
/// other rows is worked out once. More rows add little: what a law leaves of a real servo is no noise, and does not fall with their number.
pub(crate) const MOST_FITTED_ROWS: usize = 4000;
pub(crate) const MOST_FITTED_S: f64 = 40.0;
pub(crate) const STRETCHES_OF_FIT: usize = 2 * FOLDS;
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
/// The same next to a law that leaves no gap but noise, which favours neither: of 34 logs of a pure delay a loop with a mass left up to 1.18
/// times as much where no motion was fast enough.
pub(crate) const REFUSED_AT_NOISE: f64 = 1.2;
/// Damping ratio of a loop with a mass at which its search starts: there it answers slow commands as a delay does.
pub(crate) const START_DAMPING: f64 = 0.7;
/// Delay and lag at which their search starts within a limit of the speed \[s\].
pub(crate) const START_LAG_S: f64 = 0.01;
/// A gain on unseen rows is sure if it is this many standard deviations over the folds, or if all folds but one gain.
pub(crate) const SURE_SD: f64 = 2.0;
/// Where a law does nothing in some parts, so many others must each leave [`REFUSED`] times as much without it: noise halves none.
pub(crate) const FEWEST_SPEAKING: usize = 3;
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
/// Time between rows up to which rows of a faster log are put together where a delay is looked for \[s\]: the regression's lags then
/// see 0.16 s. Of 1000 rows a second they saw 16 ms, less than most delays, and 3 of 47 logs without a change had one.
pub(crate) const DELAY_STEP_S: f64 = 0.01;
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

// `log`
/// Changes of a reading that show its count.
pub(crate) const FEWEST_COUNTS: usize = 5;

// `joint`
/// What the search stops at, as a share of a number: folds that end at one point are no surer than that.
pub(crate) const RESOLUTION: f64 = 2e-3;

/// Deviation of a limit of the speed, as a share of it, in shares of the gap's size that the laws leave beyond noise. Of 36 logs of four
/// drives that come to their limit in other ways the limit was off by 1.7 such shares at most, and by 1.2 in all but one.
pub(crate) const LAW_SHARE: f64 = 0.6;

// `fit::linear`
/// Share of a column's square that holds the weakest directions.
pub(crate) const RIDGE: f64 = 1e-9;

// `fit::search`
/// Rounds of a search after which it has not converged. Cost.
pub(crate) const SEARCH_ROUNDS: usize = 400;
/// Fall of the squares that the parabola through the last points promises, in variances of the noise, below which a search ends: numbers are
/// within a tenth of their standard deviations.
pub(crate) const LEAST_FALL: f64 = 0.01;
/// The same of searches from several starts, on so many rows at most, or those of so many seconds, from the best of which all rows go on.
pub(crate) const ROUGH_FALL: f64 = 1.0;
pub(crate) const ROUGH_ROWS: usize = 1200;
pub(crate) const ROUGH_S: f64 = 12.0;
pub(crate) const ROUGH_STRETCHES: usize = 4;

// `change::sums`
/// Past readings of the position in the regression.
pub(crate) const PAST_READINGS: usize = 2;
/// Past of the command that the regression sees \[s\].
pub(crate) const MEMORY_S: f64 = 0.32;
/// Lags of the command at most.
pub(crate) const MOST_LAGS: usize = 16;
/// Grid points over a log at most.
pub(crate) const MOST_POINTS: usize = 1200;
/// Least rows between them.
pub(crate) const LEAST_STEP: usize = 10;
/// Rows before and after a reading whose velocities it follows: velocities are a mean over the last rows, or of the next.
pub(crate) const VELOCITY_LAGS: std::ops::Range<isize> = -3..2;

// `change::scan`
/// Factors that a gain is looked for at.
pub(crate) const GAIN_FACTORS: [f64; 6] = [0.125, 0.25, 0.5, 2.0, 4.0, 8.0];
/// Part of the log at either end in which no change of a level is looked for.
pub(crate) const LEVEL_EDGE: usize = 20;
/// Points over a log at which a change is looked for first, at most, and how much finer each look about the likeliest is than the one before.
pub(crate) const SCAN_POINTS: usize = 150;
pub(crate) const FINER: usize = 8;
/// Rows that are looked at besides a grid.
pub(crate) const LEVEL_REPEATS: usize = 12;

// `change::delay`
/// Rows by which a delay is looked for at.
pub(crate) const DELAY_SHIFTS: [isize; 8] = [-5, -3, -2, -1, 1, 2, 3, 5];
/// Parts of a row to which a delay is refined, and of rows that were put together.
pub(crate) const DELAY_PARTS: [f64; 2] = [0.1, 0.02];
/// Part of the log at either end in which none is looked for: a single step shows it badly.
pub(crate) const DELAY_EDGE: usize = 8;
/// Rows that are looked at besides a grid.
pub(crate) const DELAY_REPEATS: usize = 24;
/// What a repeated reading of a joint that moves says at most \[nats\]: a bus may drop one by itself.
pub(crate) const REPEATED_NATS: f64 = 7.0;
/// Stretches on either side of a change that are counted by themselves, those of them that may be something else, and what the
/// others must say \[nats\].
pub(crate) const STRETCHES: usize = 24;
pub(crate) const SPARE_STRETCHES: usize = 2;
pub(crate) const BROAD_NATS: f64 = 1.0;

// `change::still`
/// Runs on either side that are needed.
pub(crate) const FEWEST_RUNS: usize = 4;
/// How many times the scatter of runs an offset between two of them is.
pub(crate) const RUN_SCATTERS: f64 = 3.0;
/// Share of the squares that two means take which one leaves.
pub(crate) const SPLIT_SHARE: f64 = 0.5;
/// Least step of a joint whose command stands that is no slip of its friction \[rad\], and in deviations of its readings.
pub(crate) const STILL_STEP: f64 = 0.03;
pub(crate) const STILL_SD: f64 = 8.0;

// `change`
/// Gains of a joint that changed.
pub(crate) const CHANGED_GAINS: std::ops::Range<f64> = 0.1..10.0;
/// A factor that is nearer to 1 is what the laws get wrong.
pub(crate) const LEAST_GAIN: f64 = 1.3;
pub(crate) const GAIN_ROUNDS: usize = 6;

// `change::torque`
/// Factors of a torque that are looked for.
pub(crate) const TORQUE_FACTORS: std::ops::RangeInclusive<u32> = 2..=10;
/// How far from a whole count a reading may be, for the digits of a log.
pub(crate) const COUNT_ROUNDING: f64 = 0.05;
/// Steps that are needed on either side.
pub(crate) const FEWEST_TORQUE_STEPS: usize = 8;
/// What the steps must say \[nats\].
pub(crate) const TORQUE_NATS: f64 = 15.0;
/// Largest reading in counts.
pub(crate) const MOST_COUNTS: f64 = 1e6;
/// A command that is faster than its joint by this factor may meet a limit of the speed: a start of the search.
pub(crate) const FASTER: f64 = 1.1;
/// Time over which those speeds are taken \[s\]: noise of 0.5 mrad is 0.014 rad/s then, and 0.7 rad/s from one row of 1 ms to the next.
pub(crate) const SPEED_S: f64 = 0.05;

// `effect::saturation`
/// Switches between limit and lag within a row at most: an input along a straight line has two.
pub(crate) const SWITCHES: usize = 4;
