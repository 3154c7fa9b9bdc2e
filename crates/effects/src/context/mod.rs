//! Inputs of all effects: the base model's angles, distances and sensitivities at every row,
//! with the recorded covariates smoothed.

mod cable;
mod drives;
mod frames;
mod hooks;
mod lines;
mod loads;
mod rows;
mod stream;
mod touches;

use std::ops::Range;

use haptical_calibration::{Channel, Tracked};
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Evaluation, ModelError, Mount, Recording};

use self::frames::Frames;
use self::loads::loads;
use crate::ContextError;
use crate::signal::{LocalMotion, local_motion, smooth, smooth_twice};

use self::cable::{anchor_m, cable_geometry};
pub(crate) use self::rows::moves;
pub use self::rows::runs_of;
use self::rows::{STEP_OF_A_MOTION, is_path, load_reach, step_of_range};
use self::stream::stream_of;

pub use self::cable::CableGeometry;
pub use self::frames::joint_origin_m;
pub use self::lines::Line;
pub use self::stream::{Stream, streams};
pub use self::touches::Touches;

/// Everything effects are computed from.
#[derive(Debug)]
pub struct Context<'a> {
    /// The base model.
    pub device: &'a Device,
    /// What was recorded.
    pub recording: &'a Recording,
    /// Rows of each run.
    pub runs: Vec<Range<usize>>,
    /// Successive rows are successive instants of a motion.
    pub ordered: bool,
    /// What was measured.
    pub streams: Vec<Stream>,
    /// Output angles by the base model, per joint.
    pub output: Vec<Vec<f64>>,
    /// d output / d reading by the base model, per joint.
    pub(crate) slope: Vec<Vec<f64>>,
    /// Motor-side readings with derivatives in time, per joint; none without a time column.
    pub motion: Option<Vec<LocalMotion>>,
    /// Pose derivative per joint and row; empty without links.
    pub twist: Vec<Vec<Twist>>,
    /// Position of the handle, frame (-1) \[m\].
    pub position: Vec<Vector3<f64>>,
    /// Orientation of the handle.
    pub rotation: Vec<Matrix3<f64>>,
    /// The handle as a tracker with a fitted base or tool sees it: per row, or none.
    tracked: Vec<Option<Tracked>>,
    /// Where the tracker stood and what was on the hand, per row; empty where that is the same for all.
    mounts: Vec<Mount>,
    /// Origin of the frame that each joint turns (or slides) in, frame (-1); per joint and row.
    pub(crate) origin: Vec<Vec<Vector3<f64>>>,
    /// The robot's base, frame (-1), per row.
    base_origin_m: Vec<Vector3<f64>>,
    /// Moment of hand and gravity about the robot's base, where either is known; frame (-1).
    pub base_moment_nm: Option<Vec<Vector3<f64>>>,
    /// Moment of hand and gravity beyond each joint about its origin, frame (-1), per joint and row; empty where neither is
    /// known, and of joints that move several rows of the chain.
    pub joint_moment_nm: Vec<Vec<Vector3<f64>>>,
    /// The first cable, where it was recorded.
    pub cable: Option<CableGeometry>,
    /// Torques per joint, recorded and smoothed, or those that masses and hand need \[N m\].
    pub torque_nm: Vec<Option<Vec<f64>>>,
    /// Force of the hand on the handle, frame (-1).
    pub force_n: Option<Vec<Vector3<f64>>>,
    /// Temperature less [`Context::reference_degc`].
    pub warming_k: Option<Vec<f64>>,
    /// Temperature at which nothing has grown: the recording's mean, unless [`Context::set_reference_degc`] says otherwise.
    pub reference_degc: f64,
    touches: Touches,
    /// Spectral lines of what the base model leaves; none until they are looked for.
    pub lines: Vec<Line>,
}

/// Samples on each side over which temperatures are averaged.
const TEMPERATURE_REACH: usize = 50;

/// Vectors with each axis changed as a column.
fn by_axes(vectors: &[Vector3<f64>], change: impl Fn(&Vec<f64>) -> Vec<f64>) -> Vec<Vector3<f64>> {
    let axis = |axis: usize| change(&vectors.iter().map(|vector| vector[axis]).collect());
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let rows = x.into_iter().zip(y).zip(z);
    rows.map(|((x, y), z)| Vector3::new(x, y, z)).collect()
}

