//! Residuals and derivatives of a recording, a tile of postures at a time: the chain in lanes, readings one by one.

mod columns;
mod joints;
#[cfg(test)]
mod tests;
pub(crate) mod variances;

use std::ops::Range;

use haptical_batch::{Lane, POSTURES, ScrewTile, TwistLanes};
use haptical_identification::Matrix;
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceChain, Evaluation, ParameterId};

use crate::problem::channel::with_kind;
use crate::problem::measurement::kind::{Measurement, Posture, is_of_handle};
use crate::{Channel, DeviceProblem};
use columns::Column;
use joints::JointRows;

/// Rows from which a tile is worth it.
const FEWEST_ROWS: usize = 8;

/// A channel's readings within a tile.
struct Part {
    channel: Channel,
    width: usize,
    /// Postures of the tile with a reading.
    postures: Vec<usize>,
    weights: Vec<f64>,
    /// First residual.
    first: usize,
    /// Reading within the block.
    cursor: usize,
    /// Derivatives of each residual along the handle's twist, and along that of the base; none for what the chain
    /// does not move.
    along: Option<Box<[[TwistLanes; 3]; 2]>>,
}

/// Room of a run.
struct Room {
    tile: ScrewTile,
    variables: Vec<Lane>,
    term: TwistLanes,
    twist: TwistLanes,
    lane: Lane,
}

