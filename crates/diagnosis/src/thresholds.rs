//! Every number that decides a verdict, in one place: the seed of a scored batch depends on it (docs/blind-checks.md). Those of moving
//! arms and of servos are in `thresholds` of `haptical-motion` and `haptical-servo`.
//!
//! Each says its unit (a pure number where none is given), what it means and how it was set: *Chance* and *Calculated* by the
//! calculation given, *Choice* by judgement, *Cost* to bound the time; where nothing is said, on development trials and on
//! the logs of the tests, never on a scored batch. Numbers of a single effect are in its `Spec` (`haptical-effects`).

/// Chance and evidence: what is more than noise, and which names the data tell apart.
pub(crate) mod chance {
    /// Probability of an effect's score by chance, below which it is more than chance. Choice: 3 false alarms in 1000 logs.
    pub(crate) const FAMILY_WISE_P: f64 = 0.003;
    /// Standard deviations of the windows' slow energy above noise, over all channels, that are more than chance.
    pub(crate) const OMNIBUS_Z: f64 = 4.5;
    /// Share of the structured energy left that an effect must explain when it is added.
    pub(crate) const SHARE_OF_REST: f64 = 0.35;
    /// Causes at most. Cost.
    pub(crate) const MOST_CAUSES: usize = 4;
    /// Nats within which another effect counts as confusable: ln 100. Choice.
    pub(crate) const CONFUSABLE_NATS: f64 = 4.605_170_185_988_092;
    /// Penalty in nats of an effect whose size no sound device shows.
    pub(crate) const IMPLAUSIBLE_NATS: f64 = 15.0;
    /// Share of a column that must survive the base model for an implausible size to be considered.
    pub(crate) const LEAST_RETAINED: f64 = 0.01;
    /// As many names that the data cannot tell apart are no answer. Choice.
    pub(crate) const MOST_NAMES: usize = 4;
    /// Noise deviations from its neighbours from which a reading is an outlier. Chance: one in 10^9 of normal noise.
    pub(crate) const OUTLIER_SD: f64 = 6.0;
}

/// The recording: how much of it is taken, and what is held back.
pub(crate) mod recording {
    /// Rows beyond which every k-th is taken: what differs between successive milliseconds is noise. Cost.
    pub(crate) const MOST_ROWS: usize = 25_000;
    /// Share of the rows that is held back without a second recording. Choice, as in `identify`.
    pub(crate) const HELD_BACK: f64 = 0.2;
    /// Leverage up to which a reading that the fit did not see is predicted. Calculated (A245): the error of the fit scatters the
    /// prediction as widely as noise the reading.
    pub(crate) const MOST_LEVERAGE: f64 = 1.0;
    /// The same by the channel's gap: the variance of the fit's error over the square of the gap. Choice (A276).
    pub(crate) const ERROR_OF_GAP: f64 = 0.01;
    /// Rows in a block of the moving-block bootstrap of a reduction's interval. Choice.
    pub(crate) const BOOTSTRAP_BLOCK_ROWS: usize = 50;
}

