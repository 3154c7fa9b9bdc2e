//! Noise of the external encoders and of the cable: size, colour, outliers, rounding.

use crate::random::Random;
use crate::rig::readings::rounded;

/// Noise of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelNoise {
    /// Standard deviation relative to the stated one.
    pub factor: f64,
    /// Correlation of neighbouring samples (AR(1)).
    pub autoregression: f64,
    /// Share of readings that are outliers.
    pub outlier_share: f64,
    /// Standard deviation of outliers relative to the channel's.
    pub outlier_factor: f64,
    /// Ratio of the standard deviation in motion, at the channel's root-mean-square speed and above,
    /// to that at rest; 1 for noise that does not depend on speed.
    pub speed_ratio: f64,
    /// Ratio of the standard deviation at the far end of the channel's range to that at the near end; the root mean square
    /// over the range is the stated one; 1 for even noise.
    pub range_ratio: f64,
    /// Whether the reading is rounded to the encoder's counts.
    pub rounded: bool,
}

impl Default for ChannelNoise {
    fn default() -> Self {
        Self {
            factor: 1.0,
            autoregression: 0.0,
            outlier_share: 0.0,
            outlier_factor: 8.0,
            speed_ratio: 1.0,
            range_ratio: 1.0,
            rounded: false,
        }
    }
}

/// Noise of all channels: one entry per joint (used where it has an external encoder), then the cable.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NoisePlan {
    /// External encoders.
    pub output: Vec<ChannelNoise>,
    /// The cable.
    pub cable: ChannelNoise,
}

impl NoisePlan {
    /// White noise of the stated size on every channel of a device with `joints` joints.
    pub fn white(joints: usize) -> Self {
        Self {
            output: vec![ChannelNoise::default(); joints],
            cable: ChannelNoise::default(),
        }
    }
}

impl ChannelNoise {
    /// `clean` with noise of this kind and the digits of a log; `speed` is the channel's, in any unit; `count` the encoder's.
    pub(crate) fn read(
        &self,
        clean: &[f64],
        speed: &[f64],
        sd: f64,
        count: Option<f64>,
        random: &mut Random,
    ) -> Vec<f64> {
        let speed_rms = crate::laws::rms(speed).max(f64::MIN_POSITIVE);
        let fresh = libm::sqrt(1.0 - self.autoregression * self.autoregression);
        let uneven = Uneven::over(clean, self.range_ratio);
        let mut state = random.normal();
        clean
            .iter()
            .zip(speed)
            .map(|(value, speed)| {
                state = self.autoregression * state + fresh * random.normal();
                let moving = (speed / speed_rms).abs().min(1.0);
                let size = sd * self.factor * (1.0 + (self.speed_ratio - 1.0) * moving);
                let size = size * uneven.at(*value);
                let mut reading = value + size * state;
                if self.outlier_share > 0.0 && random.unit() <= self.outlier_share {
                    reading += size * self.outlier_factor * random.normal();
                }
                if let Some(count) = count.filter(|_| self.rounded) {
                    reading = libm::round(reading / count) * count;
                }
                rounded(reading, 1e7)
            })
            .collect()
    }
}

/// Noise that grows along a channel's range.
#[derive(Debug)]
struct Uneven {
    least: f64,
    range: f64,
    near: f64,
    ratio: f64,
}

impl Uneven {
    fn over(clean: &[f64], ratio: f64) -> Self {
        let least = clean.iter().copied().fold(f64::INFINITY, f64::min);
        let most = clean.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut uneven = Self {
            least,
            range: (most - least).max(f64::MIN_POSITIVE),
            near: 1.0,
            ratio,
        };
        let sizes: Vec<f64> = clean.iter().map(|value| uneven.at(*value)).collect();
        uneven.near = 1.0 / crate::laws::rms(&sizes).max(f64::MIN_POSITIVE);
        uneven
    }

    fn at(&self, value: f64) -> f64 {
        if self.ratio == 1.0 {
            return 1.0;
        }
        let share = (value - self.least) / self.range;
        self.near * (1.0 + (self.ratio - 1.0) * share)
    }
}