impl DeviceProblem<'_> {
    /// What [`DeviceProblem::run`] writes, of some rows; `firsts` is where each block's residuals begin. None where the
    /// chain is not asked for, or each hand has one, or a number is refused, which the form row by row names.
    pub(crate) fn run_tiles(
        &self,
        device: &Device,
        rows: &Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        if !self.sees_chain || rows.len() < FEWEST_ROWS || device.has_hands() {
            return None;
        }
        let free = jacobian.as_ref().map_or(&[][..], |(free, _)| *free);
        let joints = JointRows::new(self, device, rows, free)?;
        let chain = DeviceChain::new(device);
        let table = chain.chain().ok()?;
        let drives = chain.drives();
        if drives.len() != table.joint_count() {
            return None;
        }
        let columns: Vec<Column> = free
            .iter()
            .map(|&index| Column::new(self.parameters[index], drives))
            .collect();
        let wanted: Vec<_> = columns.iter().flat_map(Column::wanted).collect();
        let mut parts: Vec<Part> = self.parts(rows.start, firsts, jacobian.is_some());
        let mut evaluation = Evaluation::new(device);
        let mut outputs = vec![0.0; device.joints.len()];
        let mut room = Room {
            tile: ScrewTile::default(),
            variables: vec![[0.0; POSTURES]; drives.len()],
            term: TwistLanes::default(),
            twist: TwistLanes::default(),
            lane: [0.0; POSTURES],
        };
        for start in rows.clone().step_by(POSTURES) {
            let first = start - rows.start;
            let count = POSTURES.min(rows.end - start);
            for (drive, variable) in drives.iter().zip(&mut room.variables) {
                let compliance = device.compliance_rad_per_nm(drive.joint);
                let yielded = |entry: usize| {
                    let loads = self.loads.as_ref();
                    loads.map_or(0.0, |loads| {
                        compliance * loads.of_row(rows.start + entry)[drive.joint]
                    })
                };
                joints.variable(drive, first, yielded, variable);
            }
            if !room.tile.sweep(&table, &room.variables, &wanted) {
                return None;
            }
            for posture in 0..count {
                for (output, own) in outputs.iter_mut().zip(&joints.outputs) {
                    *output = own[first + posture];
                }
                evaluation.place(&outputs, room.tile.pose(posture)).ok()?;
                let of_row = (start + posture, posture);
                self.readings(
                    of_row,
                    device,
                    &mut evaluation,
                    &mut parts,
                    residuals,
                    jacobian,
                )?;
            }
            if let Some((_, matrix)) = jacobian {
                for (position, column) in columns.iter().enumerate() {
                    self.column(
                        column,
                        &joints,
                        (rows.start, first),
                        &mut room,
                        &parts,
                        matrix.column_mut(position),
                    );
                }
            }
            for part in &mut parts {
                part.first += part.postures.len() * part.width;
                part.postures.clear();
                part.weights.clear();
            }
        }
        Some(())
    }

    fn parts(&self, start: usize, firsts: &[usize], derivatives: bool) -> Vec<Part> {
        let blocks = self.blocks.iter().zip(firsts);
        let part = |(block, &first): (&crate::problem::device_problem::Block, &usize)| {
            let is_of_handle = with_kind!(block.channel, kind => is_of_handle(&kind));
            Part {
                channel: block.channel,
                width: block.channel.width(),
                postures: Vec::with_capacity(POSTURES),
                weights: Vec::with_capacity(POSTURES),
                first,
                cursor: block.rows.partition_point(|&row| row < start),
                along: (is_of_handle && derivatives)
                    .then(|| Box::new([[TwistLanes::default(); 3]; 2])),
            }
        };
        blocks.map(part).collect()
    }

    /// All channels' readings at one row: residuals, and the derivatives that no twist of the handle gives.
    fn readings(
        &self,
        (row, posture): (usize, usize),
        device: &Device,
        evaluation: &mut Evaluation<'_>,
        parts: &mut [Part],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        for (block, part) in self.blocks.iter().zip(parts) {
            if block.rows.get(part.cursor) != Some(&row) {
                continue;
            }
            if let (Channel::Fixture { joint }, Some(_), None) =
                (block.channel, &jacobian, &self.outputs)
            {
                let reading = self.recording.joint[joint][row];
                evaluation.move_joint(joint, reading).ok()?;
            }
            let at = Posture {
                device,
                evaluation,
                recording: self.recording,
                row,
                subject: block.subjects.get(part.cursor).copied().unwrap_or(0),
                mount: self.mount(row),
            };
            let own = part.first + part.postures.len() * part.width;
            let weight = block.weights[part.cursor];
            let own = own..own + part.width;
            with_kind!(block.channel, kind => {
                self.tile_reading(&kind, &at, weight, own, (posture, &mut *part), residuals, jacobian)
            })?;
            part.postures.push(posture);
            part.weights.push(weight);
            part.cursor += 1;
        }
        Some(())
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one reading, with where each of its numbers goes"
    )]
    fn tile_reading<M: Measurement>(
        &self,
        kind: &M,
        at: &Posture<'_>,
        weight: f64,
        own: Range<usize>,
        (posture, part): (usize, &mut Part),
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        let (values, seen) = kind.see(at, weight).ok()?;
        residuals[own.clone()].copy_from_slice(&values[..own.len()]);
        let Some((free, matrix)) = jacobian else {
            return Some(());
        };
        if matches!(part.channel, Channel::Output { .. }) {
            return Some(());
        }
        if let Some(along) = &mut part.along {
            for coordinate in 0..6 {
                let twist = unit_twist(coordinate);
                let by = [
                    kind.by_twist(&seen, &twist),
                    kind.by_base_twist(&seen, &twist),
                ];
                for (along, by) in along.iter_mut().zip(by) {
                    for (lanes, by) in along.iter_mut().zip(by).take(M::WIDTH) {
                        let lane = match coordinate.checked_sub(3) {
                            None => &mut lanes.linear[coordinate],
                            Some(turn) => &mut lanes.angular[turn],
                        };
                        lane[posture] = by;
                    }
                }
            }
        }
        for (position, &index) in free.iter().enumerate() {
            let parameter = self.parameters[index];
            if M::IS_OF_HANDLE && !matches!(parameter, ParameterId::Surrounding(_)) {
                continue;
            }
            let values = match kind.sees(parameter) {
                true => kind.derivative(&seen, at, parameter),
                false => [0.0; 3],
            };
            matrix.column_mut(position)[own.clone()].copy_from_slice(&values[..own.len()]);
        }
        Some(())
    }

    /// The derivatives by one parameter that a twist of the handle or a transmission's slope gives, of all channels in
    /// the tile. `start` is the first row of the run, `first` the tile's entry in it.
    fn column(
        &self,
        column: &Column,
        joints: &JointRows,
        (start, first): (usize, usize),
        room: &mut Room,
        parts: &[Part],
        into: &mut [f64],
    ) {
        let factors = match column.parameter {
            ParameterId::Transmission { joint, index } => {
                Some(joints.slope_lane(joint, index, first))
            }
            ParameterId::Compliance { joint } => {
                let mut lane = [0.0; POSTURES];
                let loads = self.loads.as_ref();
                let rows = start + first..self.recording.len();
                for (into, row) in lane.iter_mut().zip(rows) {
                    *into = loads.map_or(0.0, |loads| -loads.of_row(row)[joint]);
                }
                Some(lane)
            }
            _ => None,
        };
        let Room {
            tile,
            term,
            twist,
            lane,
            ..
        } = room;
        if column.is_of_chain() {
            column.twist(tile, factors.as_ref(), term, twist);
        }
        for part in parts {
            let own = &mut into[part.first..][..part.postures.len() * part.width];
            if let Channel::Output { joint } = part.channel {
                match (column.parameter, &factors) {
                    (ParameterId::Transmission { joint: of, .. }, Some(slopes)) if of == joint => {
                        let readings = part.postures.iter().zip(&part.weights);
                        for (into, (&posture, weight)) in own.iter_mut().zip(readings) {
                            *into = weight * slopes[posture];
                        }
                    }
                    _ => own.fill(0.0),
                }
            }
            let Some(along) = part.along.as_ref().filter(|_| column.is_of_chain()) else {
                continue;
            };
            for (axis, along) in along[usize::from(column.is_of_base())]
                .iter()
                .enumerate()
                .take(part.width)
            {
                twist.dot(along, lane);
                let own = own.iter_mut().skip(axis).step_by(part.width);
                for (into, &posture) in own.zip(&part.postures) {
                    *into = lane[posture];
                }
            }
        }
    }
}

/// Velocity 1 along, or angular velocity 1 about, an axis of frame (-1).
fn unit_twist(coordinate: usize) -> Twist {
    match coordinate.checked_sub(3) {
        None => Twist {
            linear: Vector3::ith(coordinate, 1.0),
            angular: Vector3::zeros(),
        },
        Some(turn) => Twist {
            linear: Vector3::zeros(),
            angular: Vector3::ith(turn, 1.0),
        },
    }
}