/// Noise: its size, colour and outliers.
pub(crate) mod noise {
    /// Relative uncertainty of the variance that a device file states. Choice.
    pub(crate) const STATED_UNCERTAINTY: f64 = 0.3;
    /// Share of rounding from which it is a large part of the noise. Choice.
    pub(crate) const MUCH_ROUNDING: f64 = 0.1;
    /// Degrees of freedom of repeats that are enough for an estimate. Choice: its deviation is known to a quarter.
    pub(crate) const ENOUGH_REPEATS: usize = 8;
    /// Share of a joint's range within which two rows are one posture. Choice.
    pub(crate) const SAME_POSTURE: f64 = 1e-3;
    /// Standard deviations by which one noise is larger than another beyond chance. Chance: one in 700.
    pub(crate) const BEYOND: f64 = 3.0;
    /// Root mean square of residuals over that of an encoder's rounding up to which they are hardly more. Choice.
    pub(crate) const HARDLY_MORE: f64 = 1.5;
    /// Share of the amplitude of a saw of counts, count / pi, up to which an oscillation may be one: at one speed for a quarter of a
    /// log. Choice.
    pub(crate) const SAW_OF_A_LOG: f64 = 0.5;
    /// Largest correlation of successive blocks by noise, and by a reading that they share. Calculated: 100
    /// blocks of one reading count for 1.05 readings.
    pub(crate) const MOST_OF_BLOCKS: f64 = 0.95;
    pub(crate) const ONE_READING: f64 = 0.999;
    /// Segments that are enough for an estimate. Choice.
    pub(crate) const ENOUGH_SEGMENTS: usize = 8;
    /// Smallest correlation of successive rows that is looked for. Choice.
    pub(crate) const LEAST_COLOUR: f64 = -0.9;
    /// Largest correlation of successive rows that is looked for: beyond it noise and drift are one. Choice.
    pub(crate) const MOST_COLOUR: f64 = 0.97;
    /// Changes of a reading, in counts, below which they must be whole. Choice: what a log's decimals round away adds up.
    pub(crate) const SMALL_STEPS: f64 = 8.5;
    /// Part of a count by which such a change may miss a whole one. Choice: chance keeps one change in five this near.
    pub(crate) const PART_OF_A_COUNT: f64 = 0.1;
    /// Small changes that are enough to call the smallest of them a count. Chance: of a continuous reading one in 10^14.
    pub(crate) const ENOUGH_STEPS: usize = 20;
    /// Rows on each side of the median that an outlier is compared with. Choice.
    pub(crate) const MEDIAN_REACH: usize = 3;
    /// Rows of a segment within which a signal is taken for a cubic.
    pub(crate) const SEGMENT_ROWS: usize = 16;
    /// Rows of which one is taken where the noise may have a memory: segments are as many times longer. Choice.
    pub(crate) const MEMORY_STEP: usize = 4;
    /// Level of such a noise at low frequency over that of neighbours from which it is another. Choice.
    pub(crate) const OTHER_LEVEL: f64 = 1.2;
    /// Highest lag at which products of rows are compared. Choice.
    pub(crate) const LAGS: usize = 2;
    /// The same where a noise has two parts, one of them with a memory. Choice.
    pub(crate) const TWO_PART_LAGS: usize = 32;
    /// Share of its variance that the part with a memory may have.
    pub(crate) const TWO_PART_SHARES: std::ops::Range<f64> = 0.03..0.7;
    /// Squares of the products' deviations from that law, over those of chance. Chance: three times their mean.
    pub(crate) const TWO_PART_CHANCE: f64 = 3.0;
    /// Memories after which nothing is left of it, within those lags.
    pub(crate) const TWO_PART_MEMORIES: f64 = 2.0;
    /// Relative uncertainty of its variance at least. Choice.
    pub(crate) const TWO_PART_UNCERTAINTY: f64 = 0.05;
    /// A segment this many times louder than the median one shows more than noise: a jump, a dent, fast motion. Chance: of
    /// white noise one in 10^5 does; leaving out more would prefer the less coloured ones.
    pub(crate) const DISTURBED: f64 = 4.0;
    /// Parts of the speeds in which the noise is compared. Choice.
    pub(crate) const SPEED_CLASSES: usize = 4;
    /// Variance at the fastest quarter over that at the slowest from which noise depends on speed. Chance: ten standard
    /// deviations with ninety segments each.
    pub(crate) const DEPENDS_ON_SPEED: f64 = 1.6;
    /// Mean square at the slowest quarter over that at the fastest up to which the slowest stands still: its readings repeat to
    /// the count and show no noise, of any size.
    pub(crate) const STANDS_STILL: f64 = 1e-6;
    /// Ratio to the stated noise from which noise is reported. Choice.
    pub(crate) const LOUD: f64 = 1.3;
    /// Growth of noise from slow to fast motion from which it is reported. Choice.
    pub(crate) const GROWS_WITH_SPEED: f64 = 1.4;
    /// Share of outliers from which they are reported. Chance: without any there would be one in 10^8.
    pub(crate) const MANY_OUTLIERS: f64 = 2e-3;
    /// Residual over stated noise below which it refutes that noise. Chance: of 30 degrees of freedom a quarter of the
    /// variance is left once in 10^5 recordings. (`identify` only warns, from a quarter.)
    pub(crate) const REFUTED: f64 = 0.5;
    /// Degrees of freedom from which a residual can refute a stated noise.
    pub(crate) const REFUTING_FREEDOM: f64 = 30.0;
    /// Residual over stated noise below which the numbers were computed, not measured. Choice.
    pub(crate) const COMPUTED: f64 = 1e-6;
    /// Steps of a reading over one count that refute the stated counts. Choice.
    pub(crate) const FINER_COUNTS: f64 = 0.5;
    /// Steps of a reading over one count that are what arithmetic leaves. Choice.
    pub(crate) const ARITHMETIC_COUNTS: f64 = 1e-6;
    /// A ball in a socket, or a tip on a plane, repeats better than this \[m\]. Choice: printed sockets hold to 0.1 to 0.5 mm.
    pub(crate) const ROUGHEST_TOUCH_M: f64 = 5e-4;
    /// Probability of a finding on the data. Choice.
    pub(crate) const DATA_PROBABILITY: f64 = 0.95;
    /// Relative standard deviation of a noise level that a motion shows. Choice.
    pub(crate) const LEVEL_SD: f64 = 0.03;
}

