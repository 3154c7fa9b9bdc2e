//! Loops that are not the library's, between rows by small steps: a delay, a lag, a mass, friction and a limit of the speed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::servo::Log;

/// Steps of the integration in a second.
const STEPS_HZ: f64 = 8000.0;

/// A loop; the default answers at once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loop {
    pub(crate) rows_hz: f64,
    /// Commands hold till the next row; else they go there along a straight line.
    pub(crate) holds: bool,
    pub(crate) delay_s: f64,
    /// Damping over stiffness; with a mass twice the damping ratio over the natural frequency.
    pub(crate) lag_s: f64,
    /// Natural frequency of a mass on the stiffness.
    pub(crate) rad_per_s: Option<f64>,
    /// Coulomb's torque over the stiffness.
    pub(crate) friction_rad: f64,
    pub(crate) most_rad_per_s: f64,
    pub(crate) noise_rad: f64,
}

impl Default for Loop {
    fn default() -> Self {
        Self {
            rows_hz: 200.0,
            holds: false,
            delay_s: 0.0,
            lag_s: 0.02,
            rad_per_s: None,
            friction_rad: 0.0,
            most_rad_per_s: f64::INFINITY,
            noise_rad: 0.0005,
        }
    }
}

/// Steps to an even draw within 0.7 rad, every 0.4 to 1.5 s.
pub(crate) fn steps(seed: u64, rows_hz: f64, duration_s: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rows = (duration_s * rows_hz) as usize;
    let (mut command, mut at) = (Vec::with_capacity(rows), 0.0);
    while command.len() < rows {
        let length = (rows_hz * random.random_range(0.4..1.5)) as usize;
        command.resize((command.len() + length).min(rows), at);
        at = random.random_range(-0.7..0.7);
    }
    command
}

/// Moves of minimum jerk (Flash & Hogan 1985) between such rests, a share of them wide.
pub(crate) fn moves(seed: u64, rows_hz: f64, duration_s: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rows = (duration_s * rows_hz) as usize;
    let (mut command, mut at) = (Vec::with_capacity(rows), 0.0);
    while command.len() < rows {
        let next: f64 = random.random_range(-0.9..0.9);
        let length = (rows_hz * random.random_range(0.4..1.5)) as usize;
        for row in 0..length {
            let s = row as f64 / length as f64;
            command.push(at + (next - at) * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s));
        }
        at = next;
        let rest = (rows_hz * random.random_range(0.0..0.6)) as usize;
        command.resize(command.len() + rest, at);
    }
    command.truncate(rows);
    command
}

impl Loop {
    /// Its log of a command.
    pub(crate) fn log(&self, command: &[f64], seed: u64) -> Log {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let steps = (STEPS_HZ / self.rows_hz).ceil() as usize;
        let step_s = 1.0 / self.rows_hz / steps as f64;
        let count_rad = std::f64::consts::TAU / 16384.0;
        let (mut angle, mut speed) = (command[0], 0.0);
        let mut log = Log::default();
        for row in 0..command.len() {
            // the sum of twelve even draws is nearly normal, with variance 1
            let noise: f64 = (0..12).map(|_| random.random_range(-0.5..0.5)).sum();
            let read = angle + self.noise_rad * noise;
            log.time_s.push(row as f64 / self.rows_hz);
            log.run.push(0);
            log.command.push(command[row]);
            log.response.push((read / count_rad).round() * count_rad);
            for step in 0..steps {
                let at = row as f64 + step as f64 / steps as f64 - self.delay_s * self.rows_hz;
                let wanted = self.wanted(command, at);
                (angle, speed) = self.moved((angle, speed), wanted, step_s);
            }
        }
        log
    }

    /// The command at a row and a part.
    fn wanted(&self, command: &[f64], at: f64) -> f64 {
        // what a row holds begins at it, whatever the last digit
        let at = (at + 1e-9).clamp(0.0, (command.len() - 1) as f64);
        let (row, part) = (at.floor() as usize, at.fract());
        let next = (row + 1).min(command.len() - 1);
        match self.holds {
            true => command[row],
            false => command[row] + part * (command[next] - command[row]),
        }
    }

    fn moved(&self, (angle, speed): (f64, f64), wanted: f64, step_s: f64) -> (f64, f64) {
        let pull = wanted - angle;
        let Some(natural) = self.rad_per_s else {
            let most = self.most_rad_per_s;
            let speed = (pull / self.lag_s.max(step_s)).clamp(-most, most);
            return (angle + step_s * speed, speed);
        };
        let drive = pull - self.lag_s * speed;
        if speed == 0.0 && drive.abs() <= self.friction_rad {
            return (angle, 0.0);
        }
        let against = if speed == 0.0 { drive } else { speed };
        let next =
            speed + step_s * natural.powi(2) * (drive - self.friction_rad * against.signum());
        // friction stops a motion, it does not turn it round
        let next = if next * speed < 0.0 && self.friction_rad > 0.0 {
            0.0
        } else {
            next
        };
        (angle + step_s * next, next)
    }
}