/// Motor-side readings with derivatives in time, joint by joint.
fn motions(recording: &Recording, time_s: &[f64], runs: &[Range<usize>]) -> Vec<LocalMotion> {
    let columns = recording.joint.iter();
    let motion = columns.map(|column| local_motion(column, time_s, runs));
    motion.collect()
}

/// Temperatures less their mean, and the mean.
fn warming(degc: Vec<f64>) -> (Vec<f64>, f64) {
    let mean_degc = degc.iter().sum::<f64>() / degc.len().max(1) as f64;
    let warming = degc.into_iter().map(|value| value - mean_degc);
    (warming.collect(), mean_degc)
}

/// Moves a device's joints to readings, and its links with them where they count.
fn moved(
    evaluation: &mut Evaluation<'_>,
    readings: &[f64],
    has_links: bool,
) -> Result<(), ModelError> {
    match has_links {
        true => evaluation.move_to(readings),
        false => {
            let mut each = readings.iter().enumerate();
            each.try_for_each(|(joint, own)| evaluation.move_joint(joint, *own))
        }
    }
}

impl<'a> Context<'a> {
    /// Evaluates the base device at every row.
    ///
    /// # Errors
    /// [`ContextError`] for a row at which the device has no value.
    pub fn new(
        device: &'a Device,
        recording: &'a Recording,
        streams: &[Stream],
    ) -> Result<Self, ContextError> {
        Self::of(device, recording, streams, device.has_links())
    }

    /// For what follows the motion of the drives and their recorded torques alone, where nothing else was measured: without poses, loads
    /// and moments, as of a device without links.
    ///
    /// # Errors
    /// [`ContextError`] for a row at which the device has no value.
    pub fn of_drives(device: &'a Device, recording: &'a Recording) -> Result<Self, ContextError> {
        Self::of(device, recording, &[], false)
    }