/// Views of one log, together.
pub(crate) mod joined {
    /// Gap over noise beyond which a view's part of the whole is counted no larger: a noiseless channel has one of any size.
    pub(crate) const MOST_OVER_NOISE: f64 = 1e6;
}

/// Forces of a hand.
pub(crate) mod hand {
    /// Time between rows up to which a hand's push lasts longer than one of them \[s\]. Choice.
    pub(crate) const CLOSE_S: f64 = 0.1;
    /// Readings of an axis from which its noise is judged. Choice.
    pub(crate) const FEWEST_ROWS: usize = 100;
    /// Standard deviations by which the ratio of white noise may miss 1. Chance: one axis in 30 000 does.
    pub(crate) const WHITE_SD: f64 = 4.0;
}

/// Spectral lines of what the base model leaves.
pub(crate) mod lines {
    /// Probability, over all frequencies and streams, below which a peak is more than chance. Choice: far below that of an
    /// effect, as a line changes the noise that everything is compared with.
    pub(crate) const LINE_P: f64 = 1e-6;
    /// Segments from which a spectrum is tested for a peak that is no single oscillation. Choice.
    pub(crate) const ENOUGH_SPECTRA: usize = 6;
    /// Factor of a peak's probability for the level beside it, which is estimated too. Calculated: white and coloured noise
    /// of 300 to 6000 rows, a test of `noise::lines`.
    pub(crate) const ROUGH_LEVEL: f64 = 30.0;
    /// Lines of a channel at most. Choice.
    pub(crate) const MOST_LINES: usize = 2;
    /// Rows of a segment at least. Choice.
    pub(crate) const SHORTEST_ROWS: usize = 64;
    /// Rows of a segment at most. Choice.
    pub(crate) const LONGEST_ROWS: usize = 1024;
    /// Segments that the longest piece is cut into, about; half of each is shared with the next. Choice.
    pub(crate) const SEGMENTS: usize = 4;
    /// Share of a segment's instants that must have a reading. Choice.
    pub(crate) const FILLED: f64 = 0.6;
    /// Steps of time that part two pieces. Choice.
    pub(crate) const PAUSE: f64 = 16.0;
    /// Bins on each side whose level a peak is compared with. Choice.
    pub(crate) const NEAR_BINS: usize = 20;
    /// Bins next to a peak that its window touches. Calculated: the main lobe of Hann's, and one.
    pub(crate) const TOUCHED_BINS: usize = 3;
    /// Bins from zero within which nothing is looked for. Choice.
    pub(crate) const SLOW_BINS: usize = 8;
    /// A line is this many times faster than the device moves: what the device's own errors make of its motion is slower.
    pub(crate) const FASTER_THAN_MOTION: f64 = 8.0;
    /// Share of a peak's power that one oscillation throughout each run must hold: noise of a resonance does not. Choice.
    pub(crate) const COHERENT: f64 = 0.6;
    /// Frequencies that are tried for each one that a run resolves. Choice.
    pub(crate) const FINENESS: f64 = 8.0;
    /// Readings this many times their median size are taken for that. Choice.
    pub(crate) const FAR: f64 = 10.0;
    /// Share of a line's period that a block holds at most. Calculated: the mean keeps 90 % of the line's size.
    pub(crate) const SHARE_OF_A_PERIOD: f64 = 0.25;
    /// Share of a gap from which a line in it is the place of the gap. Choice.
    pub(crate) const MOST_OF_A_GAP: f64 = 0.5;
}

