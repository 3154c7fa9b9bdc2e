//! A servo that is not the library's: a second-order loop with Coulomb friction that sticks (Karnopp 1985), integrated at 1 kHz,
//! read in counts at 50 Hz.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Steps of the simulation in a row of the log.
const STEPS: usize = 20;
const STEP_S: f64 = 1e-3;

/// A servo; the default answers at once.
#[derive(Debug, Clone)]
pub(crate) struct Servo {
    /// Natural frequency of the loop; none without dynamics.
    pub(crate) rad_per_s: Option<f64>,
    pub(crate) damping: f64,
    /// Coulomb's torque over the stiffness \[rad\].
    pub(crate) friction_rad: f64,
    /// Gravity's torque over the stiffness \[rad\], times the cosine of the angle.
    pub(crate) droop_rad: f64,
    pub(crate) delay_s: f64,
    pub(crate) offset_rad: f64,
    pub(crate) gain: f64,
    pub(crate) count_rad: f64,
}

impl Default for Servo {
    fn default() -> Self {
        Self {
            rad_per_s: None,
            damping: 1.0,
            friction_rad: 0.0,
            droop_rad: 0.0,
            delay_s: 0.0,
            offset_rad: 0.0,
            gain: 1.0,
            count_rad: std::f64::consts::TAU / 4096.0,
        }
    }
}

/// Times and columns of a log.
#[derive(Debug, Clone, Default)]
pub(crate) struct Log {
    pub(crate) time_s: Vec<f64>,
    pub(crate) run: Vec<i64>,
    pub(crate) command: Vec<f64>,
    pub(crate) response: Vec<f64>,
}

/// A motion of five sines with rests: what it is at a time \[rad\].
pub(crate) fn motion(seed: u64) -> impl Fn(f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<[f64; 3]> = (0..5)
        .map(|_| {
            [
                random.random_range(0.05..0.15),
                random.random_range(0.3..6.0),
                random.random_range(0.0..6.3),
            ]
        })
        .collect();
    move |time_s: f64| {
        // rests of a second in five
        let moving = (time_s / 5.0).floor() * 4.0 + (time_s % 5.0).min(4.0);
        waves
            .iter()
            .map(|[size, speed, phase]| size * (speed * moving + phase).sin())
            .sum()
    }
}

impl Servo {
    /// Its log of a motion.
    pub(crate) fn log(&self, command: &dyn Fn(f64) -> f64, duration_s: f64) -> Log {
        let rows = (duration_s / (STEPS as f64 * STEP_S)) as usize;
        let mut log = Log::default();
        let (mut angle, mut speed) = (command(0.0), 0.0);
        for row in 0..rows {
            let time_s = (row * STEPS) as f64 * STEP_S;
            let read = self.gain * angle + self.offset_rad;
            log.time_s.push(time_s);
            log.run.push(0);
            log.command.push(command(time_s));
            log.response
                .push((read / self.count_rad).round() * self.count_rad);
            for step in 0..STEPS {
                // the command at the end of the step
                let now = time_s + (step + 1) as f64 * STEP_S;
                let wanted = command((now - self.delay_s).max(0.0));
                (angle, speed) = self.moved((angle, speed), wanted);
            }
        }
        log
    }

    /// One step: in units of the stiffness a torque is an angle.
    fn moved(&self, (angle, speed): (f64, f64), wanted: f64) -> (f64, f64) {
        let Some(natural) = self.rad_per_s else {
            return (wanted, 0.0);
        };
        let pull = wanted - angle - self.droop_rad * angle.cos();
        let drive = pull - 2.0 * self.damping / natural * speed;
        // it sticks where it is slow and the pull is no larger than friction
        if speed.abs() < 1e-3 && pull.abs() <= self.friction_rad {
            return (angle, 0.0);
        }
        let against = if speed.abs() < 1e-3 { pull } else { speed };
        let next =
            speed + natural * natural * (drive - self.friction_rad * against.signum()) * STEP_S;
        // friction stops a motion, it does not turn it round
        let next = if speed.abs() >= 1e-3 && next * speed < 0.0 {
            0.0
        } else {
            next
        };
        (angle + next * STEP_S, next)
    }
}
