//! What the arm is told to do: sums of harmonics, or moves from posture to posture.

use std::f64::consts::TAU;

use crate::moving::arms::Arm;
use crate::moving::motion::control::Asked;
use crate::moving::motion::rigid::At;
use crate::random::Random;

/// Time over which a sum of harmonics is eased in \[s\].
const EASE_S: f64 = 1.5;
/// Share of the range of a drive that the rigid bodies may need on the way.
const LOAD_SHARE: f64 = 0.7;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course {
    pub(crate) duration_s: f64,
    pub(crate) about: Vec<f64>,
    way: Way,
}

#[derive(Debug, Clone, PartialEq)]
enum Way {
    /// Per joint: frequency \[Hz\], amplitude, phase \[rad\].
    Harmonics(Vec<Vec<[f64; 3]>>),
    /// Postures from the one at the start, and the time of each move with its rest \[s\].
    Postures {
        stops: Vec<Vec<f64>>,
        every_s: f64,
        move_s: f64,
    },
}

impl Course {
    /// Harmonics of a base frequency. Source: Swevers et al., "Optimal robot excitation and identification", IEEE
    /// Transactions on Robotics and Automation 13, 1997.
    pub(crate) fn harmonics(arm: &Arm, duration_s: f64, random: &mut Random) -> Self {
        let base_hz = random.uniform(0.07, 0.13);
        let count = 5 + random.index(4);
        let about = posture(arm, 0.25, random);
        let tones = arm.axes.iter().zip(&about).map(|(axis, about)| {
            let mut tones: Vec<[f64; 3]> = (1..=count)
                .map(|order| {
                    let amplitude = random.uniform(0.4, 1.0) / libm::sqrt(order as f64);
                    [base_hz * order as f64, amplitude, random.phase_rad()]
                })
                .collect();
            // worst case of angle and speed within the limits
            let room = (axis.reach[1] - about).min(about - axis.reach[0]);
            let angle: f64 = tones.iter().map(|tone| tone[1]).sum();
            let speed: f64 = tones.iter().map(|tone| TAU * tone[0] * tone[1]).sum();
            let scale = (0.9 * room / angle).min(1.1 * axis.speed / speed);
            for tone in &mut tones {
                tone[1] *= scale;
            }
            tones
        });
        let way = Way::Harmonics(tones.collect());
        Self {
            duration_s,
            about,
            way,
        }
        .within_torques(arm)
    }

    /// Moves with rests between them, of the fifth order in time.
    pub(crate) fn postures(arm: &Arm, duration_s: f64, random: &mut Random) -> Self {
        let every_s = random.uniform(1.2, 1.8);
        let move_s = every_s * random.uniform(0.75, 0.92);
        let about = posture(arm, 0.2, random);
        let count = (duration_s / every_s) as usize + 1;
        let mut stops = vec![vec![0.0; arm.count()]];
        for _ in 0..count {
            let stop = arm.axes.iter().zip(&about).map(|(axis, about)| {
                let room = (axis.reach[1] - about).min(about - axis.reach[0]);
                // 15/8 is the top speed of a move of the fifth order
                let most = (0.8 * room).min(0.45 * axis.speed * move_s / 1.875);
                random.uniform(-most, most)
            });
            stops.push(stop.collect());
        }
        let way = Way::Postures {
            stops,
            every_s,
            move_s,
        };
        Self {
            duration_s,
            about,
            way,
        }
        .within_torques(arm)
    }

    pub(crate) fn at(&self, time_s: f64) -> Asked {
        let mut asked = Asked::default();
        match &self.way {
            Way::Harmonics(tones) => {
                let ease = quintic(time_s / EASE_S, EASE_S);
                for (tones, about) in tones.iter().zip(&self.about) {
                    let mut sum = [0.0; 3];
                    for [hz, amplitude, phase] in tones {
                        let pulse = TAU * hz;
                        let (sine, cosine) = libm::sincos(pulse * time_s + phase);
                        sum[0] += amplitude * sine;
                        sum[1] += amplitude * pulse * cosine;
                        sum[2] -= amplitude * pulse * pulse * sine;
                    }
                    asked.push([
                        about + ease[0] * sum[0],
                        ease[1] * sum[0] + ease[0] * sum[1],
                        ease[2] * sum[0] + 2.0 * ease[1] * sum[1] + ease[0] * sum[2],
                    ]);
                }
            }
            Way::Postures {
                stops,
                every_s,
                move_s,
            } => {
                let last = stops.len() - 2;
                let number = ((time_s / every_s) as usize).min(last);
                let ease = quintic((time_s - number as f64 * every_s) / move_s, *move_s);
                for (joint, about) in self.about.iter().enumerate() {
                    let (from, to) = (stops[number][joint], stops[number + 1][joint]);
                    let way = to - from;
                    asked.push([about + from + way * ease[0], way * ease[1], way * ease[2]]);
                }
            }
        }
        asked
    }

    /// Smaller, until the drives can follow.
    fn within_torques(mut self, arm: &Arm) -> Self {
        let chain = arm.chain();
        let mut at = At::default();
        for _ in 0..12 {
            let mut worst: f64 = 0.0;
            for step in 0..(10.0 * self.duration_s) as usize {
                let asked = self.at(0.1 * step as f64);
                chain.at(&asked.angle, &asked.rate, &mut at);
                let loads = loads(arm, &asked, &at);
                for (load, axis) in loads.iter().zip(arm.axes) {
                    worst = worst.max(load.abs() / axis.range);
                }
            }
            if worst <= LOAD_SHARE {
                break;
            }
            self.shrink(0.88);
        }
        self
    }

    fn shrink(&mut self, factor: f64) {
        match &mut self.way {
            Way::Harmonics(tones) => {
                for tone in tones.iter_mut().flatten() {
                    tone[1] *= factor;
                }
            }
            Way::Postures { stops, .. } => {
                for stop in stops.iter_mut().flatten() {
                    *stop *= factor;
                }
            }
        }
    }
}

impl Asked {
    fn push(&mut self, [angle, rate, acceleration]: [f64; 3]) {
        self.angle.push(angle);
        self.rate.push(rate);
        self.acceleration.push(acceleration);
    }
}

/// Torques that the nominal bodies and rotors need.
pub(crate) fn loads(arm: &Arm, asked: &Asked, at: &At) -> Vec<f64> {
    let axes = arm.axes.iter().enumerate();
    axes.map(|(joint, axis)| at.needed(joint, &asked.acceleration, axis.armature))
        .collect()
}

/// A posture near the middle of the limits.
fn posture(arm: &Arm, share: f64, random: &mut Random) -> Vec<f64> {
    let middle = arm.axes.iter().map(|axis| {
        let [low, high] = axis.reach;
        0.5 * (low + high) + share * 0.5 * (high - low) * random.uniform(-1.0, 1.0)
    });
    middle.collect()
}

/// Smooth step from 0 to 1 over `x` from 0 to 1 with its slopes in time, where x takes `over_s`.
fn quintic(x: f64, over_s: f64) -> [f64; 3] {
    if x >= 1.0 {
        return [1.0, 0.0, 0.0];
    }
    let x = x.max(0.0);
    [
        x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * x * x * (1.0 + x * (x - 2.0)) / over_s,
        60.0 * x * (1.0 + x * (2.0 * x - 3.0)) / (over_s * over_s),
    ]
}