/// Fits of the base model and of causes.
pub(crate) mod fit {
    /// Standard deviation that a number of the chain is given about its anchor, in plausible sizes. Calculated: a number that
    /// the touches fix is moved by it at most by 3 % of its deviation, as its own standard deviation is at most a third of
    /// a plausible size.
    pub(crate) const ANCHOR_REACH: f64 = 3.0;
    /// Rows from which the base fit starts; the search that follows uses all of them. Cost.
    pub(crate) const START_ROWS: usize = 900;
    /// Degree of the polynomial of a parallelogram (the paper's); one that the evidence chose on few rows leaves more than
    /// the noise of many.
    pub(crate) const POLYNOMIAL_DEGREE: usize = 10;
    /// Rows that carry such a polynomial. Choice.
    pub(crate) const ROWS_FOR_A_POLYNOMIAL: usize = 300;
    /// Steps after which a search that has found no minimum is left where it is: an effect that no base model resembles can
    /// keep it wandering. Cost.
    pub(crate) const MOST_STEPS: usize = 100;
    /// Steps of the base model's own refit with the derivatives of its start. Cost.
    pub(crate) const BASE_PASSES: usize = 3;
    /// Blocks that a long recording is averaged into, about. Cost.
    pub(crate) const BLOCKS: usize = 1200;
    /// Rows at rest that one block averages at most. Choice.
    pub(crate) const LONGEST_REST_ROWS: usize = 400;
    /// Time within which what is left of a gap hardly changes \[s\]. Choice.
    pub(crate) const WINDOW_S: f64 = 0.25;
    /// Fall of the cost that the linearised problem promises, in variances of the noise or of what is left, below which a fit has
    /// converged: its numbers are within a tenth of their standard deviations of the minimum. Choice.
    pub(crate) const LEAST_FALL: f64 = 0.01;
    /// Share of the cost by which a step of a slow search lowers it at least, where its minimum is only compared with others; and
    /// where all is computed anew once a cause is known. Cost: what is kept is refitted to `LEAST_FALL`.
    pub(crate) const COMPARED: f64 = haptical_identification::Settings::COMPARED;
    pub(crate) const ROUGH: f64 = 1e-3;
    /// Standard deviations that a step may move a cause's number by where the cost no longer falls. Choice, as `LEAST_FALL`.
    pub(crate) const STILL_SD: f64 = 0.1;
    /// Noise deviations that a model with scanned causes leaves from which on its search begins elsewhere. Cost: both ends are minima.
    pub(crate) const FAR_SD: f64 = 10.0;
    /// Time between rows at which a search works out the base model \[s\]. Cost: the end is found with all rows.
    pub(crate) const SAMPLED_S: f64 = 0.02;
    /// Searches from one end to the next until the residuals of all rows ask for no step. Cost.
    pub(crate) const ROUNDS: usize = 4;
    /// Steps of a refit after which it has not converged. Cost.
    pub(crate) const PASSES: usize = 40;
    /// Fits in turn with what the causes add, until the latter moves no more. Cost.
    pub(crate) const NEARER_ROUNDS: usize = 4;
    /// Noise that falls below this share of itself with the causes in the model was partly gap.
    pub(crate) const NOISE_FELL: f64 = 0.9;
    /// Change of the base model's predictions by the causes, in noise deviations (root mean square), from which effects are
    /// computed anew.
    pub(crate) const MOVED_FAR: f64 = 25.0;
    /// Change of what the causes add, in noise deviations of a stream (root mean square), up to which they stand still. As in the fit of
    /// effects of a device file (docs/diagnosis.md, Effects of a device).
    pub(crate) const STILL_NOISES: f64 = 0.1;
}

/// Selection of causes.
pub(crate) mod selection {
    /// Contenders that are refitted at most when a pick is close. Cost.
    pub(crate) const CONTENDERS: usize = 3;
    /// Share of what the best explains from which an effect is a contender.
    pub(crate) const CONTENDING: f64 = 0.93;
    /// Share of the earlier laws' possible error that a later pick must exceed where it leaves a rest.
    pub(crate) const LATER_PICK: f64 = 0.15;
    /// The same of a pick at a joint of theirs.
    pub(crate) const LATER_PICK_THERE: f64 = 0.5;
    /// Freedom below which the base model takes a single reading up: it says nothing. Choice.
    pub(crate) const TAKEN_UP: f64 = 0.1;
    /// Probability above which a rest that follows an effect's own covariate is chance. Choice.
    pub(crate) const LAW_P: f64 = 1e-3;
    /// Share of an effect's course by which the chain may differ from the external encoder.
    pub(crate) const OFF_BY: f64 = 0.35;
    /// Probability below which it surely differs. Choice.
    pub(crate) const SURELY: f64 = 1e-6;
    /// Share of what was explained below which an effect is one with the rounding of large numbers.
    pub(crate) const DYNAMIC_RANGE: f64 = 2e-4;
    /// Falls of a slow search that may be left where it ended, and squares that count as equal in any case: contenders so close are
    /// fitted to the last digit. Cost.
    pub(crate) const FALLS_LEFT: f64 = 30.0;
    pub(crate) const TIE: f64 = 10.0;
    /// What a refit explains over what the scan says of an effect, at most, where nothing is asked of the refit. Cost.
    pub(crate) const REFIT_OVER_SCAN: f64 = 4.0;
    /// Picks that are tried and refused before the search ends. Cost.
    pub(crate) const REFUSALS: usize = 3;
    /// Share of the structured energy below which nothing is left that could have moved the base model. Choice.
    pub(crate) const NEARLY_NOTHING: f64 = 0.01;
    /// Share of the structured energy above which other effects are still to come.
    pub(crate) const STILL_MUCH: f64 = 0.05;
}

