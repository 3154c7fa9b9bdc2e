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

// `episodes`: of 26 joints of a humanoid in 50 episodes at 30 rows a second (docs/episodes.md)
/// Rows of an episode that is looked at, and episodes that a change of offset, gain or delay is looked for in.
pub(crate) const FEWEST_EPISODE_ROWS: usize = 30;
pub(crate) const FEWEST_EPISODES: usize = 6;
/// Episodes on either side of a change, at least, whose medians must differ by this share of it.
pub(crate) const NEIGHBOURS: usize = 3;
pub(crate) const CRISP: f64 = 0.5;
/// A change of level in scatters of the episodes, and in its standard deviations.
pub(crate) const STEP_SCATTERS: f64 = 3.0;
pub(crate) const LEVEL_Z: f64 = 6.0;
/// Places at which a long series is looked at first.
pub(crate) const MOST_SCAN: usize = 200;
/// Steps must leave this share of what a parabola over the poses leaves.
pub(crate) const POSE_LEAVES: f64 = 0.5;
/// An episode by itself is at another level by so many scatters.
pub(crate) const ODD_SCATTERS: f64 = 12.0;
/// And its rows scatter about it by less than this share of the least.
pub(crate) const ODD_SPREAD: f64 = 0.25;
/// An offset of all episodes is so many times what they scatter by.
pub(crate) const STANDING_SCATTERS: f64 = 10.0;
/// An offset is of one column where it is so many times what the task's poses scatter by.
pub(crate) const SIDE_RATIO: f64 = 4.0;
/// Past of the position and of the command in rows, and how far it is moved either way.
pub(crate) const EPISODE_PAST: usize = 2;
pub(crate) const EPISODE_TAPS: usize = 16;
pub(crate) const EPISODE_LEAD: usize = 8;
/// Rows of a faster recording are taken so far apart at least \[s\]: the taps then see half a second.
pub(crate) const EPISODE_STEP_S: f64 = 0.0334;
/// Degrees of freedom of the weights of rows.
pub(crate) const ROBUST_FREEDOM: f64 = 4.0;
/// A sensor that repeats more of its readings than this, of a moving command, holds them.
pub(crate) const HELD_REPEATS: f64 = 0.5;
/// Sum of the taps of a joint that follows its command in its unit; and the least, and the least share of its squares that they explain, of one that
/// follows it at all.
pub(crate) const PLAUSIBLE_SUM: std::ops::Range<f64> = 0.6..1.45;
pub(crate) const LEAST_SUM: f64 = 0.1;
pub(crate) const FOLLOWED_SHARE: f64 = 0.3;
/// An episode in which command and position both move by less than this share of what they do where they move most is a rest.
pub(crate) const REST_SHARE: f64 = 0.05;
/// The stretch that is farther from no error by this share of the change is the one that is wrong; else the later one is.
pub(crate) const WRONG_SIDE: f64 = 0.75;
/// Rows that a delay is looked for at.
pub(crate) const EPISODE_SHIFTS: [f64; 20] = [
    -7.0, -5.5, -4.2, -3.0, -2.0, -1.5, -1.2, -0.9, -0.6, -0.3, 0.3, 0.6, 0.9, 1.2, 1.5, 2.0, 3.0,
    4.2, 5.5, 7.0,
];
pub(crate) const EPISODE_RIDGE: f64 = 1e-9;
/// What a delay gains \[nats\] (untouched: up to 12; of 20 ms 17 and more in 46 of 52), in standard deviations over the episodes, the
/// share of the episodes on either side that speak for it, the least one in rows with weights and without, and tenths of a row up to which its size is looked for.
pub(crate) const EPISODE_DELAY_NATS: f64 = 15.0;
/// The same of a sensor that holds its readings: few of its rows speak, each for much (20 ms: 60 and more).
pub(crate) const HELD_DELAY_NATS: f64 = 30.0;
pub(crate) const EPISODE_DELAY_Z: f64 = 4.0;
pub(crate) const SMALL_DELAY_Z: f64 = 0.8;
pub(crate) const EPISODE_DELAY_EVEN: f64 = 0.6;
pub(crate) const LEAST_SHIFT: f64 = 0.25;
pub(crate) const LEAST_DELAY: f64 = 0.4;
pub(crate) const SIZE_TENTHS: u32 = 75;
/// Episodes on either side in which it is placed again, with that size.
pub(crate) const PLACED_AGAIN: usize = 6;
/// Rows farther apart show no delay \[s\].
pub(crate) const SLOWEST_STEP_S: f64 = 0.11;
/// A gain that is nearer to 1 is what the laws get wrong, and what one gains over an offset \[nats\].
pub(crate) const EPISODE_GAIN: f64 = 1.2;
pub(crate) const EPISODE_GAIN_NATS: f64 = 9.0;
/// Where the episodes' own gains scatter by more than this share of it, both must be larger (untouched: up to 13 nats, 1.22).
pub(crate) const GAIN_TOLD: f64 = 0.25;
pub(crate) const STILL_GAIN: f64 = 1.3;
pub(crate) const STILL_GAIN_NATS: f64 = 16.0;
/// A dead joint moves by no more than this share of its command, and by so many counts.
pub(crate) const DEAD_SHARE: f64 = 0.02;
pub(crate) const DEAD_COUNTS: f64 = 3.0;
/// A joint follows where it moves by this share of its command.
pub(crate) const FOLLOWS_SHARE: f64 = 0.2;
/// Rows of an episode that are looked at for swapped joints; how much nearer each is to the other's command.
pub(crate) const SWAP_ROWS: usize = 60;
pub(crate) const SWAPPED_SHARE: f64 = 0.5;
/// And no farther than so many times what that joint is from it as a rule.
pub(crate) const SWAPPED_USUAL: f64 = 3.0;
/// Rows of an episode at one end, episodes with that end, and how far the command goes beyond, in usual errors.
pub(crate) const CLIPPED_ROWS: usize = 5;
pub(crate) const CLIPPED_EPISODES: usize = 2;
pub(crate) const CLIPPED_SCATTERS: f64 = 3.0;
/// A sensor that repeats no more readings than this, of a moving command, follows each row; then it is enough that the position stays
/// at that value in so many episodes while the command moves on.
pub(crate) const FOLLOWING_REPEATS: f64 = 0.4;
pub(crate) const CLIPPED_HELD: usize = 3;
/// Times farther apart than so many usual steps have lost rows between them.
pub(crate) const LOST_STEPS: f64 = 1.6;
/// A step of positions and of commands beyond so many times the largest of so many rows before and after (untouched: up to 1.74; of ten
/// lost rows 2 and more in 91 of 100), which count as at least this many usual ones.
pub(crate) const JUMP_RATIO: f64 = 2.0;
pub(crate) const JUMP_NEIGHBOURS: usize = 4;
pub(crate) const JUMP_REST: f64 = 0.1;
/// Part of an episode's rows that repeat the row before.
pub(crate) const REPEATED_SHARE: f64 = 0.02;
/// Between steps of this many usual ones, all joints together.
pub(crate) const REPEATED_STEP: f64 = 0.3;
/// Rows nearer than this are not looked through for repeated ones \[s\]: sensors in counts repeat by themselves.
pub(crate) const REPEATED_LEAST_S: f64 = 0.0075;
/// Where all joints repeat more of their readings than this by themselves, rows that a recorder repeats are not told.
pub(crate) const REPEATS_ALONE: f64 = 0.3;
/// And so many times as often as joints that repeat each by itself would all do at once.
pub(crate) const REPEATED_CHANCE: f64 = 3.0;
/// Lost rows count from so many in one gap, or from this share of the episode.
pub(crate) const FEWEST_LOST: usize = 3;
pub(crate) const LOST_SHARE: f64 = 0.02;
/// A part of the readings of a joint that are missing.
pub(crate) const MISSING_SHARE: f64 = 0.05;
/// An episode at another rate than this share of the usual step.
pub(crate) const OTHER_RATE: f64 = 0.1;
/// An episode that lost more than this share is left out.
pub(crate) const LEAVE_OUT_SHARE: f64 = 0.2;
/// Odds of a fault beforehand, and the largest probability that is said.
pub(crate) const PRIOR_ODDS: f64 = 0.01;
pub(crate) const MOST_PROBABILITY: f64 = 0.99;
