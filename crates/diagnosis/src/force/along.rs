//! The chain along a recording, block by block: columns of the inertial parameters, of forces at
//! the handle, of the geometry and of a delay.

use haptical_model::DeviceChain;
use haptical_model::kinematics::Parameter;
use nalgebra::{Matrix3, Vector3};

use super::posture::{PER_LINK, Posture};
use super::recorded::{Besides, Recorded};
use super::rows::whitener::Whitener;
use crate::DiagnosisError;
use crate::thresholds::torque::{
    ANGLE_SD_RAD, COLUMN_ROUNDING, FORCE_PRIOR, LEAST_SCALE_SD, LENGTH_SD_M,
};

/// Inertial numbers of an arm: ten of each link, and the inertia of each drive's rotor and gears at its joint, which no link's
/// number takes (Khalil & Dombre, *Modeling, Identification and Control of Robots*, section 9.4).
pub(super) fn numbers(joints: usize) -> usize {
    (PER_LINK + 1) * joints
}

/// Place of a rotor among these numbers.
fn rotor(joints: usize, joint: usize) -> usize {
    PER_LINK * joints + joint
}

/// Half a block: the chain is taken for its mean posture.
#[derive(Debug)]
struct Half {
    joints: [Vec<f64>; 3],
    /// Transposed Jacobian, per channel, in the handle's frame.
    hand: Vec<Vector3<f64>>,
    posture: Posture,
}

/// The chain along a recording, block by block.
#[derive(Debug)]
pub(super) struct Along<'a> {
    pub(super) recorded: &'a Recorded<'a>,
    /// Two per block.
    halves: Vec<Half>,
    /// Mean recorded force of the hand, per half block.
    pub(super) force_n: Vec<Vector3<f64>>,
    /// Means of the transposed Jacobian, per block and channel.
    pub(super) hand: Vec<Vec<Vector3<f64>>>,
    /// Columns of the inertial parameters, and which ones they are.
    pub(super) inertia: Vec<Vec<f64>>,
    pub(super) parameters: Vec<usize>,
    /// Torques of drives and hand together, channel after channel.
    pub(super) reading: Vec<f64>,
}

impl<'a> Along<'a> {
    /// # Errors
    /// [`DiagnosisError::Row`] where the arm has no torques.
    pub(super) fn new(recorded: &'a Recorded<'a>) -> Result<Self, DiagnosisError> {
        let context = recorded.context;
        let chain = DeviceChain::of_hand(context.device, 0);
        let joints = context.device.joints.len();
        let blocks = recorded.blocks.len();
        let mut along = Self {
            recorded,
            halves: Vec::with_capacity(2 * blocks),
            force_n: Vec::with_capacity(2 * blocks),
            hand: Vec::with_capacity(blocks),
            inertia: vec![vec![0.0; recorded.len()]; numbers(joints)],
            parameters: Vec::new(),
            reading: Vec::with_capacity(recorded.len()),
        };
        for values in &recorded.torque_nm {
            along.reading.extend(recorded.means(|row| values[row]));
        }
        let mut work = recorded.bodies.work();
        let mut torques = vec![0.0; PER_LINK * joints * joints];
        for block in 0..blocks {
            let rows = recorded.blocks[block].rows.clone();
            let middle = rows.start + rows.len() / 2;
            let halves = if rows.len() < 2 {
                [rows.clone(), rows]
            } else {
                [rows.start..middle, middle..rows.end]
            };
            for half in halves {
                let moved = along.mean_joints(&half);
                let [position, rate, acceleration] = &moved;
                let posture = recorded
                    .bodies
                    .regressor(position, rate, acceleration, &mut work, &mut torques)
                    .and_then(|()| Posture::new(&chain, position, &work))
                    .map_err(|source| DiagnosisError::Row {
                        line: context.recording.line.get(half.start).copied().unwrap_or(0),
                        source,
                    })?;
                for (channel, &joint) in recorded.channels.iter().enumerate() {
                    let cell = channel * blocks + block;
                    let links = torques[PER_LINK * joints * joint..].iter();
                    for (column, torque) in along.inertia[..PER_LINK * joints].iter_mut().zip(links)
                    {
                        column[cell] += 0.5 * torque;
                    }
                    along.inertia[rotor(joints, joint)][cell] += 0.5 * acceleration[joint];
                }
                let hand = recorded
                    .channels
                    .iter()
                    .map(|&joint| posture.hand(joint))
                    .collect();
                along.force_n.push(mean_force(recorded, block, &half));
                along.halves.push(Half {
                    joints: moved,
                    hand,
                    posture,
                });
            }
            let [.., first, second] = along.halves.as_slice() else {
                continue;
            };
            let both = first.hand.iter().zip(&second.hand);
            along.hand.push(both.map(|(a, b)| (a + b) * 0.5).collect());
        }
        along.drop_empty();
        Ok(along)
    }

