//! The drives' torques of a recording: blocks of rows, the torque that is not the hand's,
//! the noise of both, or why nothing can be said.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::signal::LocalMotion;
use haptical_effects::{Context, Signal, Stream};
use haptical_model::{RigidBodies, varies};
use haptical_motion::{MotionError, torque_nm_without_effects};
use nalgebra::{DMatrix, Matrix3, MatrixXx3, Vector3};

use super::Means;
use super::harmonics::{harmonics, without_harmonics};
use crate::noise;
use crate::noise::{Known, NoiseSource};
use crate::thresholds::torque::{
    BLOCK_S, CONSTANT_FORCE, LONGEST_BLOCK_ROWS, MILLISECONDS_S, MODEL_SD, POSITION_GAP,
    READINGS_PER_PARAMETER, UNKNOWN_FORCE_SD_N, UNKNOWN_TORQUE_SD_NM, WINDOW_BLOCKS,
};

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

impl Block {
    /// Its first and second half. A block of a single row has that row in both.
    fn halves(&self) -> [Range<usize>; 2] {
        let Range { start, end } = self.rows;
        let middle = start + self.rows.len() / 2;
        [start..middle.max(start + 1), middle..end]
    }
}

/// Noise of a column's rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowNoise {
    pub(super) sd: f64,
    /// Factor by which its colour raises the variance of a mean over a block.
    inflation: f64,
}

impl RowNoise {
    /// Noise of readings; none where no rows follow each other. `size` is the number of rows of a block.
    fn of(context: &Context<'_>, values: &[f64], size: f64) -> Option<Self> {
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
        (noise.source == NoiseSource::Motion).then_some(Self {
            sd: noise.ratio,
            inflation: 1.0 + noise.coloured_share * (inflation(noise.colour, size) - 1.0),
        })
    }

    /// Variance of a mean over that many rows.
    fn of_mean(self, rows: f64) -> f64 {
        self.sd.powi(2) * self.inflation / rows
    }
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
    /// Force of the hand in the handle's frame, row by row; none where it is not recorded.
    pub(super) force_n: Option<Vec<Vector3<f64>>>,
    /// Whether a hand of unknown force may hold the handle. Where only joints and torques are recorded, the arm moves
    /// by itself.
    pub(super) is_held: bool,
    /// Per channel and row: torque of the drive plus that of the hand.
    pub(super) torque_nm: Vec<Vec<f64>>,
    /// Cosines and sines of multiples of each channel's motor angle.
    pub(super) harmonics: Vec<Vec<Vec<f64>>>,
    /// Noise of each channel's torque, and of the force along each axis.
    pub(super) noise: Vec<RowNoise>,
    pub(super) force_noise: [RowNoise; 3],
}