/// Steps: effects that happen at an instant.
pub(crate) mod steps {
    /// A joint that is this near to its start still rests there \[rad\]. Choice.
    pub(crate) const RESTING_RAD: f64 = 0.05;
    /// Share of the first step's score from which a further step of the event is looked for.
    pub(crate) const STEP_SHARE: f64 = 0.003;
    /// Score from which a further step is one by itself. Chance: one in 10^7 instants of noise.
    pub(crate) const STEP_SCORE: f64 = 40.0;
    /// Steps of one event at most. Cost.
    pub(crate) const MOST_STEPS_OF_AN_EVENT: usize = 5;
    /// Sweeps over all steps after one was added. Cost.
    pub(crate) const SWEEPS: usize = 3;
    /// Steps of one event are at least so far apart \[s\]. Choice.
    pub(crate) const APART_S: f64 = 0.3;
    /// Two steps so near to each other are one event, seen by more than one channel \[s\]. Choice.
    pub(crate) const COINCIDENT_S: f64 = 0.8;
    /// Score from which an event may have further steps.
    pub(crate) const WORTH_MORE_STEPS: f64 = 60.0;
    /// Independent instants at which a step may happen, per block.
    pub(crate) const INSTANTS: f64 = 0.15;
    /// Share of the best score from which an event may have further steps. Cost.
    pub(crate) const MORE_STEPS_SHARE: f64 = 0.3;
    /// Part of a run, as one over this number, at either end of which a step is one with the zero that the base model adjusts.
    /// Choice.
    pub(crate) const MARGIN: usize = 30;
    /// Fall of the squares, in variances of the noise, within which an instant is as good as the best. Calculated: -2 ln(1 - sqrt(0.95)),
    /// of 95 % of small steps (Hansen 2000).
    pub(crate) const INSTANT_COST: f64 = 7.352_276_694;
    /// Squared share of a step that must survive the base model. Choice.
    pub(crate) const LEAST_LEFT: f64 = 1e-6;
    /// Of single postures: fewest rows on each side of a displacement within a run. Choice.
    pub(crate) const LEAST_ROWS_BESIDE: usize = 6;
    /// What it explains at least, its numbers and the rows and places that were tried allowed for \[nats\], and the share of what is left.
    pub(crate) const SPLIT_NATS: f64 = 16.0;
    pub(crate) const SPLIT_SHARE: f64 = 0.5;
}

/// Rivals: effects that could be in a cause's place.
pub(crate) mod rivals {
    /// Share of what causes explain from which springs under assumed weights may be in their place.
    pub(crate) const SAG_SHARE: f64 = 0.5;
    /// Probability of such a cause at most, where nothing tells the loads.
    pub(crate) const UNTOLD_PROBABILITY: f64 = 0.5;
    /// Structured energy below which a wrong effect imitates a gap as well as the right one.
    pub(crate) const WEAK: f64 = 100.0;
    /// Exchanges of causes at most. Cost.
    pub(crate) const EXCHANGES: usize = 2;
    /// Nats by which a rival must lead to take a cause's place.
    pub(crate) const LEAD: f64 = 2.0;
    /// Rivals that are listed at most. Cost.
    pub(crate) const LISTED: usize = 30;
    /// Rivals that are refitted at most. Cost.
    pub(crate) const REFITTED: usize = 3;
    /// Nats within which the linear score calls for a refit.
    pub(crate) const NEAR_NATS: f64 = 60.0;
    /// Share of a drift's energy that its law may get wrong.
    pub(crate) const DRIFT_LAW: f64 = 0.15;
    /// Share from which a drift in time and one with temperature are look-alikes, where the temperature only rises.
    pub(crate) const LOOK_ALIKE: f64 = 0.6;
    /// Share from which a wobble and a coupling are look-alikes, and two displacements between runs.
    pub(crate) const COUPLED: f64 = 0.98;
    /// Probability of a steady drift's name at a joint when everything else speaks for it (docs/assumptions.md, A62).
    pub(crate) const STEADY: f64 = 0.8;
    /// Probability of a settling drift's name when everything else speaks for it (A62).
    pub(crate) const SETTLING: f64 = 0.75;
    /// Probability from which a later cause is reported: below it, it is what an earlier one's law gets wrong.
    pub(crate) const LATER_PROBABILITY: f64 = 0.6;
    /// Squared deviations by which a model with a rival in the cause's place may fit worse. Choice: three standard deviations.
    pub(crate) const REPLACED_COST: f64 = 9.0;
    /// Share of what the cause explains from which a rival is refitted however far behind it is.
    pub(crate) const SAME_GAIN: f64 = 0.93;
    /// Correlation of temperature and a settling function of time from which one follows the other (A63).
    pub(crate) const SAME_COURSE: f64 = 0.95;
    /// Time constants of such functions over the length of the recording. Choice.
    pub(crate) const SETTLING_COURSES: [f64; 4] = [0.1, 0.3, 1.0, 10.0];
    /// Probability that the cause of the weakest gap is none of the catalogue; it falls with the root of the energy.
    pub(crate) const WEAK_DOUBT: f64 = 0.3;
    /// What is left of doubt when everything fits. Choice.
    pub(crate) const LEAST_DOUBT: f64 = 0.01;
    /// Doubt at most. Choice.
    pub(crate) const MOST_DOUBT: f64 = 0.5;
    /// Probability that the cause is none of the catalogue when no name is given. Choice.
    pub(crate) const UNKNOWN: f64 = 0.95;
    /// Nats by which a look-alike is behind at least. Choice.
    pub(crate) const BEHIND_NATS: f64 = 1.0;
    /// Further nats by which the least similar look-alike of a drift is behind. Choice.
    pub(crate) const LOOK_ALIKE_NATS: f64 = 3.0;
}

