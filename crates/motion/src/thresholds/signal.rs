//! From readings to samples: gaps, smoothing, noise.

// `signal::samples`
/// Steps that differ from the usual one by more than this share end a piece.
pub(crate) const BREAK_SHARE: f64 = 0.6;
/// Steps over which readings are filled in, of a log of which rows are missing.
pub(crate) const FILLED_STEPS: f64 = 4.6;
/// The same of a log whose stamps are so uneven that most of its rows are in no piece of this length otherwise \[s\], and its
/// shortest step.
pub(crate) const LONG_PIECE_S: f64 = 1.0;
pub(crate) const UNEVEN_FILLED_S: f64 = 0.02;
pub(crate) const SHORTEST_STEP: f64 = 0.1;
/// Stamps within this share of a step of an even grid are taken as even.
pub(crate) const EVEN_STAMPS: f64 = 0.05;
/// Rows on each side of a step of an odd length that say whether rows are missing there.
pub(crate) const ROWS_AROUND_STEP: usize = 6;
/// Fewest samples of a piece.
pub(crate) const LEAST_PIECE_SAMPLES: usize = 32;

// `signal::sampling`
/// Fewest rows that are repeated or missing, and their least share, that are a fault of the log.
pub(crate) const LEAST_FAULTY_ROWS: usize = 3;
pub(crate) const LEAST_FAULTY_SHARE: f64 = 0.001;
/// A step of all joints together that is this many times what its neighbours say is one with rows missing.
pub(crate) const LONG_STEP: f64 = 1.6;
/// A step whose stamps are within this share of a whole number of steps is judged.
pub(crate) const WHOLE_STEP: f64 = 0.1;
/// Stamps of which more than this share are off a whole number of steps are a clock's own and say themselves where rows are missing: a
/// logger that is out of step with its controller reads a state twice, and skips one, and neither moves its clock.
pub(crate) const UNEVEN_CLOCK: f64 = 0.05;
/// Most rows that are missing at one place.
pub(crate) const MOST_MISSING_ROWS: f64 = 20.0;
/// A step is judged where a joint moves by this many times its smallest change, or what its steps scatter by.
pub(crate) const CLEAR_MOTION: f64 = 10.0;

// `signal::local_polynomial`
/// Degree of the polynomial: position and acceleration have no error up to the fourth power of time.
pub(crate) const LOCAL_DEGREE: usize = 4;

// `signal::low_pass`
/// Periods of the band's edge on each side of the low pass.
pub(crate) const LOW_PASS_PERIODS: f64 = 2.0;

// `signal::states`
/// Positions are smoothed up to this multiple of the band's edge, so that the low pass alone shapes the rows.
pub(crate) const SMOOTHED_BEYOND: f64 = 2.0;
/// Fewest fine steps in a period of the band's edge.
pub(crate) const FINE_STEPS: f64 = 8.0;
/// Noise that a speed may have where friction changes sides with it \[rad/s\], \[m/s\]: friction turns over within speeds that are larger.
pub(crate) const SLIDING_NOISE: f64 = 1e-3;
/// Most rows of a joint, and rows of a stretch: of a longer log stretches are looked at that lie evenly over it. More rows add little: what a
/// model leaves of a real arm is no noise, and does not fall with their number.
pub(crate) const MOST_JOINT_ROWS: usize = 2_500;
pub(crate) const STRETCH_ROWS: usize = 100;
/// The golden ratio less 1: fractions of its multiples fill an interval evenly.
pub(crate) const GOLDEN: f64 = 0.618_033_988_749_894_9;

// `signal::link`
/// The difference between an encoder on a link and that of its motor is smoothed up to the cutoff over two to this power at least.
pub(crate) const DIFFERENCE_HALVINGS: i32 = 3;
/// Standard deviations of chance by which a smoother difference may differ from the one that is smoothed as positions are.
pub(crate) const DIFFERENCE_SDS: f64 = 3.0;

// `signal::noise`
/// Samples of a segment, of which the median counts: a reversal of friction is in few of them. Of slow logs they last so long \[s\], and have
/// so many samples at least: of 0.48 s most have a reversal, and a noise came out ten times too large.
pub(crate) const NOISE_SEGMENT: usize = 48;
pub(crate) const NOISE_SEGMENT_S: f64 = 0.24;
pub(crate) const LEAST_NOISE_SEGMENT: usize = 12;
/// Segments that are looked at, at most: their median is known to 1 % then.
pub(crate) const NOISE_SEGMENTS: usize = 1000;
/// A rest of a column that is this share of its values is rounding: a joint at rest shows no noise of its counts.
pub(crate) const NOISE_ROUNDING: f64 = 1e-12;

// `signal::memory`
/// Memories that are tried, from half a sample to the longest \[s\]. The longest itself is no noise: what a slow motion leaves of a delay of 16 ms
/// that is withheld is as well one of 0.3 to 0.6 s.
pub(crate) const MEMORIES: usize = 20;
pub(crate) const LONGEST_MEMORY_S: f64 = 0.3;
/// Rows of a segment whose periodogram is taken, at most.
pub(crate) const SEGMENT: usize = 512;
/// Samples of one above the band, whose median counts: at most, and at least of a slow log, of which it lasts `NOISE_SEGMENT_S`.
pub(crate) const SHORT_SEGMENT: usize = 64;
pub(crate) const LEAST_SHORT_SEGMENT: usize = 24;
/// Groups of ordinates above the band and within it, and the fewest independent ordinates of each.
pub(crate) const OUTER_GROUPS: usize = 12;
pub(crate) const INNER_GROUPS: usize = 8;
pub(crate) const LEAST_MEMORY_ORDINATES: f64 = 40.0;
/// Standard deviations of chance by which a group may be above the model, and the share that one above the band may be off at least: lines
/// and counts are there too.
pub(crate) const SHAPE_SDS: f64 = 5.0;
pub(crate) const SHAPE_OFF: f64 = 0.5;
/// Parts of the rows by speed, load and posture, in each of which a noise is as large.
pub(crate) const FIFTHS: usize = 5;

// `signal::line`
/// Samples whose periodogram is looked at, at most.
pub(crate) const LINE_SAMPLES: usize = 4096;
/// Share of what is faster than the motion that one frequency holds where it is an oscillation, and no noise: its amplitude is more than twice
/// the standard deviation of the rest.
pub(crate) const LINE_SHARE: f64 = 0.7;

// `loads`
/// Positions are smoothed up to this frequency \[Hz\], and up to this share of the log's rate.
pub(crate) const LOADS_CUTOFF_HZ: f64 = 40.0;
pub(crate) const LOADS_OF_RATE: f64 = 0.2;