impl<'a> Recorded<'a> {
    /// Gathers the channels, or says what is missing. `is_held` says whether a hand of unknown force may hold the
    /// handle.
    pub(super) fn new(context: &'a Context<'a>, is_held: bool) -> Result<Self, String> {
        let (device, recording) = (context.device, context.recording);
        needed(context)?;
        let joints = 0..device.joints.len();
        let motion = joints.map(|joint| context.drive_motion(joint));
        let motion: Option<Vec<LocalMotion>> = motion.collect();
        let motion = motion.ok_or("no column t_s")?;
        let channels = measured(context)?;
        if device.gravity_mps2.is_none() {
            return Err("no [gravity] in the device file".to_owned());
        }
        let bodies = RigidBodies::plausible(device).map_err(|error| error.to_string())?;
        // a force that is zero throughout is no hand's, and tests no sensor
        let axes = recording.force_n.as_ref();
        let axes = axes.filter(|axes| axes.iter().flatten().any(|force| *force != 0.0));
        let at = |row: usize| axes.map(|axes| Vector3::from(axes.each_ref().map(|axis| axis[row])));
        let force_n: Option<Vec<Vector3<f64>>> = (0..context.rows()).map(at).collect();
        if is_held && channels.len() < 5 {
            return Err(
                "no columns fx_n, fy_n, fz_n, and too few torques to do without".to_owned(),
            );
        }
        let torque_of = |&joint: &usize| -> Vec<f64> {
            let mut torque_nm =
                torque_nm_without_effects(device, recording, joint).unwrap_or_default();
            for (row, force) in force_n.iter().flatten().enumerate() {
                torque_nm[row] += context.arm(joint, row).dot(force);
            }
            torque_nm
        };
        let torque_nm: Vec<Vec<f64>> = channels.iter().map(torque_of).collect();
        let blocks = blocks(context, &torque_nm);
        let enough = READINGS_PER_PARAMETER * 10 * device.joints.len();
        if blocks.len() * channels.len() < enough {
            let long_s = enough.div_ceil(channels.len()) as f64 * BLOCK_S;
            return Err(format!(
                "too little motion with torques: record at least {long_s:.0} s of it"
            ));
        }
        let harmonics_of = |&joint: &usize| {
            let ratio = device.joints[joint].transmission_ratio;
            harmonics(&motion[joint].value, ratio)
        };
        let harmonics: Vec<Vec<Vec<f64>>> = channels.iter().map(harmonics_of).collect();
        let size = mean_rows(&blocks);
        let noise_of = |(&joint, harmonics): (&usize, &Vec<Vec<f64>>)| {
            let values = context.recorded_torque_nm(joint)?;
            let mut noise = RowNoise::of(context, values, size)?;
            if noise.inflation > 1.0 {
                noise = RowNoise::of(context, &without_harmonics(values, harmonics), size)?;
            }
            let usable = values.iter().filter(|value| value.is_finite());
            let square = usable.clone().map(|value| value * value).sum::<f64>();
            let rms = (square / usable.count().max(1) as f64).sqrt();
            noise.sd = noise.sd.hypot(MODEL_SD * rms);
            Some(noise)
        };
        let noise: Option<Vec<RowNoise>> = channels.iter().zip(&harmonics).map(noise_of).collect();
        let unknown = RowNoise {
            sd: UNKNOWN_FORCE_SD_N * f64::from(u8::from(is_held)),
            inflation: size,
        };
        let mut force_noise = [unknown; 3];
        for (noise, values) in force_noise
            .iter_mut()
            .zip(recording.force_n.iter().flatten())
        {
            *noise = RowNoise::of(context, values, size).unwrap_or(unknown);
        }
        Ok(Self {
            noise: noise.ok_or("too few rows in a run")?,
            context,
            motion,
            channels,
            blocks,
            bodies,
            force_n,
            is_held,
            torque_nm,
            harmonics,
            force_noise,
        })
    }

    /// Number of blocks and of channels.
    pub(super) fn shape(&self) -> (usize, usize) {
        (self.blocks.len(), self.channels.len())
    }

    /// Half blocks, two of each block.
    pub(super) fn halves(&self) -> impl Iterator<Item = Range<usize>> {
        self.blocks.iter().flat_map(Block::halves)
    }

    /// Means over half blocks of a value per row.
    pub(super) fn half_means(&self, values: &[f64]) -> Vec<f64> {
        let mean = |rows: Range<usize>| {
            let count = rows.len() as f64;
            values[rows].iter().sum::<f64>() / count
        };
        self.halves().map(mean).collect()
    }

    /// Rows that are used of each channel.
    pub(super) fn rows(&self) -> f64 {
        let blocks = self.blocks.iter();
        blocks.map(|block| block.usable.len()).sum::<usize>() as f64
    }

    /// Means over blocks of a value per row.
    pub(super) fn means(&self, values: &[f64]) -> Vec<f64> {
        let blocks = self.blocks.iter();
        let mean = |block: &Block| {
            let sum: f64 = block.usable.iter().map(|&row| values[row]).sum();
            sum / block.usable.len() as f64
        };
        blocks.map(mean).collect()
    }

    /// Channel of a joint's torque.
    pub(super) fn channel(&self, joint: usize) -> Option<usize> {
        self.channels.iter().position(|&own| own == joint)
    }

    /// Block means of one channel, zero elsewhere.
    pub(super) fn on(&self, channel: usize, means: &[f64]) -> Means {
        let (blocks, channels) = self.shape();
        let mut all = Means::zeros(blocks, channels);
        all.column_mut(channel).copy_from_slice(means);
        all
    }

