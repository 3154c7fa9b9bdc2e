//! The way of a hand-guided device: smooth, within limits, fast as a hand, from home to home.

use haptical_model::{Device, Joint, JointType, TransmissionError};
use rand_chacha::ChaCha8Rng;

use crate::SimulatorError;
use crate::motion::rests::{Rests, STEEPEST};
use crate::motion::settings::HandMotion;
use crate::sampling::{joint_part, limits};
use crate::settings::allow;
use crate::streams::{Stream, uniform};

/// Largest slope of the minimum-jerk step 10 u^3 - 15 u^4 + 6 u^5: at u = 1/2.
const STEEPEST_STEP: f64 = 1.875;
/// Largest second derivative of it, 10 / sqrt 3, rounded up: at u = 1/2 -+ sqrt(3) / 6.
const MOST_CURVED_STEP: f64 = 5.774;
/// Every so many targets one is an end of the range, upper and lower in turn.
const TARGETS_PER_END: usize = 4;
/// Joints of the same range take different numbers of targets, so that they do not turn together.
const DIFFERENT_COUNTS: usize = 4;

/// Reading of a joint that the hand wants, with its derivatives: \[rad\], \[rad/s\], \[rad/s^2\], or
/// \[m\] and so on for a prismatic joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JointMotion {
    /// Reading from home.
    pub position: f64,
    /// Its rate.
    pub velocity: f64,
    /// The rate's rate.
    pub acceleration: f64,
}

/// The way of every joint through one recording.
///
/// Each joint goes from target to target in equal times, by the step of minimum jerk (Flash & Hogan,
/// "The coordination of arm movements", J. Neuroscience 1985, eq. 3), and stays between the two; the
/// first and the last target are home. Targets are uniform in the share of the range, every fourth an
/// end of it. The time between targets is the shortest that keeps the bounds on speed and
/// acceleration for the longest step, so a joint with a wide range turns less often. The
/// position has two continuous derivatives. Source: docs/equations.md, Motion simulation.
///
/// ```
/// use haptical_simulator::model::Device;
/// use haptical_simulator::{HandMotion, Motion};
/// let text = "[[joint]]\nlower_rad = -1.0\nupper_rad = 1.2\n";
/// let device = Device::from_toml(text, "one.toml")?.device;
/// let motion = Motion::new(&device, &HandMotion::default(), 1)?;
/// let middle = motion.joint_motion(0, 51.3);
/// assert!(middle.position >= -0.95 && middle.position <= 0.95 * 1.2);
/// assert_eq!(motion.joint_motion(0, 100.0).position, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Motion {
    rests: Rests,
    paths: Vec<Path>,
}

/// The way of one joint.
#[derive(Debug, Clone)]
struct Path {
    targets: Vec<f64>,
    segment_s: f64,
    range: [f64; 2],
    generator: ChaCha8Rng,
}

impl Motion {
    /// Draws the targets of every joint of a device.
    ///
    /// A joint whose transmission error is a polynomial stays where the polynomial was fitted too.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`]; [`SimulatorError::Value`] for a joint without finite limits;
    /// [`SimulatorError::NoRoom`] for one whose home is outside them.
    pub fn new(device: &Device, motion: &HandMotion, seed: u64) -> Result<Self, SimulatorError> {
        let rests = Rests::new(motion)?;
        let paths = device
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| Path::new(joint, index, motion, &rests, seed))
            .collect::<Result<Vec<Path>, SimulatorError>>()?;
        Ok(Self { rests, paths })
    }

    /// Where a joint (from 0) is at a time \[s\]: at home before the start and after the end.
    ///
    /// # Panics
    /// If the device has no such joint.
    pub fn joint_motion(&self, joint: usize, time_s: f64) -> JointMotion {
        let moving = self.rests.moving_time(time_s);
        let path = &self.paths[joint];
        let (segment, share) = path.place(moving.value_s);
        let (from, to) = (path.targets[segment], path.targets[segment + 1]);
        let u = share;
        let step = to - from;
        let value = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let slope = 30.0 * u * u * (1.0 - u) * (1.0 - u) / path.segment_s;
        let curve = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (path.segment_s * path.segment_s);
        JointMotion {
            // the clamp is for rounding at a target
            position: (from + step * value).clamp(from.min(to), from.max(to)),
            velocity: step * slope * moving.rate,
            acceleration: step
                * (curve * moving.rate * moving.rate + slope * moving.rate_change_per_s),
        }
    }

    /// Draws anew where every joint goes at a time, but for home at both ends.
    pub(crate) fn redraw(&mut self, time_s: f64) {
        let moving_s = self.rests.moving_time(time_s).value_s;
        for path in &mut self.paths {
            let (segment, _) = path.place(moving_s);
            let last = path.targets.len() - 1;
            for target in [segment, segment + 1] {
                if target != 0 && target != last {
                    path.targets[target] = draw(&mut path.generator, path.range);
                }
            }
        }
    }
}

