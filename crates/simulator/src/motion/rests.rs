//! Time as the hand's motion counts it: it stands still while the whole device rests.

use crate::SimulatorError;
use crate::motion::settings::HandMotion;
use crate::settings::allow;

/// Largest slope of the smooth step 3 y^2 - 2 y^3.
pub(crate) const STEEPEST: f64 = 1.5;

/// Moving time sigma as a function of time t, with C2 rests.
///
/// Between rests sigma' = 1. Before a rest sigma' falls to 0 as 1 - S(y), S = 3 y^2 - 2 y^3, within
/// the ramp, and rises the same way after it. Source: docs/equations.md, Motion simulation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rests {
    home_rest_s: f64,
    /// Time between the rests at home.
    active_s: f64,
    rests: usize,
    rest_s: f64,
    ramp_s: f64,
    /// Moving time in all.
    pub(crate) moving_s: f64,
}

/// Moving time at an instant, and its first two derivatives with respect to time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingTime {
    pub(crate) value_s: f64,
    pub(crate) rate: f64,
    pub(crate) rate_change_per_s: f64,
}

impl Rests {
    pub(crate) fn new(motion: &HandMotion) -> Result<Self, SimulatorError> {
        let active_s = motion.seconds - 2.0 * motion.home_rest_s;
        let good = active_s > 0.0;
        let allowed = "more than the two rests at home, 2 home_rest_s";
        allow("seconds", motion.seconds, good, allowed)?;
        // a recording that is too short for its rests has fewer of them
        let rest_and_ramps_s = motion.rest_s + 2.0 * motion.ramp_s;
        let room = libm::floor(active_s / rest_and_ramps_s / 2.0);
        let rests = (motion.rests as f64).min(room).max(0.0) as usize;
        Ok(Self {
            home_rest_s: motion.home_rest_s,
            active_s,
            rests,
            rest_s: motion.rest_s,
            ramp_s: motion.ramp_s,
            moving_s: active_s - rests as f64 * (motion.rest_s + motion.ramp_s),
        })
    }

    /// Moving time at a time \[s\]; before the start and after the end it stands still.
    pub(crate) fn moving_time(&self, time_s: f64) -> MovingTime {
        let since_s = time_s - self.home_rest_s;
        let moving = |value_s, rate, rate_change_per_s| MovingTime {
            value_s,
            rate,
            rate_change_per_s,
        };
        let still = |value_s| moving(value_s, 0.0, 0.0);
        if since_s <= 0.0 {
            return still(0.0);
        }
        if since_s >= self.active_s {
            return still(self.moving_s);
        }
        let spacing_s = self.active_s / (self.rests + 1) as f64;
        let window_s = self.rest_s + 2.0 * self.ramp_s;
        // the rests whose windows have begun: rest i is centred at i spacings
        let begun = libm::floor((since_s + window_s / 2.0) / spacing_s).min(self.rests as f64);
        let lost_s = self.rest_s + self.ramp_s;
        if begun < 1.0 {
            return moving(since_s, 1.0, 0.0);
        }
        let start_s = begun * spacing_s - window_s / 2.0;
        let before_s = start_s - (begun - 1.0) * lost_s;
        let into_s = since_s - start_s;
        let ramp_s = self.ramp_s;
        // integral of S, S and S' at y
        let step = |y: f64| {
            (
                y * y * y * (1.0 - y / 2.0),
                y * y * (3.0 - 2.0 * y),
                6.0 * y * (1.0 - y),
            )
        };
        if into_s < ramp_s {
            let (area, height, slope) = step(into_s / ramp_s);
            let value_s = before_s + into_s - ramp_s * area;
            moving(value_s, 1.0 - height, -slope / ramp_s)
        } else if into_s <= ramp_s + self.rest_s {
            still(before_s + ramp_s / 2.0)
        } else if into_s < window_s {
            let (area, height, slope) = step((into_s - ramp_s - self.rest_s) / ramp_s);
            let value_s = before_s + ramp_s / 2.0 + ramp_s * area;
            moving(value_s, height, slope / ramp_s)
        } else {
            moving(since_s - begun * lost_s, 1.0, 0.0)
        }
    }
}