    /// Means over blocks of what an effect adds.
    pub(super) fn signal_means(&self, signal: &Signal) -> Means {
        let (blocks, channels) = self.shape();
        let mut all = Means::zeros(blocks, channels);
        for (mut column, &joint) in all.column_iter_mut().zip(&self.channels) {
            let stream = self.context.torque_stream(joint);
            if let Some(values) = stream.and_then(|stream| signal.on(stream)) {
                column.copy_from_slice(&self.means(values));
            }
        }
        all
    }

    /// Directions of each window of torques that a free force of the hand can take.
    pub(super) fn free_directions(&self) -> usize {
        if self.is_held { 3 } else { 0 }
    }

    /// Whether nobody is taken to hold the handle.
    pub(super) fn moves_by_itself(&self) -> bool {
        self.force_n.is_none() && !self.is_held
    }

    /// Variance of a block's mean torque by noise alone \[(N m)^2\], ((N)^2 where the joint slides), channel by channel.
    pub(super) fn block_variances(&self) -> Vec<f64> {
        let rows = mean_rows(&self.blocks).max(1.0);
        self.noise.iter().map(|noise| noise.of_mean(rows)).collect()
    }

    /// Name of a joint's torque column in a log.
    pub(super) fn column(&self, joint: usize) -> String {
        self.context.device.joints[joint].torque_column(joint + 1)
    }

    /// A channel by its name in an answer, and its unit: N where its joint slides.
    pub(super) fn named(&self, channel: usize) -> (String, &'static str) {
        let joint = self.channels[channel];
        let unit = self.context.device.joints[joint].torque_unit();
        (format!("torque{}", joint + 1), unit)
    }

    /// Whether a force of the hand is recorded that is not constant.
    pub(super) fn force_varies(&self) -> bool {
        let known = self.force_n.iter().flatten();
        let known = known.filter(|force| force.iter().all(|n| n.is_finite()));
        let mean = known.clone().sum::<Vector3<f64>>() / known.clone().count().max(1) as f64;
        let spread: f64 = known
            .clone()
            .map(|force| (force - mean).norm_squared())
            .sum();
        spread > CONSTANT_FORCE * known.map(Vector3::norm_squared).sum::<f64>()
    }

    /// Windows of successive blocks, channel by channel.
    pub(super) fn windows(&self) -> Vec<Vec<Range<usize>>> {
        let mut windows: Vec<Range<usize>> = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            match windows.last_mut() {
                Some(last) if block.follows && last.len() < WINDOW_BLOCKS => last.end = index + 1,
                _ => windows.push(index..index + 1),
            }
        }
        let behind = |channel: usize| {
            let first = channel * self.blocks.len();
            let windows = windows.iter();
            windows
                .map(|window| first + window.start..first + window.end)
                .collect()
        };
        (0..self.channels.len()).map(behind).collect()
    }

    /// Covariance of a block's mean torques, its transposed Jacobian (channel by axis of the
    /// handle's frame) given, and what may act besides.
    pub(super) fn covariance(
        &self,
        block: usize,
        hand: &MatrixXx3<f64>,
        besides: Besides,
    ) -> DMatrix<f64> {
        let rows = self.blocks[block].usable.len() as f64;
        let mut force = self.force_noise.map(|noise| noise.of_mean(rows));
        let mut torque: Vec<f64> = self.noise.iter().map(|noise| noise.of_mean(rows)).collect();
        match besides {
            Besides::Nothing => {}
            Besides::Hand(sd_n) => force
                .iter_mut()
                .for_each(|variance| *variance += sd_n * sd_n),
            Besides::Channel(channel) => torque[channel] += UNKNOWN_TORQUE_SD_NM.powi(2),
        }
        let by_force = hand * Matrix3::from_diagonal(&force.into());
        by_force * hand.transpose() + DMatrix::from_diagonal(&torque.into())
    }
}