/// Causes that account for a part of a gap.
pub(crate) mod partial {
    /// Contiguous parts of a recording, each predicted from the others. Choice.
    pub(crate) const SEGMENTS: usize = 20;
    /// What keeps a direction finite that one segment alone fixes: added to a share of 1. Choice.
    pub(crate) const RIDGE: f64 = 1e-3;
    /// Standard deviations over the segments from which a gain on unseen rows is more than chance. Choice.
    pub(crate) const BEYOND_CHANCE_SD: f64 = 3.0;
    /// Standard deviations of a size from nothing at one of several places that follow one law. Choice.
    pub(crate) const LEAST_MEMBER_SD: f64 = 3.0;
    /// The same of the gain of that place on unseen rows: the law's own gain is tested in all. Choice.
    pub(crate) const LEAST_MEMBER_GAIN_SD: f64 = 1.0;
    /// Least share of what is left of the gap that a further hypothesis must close.
    pub(crate) const LEAST_FURTHER_SHARE: f64 = 0.05;
    /// Intervals of another joint's angle over which a coupling is nearly straight. Choice.
    pub(crate) const COUPLING_KNOTS: usize = 2;
    /// Intervals of a joint's own angle over which a coupling's gain may vary. Choice.
    pub(crate) const GAIN_KNOTS: usize = 3;
    /// Intervals of the free functions that a law is tested against. Choice.
    pub(crate) const FREE_KNOTS: usize = 8;
    /// The same of the turn of a motor, and of time: grooves and lost counts are steps. Choice.
    pub(crate) const FINE_KNOTS: usize = 24;
    /// Standard deviations from which free functions beside a law predict unseen rows better. Chance: one in 40.
    pub(crate) const SURELY_BESIDE_SD: f64 = 2.0;
    /// Share of its gain that a law must keep beside free functions of another covariate of its joint. Choice.
    pub(crate) const KEPT_SHARE: f64 = 0.5;
    /// Share of the squares beyond noise of a moving arm's second recording that a name may leave there. Choice (A201).
    pub(crate) const MOST_LEFT_OF_SECOND: f64 = haptical_motion::OF_SECOND_BESIDE_SPRING;
    /// Probability below which a name is no finding where it leaves a rest. Choice.
    pub(crate) const LEAST_PROBABILITY: f64 = 0.5;
    /// Share of a law's gain by which free functions elsewhere must predict more: the gap lies there. Choice.
    pub(crate) const ELSEWHERE_SHARE: f64 = 0.1;
    /// Share of a column that the others must leave for a place of its own. Choice.
    pub(crate) const DISTINCT: f64 = 0.02;
    /// Deviations of a lead on unseen rows whose odds are e to 1. Calculated: of a normal lead, half its square are the nats.
    pub(crate) const LEAD_NATS: f64 = 0.5;
    /// Least share of the gap that a hypothesis must close on unseen rows.
    pub(crate) const LEAST_SHARE: f64 = 0.15;
    /// Hypotheses that are taken up one after the other at most. Cost.
    pub(crate) const MOST_HYPOTHESES: usize = 3;
    /// Effects of cables that are named together at least: one alone is found without. Choice.
    pub(crate) const LEAST_CABLES: usize = 2;
    /// Effects of cables at one joint at most. Cost.
    pub(crate) const MOST_CABLES: usize = 8;
    /// Standard deviations of the gain of one of them on unseen rows; what they gain together is tested too. Choice.
    pub(crate) const LEAST_CABLE_SD: f64 = 2.0;
    /// Share of the joint's gap that one of them must close on unseen rows. Choice.
    pub(crate) const LEAST_CABLE_SHARE: f64 = 0.01;
    /// Share of an encoder's squares that causes must predict on unseen rows where noise may be all of it. Choice.
    pub(crate) const LEAST_PREDICTED: f64 = 0.3;
    /// Half widths from which a play is searched \[rad\]. Cost.
    pub(crate) const PLAYS_RAD: [f64; 5] = [1e-3, 5e-3, 0.02, 0.08, 0.25];
    /// Single effects that are tried at most. Cost.
    pub(crate) const LISTED: usize = 12;
    /// Readings for each number of a hypothesis at least. Choice.
    pub(crate) const READINGS_PER_NUMBER: usize = 8;
}