    /// Takes a torque off the readings.
    pub(super) fn put_down(&mut self, torque_nm: &[f64]) {
        let pairs = self.reading.iter_mut().zip(torque_nm);
        pairs.for_each(|(reading, torque)| *reading -= torque);
    }

    /// Mean position of each joint in a block.
    pub(super) fn posture_of(&self, block: usize) -> Vec<f64> {
        let [first, second] = [&self.halves[2 * block], &self.halves[2 * block + 1]];
        let pairs = first.joints[0].iter().zip(&second.joints[0]);
        pairs.map(|(a, b)| 0.5 * (a + b)).collect()
    }

    /// Mean position of a joint, block by block.
    pub(super) fn angles(&self, joint: usize) -> Vec<f64> {
        self.means_of(0, joint)
    }

    /// Mean rate of a joint, block by block.
    pub(super) fn rates(&self, joint: usize) -> Vec<f64> {
        self.means_of(1, joint)
    }

    fn means_of(&self, derivative: usize, joint: usize) -> Vec<f64> {
        let pairs = self.halves.chunks_exact(2);
        let value = |half: &Half| half.joints[derivative][joint];
        pairs
            .map(|pair| 0.5 * (value(&pair[0]) + value(&pair[1])))
            .collect()
    }

    /// Highest less lowest position of each joint.
    pub(super) fn ranges(&self) -> Vec<f64> {
        let joints = 0..self.recorded.context.device.joints.len();
        let range = |joint: usize| {
            let ends = self.angles(joint).into_iter();
            let ends = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], angle| {
                [low.min(angle), high.max(angle)]
            });
            (ends[1] - ends[0]).max(0.0)
        };
        joints.map(range).collect()
    }

    /// Column of an inertial number of the links, where a torque depends on it.
    pub(super) fn column_of(&self, parameter: usize) -> Option<&[f64]> {
        let place = self.parameters.iter().position(|&own| own == parameter)?;
        Some(&self.inertia[place])
    }

    /// The handle in the frame of the last link \[m\], which moves with it.
    pub(super) fn flange_m(&self) -> Vector3<f64> {
        let flange = self.recorded.bodies.flange(0);
        flange.map_or_else(Vector3::zeros, |flange| flange.pose.position_m)
    }

    /// Parameters that no torque depends on but for rounding have no column.
    fn drop_empty(&mut self) {
        let sizes: Vec<f64> = self
            .inertia
            .iter()
            .map(|column| column.iter().map(|entry| entry * entry).sum::<f64>())
            .collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let columns = std::mem::take(&mut self.inertia);
        for (parameter, column) in columns.into_iter().enumerate() {
            if sizes[parameter] > COLUMN_ROUNDING * COLUMN_ROUNDING * largest {
                self.parameters.push(parameter);
                self.inertia.push(column);
            }
        }
    }

    fn mean_joints(&self, half: &std::ops::Range<usize>) -> [Vec<f64>; 3] {
        let context = self.recorded.context;
        let count = half.len().max(1) as f64;
        let mut joints = [Vec::new(), Vec::new(), Vec::new()];
        for (joint, motion) in self.recorded.motion.iter().enumerate() {
            let output = &context.output[joint];
            let reading = &context.recording.joint[joint];
            let (mut position, mut rate, mut acceleration) = (0.0, 0.0, 0.0);
            for row in half.clone() {
                // the smoothed reading through the transmission, whose slope is nearly 1
                position += output[row] + motion.value[row] - reading[row];
                rate += motion.velocity[row];
                acceleration += motion.acceleration[row];
            }
            joints[0].push(position / count);
            joints[1].push(rate / count);
            joints[2].push(acceleration / count);
        }
        joints
    }

    pub(super) fn whitener(&self, besides: Besides) -> Option<Whitener> {
        let covariances = (0..self.recorded.blocks.len())
            .map(|block| self.recorded.covariance(block, &self.hand[block], besides))
            .collect();
        Whitener::new(self.recorded.channels.len(), covariances)
    }

    /// Column of a force in the handle's frame, per half block (its index and the recorded force
    /// given).
    pub(super) fn hand_column(
        &self,
        force: impl Fn(usize, &Vector3<f64>) -> Vector3<f64>,
    ) -> Vec<f64> {
        let blocks = self.recorded.blocks.len();
        let mut column = vec![0.0; self.recorded.len()];
        for (index, half) in self.halves.iter().enumerate() {
            let force = force(index, &self.force_n[index]);
            for (channel, arm) in half.hand.iter().enumerate() {
                column[channel * blocks + index / 2] += 0.5 * arm.dot(&force);
            }
        }
        column
    }

    /// Means over half blocks of a value per row.
    pub(super) fn half_means(&self, values: &[f64]) -> Vec<f64> {
        let mean = |rows: std::ops::Range<usize>| {
            let count = rows.len().max(1) as f64;
            values[rows].iter().sum::<f64>() / count
        };
        let mut means = Vec::with_capacity(self.halves.len());
        for block in &self.recorded.blocks {
            let rows = block.rows.clone();
            let middle = rows.start + rows.len() / 2;
            if rows.len() < 2 {
                means.extend([mean(rows.clone()), mean(rows)]);
            } else {
                means.extend([mean(rows.start..middle), mean(middle..rows.end)]);
            }
        }
        means
    }

    /// The force of each block whose torques are nearest to `rest`, with its covariance.
    pub(super) fn hand_force(
        &self,
        whitener: &Whitener,
        rest: &[f64],
    ) -> Vec<(Vector3<f64>, Matrix3<f64>)> {
        let white = whitener.whiten(rest);
        let blocks = self.recorded.blocks.len();
        let along = [0, 1, 2].map(|axis| {
            let channels = 0..self.recorded.channels.len();
            let arms =
                channels.flat_map(|channel| self.hand.iter().map(move |hand| hand[channel][axis]));
            whitener.whiten(&arms.collect::<Vec<f64>>())
        });
        let force = |block: usize| {
            // a direction in which the handle cannot be pushed has no force
            let mut information = Matrix3::identity() * FORCE_PRIOR;
            let mut right = Vector3::zeros();
            for entry in (block..white.len()).step_by(blocks) {
                let arm = Vector3::from_fn(|axis, _| along[axis][entry]);
                right += arm * white[entry];
                information += arm * arm.transpose();
            }
            let covariance = information.try_inverse().unwrap_or_else(Matrix3::zeros);
            (covariance * right, covariance)
        };
        (0..blocks).map(force).collect()
    }

    /// Torque of links with these inertial parameters.
    pub(super) fn link_torques(&self, inertia: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.recorded.len()];
        for (&parameter, column) in self.parameters.iter().zip(&self.inertia) {
            let value = inertia[parameter];
            for (sum, entry) in torque.iter_mut().zip(column) {
                *sum += value * entry;
            }
        }
        torque
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
        let order = device.convention.order();
        let rows = device.links.iter().flat_map(|_| order);
        rows.map(sd).collect()
    }

    /// One column for each row parameter of the chain.
    pub(super) fn geometry(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Vec<Vec<f64>> {
        let blocks = self.recorded.blocks.len();
        let gravity = self.recorded.bodies.gravity_mps2();
        let mut columns = vec![vec![0.0; self.recorded.len()]; self.geometry_sds().len()];
        for (index, (half, force)) in self.halves.iter().zip(force_n).enumerate() {
            let posture = &half.posture;
            posture.geometry(inertia, gravity, force, |number, joint, change| {
                if let Some(channel) = self.recorded.channel(joint) {
                    columns[number][channel * blocks + index / 2] += 0.5 * change;
                }
            });
        }
        columns
    }

    /// Change of the model's torques with time, the hand's force held: what late encoders add.
    pub(super) fn delayed(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Vec<f64> {
        let links = self.link_torques(inertia);
        let blocks = &self.recorded.blocks;
        let mut column = vec![0.0; links.len()];
        for block in 0..blocks.len() {
            let before = if blocks[block].follows {
                block - 1
            } else {
                block
            };
            let has_next = blocks.get(block + 1).is_some_and(|next| next.follows);
            let after = if has_next { block + 1 } else { block };
            if after == before {
                continue;
            }
            let middle =
                |index: usize| 0.5 * (blocks[index].rows.start + blocks[index].rows.end) as f64;
            let time_s = (middle(after) - middle(before)) * self.recorded.step_s;
            let force = (force_n[2 * block] + force_n[2 * block + 1]) * 0.5;
            for channel in 0..self.recorded.channels.len() {
                let first = channel * blocks.len();
                let arm = self.hand[after][channel] - self.hand[before][channel];
                let change = links[first + after] - links[first + before] - arm.dot(&force);
                column[first + block] = change / time_s;
            }
        }
        column
    }

    /// Torques of the drives for a unit acceleration of one joint, half block by half block: the
    /// joint's column of the mass matrix.
    pub(super) fn mass_column(&self, joint: usize, inertia: &[f64]) -> Vec<Vec<f64>> {
        let column = |half: &Half| {
            let mut torque = half.posture.mass_column(joint, inertia);
            torque[joint] += inertia[rotor(torque.len(), joint)];
            let channels = self.recorded.channels.iter();
            channels.map(|&channel| torque[channel]).collect()
        };
        self.halves.iter().map(column).collect()
    }
}

fn mean_force(
    recorded: &Recorded<'_>,
    block: usize,
    half: &std::ops::Range<usize>,
) -> Vector3<f64> {
    let Some(force) = &recorded.force_n else {
        return Vector3::zeros();
    };
    let usable = &recorded.blocks[block].usable;
    let mean = |rows: Vec<usize>| {
        let sum: Vector3<f64> = rows.iter().map(|&row| force[row]).sum();
        sum / rows.len().max(1) as f64
    };
    let own: Vec<usize> = usable
        .iter()
        .copied()
        .filter(|row| half.contains(row))
        .collect();
    if own.is_empty() {
        mean(usable.clone())
    } else {
        mean(own)
    }
}
