//! Settings of a hand-guided recording: the motion and load of the hand, the noise of sensors.

use crate::settings::{allow, allow_share, allow_size};
use crate::{Settings, SimulatorError};

/// How a hand moves the device. The bounds hold for every joint at every instant.
///
/// Defaults are assumptions A44 and A45 of docs/assumptions.md.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandMotion {
    /// Length of the recording \[s\].
    pub seconds: f64,
    /// Rows per second \[1/s\].
    pub rate_hz: f64,
    /// Rest at home before the motion, and after it \[s\].
    pub home_rest_s: f64,
    /// Rests of the whole device on the way.
    pub rests: usize,
    /// Length of each such rest \[s\].
    pub rest_s: f64,
    /// Time in which the hand slows down before such a rest, and speeds up after it \[s\].
    pub ramp_s: f64,
    /// Share of the range between a joint's limits that the motion uses, in (0, 1].
    pub range_share: f64,
    /// Largest speed of a revolute joint \[rad/s\].
    pub speed_rad_per_s: f64,
    /// Largest acceleration of a revolute joint \[rad/s^2\].
    pub acceleration_rad_per_s2: f64,
    /// Largest speed of a prismatic joint \[m/s\].
    pub speed_m_per_s: f64,
    /// Largest acceleration of a prismatic joint \[m/s^2\].
    pub acceleration_m_per_s2: f64,
}

impl Default for HandMotion {
    fn default() -> Self {
        Self {
            seconds: 100.0,
            rate_hz: 1000.0,
            home_rest_s: 2.0,
            rests: 3,
            rest_s: 1.0,
            ramp_s: 1.0,
            range_share: 0.95,
            speed_rad_per_s: 2.0,
            acceleration_rad_per_s2: 8.0,
            speed_m_per_s: 0.5,
            acceleration_m_per_s2: 2.0,
        }
    }
}

/// What the encoders add to true values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Encoders {
    /// Nothing.
    Exact,
    /// As the device file describes each encoder: motor-side and external encoders show whole counts
    /// where it gives counts (an external one that has a standard deviation alone has normal noise of
    /// that size); a cable has normal noise of its `distance_sd_m`, or shows whole counts where it
    /// has none. What the file does not describe is exact.
    Described,
    /// The same for all, as in [`crate::simulate`]; how poses are drawn is not used.
    Same(Settings),
}

/// Warming up of the device: start + rise (1 - exp(-t / time constant)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temperature {
    /// At the start \[degC\].
    pub start_degc: f64,
    /// From the start to the end of a very long recording \[K\].
    pub rise_k: f64,
    /// Time constant \[s\].
    pub time_constant_s: f64,
    /// Noise of the thermometer \[K\].
    pub sd_k: f64,
}

impl Default for Temperature {
    fn default() -> Self {
        Self {
            start_degc: 22.0,
            rise_k: 4.0,
            time_constant_s: 60.0,
            sd_k: 0.02,
        }
    }
}

impl Temperature {
    /// Rise since the start \[K\].
    pub(crate) fn rise_at(&self, time_s: f64) -> f64 {
        -self.rise_k * libm::expm1(-time_s.max(0.0) / self.time_constant_s)
    }
}

/// Settings of a hand-guided recording.
///
/// ```
/// use haptical_simulator::{HandMotion, MotionSettings};
/// let settings = MotionSettings {
///     motion: HandMotion { seconds: 20.0, rate_hz: 100.0, ..HandMotion::default() },
///     ..MotionSettings::quiet()
/// };
/// assert_eq!(settings.rows()?, 2000);
/// # Ok::<(), haptical_simulator::SimulatorError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSettings {
    /// How the hand moves.
    pub motion: HandMotion,
    /// What the encoders add.
    pub encoders: Encoders,
    /// Seed of what belongs to the device and not to a recording: its drums' roughness.
    pub device_seed: u64,
    /// Root mean square of the hand's force along each axis of the handle \[N\]; 0: the hand only
    /// moves.
    pub force_rms_n: f64,
    /// Noise of the force sensor \[N\].
    pub force_sd_n: f64,
    /// Noise of a torque (motor current) \[N m\].
    pub torque_sd_nm: f64,
    /// Temperature of the device; without it there is no column of it.
    pub temperature: Option<Temperature>,
}

impl Default for MotionSettings {
    fn default() -> Self {
        Self {
            motion: HandMotion::default(),
            encoders: Encoders::Described,
            device_seed: 1,
            force_rms_n: 2.0,
            force_sd_n: 0.02,
            torque_sd_nm: 2e-3,
            temperature: Some(Temperature::default()),
        }
    }
}

impl MotionSettings {
    /// The default motion and force, with sensors that show true values.
    pub fn quiet() -> Self {
        let temperature = Temperature {
            sd_k: 0.0,
            ..Temperature::default()
        };
        Self {
            encoders: Encoders::Exact,
            force_sd_n: 0.0,
            torque_sd_nm: 0.0,
            temperature: Some(temperature),
            ..Self::default()
        }
    }

    /// Rows of a recording with these settings: row k is at k / rate.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] for settings outside their domain.
    pub fn rows(&self) -> Result<u64, SimulatorError> {
        self.check()?;
        Ok(libm::round(self.motion.seconds * self.motion.rate_hz) as u64)
    }

    /// Refuses settings outside their domain.
    pub(crate) fn check(&self) -> Result<(), SimulatorError> {
        let motion = &self.motion;
        let positive = "finite, above 0";
        for (setting, value) in [
            ("rate_hz", motion.rate_hz),
            ("ramp_s", motion.ramp_s),
            ("speed_rad_per_s", motion.speed_rad_per_s),
            ("acceleration_rad_per_s2", motion.acceleration_rad_per_s2),
            ("speed_m_per_s", motion.speed_m_per_s),
            ("acceleration_m_per_s2", motion.acceleration_m_per_s2),
            (
                "time_constant_s",
                self.temperature.map_or(1.0, |warm| warm.time_constant_s),
            ),
        ] {
            allow(setting, value, value > 0.0 && value.is_finite(), positive)?;
        }
        let warm = self.temperature.unwrap_or_default();
        for (setting, value) in [
            ("home_rest_s", motion.home_rest_s),
            ("rest_s", motion.rest_s),
            ("force_rms_n", self.force_rms_n),
            ("force_sd_n", self.force_sd_n),
            ("torque_sd_nm", self.torque_sd_nm),
            ("sd_k", warm.sd_k),
        ] {
            allow_size(setting, value)?;
        }
        for (setting, value) in [("start_degc", warm.start_degc), ("rise_k", warm.rise_k)] {
            allow(setting, value, value.is_finite(), "finite")?;
        }
        allow_share("range_share", motion.range_share)?;
        // a target is kept for every second or so of every joint
        let seconds = motion.seconds;
        let good = seconds > 0.0 && seconds <= MOST_SECONDS;
        allow("seconds", seconds, good, "above 0, at most 1e7")?;
        let rows = seconds * motion.rate_hz;
        let good = (1.0..MOST_ROWS).contains(&rows);
        allow("seconds x rate_hz", rows, good, "1 row to 2^32 rows")?;
        if let Encoders::Same(settings) = &self.encoders {
            settings.check(0)?;
        }
        Ok(())
    }
}

/// Longest recording.
const MOST_SECONDS: f64 = 1e7;
/// Rows below which each has a number that a `u32` holds.
const MOST_ROWS: f64 = 4_294_967_296.0;
