//! Pieces of motion about the postures of a device.

use std::f64::consts::PI;

use haptical_model::Device;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Motion, Motions};
use crate::posture::candidates::{Draws, range};
use crate::{DesignError, Limits, candidates};

/// Duration of a piece \[s\].
const PIECE_S: f64 = 3.0;
/// No joint moves faster than through its range in this time \[s\].
const RANGE_S: f64 = 1.0;
/// Share of a joint's range at either end that a way through all of it leaves out.
const END: f64 = 0.02;
/// Share of a joint's range by which a single posture is come to from one side and the other.
const SIDE: f64 = 0.06;
/// Rows between those that are checked against the limits.
const CHECKED_EVERY: usize = 10;

/// Draws pieces of motion: one joint, some through all of its range, or all of them to and fro about a posture within the limits,
/// slowly or fast, with nothing that presses or with a constant force along an axis of the handle. Each starts and ends at rest in the same posture, so that
/// it comes to every place from both sides. Of single postures a piece is a posture that is come to from both sides of a joint.
///
/// ```
/// use haptical_design::{Limits, Motions, pieces};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let motions = Motions { rate_hz: Some(100.0), count: 8, seed: 1, press_n: Some(2.0) };
/// let pieces = pieces(&device, &Limits::default(), &motions)?;
/// assert_eq!((pieces.len(), pieces[0].len()), (8, 301));
/// assert!(pieces.iter().flat_map(|piece| &piece.joint).all(|own| (own[0] - own[300]).abs() < 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`candidates`].
pub fn pieces(
    device: &Device,
    limits: &Limits,
    motions: &Motions,
) -> Result<Vec<Motion>, DesignError> {
    // every second one is where joints go to that move together
    let postures = candidates(device, limits, 4 * motions.count, motions.seed)?;
    let joints = device.joints.iter().zip(1..);
    let ranges: Vec<[f64; 2]> = joints
        .map(|(joint, number)| range(joint, number))
        .collect::<Result<_, _>>()?;
    let mut random = ChaCha8Rng::seed_from_u64(motions.seed);
    let mut draws = Draws::new(device, limits, motions.seed)?;
    let mut found = Vec::with_capacity(motions.count);
    for pair in postures.chunks_exact(2) {
        let [from, towards] = pair else { continue };
        let piece = Draft {
            device,
            ranges: &ranges,
            motions,
            number: found.len(),
            random: &mut random,
        }
        .piece(from, towards);
        let rows = (0..piece.len()).step_by(CHECKED_EVERY);
        let is_reached = rows.into_iter().all(|row| {
            let readings: Vec<f64> = piece.joint.iter().map(|own| own[row]).collect();
            draws.is_within(&readings) && draws.admits(&readings)
        });
        if is_reached && found.len() < motions.count {
            found.push(piece);
        }
    }
    Ok(found)
}

/// One piece before it is drawn.
struct Draft<'d> {
    device: &'d Device,
    ranges: &'d [[f64; 2]],
    motions: &'d Motions,
    number: usize,
    random: &'d mut ChaCha8Rng,
}

/// How a joint moves: to a reading and back, so many times.
#[derive(Clone, Copy)]
struct Swing {
    joint: usize,
    way: f64,
    times: usize,
}

