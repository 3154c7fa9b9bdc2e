//! The chain along a recording, block by block: columns of the inertial parameters, of forces at
//! the handle, of the geometry and of a delay.

use std::ops::Range;

use haptical_model::DeviceChain;
use haptical_model::dynamics::Inertia;
use haptical_model::kinematics::{Parameter, Pose};
use nalgebra::{DMatrix, DVector, Matrix3, MatrixXx3, Vector3};

use super::Means;
use super::posture::{PER_LINK, Posture};
use super::recorded::{Besides, Recorded};
use super::rows::Whitener;
use crate::thresholds::torque::{
    ANGLE_SD_RAD, COLUMN_ROUNDING, DELAY_SD_S, FORCE_PRIOR, LEAST_SCALE_SD, LENGTH_SD_M,
};
use crate::{DiagnosisError, Result};

/// Half a block: the chain is taken for its mean posture.
#[derive(Debug)]
struct Half {
    /// Transposed Jacobian, a row for each channel, in the handle's frame.
    hand: MatrixXx3<f64>,
    posture: Posture,
}

/// The chain along a recording, block by block.
#[derive(Debug)]
pub(super) struct Along<'a> {
    pub(super) recorded: Recorded<'a>,
    /// Two per block.
    halves: Vec<Half>,
    /// Mean position and rate of each joint, a row for each block.
    pub(super) angle: DMatrix<f64>,
    pub(super) rate: DMatrix<f64>,
    /// Mean recorded force of the hand, per half block.
    pub(super) force_n: Vec<Vector3<f64>>,
    /// Columns of the inertial numbers of an arm: ten of each link, then one of each drive. That one is the inertia
    /// of rotor and gears at the joint, which no link's number replaces. A column of rounding errors alone is zero.
    /// Source: Khalil & Dombre, *Modeling, Identification and Control of Robots*, section 9.4.
    pub(super) inertia: Vec<Means>,
    /// Sum of the drives' and the hand's torques.
    pub(super) reading: Means,
}

impl<'a> Along<'a> {
    /// # Errors
    /// [`DiagnosisError::Row`] where the arm has no torques.
    pub(super) fn new(recorded: Recorded<'a>) -> Result<Self> {
        let context = recorded.context;
        let chain = DeviceChain::of_hand(context.device, 0);
        let joints = context.device.joints.len();
        let (blocks, channels) = recorded.shape();
        let torques = recorded.torque_nm.iter();
        let means = torques.flat_map(|torque_nm| recorded.means(torque_nm));
        let mut along = Self {
            halves: Vec::with_capacity(2 * blocks),
            angle: DMatrix::zeros(blocks, joints),
            rate: DMatrix::zeros(blocks, joints),
            force_n: Vec::with_capacity(2 * blocks),
            inertia: vec![Means::zeros(blocks, channels); (PER_LINK + 1) * joints],
            reading: Means::from_iterator(blocks, channels, means),
            recorded,
        };
        let recorded = &along.recorded;
        let mut work = recorded.bodies.work();
        let mut torques = vec![0.0; PER_LINK * joints * joints];
        let motions: Vec<[Vec<f64>; 3]> =
            (0..joints).map(|joint| motion(recorded, joint)).collect();
        for (index, half) in recorded.halves().enumerate() {
            let block = index / 2;
            let [position, rate, acceleration] = [0, 1, 2].map(|order| -> Vec<f64> {
                let joints = motions.iter();
                joints.map(|motion| motion[order][index]).collect()
            });
            let posture = (recorded.bodies)
                .regressor(&position, &rate, &acceleration, &mut work, &mut torques)
                .and_then(|()| Posture::new(&chain, &position, &work))
                .map_err(|source| DiagnosisError::Row {
                    line: context.recording.line.get(half.start).copied().unwrap_or(0),
                    source,
                })?;
            for (channel, &joint) in recorded.channels.iter().enumerate() {
                let links = torques[PER_LINK * joints * joint..].iter();
                for (column, torque) in along.inertia[..PER_LINK * joints].iter_mut().zip(links) {
                    column[(block, channel)] += 0.5 * torque;
                }
                along.inertia[PER_LINK * joints + joint][(block, channel)] +=
                    0.5 * acceleration[joint];
            }
            for joint in 0..joints {
                along.angle[(block, joint)] += 0.5 * position[joint];
                along.rate[(block, joint)] += 0.5 * rate[joint];
            }
            let arm = |&joint: &usize| posture.hand(joint).transpose();
            let arms: Vec<_> = recorded.channels.iter().map(arm).collect();
            let hand = MatrixXx3::from_rows(&arms);
            along.force_n.push(mean_force(recorded, block, &half));
            along.halves.push(Half { hand, posture });
        }
        let sizes = along.inertia.iter().map(Means::norm_squared);
        let largest = sizes.fold(0.0, f64::max);
        for column in &mut along.inertia {
            if column.norm_squared() <= COLUMN_ROUNDING * COLUMN_ROUNDING * largest {
                column.fill(0.0);
            }
        }
        Ok(along)
    }