    fn of(
        device: &'a Device,
        recording: &'a Recording,
        streams: &[Stream],
        has_links: bool,
    ) -> Result<Self, ContextError> {
        let rows = recording.len();
        let runs = runs_of(recording);
        let step = step_of_range(device, recording, &runs);
        // so closely that noise differs from row to row and effects do not
        let ordered = step.is_some_and(|step| step <= STEP_OF_A_MOTION)
            && is_path(recording, &runs)
            && (recording.time_s.is_some() || !streams.iter().any(Stream::is_touch));
        let load_reach = step.map_or(0, |step| load_reach(step, recording, &runs));
        let streams = streams.to_vec();
        let joints = device.joints.len();
        let mut output = vec![Vec::with_capacity(rows); joints];
        let mut slope = output.clone();
        let mut twist = vec![Vec::with_capacity(rows); if has_links { joints } else { 0 }];
        let (mut position, mut rotation, mut tracked) = (Vec::new(), Vec::new(), Vec::new());
        // a place that the device lacks: the channels' problem says which
        let mounts = device.mounts(recording).unwrap_or_default();
        let mut force = recording.force_n.as_ref().map(|_| Vec::with_capacity(rows));
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; joints];
        for row in 0..rows {
            recording.read_joints(row, &mut readings);
            evaluation.choose_hand(device.hand_at(recording, row));
            moved(&mut evaluation, &readings, has_links).map_err(|source| ContextError::Row {
                line: recording.line.get(row).copied().unwrap_or(0),
                source,
            })?;
            for (joint, (output, slope)) in output.iter_mut().zip(&mut slope).enumerate() {
                output.push(evaluation.output_rad(joint));
                slope.push(evaluation.output_slope(joint));
            }
            if has_links && let Ok(pose) = evaluation.pose() {
                position.push(pose.position_m);
                rotation.push(pose.rotation);
                let mount = mounts.get(row).copied().unwrap_or_default();
                tracked.push(Tracked::new(device, pose, mount));
                for (joint, column) in twist.iter_mut().enumerate() {
                    column.push(evaluation.joint_twist(joint));
                }
                if let (Some(force), Some(axes)) = (&mut force, &recording.force_n) {
                    let local = Vector3::new(axes[0][row], axes[1][row], axes[2][row]);
                    force.push(pose.rotation * local);
                }
            }
        }
        let time_s = recording.time_s.as_deref();
        let motion = time_s.map(|time_s| motions(recording, time_s, &runs));
        let cable = cable_geometry(device, &streams, &position, time_s, &runs);
        let frames = has_links.then(|| Frames::new(device, &output, rows));
        let frames = frames.unwrap_or_default();
        let smoothed =
            |column: &Vec<f64>, reach| smooth(column, if ordered { reach } else { 0 }, &runs);
        let force = force.filter(|force| force.len() == rows);
        let load_reach = if ordered { load_reach } else { 0 };
        let averaged = |column: &Vec<f64>| smooth_twice(column, load_reach, &runs);
        let force_n = force.map(|force| by_axes(&force, averaged));
        let along = (&frames.origin[..], force_n.as_deref());
        let loads = has_links.then(|| loads(device, recording, &output, along));
        let loads = loads.transpose()?.flatten();
        let at_rest = |joint: usize| loads.as_ref().map(|loads| loads.torque_nm[joint].clone());
        let recorded = |joint: usize| recording.torque_nm.get(joint)?.as_ref();
        let read = |joint| Some(averaged(recorded(joint)?));
        let torques = (0..joints).map(|joint| read(joint).or_else(|| at_rest(joint)));
        let torque_nm = torques.collect();
        let (base_moment_nm, joint_moment_nm) = loads
            .map(|loads| (loads.base_moment_nm, loads.joint_moment_nm))
            .unzip();
        let degc = recording.temperature_degc.as_ref();
        let (warming_k, reference_degc) = degc
            .map(|column| warming(smoothed(column, TEMPERATURE_REACH)))
            .unzip();
        Ok(Self {
            device,
            recording,
            runs,
            ordered,
            streams,
            output,
            slope,
            motion,
            twist,
            position,
            rotation,
            tracked,
            mounts,
            origin: frames.origin,
            base_origin_m: frames.base,
            base_moment_nm,
            joint_moment_nm: joint_moment_nm.unwrap_or_default(),
            cable,
            torque_nm,
            force_n,
            warming_k,
            reference_degc: reference_degc.unwrap_or(0.0),
            touches: Touches::new(device, recording),
            lines: Vec::new(),
        })
    }

    /// Takes another temperature for the one at which nothing has grown.
    pub fn set_reference_degc(&mut self, reference_degc: f64) {
        let less = reference_degc - self.reference_degc;
        for warming in self.warming_k.iter_mut().flatten() {
            *warming -= less;
        }
        self.reference_degc = reference_degc;
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.recording.len()
    }

    /// Time since the start of the run \[s\].
    pub fn elapsed_s(&self) -> Option<Vec<f64>> {
        let time_s = self.recording.time_s.as_ref()?;
        let mut elapsed = vec![0.0; time_s.len()];
        for run in &self.runs {
            for row in run.clone() {
                elapsed[row] = time_s[row] - time_s[run.start];
            }
        }
        Some(elapsed)
    }

    /// Where the tracker stood and what was on the hand at a row.
    pub fn mount(&self, row: usize) -> Mount {
        self.mounts.get(row).copied().unwrap_or_default()
    }

    /// The stream of a joint's external encoder.
    pub fn output_stream(&self, joint: usize) -> Option<usize> {
        stream_of(&self.streams, Channel::Output { joint })
    }

    /// The way from the robot's base to the handle, frame (-1).
    pub fn way_from_base(&self, row: usize) -> Vector3<f64> {
        let base = self.base_origin_m.get(row).copied();
        self.position[row] - base.unwrap_or_else(Vector3::zeros)
    }

    /// Mean distance of the first cable; 1 m without one.
    pub(crate) fn mean_length_m(&self) -> f64 {
        self.cable.as_ref().map_or(1.0, |cable| {
            cable.length_m.iter().sum::<f64>() / cable.length_m.len().max(1) as f64
        })
    }

    /// Distance from the exit of a cable (from 0) to the handle at every row \[m\]; none of one that was not recorded.
    pub fn cable_length_m(&self, index: usize) -> Option<Vec<f64>> {
        self.streams_of(Channel::Cable { index }).next()?;
        let anchor = anchor_m(self.device, index);
        Some(self.position.iter().map(|p| (p - anchor).norm()).collect())
    }

    /// A joint's axis and the way from its origin to the handle, frame (-1). None for a sliding joint, for one that moves
    /// several rows of the chain, and where another branch ends at the row's hand.
    pub fn lever(&self, joint: usize, row: usize) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let axis = self.twist.get(joint)?.get(row)?.angular;
        if axis.norm_squared() < 0.5 {
            return None;
        }
        let origin = self.origin.get(joint)?.get(row)?;
        Some((axis, self.position[row] - origin))
    }
}
