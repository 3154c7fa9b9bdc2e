//! Torques and forces that no catalogue lists: tones, bumps, walks, steps, products, switching offsets.

use std::f64::consts::TAU;

use crate::effects::forces::GRIP;
use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::rms;
use crate::rig::scene::Scene;

/// The names that are right.
const UNKNOWN: [&str; 1] = ["unknown"];
/// Strong sizes: a joint's friction is 0.06 N m, a sensor's bias 0.3 N.
const STRONG_NM: f64 = 0.15;
const STRONG_N: f64 = 0.6;

/// Course of a foreign torque or force; the size is its height, of walks and products its root mean square.
#[derive(Debug, Clone, Copy)]
enum Course {
    /// A tone of a rate that the device does not have.
    Tone { rate_hz: f64, phase_rad: f64 },
    /// A bump over the joint's angle.
    Bump {
        joint: usize,
        centre: f64,
        width_rad: f64,
    },
    /// A random walk.
    Walk { tag: u64 },
    /// A step that stays.
    Step { tag: u64 },
    /// Product of the angles of two joints.
    Product { first: usize, second: usize },
    /// An offset that comes and goes.
    Switching { tag: u64 },
}

impl Course {
    fn values(self, scene: &Scene<'_>) -> Vec<f64> {
        let rows = scene.len();
        let angle = |joint: usize| &scene.motion.angle_rad[joint];
        let end_s = scene.elapsed_s(rows);
        match self {
            Self::Tone { rate_hz, phase_rad } => (0..rows)
                .map(|row| libm::sin(TAU * rate_hz * scene.elapsed_s(row) + phase_rad))
                .collect(),
            Self::Bump {
                joint,
                centre,
                width_rad,
            } => {
                let angle = angle(joint);
                let low = angle.iter().copied().fold(f64::INFINITY, f64::min);
                let high = angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let middle = low + centre * (high - low);
                let away = angle.iter().map(|angle| (angle - middle) / width_rad);
                away.map(|x| libm::exp(-0.5 * x * x)).collect()
            }
            Self::Walk { tag } => {
                let mut random = scene.events(tag);
                let mut sum = 0.0;
                let walk: Vec<f64> = (0..rows)
                    .map(|_| {
                        sum += random.normal();
                        sum
                    })
                    .collect();
                unit(walk)
            }
            Self::Step { tag } => {
                let start_s = end_s * scene.events(tag).uniform(0.3, 0.7);
                let is_on = |row: usize| scene.elapsed_s(row) >= start_s;
                (0..rows)
                    .map(|row| f64::from(u8::from(is_on(row))))
                    .collect()
            }
            Self::Product { first, second } => {
                let pairs = angle(first).iter().zip(angle(second));
                unit(pairs.map(|(a, b)| a * b).collect())
            }
            Self::Switching { tag } => {
                let mut random = scene.events(tag);
                let (rate_hz, phase_rad) = (random.uniform(0.05, 0.15), random.phase_rad());
                let wave = |row: usize| libm::sin(TAU * rate_hz * scene.elapsed_s(row) + phase_rad);
                let on = |row: usize| f64::from(u8::from(wave(row) > 0.4));
                (0..rows).map(on).collect()
            }
        }
    }
}

/// Scaled to a root mean square of 1.
fn unit(mut values: Vec<f64>) -> Vec<f64> {
    let scale = 1.0 / rms(&values).max(f64::MIN_POSITIVE);
    values.iter_mut().for_each(|value| *value *= scale);
    values
}

/// Where a foreign course is read.
#[derive(Debug, Clone, Copy)]
enum Channel {
    Torque(usize),
    Force(usize),
}

#[derive(Debug)]
struct Foreign {
    info: Info,
    channel: Channel,
    course: Course,
    size: f64,
}

impl Effect for Foreign {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let facts = Facts::default().law("size", self.size);
        match self.course {
            Course::Tone { rate_hz, .. } => facts.law("rate_hz", rate_hz),
            Course::Bump { width_rad, .. } => facts.law("width_rad", width_rad),
            _ => facts,
        }
    }

    fn torque(&self, scene: &Scene<'_>, torque_nm: &mut [Vec<f64>]) {
        if let Channel::Torque(joint) = self.channel {
            add(&mut torque_nm[joint], self.size, &self.course.values(scene));
        }
    }

    fn force(&self, scene: &Scene<'_>, force_n: &mut [Vec<f64>; 3]) {
        if let Channel::Force(axis) = self.channel {
            add(&mut force_n[axis], self.size, &self.course.values(scene));
        }
    }
}

fn add(readings: &mut [f64], size: f64, course: &[f64]) {
    for (reading, value) in readings.iter_mut().zip(course) {
        *reading += size * value;
    }
}

fn of_torque(draw: &mut Draw<'_>, name: &'static str, course: Course) -> Box<dyn Effect> {
    let theta = |joint: usize| format!("theta{}", joint + 1);
    let depends_on = match course {
        Course::Bump { joint, .. } => vec![theta(joint)],
        Course::Product { first, second } => vec![theta(first), theta(second)],
        _ => vec!["t_s".to_owned()],
    };
    Box::new(Foreign {
        info: Info {
            depends_on,
            ..draw.at_joint(name, &UNKNOWN)
        },
        channel: Channel::Torque(draw.joint),
        course,
        size: draw.signed(STRONG_NM),
    })
}

/// A tone on a torque.
pub(crate) fn torque_tone(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Tone {
        rate_hz: draw.random.uniform(0.3, 2.0),
        phase_rad: draw.random.phase_rad(),
    };
    of_torque(draw, "torque-tone", course)
}

/// A bump of a torque at one place of the joint's range.
pub(crate) fn torque_bump(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Bump {
        joint: draw.joint,
        centre: draw.random.uniform(0.3, 0.7),
        width_rad: draw.random.uniform(0.05, 0.15),
    };
    of_torque(draw, "torque-bump", course)
}

/// A walk of a torque's zero.
pub(crate) fn torque_walk(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Walk { tag: draw.tag };
    of_torque(draw, "torque-walk", course)
}

/// A step of a torque's zero.
pub(crate) fn torque_step(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Step { tag: draw.tag };
    of_torque(draw, "torque-step", course)
}

/// A torque that follows the product of two angles.
pub(crate) fn torque_product(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Product {
        first: draw.joint,
        second: (draw.joint + 1) % draw.device.joints.len(),
    };
    of_torque(draw, "torque-product", course)
}

/// An offset of the force sensor that comes and goes.
pub(crate) fn force_switching(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let course = Course::Switching { tag: draw.tag };
    Box::new(Foreign {
        info: Info {
            depends_on: vec!["t_s".to_owned()],
            // the same equation: a force that does not pass the sensor
            acceptable: vec![GRIP],
            ..draw.anywhere("force-switching", &UNKNOWN)
        },
        channel: Channel::Force(draw.random.index(3)),
        course,
        size: draw.signed(STRONG_N),
    })
}
