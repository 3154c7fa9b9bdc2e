//! Laws with a memory, one sample after the other: play, Dahl's loop, creep; and what follows late.
//!
//! Each struct is the memory itself. Its owner keeps it between samples and starts a run with a new one.

/// Half-width below which a play is taken to be so wide, its output scaled to its own half-width \[rad\], \[m\]: small
/// against any motion, and a play of no width still has a side.
pub const SMALLEST_HALF_WIDTH: f64 = 5e-5;
/// Shortest transition or half-width that something is divided by.
const SHORTEST: f64 = 1e-12;

/// A play (Prandtl's element): its output rests until the input has taken up the play.
///
/// ```
/// use haptical_transmission::loops::Play;
/// let mut play = Play::default();
/// let lost = [0.0, 0.3, 0.2, 0.0].map(|travel| play.step(0.1, travel));
/// // at rest, carried along from behind, half way through the play, carried along by its other side
/// for (lost, expected) in lost.iter().zip([0.0, -1.0, 0.0, 1.0]) {
///     assert!((lost - expected).abs() < 1e-12);
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Play {
    output: Option<f64>,
}

impl Play {
    /// Before the first sample; as the default, and usable in a constant.
    pub const NEW: Self = Self { output: None };

    /// Output less input for the next input, over the half-width: -1 after a long motion forward, +1 after one back, 0 at
    /// the first sample.
    ///
    /// `half_width` and `travel` in one unit; a half-width of less than 1e-12 is taken for 1e-12.
    /// Source: Brokate & Sprekels, Hysteresis and Phase Transitions, section 2.1 (the play operator).
    #[inline]
    pub fn step(&mut self, half_width: f64, travel: f64) -> f64 {
        let half_width = half_width.max(SHORTEST);
        let before = self.output.unwrap_or(travel);
        let output = before.max(travel - half_width).min(travel + half_width);
        self.output = Some(output);
        (output - travel) / half_width
    }
}

/// Dahl's friction state with exponent 1, scaled to saturate at 1.
///
/// ```
/// use haptical_transmission::loops::Dahl;
/// let mut friction = Dahl::default();
/// assert_eq!(friction.step(0.01, 0.0), 0.0);
/// // one transition forward: 1 - 1/e; then a long way back
/// assert!((friction.step(0.01, 0.01) - 0.632_120_558_828_557_7).abs() < 1e-15);
/// assert_eq!(friction.step(0.01, -1.0), -1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dahl {
    travel: Option<f64>,
    state: f64,
}

impl Dahl {
    /// Before the first sample; as the default, and usable in a constant.
    pub const NEW: Self = Self {
        travel: None,
        state: 0.0,
    };

    /// State at the next travel: after a reversal it goes to the other side over a travel of `transition`. In the limit
    /// of no transition it is the sign of the motion, the output of a play much smaller than the travel.
    ///
    /// Exact for a step in one direction: dz = (1 - z sgn) |dx| / transition. Source: Dahl 1968.
    #[inline]
    pub fn step(&mut self, transition: f64, travel: f64) -> f64 {
        self.step_with(transition, travel, libm::exp)
    }

    /// As [`Dahl::step`] with another exponential function: the standard library's differs from `libm`'s in the last bit.
    #[inline]
    pub fn step_with(
        &mut self,
        transition: f64,
        travel: f64,
        exponential: impl FnOnce(f64) -> f64,
    ) -> f64 {
        let step = self.travel.map_or(0.0, |before| travel - before);
        self.travel = Some(travel);
        if step != 0.0 {
            let direction = step.signum();
            let left = decay(step.abs() / transition.max(SHORTEST), exponential);
            self.state = direction + (self.state - direction) * left;
        }
        self.state
    }
}

/// exp(-x) for x at least 0: by the first terms of its reciprocal where they are exact to 1e-5, and 0
/// where it is below 1e-13.
#[inline]
fn decay(x: f64, exponential: impl FnOnce(f64) -> f64) -> f64 {
    if x > 30.0 {
        0.0
    } else if x < 0.1 {
        1.0 / (1.0 + x * (1.0 + x * (0.5 + x / 6.0)))
    } else {
        exponential(-x)
    }
}

/// What creeps with every loaded travel and does not come back: -sum of load times |travel|.
///
/// ```
/// use haptical_transmission::loops::Creep;
/// let mut creep = Creep::default();
/// let crept = [(2.0, 0.0), (2.0, 0.5), (4.0, 0.4)].map(|(load, travel)| creep.step(load, travel));
/// for (crept, expected) in crept.iter().zip([0.0, -1.0, -1.3]) {
///     assert!((crept - expected).abs() < 1e-15);
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Creep {
    before: Option<(f64, f64)>,
    sum: f64,
}

impl Creep {
    /// Before the first sample; as the default, and usable in a constant.
    pub const NEW: Self = Self {
        before: None,
        sum: 0.0,
    };

    /// The sum up to the next sample, with the mean load of each step.
    #[inline]
    pub fn step(&mut self, load: f64, travel: f64) -> f64 {
        if let Some((load_before, travel_before)) = self.before {
            let mean = 0.5 * (load + load_before);
            self.sum -= mean * (travel - travel_before).abs();
        }
        self.before = Some((load, travel));
        self.sum
    }
}

/// x(t - delay) - x(t) to second order, from the rates at t.
///
/// ```
/// // x = t^2 at t = 1, seen 0.1 later
/// let behind = haptical_transmission::loops::delayed(0.1, 2.0, 2.0);
/// assert!((behind - (0.81 - 1.0)).abs() < 1e-15);
/// ```
#[must_use]
#[inline]
pub fn delayed(delay_s: f64, velocity: f64, acceleration: f64) -> f64 {
    delay_s * (0.5 * delay_s * acceleration - velocity)
}

/// Share of its end that a drift with a time constant has come to within a time.
///
/// ```
/// let settled = haptical_transmission::loops::settled(2.0, 1.0);
/// assert!((settled - (1.0 - (-2.0f64).exp())).abs() < 1e-15);
/// ```
#[must_use]
#[inline]
pub fn settled(time_s: f64, time_constant_s: f64) -> f64 {
    1.0 - libm::exp(-time_s / time_constant_s)
}

/// Rate within which friction is that of rest rather than of motion \[rad/s\].
pub const STRIBECK_RAD_PER_S: f64 = 0.1;
/// The same of a joint that slides \[m/s\].
pub const STRIBECK_M_PER_S: f64 = 0.01;