    /// Number of the arm's joints.
    pub(super) fn joints(&self) -> usize {
        self.angle.ncols()
    }

    /// Highest less lowest position of each joint.
    pub(super) fn ranges(&self) -> Vec<f64> {
        let joints = self.angle.column_iter();
        joints.map(|angle| angle.max() - angle.min()).collect()
    }

    /// Inertial numbers of an arm whose only mass has these ten numbers, on a link or about the flange. The flange is
    /// where the last link has the handle.
    pub(super) fn carrying(&self, link: Option<usize>, numbers: [f64; PER_LINK]) -> Vec<f64> {
        let flange = self.recorded.bodies.flange(0);
        let place = Pose {
            position_m: flange.map_or_else(Vector3::zeros, |flange| flange.pose.position_m),
            ..Pose::default()
        };
        let numbers = match link {
            Some(_) => numbers,
            None => Inertia::from_parameters(numbers)
                .seen_from(&place)
                .parameters(),
        };
        let mut all = vec![0.0; self.inertia.len()];
        let first = PER_LINK * link.unwrap_or(self.joints() - 1);
        all[first..first + PER_LINK].copy_from_slice(&numbers);
        all
    }

    /// Means of a block's transposed Jacobian, a row for each channel.
    fn hand(&self, block: usize) -> MatrixXx3<f64> {
        (&self.halves[2 * block].hand + &self.halves[2 * block + 1].hand) * 0.5
    }

    /// Standard deviation of a channel's row by the noise of its torque and of the hand's force.
    pub(super) fn row_sd(&self, channel: usize) -> f64 {
        let recorded = &self.recorded;
        let of_hand = |block: usize| {
            let arm = self.hand(block);
            let noise = recorded.force_noise.iter().enumerate();
            noise
                .map(|(k, noise)| (arm[(channel, k)] * noise.sd).powi(2))
                .sum::<f64>()
        };
        let blocks = recorded.blocks.len();
        let hand = match recorded.force_n.is_some() {
            true => (0..blocks).map(of_hand).sum::<f64>() / blocks.max(1) as f64,
            false => 0.0,
        };
        (recorded.noise[channel].sd.powi(2) + hand).sqrt()
    }

    /// The whitener of the blocks; none where the torques have no noise at all.
    pub(super) fn whitener(&self, besides: Besides) -> Option<Whitener> {
        let blocks = 0..self.recorded.blocks.len();
        let covariance = |block| self.recorded.covariance(block, &self.hand(block), besides);
        Whitener::new(blocks.map(covariance))
    }

    /// Averages the torques of half blocks to block means.
    fn of_halves(&self, torques: impl Fn(usize, &Half) -> DVector<f64>) -> Means {
        let (blocks, channels) = self.recorded.shape();
        let mut means = Means::zeros(blocks, channels);
        for (index, half) in self.halves.iter().enumerate() {
            let mut block = means.row_mut(index / 2);
            block += torques(index, half).transpose() * 0.5;
        }
        means
    }

    /// The force of each block whose torques are nearest to `rest`, with its covariance.
    pub(super) fn hand_force(
        &self,
        whitener: &Whitener,
        rest: &Means,
    ) -> Vec<(Vector3<f64>, Matrix3<f64>)> {
        let white = whitener.whiten(rest);
        let force = |block: usize| {
            let (factor, hand) = (whitener.factor(block), self.hand(block));
            let arm = factor.solve_lower_triangular(&hand).unwrap_or(hand);
            // a direction in which the handle cannot be pushed has no force
            let information = Matrix3::identity() * FORCE_PRIOR + arm.tr_mul(&arm);
            let covariance = information.try_inverse().unwrap_or_else(Matrix3::zeros);
            let force = covariance * arm.tr_mul(&white.row(block).transpose());
            (force, covariance)
        };
        (0..white.nrows()).map(force).collect()
    }

    /// Torque of links with these inertial numbers.
    pub(super) fn link_torques(&self, inertia: &[f64]) -> Means {
        let mut torque = self.reading.map(|_| 0.0);
        for (column, value) in self.inertia.iter().zip(inertia) {
            torque += column * *value;
        }
        torque
    }

