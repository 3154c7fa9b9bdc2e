//! Residuals and derivatives of a recording, a tile of postures at a time: the chain in lanes, readings one by one.

mod columns;
mod hands;
mod joints;
mod reading;
#[cfg(test)]
mod tests;
pub(crate) mod variances;

use std::ops::Range;

use haptical_batch::{Lane, POSTURES, ScrewTile, TwistLanes};
use haptical_identification::Matrix;
use haptical_model::{Device, DeviceChain, Evaluation, ParameterId};

use crate::{Channel, DeviceProblem};
use columns::Column;
use hands::by_hand;
use joints::JointRows;
use reading::{Besides, Part};

/// Rows from which a tile is worth it.
const FEWEST_ROWS: usize = 8;

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
    /// chain is not asked for, or a row does not say which hand it is about, or a number is refused, which the form row by
    /// row names.
    pub(crate) fn run_tiles(
        &self,
        device: &Device,
        rows: &Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        if !self.sees_chain || rows.len() < FEWEST_ROWS {
            return None;
        }
        let free = jacobian.as_ref().map_or(&[][..], |(free, _)| *free);
        let joints = JointRows::new(self, device, rows, free)?;
        for (hand, own) in by_hand(device, self.recording, rows)? {
            let chain = DeviceChain::of_hand(device, hand);
            self.run_hand(
                device,
                (hand, &chain),
                (rows.start, &own),
                firsts,
                &joints,
                residuals,
                jacobian,
            )?;
        }
        Some(())
    }

    /// The same of the rows of one hand, the entries `own` of the run from row `start` on.
    #[expect(
        clippy::too_many_arguments,
        reason = "the rows of a hand, with where their numbers go"
    )]
    fn run_hand(
        &self,
        device: &Device,
        (hand, chain): (usize, &DeviceChain),
        (start, own): (usize, &[usize]),
        firsts: &[usize],
        joints: &JointRows,
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        let free = jacobian.as_ref().map_or(&[][..], |(free, _)| *free);
        let table = chain.chain().ok()?;
        let drives = chain.drives();
        if drives.len() != table.joint_count() {
            return None;
        }
        let columns: Vec<Column> = free
            .iter()
            .map(|&index| Column::new(self.parameters[index], chain))
            .collect();
        let wanted: Vec<_> = columns.iter().flat_map(Column::wanted).collect();
        let besides = Besides::new(free.iter().map(|&index| self.parameters[index]));
        let mut parts: Vec<Part> = self.parts(start, firsts, jacobian.is_some());
        let end = own.last().map_or(start, |last| start + last + 1);
        let mountings = self.mountings(device, &(start..end));
        let mut evaluation = Evaluation::new(device);
        evaluation.choose_hand(Some(hand));
        let mut outputs = vec![0.0; device.joints.len()];
        let mut room = Room {
            tile: ScrewTile::default(),
            variables: vec![[0.0; POSTURES]; drives.len()],
            term: TwistLanes::default(),
            twist: TwistLanes::default(),
            lane: [0.0; POSTURES],
        };
        for entries in own.chunks(POSTURES) {
            for (drive, variable) in drives.iter().zip(&mut room.variables) {
                let compliance = device.compliance_rad_per_nm(drive.joint);
                let yielded = |entry: usize| {
                    let loads = self.loads.as_ref();
                    loads.map_or(0.0, |loads| {
                        compliance * loads.of_row(start + entry)[drive.joint]
                    })
                };
                joints.variable(drive, entries, yielded, variable);
            }
            if !room.tile.sweep(&table, &room.variables, &wanted) {
                return None;
            }
            for (posture, &entry) in entries.iter().enumerate() {
                for (output, own) in outputs.iter_mut().zip(&joints.outputs) {
                    *output = own[entry];
                }
                evaluation.place(&outputs, room.tile.pose(posture)).ok()?;
                self.readings(
                    (start + entry, posture),
                    (device, &mountings, &besides),
                    &mut evaluation,
                    &mut parts,
                    residuals,
                    jacobian,
                )?;
            }
            if let Some((_, matrix)) = jacobian {
                for (position, column) in columns.iter().enumerate() {
                    let into = matrix.column_mut(position);
                    self.column(column, joints, (start, entries), &mut room, &parts, into);
                }
            }
            parts.iter_mut().for_each(Part::clear);
        }
        Some(())
    }

    /// The derivatives by one parameter that a twist of the handle or a transmission's slope gives, of all channels in
    /// the tile. `start` is the first row of the run, `entries` are the tile's rows in it.
    fn column(
        &self,
        column: &Column,
        joints: &JointRows,
        (start, entries): (usize, &[usize]),
        room: &mut Room,
        parts: &[Part],
        into: &mut [f64],
    ) {
        let factors = match column.parameter {
            ParameterId::Transmission { joint, index } => {
                Some(joints.slope_lane(joint, index, entries))
            }
            ParameterId::Compliance { joint } => {
                let mut lane = [0.0; POSTURES];
                let loads = self.loads.as_ref();
                for (into, entry) in lane.iter_mut().zip(entries) {
                    *into = loads.map_or(0.0, |loads| -loads.of_row(start + entry)[joint]);
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
            if let Channel::Output { joint } = part.channel {
                match (column.parameter, &factors) {
                    (ParameterId::Transmission { joint: of, .. }, Some(slopes)) if of == joint => {
                        let readings = part.postures.iter().zip(&part.weights);
                        for (&place, (&posture, weight)) in part.places.iter().zip(readings) {
                            into[place] = weight * slopes[posture];
                        }
                    }
                    _ => part.places.iter().for_each(|&place| into[place] = 0.0),
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
                for (place, &posture) in part.places.iter().zip(&part.postures) {
                    into[place + axis] = lane[posture];
                }
            }
        }
    }
}