impl Path {
    fn new(
        joint: &Joint,
        index: usize,
        motion: &HandMotion,
        rests: &Rests,
        seed: u64,
    ) -> Result<Self, SimulatorError> {
        let part = joint_part(joint, index);
        let (mut low, mut high) = limits(joint, &part, f64::is_finite)?;
        if let TransmissionError::Chebyshev { range_rad, .. } = &joint.transmission_error {
            (low, high) = (low.max(range_rad[0]), high.min(range_rad[1]));
        }
        (low, high) = (motion.range_share * low, motion.range_share * high);
        if !(low <= 0.0 && high >= 0.0 && low < high) {
            return Err(SimulatorError::NoRoom {
                part,
                low,
                high,
                attempts: 0,
            });
        }
        let (speed, acceleration) = match joint.joint_type {
            JointType::Revolute => (motion.speed_rad_per_s, motion.acceleration_rad_per_s2),
            JointType::Prismatic => (motion.speed_m_per_s, motion.acceleration_m_per_s2),
        };
        // what slowing down for a rest adds to the acceleration
        let own = acceleration - STEEPEST * speed / motion.ramp_s;
        let allowed = "above 1.5 speed / ramp_s, which slowing down for a rest takes";
        allow("acceleration", acceleration, own > 0.0, allowed)?;
        let width = high - low;
        let least_s =
            (STEEPEST_STEP * width / speed).max(libm::sqrt(MOST_CURVED_STEP * width / own));
        let room = libm::floor(rests.moving_s / least_s) as usize;
        let mut segments = room.max(2);
        if segments > 2 * DIFFERENT_COUNTS {
            segments -= index % DIFFERENT_COUNTS;
        }
        let segment_s = rests.moving_s / segments as f64;
        // a recording too short for the whole range has a part of it
        let part_of_range = (segment_s / least_s).min(1.0);
        let range = [low, high].map(|end| end * part_of_range * part_of_range);
        let mut generator = Stream::MotionTarget.open(index, seed);
        let targets = (0..=segments)
            .map(|target| match target {
                _ if target == 0 || target == segments => 0.0,
                _ if target % TARGETS_PER_END == 0 => range[(target / TARGETS_PER_END) % 2],
                _ => draw(&mut generator, range),
            })
            .collect();
        Ok(Self {
            targets,
            segment_s,
            range,
            generator,
        })
    }

    /// Segment at a moving time, and the share of it that is over.
    fn place(&self, moving_s: f64) -> (usize, f64) {
        let last = self.targets.len() - 2;
        let segments = moving_s / self.segment_s;
        let segment = (libm::floor(segments) as usize).min(last);
        (segment, (segments - segment as f64).clamp(0.0, 1.0))
    }
}

fn draw(generator: &mut ChaCha8Rng, range: [f64; 2]) -> f64 {
    let share = uniform(generator);
    ((1.0 - share) * range[0] + share * range[1]).clamp(range[0], range[1])
}