/// What a residual depends on.
pub(crate) mod dependence {
    /// Probability, all questions together, below which a dependence is reported. Choice.
    pub(crate) const DEPENDENCE_P: f64 = 0.01;
    /// Share of a column that the base model must leave for it to be asked at all. Choice.
    pub(crate) const ASKED_SHARE: f64 = 1e-2;
    /// Share of the largest direction's square below which one is left out. Choice.
    pub(crate) const DEPENDENT: f64 = 1e-6;
    /// Stretches of a motion within which errors may go together. Choice.
    pub(crate) const STRETCHES: usize = 200;
    /// Intervals of the free functions of an angle. Choice.
    pub(crate) const KNOTS: usize = 6;
    /// Intervals of the free functions of time and temperature, which change slowly. Choice.
    pub(crate) const SLOW_KNOTS: usize = 3;
    /// Chance below which a dependence of a gap is reported, all questions counted: that there is a gap is known, and the
    /// words say how sure its place is. Choice.
    pub(crate) const PLACED_P: f64 = 0.05;
    /// Share of the best covariate's explanation from which another one is named too. Choice.
    pub(crate) const ALSO: f64 = 0.4;
    /// Intervals of the functions with which places are compared. Choice.
    pub(crate) const PLACE_KNOTS: usize = 12;
    /// Intervals in which the residual's mean is compared. Choice.
    pub(crate) const PLACE_BINS: usize = 40;
    /// Score that each number of a covariate's function costs when places are compared.
    pub(crate) const EVIDENCE_PER_RANK: f64 = 8.0;
    /// Share of the largest bin from which a bin belongs to the region. Choice.
    pub(crate) const BIN_SHARE: f64 = 0.3;
}

/// A model identified earlier: which of its numbers are wrong.
pub(crate) mod earlier_model {
    /// Share of the difference below which a term is not named. Choice.
    pub(crate) const TERM_SHARE: f64 = 0.005;
    /// The earlier model was fitted to noise too: its own errors double the squares. Calculated.
    pub(crate) const TWO_FITS: f64 = 2.0;
    /// Squared standard deviations beyond which a group of one parameter is more than chance. Chance: one in 16 000.
    pub(crate) const BEYOND_CHANCE: f64 = 16.0;
    /// Standard deviations over blocks of unseen rows from which a difference makes them better. Choice.
    pub(crate) const CONFIRMED_SD: f64 = 2.0;
    /// Share of the difference that another tool alone must explain: what is left is what an earlier fit did not fix.
    pub(crate) const NEARLY_ALL: f64 = 0.97;
    /// Share of the difference that its terms must explain for the verdict to be a name. Choice.
    pub(crate) const MOST: f64 = 0.8;
    /// Plausible deviations from which a link's number is believed to be wrong rather than changed. Choice.
    pub(crate) const WRONG_RATHER_THAN_CHANGED: f64 = 4.0;
    /// Squared standard deviations within which two groups explain the same: twice ln 100. Choice.
    pub(crate) const AS_WELL: f64 = 9.21;
    /// Prior odds of another tool against another link: tools are made to be exchanged. Choice.
    pub(crate) const TOOL_ODDS: f64 = 10.0;
    /// Contiguous parts of the recording that count more or less often, to see what a cause does to a calibration at other
    /// postures. Choice.
    pub(crate) const SEGMENTS: usize = 8;
    /// How much more, or less, often. Choice.
    pub(crate) const OFTEN: f64 = 10.0;
    /// Standard deviations of that within which a number of an earlier model was bent. Choice: it is not known well.
    pub(crate) const BEND_SCATTERS: f64 = 4.0;
    /// Standard deviations from which a number has moved. Chance: one in 370, two fits' errors.
    pub(crate) const MOVED_SD: f64 = 4.2;
    /// Deviations, of a fit and of what its law gets wrong together, from which an effect of the device has another size. Chance:
    /// one in 370.
    pub(crate) const GROWN_SD: f64 = 3.0;
    /// Fits of the sizes of a device's own effects at most: each leaves what a law's curvature makes of the change before. Cost.
    pub(crate) const SIZE_FITS: usize = 3;
    /// Relative change of a size below which the columns of its law hold. Choice.
    pub(crate) const SIZE_SETTLED: f64 = 0.05;
    /// Probability of a term that an earlier model has wrong. Choice.
    pub(crate) const SURE: f64 = 0.98;
}