/// Joints whose torque was measured, or why there is none.
fn measured(context: &Context<'_>) -> Result<Vec<usize>, String> {
    let read = |joint: usize| Some((joint, context.recorded_torque_nm(joint)?));
    let torques = (0..context.device.joints.len()).filter_map(read);
    let mut torques: Vec<(usize, &[f64])> = torques.collect();
    if torques.is_empty() {
        return Err("no column torque1_nm, torque2_nm, ...".to_owned());
    }
    torques.retain(|(_, values)| varies(values));
    match torques.is_empty() {
        true => Err(MotionError::Constant.to_string()),
        false => Ok(torques.into_iter().map(|(joint, _)| joint).collect()),
    }
}

/// What nothing can be said without.
fn needed(context: &Context<'_>) -> Result<(), String> {
    let (device, step_s) = (context.device, context.step_s());
    let why = if device.has_hands() {
        "the device has several hands; torques of a moving arm are worked out for one chain"
    } else if !device.has_links() || !device.drives_are_plain() || context.twist.is_empty() {
        "the device file has no [[link]]"
    } else if !context.ordered {
        "the rows are single postures, not a motion"
    } else if context.motion.is_none() {
        "no column t_s"
    } else if !haptical_motion::is_fast_enough(1.0 / step_s) {
        let hint = match step_s > MILLISECONDS_S {
            true => "; is t_s in milliseconds, and not in seconds?",
            false => "",
        };
        return Err(format!(
            "{:.3} rows a second are too few for the speeds of a motion: 20 rows a second are needed{hint}",
            1.0 / step_s
        ));
    } else {
        return Ok(());
    };
    Err(why.to_owned())
}

fn blocks(context: &Context<'_>, torque_nm: &[Vec<f64>]) -> Vec<Block> {
    let size = ((BLOCK_S / context.step_s()).round() as usize).clamp(1, LONGEST_BLOCK_ROWS);
    let is_usable = |row: &usize| torque_nm.iter().all(|values| values[*row].is_finite());
    let mut blocks = Vec::new();
    for run in &context.runs {
        let mut follows = false;
        for start in run.clone().step_by(size).take(run.len() / size) {
            let rows = start..start + size;
            let usable: Vec<usize> = rows.clone().filter(is_usable).collect();
            let is_enough = 2 * usable.len() >= size;
            if is_enough {
                blocks.push(Block {
                    rows,
                    usable,
                    follows,
                });
            }
            follows = is_enough;
        }
    }
    blocks
}

/// Mean number of a block's usable rows.
fn mean_rows(blocks: &[Block]) -> f64 {
    let rows: usize = blocks.iter().map(|block| block.usable.len()).sum();
    rows as f64 / blocks.len().max(1) as f64
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

/// Whether the base model leaves more of an external encoder or of the cable than successive rows
/// differ by, and than the sensor's counts hide of it: of a slow motion most rows repeat.
pub(super) fn positions_show_a_gap(context: &Context<'_>) -> bool {
    let recording = context.recording;
    let rest = |stream: &Stream| -> Option<Vec<f64>> {
        let (read, model) = match stream.channel {
            Channel::Output { joint } => (
                recording.output.get(joint)?.as_ref()?,
                context.output.get(joint)?,
            ),
            Channel::Cable { index: 0 } => (
                recording.cable_m.first()?.as_ref()?,
                &context.cable.as_ref()?.length_m,
            ),
            _ => return None,
        };
        Some(read.iter().zip(model).map(|(a, b)| a - b).collect())
    };
    let shows_gap = |stream: &Stream| {
        let rest = rest(stream)?;
        let usable = rest.iter().filter(|value| value.is_finite());
        let count = usable.clone().count().max(1) as f64;
        let rms = (usable.map(|value| value * value).sum::<f64>() / count).sqrt();
        // the standard deviation of rounding to whole counts
        let counts = noise::rounding::Counts::new(context, stream);
        let rounding = counts.map_or(0.0, |counts| counts.variance().sqrt());
        let sd = noise::difference_sd(&rest, &context.runs)?;
        Some(rms > POSITION_GAP * sd.hypot(rounding))
    };
    let mut streams = context.streams.iter();
    streams.any(|stream| shows_gap(stream) == Some(true))
}
