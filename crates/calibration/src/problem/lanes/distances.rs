//! The second step's problem in lanes: a chain's parameters from one distance, at joint angles that stay.

use haptical_batch::{DistanceModel, PoseBatch, Sines};
use haptical_model::{Device, ParameterId, Recording};

use crate::Channel;

/// A chain and its poses, as the batch wants them.
#[derive(Debug)]
pub(crate) struct Distances {
    pub(crate) model: DistanceModel,
    pub(crate) poses: PoseBatch,
}

impl Distances {
    /// `outputs` holds the output angles row by row, `rows` the rows with a reading and `weights` one over the
    /// standard deviation of each. None where the problem is another one, or where a number is refused: the
    /// general form then says which, with its line of the log.
    pub(crate) fn new(
        device: &Device,
        recording: &Recording,
        parameters: &[ParameterId],
        channel: Channel,
        outputs: &[f64],
        (rows, weights): (&[usize], &[f64]),
    ) -> Option<Self> {
        let Channel::Cable { index } = channel else {
            return None;
        };
        let cable = device.cables.get(index);
        if !device.is_plain_table() || cable.is_some_and(|cable| !cable.is_plain()) {
            return None;
        }
        let parameters: Vec<_> = parameters
            .iter()
            .map(|parameter| match parameter {
                ParameterId::Link { row, parameter } => Some((*row, *parameter)),
                _ => None,
            })
            .collect::<Option<_>>()?;
        let motions = device.motions();
        let anchor_m = device
            .cables
            .get(index)
            .map_or([0.0; 3], |cable| cable.anchor_m);
        let model = DistanceModel::new(device.convention, &device.links, &motions, anchor_m)
            .ok()?
            .with_parameters(&parameters)
            .ok()?;
        // the links keep their own theta: what the home pose adds stands with the joint
        let joints = device.joints.len();
        let angles: Vec<Vec<f64>> = device
            .joints
            .iter()
            .enumerate()
            .map(|(joint, described)| {
                let angles = rows.iter().map(|row| outputs[row * joints + joint]);
                angles.map(|angle| angle + described.home_rad).collect()
            })
            .collect();
        let cable = recording.cable_m.get(index)?.as_ref()?;
        let distances_m: Vec<f64> = rows.iter().map(|&row| cable[row]).collect();
        let poses = PoseBatch::new(&motions, &angles, &distances_m, weights, Sines::Cached).ok()?;
        Some(Self { model, poses })
    }
}
