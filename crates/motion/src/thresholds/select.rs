//! Selection of effects: what each must explain, and how its numbers are searched.

// `select`
/// Most effects at once, and most places of them: an armature may be off at every joint.
pub(crate) const MOST_EFFECTS: usize = 4;
pub(crate) const MOST_PLACES: usize = 10;
/// What an effect explains beyond its numbers, at least \[nats\].
pub(crate) const LEAST_NATS: f64 = 16.0;
/// A further effect explains this share of the whole, or that one of what is left.
pub(crate) const LEAST_OF_WHOLE: f64 = 0.03;
pub(crate) const LEAST_OF_REST: f64 = 0.5;
/// Beside a delay of all positions it explains this share of the whole: a shifted torque is not the one that was read.
pub(crate) const LEAST_OF_DELAYED: f64 = 2e-3;
/// Times that an effect is exchanged for one that explains more in its place.
pub(crate) const MOST_EXCHANGES: usize = 4;
/// Times that a joint's zero is fitted with the readings moved by it.
pub(crate) const ZERO_ROUNDS: usize = 8;
/// Candidates that are fitted in full, strongest first, and the share of the strongest that they explain at least.
pub(crate) const FITTED_IN_FULL: usize = 6;
pub(crate) const NEAR_STRONGEST: f64 = 0.5;
/// Times that a law is corrected, and the share of what it then explains that it explained before.
pub(crate) const CORRECTIONS: usize = 2;
pub(crate) const MOST_OF_CORRECTED: f64 = 0.7;
/// Delays are found to this share of a step.
pub(crate) const DELAY_TOLERANCE: f64 = 0.01;
/// Longest delay that is tried \[s\].
pub(crate) const LONGEST_DELAY_S: f64 = 0.1;

// `select::scored`
/// What the last column of an effect that needs it explains at least \[nats\].
pub(crate) const LEAST_LAST_NATS: f64 = 12.0;

// `select::fitted`
/// Delays at which the recorded rows are kept. Cost.
pub(crate) const TARGETS: usize = 4;
/// Times that numbers beyond their limits are put at them.
pub(crate) const LIMIT_ROUNDS: usize = 6;

// `select::refine`
/// Steps of a search for a number of a shape, each 0.62 of the one before.
pub(crate) const SEARCH_STEPS: usize = 8;
/// Times that a candidate is made linear about its coefficients at most. Cost: it ends where what it explains moves no more.
pub(crate) const LINEARISATIONS: usize = 40;
/// Change of what a candidate explains below which it has converged \[nats\]: its numbers are within 0.15 of their standard deviations.
pub(crate) const UNMOVED_NATS: f64 = 0.01;

// `select::shape`
/// Steps of the logarithm of a shape's number within which what is explained has to fall for a standard deviation to be known.
pub(crate) const SHAPE_STEPS: [f64; 6] = [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];
/// Parabolas through three numbers, the ends so many standard deviations from the middle; the middle moves by no more at once. Cost: the
/// search ends where the middle moves no more, and what it would still move is counted in its interval.
pub(crate) const PARABOLAS: usize = 20;
pub(crate) const PARABOLA_SDS: f64 = 2.0;
/// A move of so many standard deviations is none.
pub(crate) const UNMOVED_SDS: f64 = 0.1;

// `select::rivals`
/// Share of what an effect of one joint's torque explains that it explains there, at least.
pub(crate) const LEAST_AT_JOINT: f64 = 0.5;

// `later`
/// What a pick makes worse of a second recording that refutes it \[nats\].
pub(crate) const REFUTED_NATS: f64 = 4.0;
/// One factor on all torques and an effect are not told apart where one explains this share of what the other does. Choice: bodies are known
/// to some percent.
pub(crate) const SAME_AS_SCALE: f64 = 0.99;
