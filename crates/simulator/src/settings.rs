//! Settings of a simulated recording: the distribution of poses, the noise of encoders.

use crate::SimulatorError;

/// How joint readings are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Normal about home with the joint's `sampling_sd_rad`; drawn again beyond 3 sd and beyond the
    /// joint's limits.
    Normal,
    /// Uniform between the joint's limits times [`Settings::uniform_share`].
    Uniform,
}

/// What an encoder adds to the true value. The standard deviation and the count are those of the
/// channel: see [`crate::simulate`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// The true value.
    None,
    /// Normal noise.
    Gaussian,
    /// Rounding to whole encoder counts.
    Counts,
    /// Normal noise, then rounding.
    GaussianAndCounts,
}

impl Noise {
    pub(crate) fn has_gaussian(self) -> bool {
        matches!(self, Self::Gaussian | Self::GaussianAndCounts)
    }

    pub(crate) fn has_counts(self) -> bool {
        matches!(self, Self::Counts | Self::GaussianAndCounts)
    }
}

/// Which standard deviation a cable distance has. R_d is the drum's radius, and
/// sigma_e = 2 pi / counts / 3 \[rad\] the paper's standard deviation of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CableSigma {
    /// The device's `distance_sd_m`.
    Stated,
    /// 2 pi R_d sigma_e, as the paper prints it.
    Printed,
    /// R_d sigma_e: an arc is radius times angle.
    Geometric,
}

/// Settings of a simulation.
///
/// ```
/// use haptical_simulator::{Noise, Settings};
/// let quiet = Settings { output_noise: Noise::None, ..Settings::paper() };
/// assert_eq!(quiet.cable_noise, Noise::Gaussian);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How poses are drawn.
    pub sampling: Sampling,
    /// Share of the range between the limits that [`Sampling::Uniform`] uses, in (0, 1].
    pub uniform_share: f64,
    /// Whether motor-side readings are rounded to real counts of
    /// 2 pi / `encoder_counts_per_rev` / |`transmission_ratio`|.
    pub motor_counts: bool,
    /// Noise of the external encoders.
    pub output_noise: Noise,
    /// Noise of the cable encoders.
    pub cable_noise: Noise,
    /// Standard deviation of the cable encoders' normal noise.
    pub cable_sigma: CableSigma,
    /// Poses whose handle is nearer to a cable's exit are drawn again \[m\]: the distance has no
    /// derivative at the exit.
    pub minimum_distance_m: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self::paper()
    }
}

impl Settings {
    /// The paper's simulation: normal poses, exact motor-side readings, normal noise on external
    /// encoders and cable, the cable's standard deviation as printed.
    pub fn paper() -> Self {
        Self {
            sampling: Sampling::Normal,
            uniform_share: 2.0 / 3.0,
            motor_counts: false,
            output_noise: Noise::Gaussian,
            cable_noise: Noise::Gaussian,
            cable_sigma: CableSigma::Printed,
            minimum_distance_m: 0.03,
        }
    }

    /// Real encoders: every reading is a whole number of counts, and nothing is normal. A count of
    /// the cable is 2 pi R_d / counts.
    pub fn real_encoders() -> Self {
        Self {
            motor_counts: true,
            output_noise: Noise::Counts,
            cable_noise: Noise::Counts,
            ..Self::paper()
        }
    }

    /// Refuses settings outside their domain; `rows` is checked with them.
    pub(crate) fn check(&self, rows: usize) -> Result<(), SimulatorError> {
        // each row owns a section of the pose stream, and there are 2^32 sections
        let is_counted = u32::try_from(rows).is_ok();
        allow("rows", rows as f64, is_counted, "below 2^32")?;
        allow_share("uniform_share", self.uniform_share)?;
        allow_size("minimum_distance_m", self.minimum_distance_m)
    }
}

/// Refuses a share that is not above 0 and at most 1.
pub(crate) fn allow_share(setting: &'static str, value: f64) -> Result<(), SimulatorError> {
    let good = value > 0.0 && value <= 1.0;
    allow(setting, value, good, "above 0, at most 1")
}

/// Refuses a size that is negative or not finite.
pub(crate) fn allow_size(setting: &'static str, value: f64) -> Result<(), SimulatorError> {
    let good = value >= 0.0 && value.is_finite();
    allow(setting, value, good, "finite, 0 or more")
}

/// Refuses a setting that is not good.
pub(crate) fn allow(
    setting: &'static str,
    value: f64,
    good: bool,
    allowed: &'static str,
) -> Result<(), SimulatorError> {
    if good {
        Ok(())
    } else {
        Err(SimulatorError::Setting {
            setting,
            value,
            allowed,
        })
    }
}
