//! The drives' torques of a recording: blocks of rows, the torque that is not the hand's,
//! the noise of both, or why nothing can be said.

use std::ops::Range;

use haptical_effects::signal::LocalMotion;
use haptical_effects::{Context, Signal, Stream};
use haptical_model::{Recording, RigidBodies, varies};
use haptical_motion::{MotionError, torque_nm_without_effects};
use nalgebra::{DMatrix, Vector3};

use super::rows::harmonics::{harmonics, without_harmonics};

use crate::noise::{self, Known, NoiseSource};
use crate::thresholds::torque::{
    BLOCK_S, CONSTANT_FORCE, LONGEST_BLOCK_ROWS, MODEL_SD, READINGS_PER_PARAMETER, SLOWEST_S,
    UNKNOWN_FORCE_SD_N, UNKNOWN_TORQUE_SD_NM, WINDOW_BLOCKS,
};

/// The recorded force of a hand, row by row \[N\]: one of zero throughout is that of no hand, and tests no sensor.
fn hand_force(recording: &Recording) -> Option<Vec<Vector3<f64>>> {
    let axes = recording.force_n.as_ref()?;
    let at = |row: usize| Vector3::new(axes[0][row], axes[1][row], axes[2][row]);
    let is_zero = axes.iter().flatten().all(|force| *force == 0.0);
    (!is_zero).then(|| (0..recording.len()).map(at).collect())
}

/// Joints whose torque was measured, or why there is none.
fn measured(context: &Context<'_>) -> Result<Vec<usize>, String> {
    let torques = (0..context.device.joints.len())
        .filter_map(|joint| Some((joint, context.recorded_torque_nm(joint)?)));
    let torques: Vec<(usize, &[f64])> = torques.collect();
    if torques.is_empty() {
        return Err("no column torque1_nm, torque2_nm, ...".to_owned());
    }
    let measured = torques.into_iter().filter(|(_, values)| varies(values));
    let measured: Vec<usize> = measured.map(|(joint, _)| joint).collect();
    match measured.is_empty() {
        true => Err(MotionError::Constant.to_string()),
        false => Ok(measured),
    }
}

/// Whether a hand that nobody measures may hold the handle: where one may, it also moves the handle against a gauge, which is a cable, a
/// tracker or a touched place.
pub(super) fn may_be_held(context: &Context<'_>) -> bool {
    context.recording.force_n.is_none() && context.streams.iter().any(Stream::shows_handle)
}

/// What may act on the chain in addition to what was recorded, changing as it likes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Besides {
    Nothing,
    /// A force at the handle of this standard deviation \[N\].
    Hand(f64),
    /// A torque on one channel.
    Channel(usize),
}

/// Successive rows that are averaged.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) rows: Range<usize>,
    /// Those with a reading of every torque and force.
    pub(super) usable: Vec<usize>,
    /// The block before it in the list is the one before it in time.
    pub(super) follows: bool,
}

/// Torques of a recording in blocks.
#[derive(Debug)]
pub(super) struct Recorded<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) motion: Vec<LocalMotion>,
    /// Joints whose torque is recorded.
    pub(super) channels: Vec<usize>,
    pub(super) blocks: Vec<Block>,
    /// The arm's links, with plausible numbers where the file has none; gravity is the file's.
    pub(super) bodies: RigidBodies,
    /// Time of a row \[s\].
    pub(super) step_s: f64,
    /// Force of the hand in the handle's frame, row by row; none where it is not recorded.
    pub(super) force_n: Option<Vec<Vector3<f64>>>,
    /// Whether a hand that nobody measures may hold the handle.
    is_held: bool,
    /// Per channel and row: torque of the drive plus that of the hand.
    pub(super) torque_nm: Vec<Vec<f64>>,
    /// Cosines and sines of multiples of each channel's motor angle.
    pub(super) harmonics: Vec<Vec<Vec<f64>>>,
    /// Standard deviation of a row's torque reading per channel, and what its colour adds to a
    /// mean.
    pub(super) torque_sd: Vec<f64>,
    torque_inflation: Vec<f64>,
    force_sd: [f64; 3],
    force_inflation: [f64; 3],
}