    /// Torque of the drives: that of the links less that of the hand.
    pub(super) fn drive_torques(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Means {
        let of_hand = self.of_halves(|index, half| &half.hand * force_n[index]);
        self.link_torques(inertia) - of_hand
    }

    /// What is stated of each torque's scale: its relative standard deviation.
    pub(super) fn scale_sds(&self) -> Vec<f64> {
        let joints = &self.recorded.context.device.joints;
        let sd = |&joint: &usize| joints[joint].torque_scale_sd.max(LEAST_SCALE_SD);
        self.recorded.channels.iter().map(sd).collect()
    }

    /// What each row parameter of the chain may be wrong by.
    pub(super) fn geometry_sds(&self) -> Vec<f64> {
        let sd = |parameter: Parameter| match parameter.unit() {
            "m" => LENGTH_SD_M,
            _ => ANGLE_SD_RAD,
        };
        let device = self.recorded.context.device;
        let rows = device.links.iter().flat_map(|_| device.convention.order());
        rows.map(sd).collect()
    }

    /// Columns of what is not exactly known except the links: of each row parameter of the chain, and of a delay.
    /// Each has the standard deviation of its number. They are linearised at these inertial numbers and these forces
    /// of the hand, one per half block.
    pub(super) fn geometry(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Vec<(Means, f64)> {
        let nothing = self.reading.map(|_| 0.0);
        let known = self.geometry_sds().into_iter();
        let mut columns: Vec<(Means, f64)> = known.map(|sd| (nothing.clone(), sd)).collect();
        let gravity = self.recorded.bodies.gravity_mps2();
        for (index, (half, force)) in self.halves.iter().zip(force_n).enumerate() {
            let posture = &half.posture;
            posture.geometry(inertia, gravity, force, |number, joint, change| {
                if let Some(channel) = self.recorded.channel(joint) {
                    columns[number].0[(index / 2, channel)] += 0.5 * change;
                }
            });
        }
        columns.push((self.delayed(inertia, force_n), DELAY_SD_S));
        columns
    }

    /// Change of the model's torques with time, the hand's force held: what late encoders add.
    fn delayed(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Means {
        let links = self.link_torques(inertia);
        let blocks = &self.recorded.blocks;
        let step_s = self.recorded.context.step_s();
        let middle_s = |block: usize| {
            0.5 * step_s * (blocks[block].rows.start + blocks[block].rows.end) as f64
        };
        let mut column = links.map(|_| 0.0);
        for block in 0..blocks.len() {
            let before = block - usize::from(blocks[block].follows);
            let has_next = blocks.get(block + 1).is_some_and(|next| next.follows);
            let after = block + usize::from(has_next);
            if after > before {
                let force = (force_n[2 * block] + force_n[2 * block + 1]) * 0.5;
                let of_hand = (self.hand(after) - self.hand(before)) * force;
                let change = links.row(after) - links.row(before) - of_hand.transpose();
                column.set_row(block, &(change / (middle_s(after) - middle_s(before))));
            }
        }
        column
    }

    /// Torques that an error of a joint's angle adds, by the accelerations of that error, row by row. The link does
    /// not have these accelerations; the joint's column of the mass matrix makes torques of them.
    pub(super) fn accelerated(&self, joint: usize, inertia: &[f64], acceleration: &[f64]) -> Means {
        let means = self.recorded.half_means(acceleration);
        self.of_halves(|index, half| {
            let mut torque = half.posture.mass_column(joint, inertia);
            torque[joint] += inertia[PER_LINK * torque.len() + joint];
            let channels = self.recorded.channels.iter();
            let torques = channels.map(|&channel| -torque[channel] * means[index]);
            DVector::from_vec(torques.collect())
        })
    }
}

/// Position, rate and acceleration of a joint, half block by half block.
fn motion(recorded: &Recorded<'_>, joint: usize) -> [Vec<f64>; 3] {
    let (context, motion) = (recorded.context, &recorded.motion[joint]);
    let output = context.output[joint].iter().zip(&motion.value);
    let readings = output.zip(&context.recording.joint[joint]);
    // the smoothed reading through the transmission, whose slope is nearly 1
    let position = readings.map(|((output, smooth), read)| output + smooth - read);
    let position: Vec<f64> = position.collect();
    [&position, &motion.velocity, &motion.acceleration].map(|values| recorded.half_means(values))
}

fn mean_force(recorded: &Recorded<'_>, block: usize, half: &Range<usize>) -> Vector3<f64> {
    let Some(force) = &recorded.force_n else {
        return Vector3::zeros();
    };
    let usable = &recorded.blocks[block].usable;
    let mut in_half: Vec<usize> = usable.clone();
    in_half.retain(|row| half.contains(row));
    let rows = if in_half.is_empty() { usable } else { &in_half };
    rows.iter().map(|&row| force[row]).sum::<Vector3<f64>>() / rows.len().max(1) as f64
}