impl Draft<'_> {
    fn piece(mut self, from: &[f64], towards: &[f64]) -> Motion {
        match self.motions.rate_hz {
            Some(rate_hz) => self.moving(from, towards, rate_hz),
            None => self.posture(from),
        }
    }

    /// A posture from both sides of one joint.
    fn posture(&self, at: &[f64]) -> Motion {
        let joint = self.number % at.len().max(1);
        let [lower, upper] = self.ranges[joint];
        let side = SIDE * (upper - lower);
        let reading = at[joint].clamp(lower + side, upper - side);
        let column = |own: usize| match own == joint {
            true => vec![reading - side, reading, reading + side, reading],
            false => vec![at[own]; 4],
        };
        Motion {
            joint: (0..at.len()).map(column).collect(),
            words: format!(
                "joint {} to {reading:.3} {} from below and from above",
                joint + 1,
                self.unit(joint)
            ),
            ..Motion::default()
        }
    }

    fn moving(&mut self, from: &[f64], towards: &[f64], rate_hz: f64) -> Motion {
        let joints = from.len();
        let is_fast = (self.number / 2) % 2 == 1;
        let is_single = self.number.is_multiple_of(2);
        let mut from = from.to_vec();
        let swings: Vec<Swing> = if is_single {
            let joint = (self.number / 4) % joints.max(1);
            let times = if is_fast { 4 } else { 1 };
            // what bends with the angle over all of its range looks straight over a part of it
            match !is_fast && self.random.random_bool(0.5) {
                true => {
                    let [lower, upper] = self.ranges[joint];
                    from[joint] = lower + END * (upper - lower);
                    vec![Swing {
                        joint,
                        way: self.slow_enough(joint, (1.0 - 2.0 * END) * (upper - lower), times),
                        times,
                    }]
                }
                false => vec![self.swing(joint, from[joint], towards[joint], times)],
            }
        } else {
            let all = 0..joints;
            all.map(|joint| {
                let times = self
                    .random
                    .random_range(if is_fast { 2..=4 } else { 1..=2 });
                self.swing(joint, from[joint], towards[joint], times)
            })
            .collect()
        };
        let rows = (PIECE_S * rate_hz).round() as usize + 1;
        let mut joint: Vec<Vec<f64>> = from.iter().map(|reading| vec![*reading; rows]).collect();
        for swing in &swings {
            for (row, reading) in joint[swing.joint].iter_mut().enumerate() {
                let phase = 2.0 * PI * swing.times as f64 * row as f64 / (rows - 1) as f64;
                *reading += 0.5 * swing.way * (1.0 - libm::cos(phase));
            }
        }
        let press = self.press();
        let force_n = press.map(|(axis, newtons)| {
            let mut force = [(); 3].map(|()| vec![0.0; rows]);
            force[axis].fill(newtons);
            force
        });
        let pressing = press.map_or_else(String::new, |(axis, newtons)| {
            format!(
                ", pressing {newtons:+} N along {} of the handle",
                ["x", "y", "z"][axis]
            )
        });
        let motion = match swings.as_slice() {
            [only] if is_single => format!(
                "joint {} by {:+.3} {} and back, {} in {PIECE_S} s",
                only.joint + 1,
                only.way,
                self.unit(only.joint),
                if only.times == 1 {
                    "once".to_owned()
                } else {
                    format!("{} times", only.times)
                }
            ),
            _ => format!(
                "all joints to and fro, {}",
                if is_fast { "fast" } else { "slowly" }
            ),
        };
        Motion {
            joint,
            time_s: Some((0..rows).map(|row| row as f64 / rate_hz).collect()),
            force_n,
            words: motion + &pressing,
        }
    }

    /// Between a third and all of the way towards another reading, no faster than the joint's range allows.
    fn swing(&mut self, joint: usize, from: f64, towards: f64, times: usize) -> Swing {
        let share = 0.33 + 0.67 * self.random.random::<f64>();
        Swing {
            joint,
            way: self.slow_enough(joint, share * (towards - from), times),
            times,
        }
    }

    /// As much of a way as the joint may go so many times.
    fn slow_enough(&self, joint: usize, way: f64, times: usize) -> f64 {
        let [lower, upper] = self.ranges[joint];
        // the cosine is fastest halfway: pi/2 times its mean speed
        let most = (upper - lower) / RANGE_S * PIECE_S / (PI * times as f64);
        way.clamp(-most, most)
    }

    /// Axis and size of a force; none in every third piece.
    fn press(&mut self) -> Option<(usize, f64)> {
        let newtons = self.motions.press_n?;
        let drawn: usize = self.random.random_range(0..9);
        let sign = if drawn.is_multiple_of(2) { 1.0 } else { -1.0 };
        (drawn < 6).then_some((drawn % 3, sign * newtons))
    }

    fn unit(&self, joint: usize) -> &'static str {
        self.device.joints[joint].unit()
    }
}