impl<'a> Recorded<'a> {
    /// Gathers the channels, or says what is missing.
    pub(super) fn new(context: &'a Context<'a>) -> Result<Self, String> {
        Self::gathered(context, may_be_held(context))
    }

    /// The same where nobody holds the handle.
    pub(super) fn held_by_nobody(context: &'a Context<'a>) -> Result<Self, String> {
        Self::gathered(context, false)
    }

    fn gathered(context: &'a Context<'a>, is_held: bool) -> Result<Self, String> {
        let device = context.device;
        let recording = context.recording;
        needed(context)?;
        let step_s = context.step_s();
        let joints = 0..device.joints.len();
        let motion: Option<Vec<LocalMotion>> =
            joints.map(|joint| context.drive_motion(joint)).collect();
        let motion = motion.ok_or_else(|| "no column t_s".to_owned())?;
        let channels = measured(context)?;
        if device.gravity_mps2.is_none() {
            return Err("no [gravity] in the device file".to_owned());
        }
        let bodies = RigidBodies::plausible(device).map_err(|error| error.to_string())?;
        let force_n = hand_force(recording);
        if is_held && channels.len() < 5 {
            return Err(
                "no columns fx_n, fy_n, fz_n, and too few torques to do without".to_owned(),
            );
        }
        let mut torque_nm = Vec::new();
        for &joint in &channels {
            let own = torque_nm_without_effects(device, recording, joint).unwrap_or_default();
            torque_nm.push(
                (0..context.rows())
                    .map(|row| {
                        let hand = force_n
                            .as_ref()
                            .map_or(0.0, |force| context.arm(joint, row).dot(&force[row]));
                        own[row] + hand
                    })
                    .collect::<Vec<f64>>(),
            );
        }
        let blocks = blocks(context, &torque_nm, step_s);
        let parameters = 10 * device.joints.len();
        if blocks.len() * channels.len() < READINGS_PER_PARAMETER * parameters {
            let rows =
                (READINGS_PER_PARAMETER * parameters).div_ceil(channels.len()) as f64 * BLOCK_S;
            return Err(format!(
                "too little motion with torques: record at least {rows:.0} s of it"
            ));
        }
        let size = blocks.iter().map(|block| block.usable.len()).sum::<usize>() as f64
            / blocks.len().max(1) as f64;
        let harmonics: Vec<Vec<Vec<f64>>> = channels
            .iter()
            .map(|&joint| {
                let ratio = device.joints[joint].transmission_ratio;
                harmonics(&motion[joint].value, ratio)
            })
            .collect();
        let of_torque: Option<Vec<(f64, f64)>> = channels
            .iter()
            .zip(&harmonics)
            .map(|(&joint, harmonics)| {
                let values = context.recorded_torque_nm(joint)?;
                let (mut sd, mut inflation) = noise_of(context, values, size)?;
                if inflation > 1.0 {
                    let rest = without_harmonics(values, harmonics);
                    (sd, inflation) = noise_of(context, &rest, size)?;
                }
                let usable = values.iter().filter(|value| value.is_finite());
                let square = usable.clone().map(|value| value * value).sum::<f64>();
                let rms = (square / usable.count().max(1) as f64).sqrt();
                Some((sd.hypot(MODEL_SD * rms), inflation))
            })
            .collect();
        let unknown_n = if is_held { UNKNOWN_FORCE_SD_N } else { 0.0 };
        let mut of_force = [(unknown_n, size); 3];
        if let Some(axes) = &recording.force_n {
            for (noise, values) in of_force.iter_mut().zip(axes) {
                *noise = noise_of(context, values, size).unwrap_or(*noise);
            }
        }
        let of_torque = of_torque.ok_or_else(|| "too few rows in a run".to_owned())?;
        Ok(Self {
            context,
            motion,
            channels,
            blocks,
            bodies,
            step_s,
            force_n,
            is_held,
            torque_nm,
            harmonics,
            torque_sd: of_torque.iter().map(|noise| noise.0).collect(),
            torque_inflation: of_torque.iter().map(|noise| noise.1).collect(),
            force_sd: of_force.map(|noise| noise.0),
            force_inflation: of_force.map(|noise| noise.1),
        })
    }

