//! How long postures stay alike: a change that follows the posture may not show for as long.

/// Spells are counted by their length: the first bin ends with this one \[s\].
const SHORTEST_S: f64 = 1e-3;
/// Bins, until the length doubles.
const PER_DOUBLING: usize = 4;
/// Number of bins: the last one is of more than a year.
const BINS: usize = 36 * PER_DOUBLING;
/// Share of the time that lies in spells of at most the length that is told.
const SHARE: f64 = 0.95;

/// Spells that joints stay on one side of their means, in bounded memory.
///
/// # Examples
/// ```
/// use haptical_monitor::Course;
/// let mut course = Course::default();
/// for second in 0..10_000 {
///     let time_s = f64::from(second);
///     course.push(time_s, [(time_s * std::f64::consts::TAU / 100.0).sin()].into_iter());
/// }
/// // half a period of 100 s
/// assert!((50.0..60.0).contains(&course.spell_s()));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Course {
    joints: Vec<Joint>,
}

#[derive(Debug, Clone)]
struct Joint {
    count: f64,
    mean: f64,
    is_above: bool,
    since_s: f64,
    /// Time in spells of each length \[s\].
    time_s: [f64; BINS],
}

impl Course {
    /// Takes a time \[s\] and the joints' values there; those that are not finite are left out.
    pub fn push(&mut self, time_s: f64, values: impl Iterator<Item = f64>) {
        for (place, value) in values.enumerate() {
            if place == self.joints.len() {
                self.joints.push(Joint::new());
            }
            let joint = &mut self.joints[place];
            if !(value.is_finite() && time_s.is_finite()) {
                continue;
            }
            joint.count += 1.0;
            joint.mean += (value - joint.mean) / joint.count;
            let is_above = value > joint.mean;
            if joint.since_s.is_nan() {
                (joint.is_above, joint.since_s) = (is_above, time_s);
            } else if is_above != joint.is_above {
                joint.close(time_s);
                joint.is_above = is_above;
            }
        }
    }

    /// Length of the spells \[s\] that 95 % of the time lies within, of the joint whose spells are longest, up to a fifth too
    /// long; 0 while no joint came back.
    pub fn spell_s(&self) -> f64 {
        self.joints.iter().map(Joint::spell_s).fold(0.0, f64::max)
    }
}

impl Joint {
    fn new() -> Self {
        Self {
            count: 0.0,
            mean: 0.0,
            is_above: false,
            since_s: f64::NAN,
            time_s: [0.0; BINS],
        }
    }

    fn close(&mut self, time_s: f64) {
        let length_s = (time_s - self.since_s).max(0.0);
        let doublings = (length_s / SHORTEST_S).max(1.0).log2();
        let bin = (PER_DOUBLING as f64 * doublings).floor() as usize;
        self.time_s[bin.min(BINS - 1)] += length_s;
        self.since_s = time_s;
    }

    fn spell_s(&self) -> f64 {
        let all_s: f64 = self.time_s.iter().sum();
        if all_s <= 0.0 {
            return 0.0;
        }
        let mut sum_s = 0.0;
        let bin = self.time_s.iter().position(|time_s| {
            sum_s += time_s;
            sum_s >= SHARE * all_s
        });
        // the upper end of the bin
        let bins = bin.unwrap_or(BINS - 1) as f64 + 1.0;
        SHORTEST_S * f64::exp2(bins / PER_DOUBLING as f64)
    }
}