/// What a recording could not have shown.
pub(crate) mod unseen {
    /// Score that is noticed in four of five recordings. Calculated: (4.9 + 0.84)^2, the normal quantiles of 0.003 over 1500
    /// tests and of 80 %.
    pub(crate) const NOTICED_SCORE: f64 = 33.0;
    /// Share of a column that must survive the base model for the effect to be visible. Choice.
    pub(crate) const VISIBLE: f64 = 3e-3;
    /// Parameters named in a bias. Choice.
    pub(crate) const MOST_BIASED: usize = 3;
    /// Deviations, in plausible sizes, that call for a hint. Choice.
    pub(crate) const HINT_DEVIATIONS: f64 = 4.0;
    /// Residual over noise from which a joint's own encoder shows the gap of an effect there. Choice.
    pub(crate) const SHOWN_BY_ENCODER: f64 = 1.02;
}

/// Torques of the drives and the hand's force (docs/diagnosis-force.md).
pub(crate) mod torque;

/// Projections, steps and ridges of the fits.
pub(crate) mod engine;

/// Whether a log may be answered.
pub(crate) mod admission;

/// What is written of a gap: its curve, its reduction, its instants.
pub(crate) mod answer;

/// A moving arm's gap in words.
pub(crate) mod moving;

/// Motors whose torque does not follow their current.
pub(crate) mod current;

/// Causes of a joint that does not follow its command.
pub(crate) mod servo;

/// The recording that tells candidates apart.
pub(crate) mod settle;

/// Payloads that change between runs (docs/diagnosis-force.md, "Payload").
pub(crate) mod payload;

/// Curves in the place of a cause that is not known.
pub(crate) mod correction {
    /// Coefficients of a curve: 40 intervals over the range of what it is drawn over. Choice: the penalty decides how smooth it is.
    pub(crate) const COEFFICIENTS: usize = 43;
    /// Gain on unseen rows in standard deviations of one by chance. Chance: one curve in 700.
    pub(crate) const CHANCE_SD: f64 = 3.0;
    /// Least share of the squares beyond noise that unseen rows lose. Choice.
    pub(crate) const LEAST_SHARE: f64 = 0.1;
    /// A curve over something else than the joint's angle must close more by this: its share times it. Choice.
    pub(crate) const NEARLY_AS_MUCH: f64 = 0.9;
}

/// A second recording: what the model of the first one may leave of it.
pub(crate) mod second {
    /// Standard deviations of a mean square of noise by chance. Chance: one in 30 000, over a hundred channels.
    pub(crate) const SDS: f64 = 4.0;
    /// Share of the square of the noise that the model of a sound device may leave: friction and geometry are no laws to the last digit.
    /// Choice: that of a moving arm's own gap (docs/assumptions.md, A158).
    pub(crate) const ALLOWED: f64 = 0.21;
    /// The same of what a joint leaves of its command. Choice: a gap is one from 1.5 times the floor on, as in the log itself.
    pub(crate) const ALLOWED_OF_COMMANDS: f64 = 1.25;
}

/// A device's own effects: what their laws may leave.
pub(crate) mod own_effects {
    /// Share of the squares that effects take off one channel, of which the channel may keep as much, if all channels together keep no more
    /// than the laws may leave. Choice: that of encoders on links (docs/assumptions.md, A169).
    pub(crate) const LEFT_OF_CHANNEL: f64 = 0.1;
}