    /// Readings of all channels in blocks.
    pub(super) fn len(&self) -> usize {
        self.channels.len() * self.blocks.len()
    }

    /// Means over blocks of a value per row.
    pub(super) fn means(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        self.blocks
            .iter()
            .map(|block| {
                let sum: f64 = block.usable.iter().map(|&row| value(row)).sum();
                sum / block.usable.len() as f64
            })
            .collect()
    }

    /// Channel of a joint's torque.
    pub(super) fn channel(&self, joint: usize) -> Option<usize> {
        self.channels.iter().position(|&own| own == joint)
    }

    /// Means over blocks of what an effect adds, channel after channel.
    pub(super) fn signal_means(&self, signal: &Signal) -> Vec<f64> {
        let means = |&joint: &usize| {
            let stream = self.context.torque_stream(joint);
            match stream.and_then(|stream| signal.on(stream)) {
                Some(values) => self.means(|row| values[row]),
                None => vec![0.0; self.blocks.len()],
            }
        };
        self.channels.iter().flat_map(means).collect()
    }

    /// Whether a hand of unknown force may hold the handle. Where nothing but joints and torques is recorded nobody does: the
    /// arm moves by itself.
    pub(super) fn hand_is_unknown(&self) -> bool {
        self.is_held
    }

    /// Directions of each window of torques that a free force of the hand can take.
    pub(super) fn free_directions(&self) -> usize {
        if self.is_held { 3 } else { 0 }
    }

    /// Whether nobody is taken to hold the handle.
    pub(super) fn moves_by_itself(&self) -> bool {
        self.force_n.is_none() && !self.is_held
    }

    /// Variance of a block's mean torque by noise alone \[(N m)^2\], ((N)^2 where the joint slides).
    pub(super) fn block_variance(&self, channel: usize) -> f64 {
        let rows: usize = self.blocks.iter().map(|block| block.usable.len()).sum();
        let rows = rows as f64 / self.blocks.len().max(1) as f64;
        self.torque_sd[channel].powi(2) * self.torque_inflation[channel] / rows.max(1.0)
    }

    /// Name of a joint's torque column in a log.
    pub(super) fn column(&self, joint: usize) -> String {
        self.context.device.joints[joint].torque_column(joint + 1)
    }

    /// Unit of a channel's torque: N where its joint slides.
    pub(super) fn unit(&self, channel: usize) -> &'static str {
        self.context.device.joints[self.channels[channel]].torque_unit()
    }

    /// Whether a force of the hand is recorded that is not constant.
    pub(super) fn force_varies(&self) -> bool {
        let forces = self.force_n.iter().flatten();
        let known = || {
            forces
                .clone()
                .filter(|force| force.iter().all(|n| n.is_finite()))
        };
        let count = known().count().max(1) as f64;
        let mean = known().sum::<Vector3<f64>>() / count;
        let spread: f64 = known().map(|force| (force - mean).norm_squared()).sum();
        let square: f64 = known().map(Vector3::norm_squared).sum();
        spread > CONSTANT_FORCE * square
    }

    /// Windows of blocks that follow each other.
    pub(super) fn windows(&self) -> Vec<Range<usize>> {
        let mut windows = Vec::new();
        let mut start = 0;
        for block in 0..self.blocks.len() {
            let next = block + 1;
            let breaks = self.blocks.get(next).is_none_or(|next| !next.follows);
            if breaks || next - start == WINDOW_BLOCKS {
                windows.push(start..next);
                start = next;
            }
        }
        windows
    }

    /// Covariance of a block's mean torques, its transposed Jacobian (channel by axis of the
    /// handle's frame) given, and what may act besides.
    pub(super) fn covariance(
        &self,
        block: usize,
        jacobian: &[Vector3<f64>],
        besides: Besides,
    ) -> DMatrix<f64> {
        let (unknown_n, unknown) = match besides {
            Besides::Nothing => (0.0, None),
            Besides::Hand(sd_n) => (sd_n, None),
            Besides::Channel(channel) => (0.0, Some(channel)),
        };
        let rows = self.blocks[block].usable.len() as f64;
        let force: [f64; 3] = std::array::from_fn(|axis| {
            self.force_sd[axis].powi(2) * self.force_inflation[axis] / rows + unknown_n * unknown_n
        });
        let count = self.channels.len();
        DMatrix::from_fn(count, count, |a, b| {
            let hand: f64 = (0..3)
                .map(|k| jacobian[a][k] * force[k] * jacobian[b][k])
                .sum();
            if a == b {
                let free = if unknown == Some(a) {
                    UNKNOWN_TORQUE_SD_NM
                } else {
                    0.0
                };
                hand + self.torque_sd[a].powi(2) * self.torque_inflation[a] / rows + free * free
            } else {
                hand
            }
        })
    }

    /// Standard deviation of a row of a channel: its torque's noise and the hand force's.
    pub(super) fn row_sd(&self, channel: usize, jacobian: &[Vec<Vector3<f64>>]) -> f64 {
        let mut hand = 0.0;
        if self.force_n.is_some() {
            for arms in jacobian {
                let arm = &arms[channel];
                hand += (0..3)
                    .map(|k| (arm[k] * self.force_sd[k]).powi(2))
                    .sum::<f64>();
            }
            hand /= jacobian.len().max(1) as f64;
        }
        (self.torque_sd[channel].powi(2) + hand).sqrt()
    }
}

