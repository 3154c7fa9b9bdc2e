//! The variance that the steps of readings add to what a channel of the handle sees, a tile of postures at a time.

use std::ops::Range;

use haptical_batch::{POSTURES, ScrewTile, TwistLanes};
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceChain, Drive, Evaluation, Mount, Recording};

use super::columns::moved;
use super::hands::by_hand;
use crate::Channel;
use crate::problem::channel::with_kind;
use crate::problem::lanes::transmission::values_and_slopes;
use crate::problem::loads::Loads;
use crate::problem::measurement::kind::{Measurement, Posture, is_of_handle};
use crate::problem::measurement::tracked::Mountings;

/// Sum over the joints of `quanta`, the variance of each reading's rounding, times the square of the residual's
/// sensitivity, row by row; zero where a touch has no reading. None where the channel is of no handle, a row does not say
/// which hand it is about, or a number is refused: the form row by row names it. `mounts` are those of the recording.
pub(crate) fn variances(
    (device, recording, channel): (&Device, &Recording, Channel),
    (loads, mounts): (Option<&Loads>, &[Mount]),
    quanta: &[f64],
    rows: &Range<usize>,
) -> Option<Vec<f64>> {
    if !with_kind!(channel, kind => is_of_handle(&kind)) {
        return None;
    }
    let (mut outputs, mut slopes) = (Vec::new(), Vec::new());
    for joint in 0..device.joints.len() {
        let own = recording.joint.get(joint)?.get(rows.clone())?;
        let (errors, own_slopes) = values_and_slopes(device, joint, own)?;
        let sums = own
            .iter()
            .zip(errors)
            .map(|(reading, error)| reading + error);
        outputs.push(sums.collect::<Vec<f64>>());
        slopes.push(own_slopes);
    }
    let stepped: Vec<usize> = (0..quanta.len())
        .filter(|&joint| quanta[joint] != 0.0)
        .collect();
    let run = Run {
        whole: (device, recording, channel),
        loads,
        quanta,
        start: rows.start,
        outputs,
        slopes,
        mountings: Mountings::new(device, mounts.get(rows.clone()).unwrap_or(&[])),
        mounts,
        stepped,
    };
    let mut made = vec![0.0; rows.len()];
    for (hand, own) in by_hand(device, recording, rows)? {
        run.of_hand(hand, &own, &mut made)?;
    }
    made.iter()
        .all(|variance| variance.is_finite())
        .then_some(made)
}

/// Some rows of a channel.
struct Run<'a> {
    whole: (&'a Device, &'a Recording, Channel),
    loads: Option<&'a Loads>,
    quanta: &'a [f64],
    /// First row.
    start: usize,
    /// Joint by joint.
    outputs: Vec<Vec<f64>>,
    slopes: Vec<Vec<f64>>,
    mounts: &'a [Mount],
    mountings: Mountings,
    /// Joints whose readings come in steps.
    stepped: Vec<usize>,
}

impl Run<'_> {
    /// The variances of one hand's rows, the entries `own` of the run.
    fn of_hand(&self, hand: usize, own: &[usize], made: &mut [f64]) -> Option<()> {
        let (device, recording, channel) = self.whole;
        let chain = DeviceChain::of_hand(device, hand);
        let table = chain.chain().ok()?;
        let drives = chain.drives();
        if drives.len() != table.joint_count() {
            return None;
        }
        let moves = |joint: usize| {
            let own = drives.iter().zip(1..);
            own.filter(move |(drive, _)| drive.joint == joint)
        };
        let place = |(drive, row): (&Drive, usize)| (row, moved(drive));
        let joints = self.stepped.iter();
        let wanted: Vec<_> = joints.flat_map(|&joint| moves(joint).map(place)).collect();
        let mut tile = ScrewTile::default();
        let mut variables = vec![[0.0; POSTURES]; drives.len()];
        let mut twists = vec![TwistLanes::default(); self.stepped.len()];
        let mut term = TwistLanes::default();
        let mut evaluation = Evaluation::new(device);
        evaluation.choose_hand(Some(hand));
        let mut of_row = vec![0.0; device.joints.len()];
        for entries in own.chunks(POSTURES) {
            for (drive, variable) in drives.iter().zip(&mut variables) {
                let compliance = device.compliance_rad_per_nm(drive.joint);
                let last = entries.last().into_iter().cycle();
                for (variable, &entry) in variable.iter_mut().zip(entries.iter().chain(last)) {
                    let torque = self
                        .loads
                        .map_or(0.0, |loads| loads.of_row(self.start + entry)[drive.joint]);
                    let angle = self.outputs[drive.joint][entry] - compliance * torque;
                    *variable = drive.multiplier * angle;
                }
            }
            if !tile.sweep(&table, &variables, &wanted) {
                return None;
            }
            for (&joint, twist) in self.stepped.iter().zip(&mut twists) {
                *twist = TwistLanes::default();
                for (drive, row) in moves(joint) {
                    tile.twist(row, moved(drive), &mut term);
                    twist.add(&term, drive.multiplier);
                }
            }
            for (posture, &entry) in entries.iter().enumerate() {
                let row = self.start + entry;
                let subject = channel.subject(device, recording, row);
                if subject.is_some() && !channel.has_reading(recording, row) {
                    continue;
                }
                for (output, own) in of_row.iter_mut().zip(&self.outputs) {
                    *output = own[entry];
                }
                evaluation.place(&of_row, tile.pose(posture)).ok()?;
                let at = Posture {
                    device,
                    evaluation: &evaluation,
                    recording,
                    row,
                    subject: subject.and_then(Result::ok).unwrap_or(usize::MAX),
                    mount: self.mounts.get(row).copied().unwrap_or_default(),
                    mountings: &self.mountings,
                };
                for (&joint, twist) in self.stepped.iter().zip(&twists) {
                    let twist = twist_of(twist, posture, self.slopes[joint][entry]);
                    let square = with_kind!(channel, kind => kind.sensitivity_square(&at, &twist));
                    made[entry] += self.quanta[joint] * square.ok()?;
                }
            }
        }
        Some(())
    }
}

/// A posture's twist times a number.
fn twist_of(lanes: &TwistLanes, posture: usize, factor: f64) -> Twist {
    let of = |lanes: &[[f64; POSTURES]; 3]| {
        Vector3::from(lanes.each_ref().map(|lane| factor * lane[posture]))
    };
    Twist {
        linear: of(&lanes.linear),
        angular: of(&lanes.angular),
    }
}