/// Standard deviation of a column's noise, and what its colour adds to the variance of a mean of
/// `size` rows; none where no rows follow each other.
fn noise_of(context: &Context<'_>, values: &[f64], size: f64) -> Option<(f64, f64)> {
    let known = Known {
        runs: &context.runs,
        ordered: true,
        repeats: None,
        are_of_one_side: false,
        lost: 0.0,
        stated: false,
        rounding: 0.0,
    };
    let noise = noise::estimate(values, &known);
    let colour = 1.0 + noise.coloured_share * (inflation(noise.colour, size) - 1.0);
    (noise.source == NoiseSource::Motion).then_some((noise.ratio, colour))
}

/// What nothing can be said without.
fn needed(context: &Context<'_>) -> Result<(), String> {
    let device = context.device;
    if device.has_hands() {
        return Err(
            "the device has several hands; torques of a moving arm are worked out for one chain"
                .to_owned(),
        );
    }
    if !device.has_links() || !device.drives_are_plain() || context.twist.is_empty() {
        return Err("the device file has no [[link]]".to_owned());
    }
    if !context.ordered {
        return Err("the rows are single postures, not a motion".to_owned());
    }
    match &context.motion {
        None => Err("no column t_s".to_owned()),
        Some(_) if context.step_s() > SLOWEST_S => Err(format!(
            "a row comes {:.3} s after the one before it, which is too slow for speeds: is t_s in milliseconds, and not in seconds?",
            context.step_s()
        )),
        Some(_) => Ok(()),
    }
}

fn blocks(context: &Context<'_>, torque_nm: &[Vec<f64>], step_s: f64) -> Vec<Block> {
    let size = ((BLOCK_S / step_s).round() as usize).clamp(1, LONGEST_BLOCK_ROWS);
    let usable = |row: usize| torque_nm.iter().all(|values| values[row].is_finite());
    let mut blocks = Vec::new();
    for run in &context.runs {
        let mut start = run.start;
        let mut follows = false;
        while start + size <= run.end {
            let rows = start..start + size;
            let usable: Vec<usize> = rows.clone().filter(|&row| usable(row)).collect();
            let enough = 2 * usable.len() >= size;
            if enough {
                blocks.push(Block {
                    rows,
                    usable,
                    follows,
                });
            }
            follows = enough;
            start += size;
        }
    }
    blocks
}

/// Variance of a mean of `size` successive rows of a first-order autoregression, over that of white
/// noise.
fn inflation(colour: f64, size: f64) -> f64 {
    let mut sum = 1.0;
    let mut power = 1.0;
    for lag in 1..(size.round() as usize).max(1) {
        power *= colour;
        sum += 2.0 * (1.0 - lag as f64 / size) * power;
    }
    sum.max(0.05)
}
