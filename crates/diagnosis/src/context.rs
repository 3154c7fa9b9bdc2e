//! What effects are computed from: the base model's angles, distances and sensitivities at every row,
//! with the recorded covariates smoothed.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Evaluation, Recording};

use crate::DiagnosisError;
use crate::frames::Frames;
use crate::loads::loads;
use crate::signal::{LocalMotion, Signal, local_motion, smooth};
use crate::touches::Touches;

/// One measured quantity, an axis of a channel.
#[derive(Debug, Clone)]
pub(crate) struct Stream {
    pub(crate) channel: Channel,
    /// Axis of a position or orientation.
    pub(crate) axis: usize,
    pub(crate) unit: &'static str,
}

impl Stream {
    /// `out2`, `cable`, `position.x`.
    pub(crate) fn name(&self) -> String {
        if self.channel.width() == 1 {
            self.channel.name()
        } else {
            format!("{}.{}", self.channel.name(), ["x", "y", "z"][self.axis])
        }
    }

    pub(crate) fn joint(&self) -> Option<usize> {
        match self.channel {
            Channel::Output { joint } => Some(joint),
            _ => None,
        }
    }

    /// Whether it moves with the handle. Known distances and angles between touched places do not, nor do
    /// encoders and fixtures.
    pub(crate) fn shows_handle(&self) -> bool {
        match self.channel {
            Channel::Cable { .. }
            | Channel::Position
            | Channel::Orientation
            | Channel::Contact
            | Channel::Plane => true,
            Channel::Output { .. }
            | Channel::ContactPair { .. }
            | Channel::PlanePair { .. }
            | Channel::Fixture { .. } => false,
        }
    }

    /// Whether its readings are touches: of a posture each, however close the postures are.
    pub(crate) fn is_touch(&self) -> bool {
        matches!(self.channel, Channel::Contact | Channel::Plane)
    }
}

/// The first cable at every row.
#[derive(Debug, Clone)]
pub(crate) struct CableGeometry {
    pub(crate) stream: usize,
    /// Distance by the model \[m\].
    pub(crate) length_m: Vec<f64>,
    /// From the exit to the handle, frame (-1).
    pub(crate) direction: Vec<Vector3<f64>>,
    /// Where the cable leaves its guide straight.
    pub(crate) exit_axis: Vector3<f64>,
    pub(crate) motion: LocalMotion,
}

/// Everything effects are computed from.
#[derive(Debug)]
pub(crate) struct Context<'a> {
    pub(crate) device: &'a Device,
    pub(crate) recording: &'a Recording,
    pub(crate) runs: Vec<Range<usize>>,
    /// Successive rows are successive instants of a motion.
    pub(crate) ordered: bool,
    pub(crate) streams: Vec<Stream>,
    /// Output angles by the base model, per joint.
    pub(crate) output: Vec<Vec<f64>>,
    /// Motor-side readings with derivatives in time, per joint; none without a time column.
    pub(crate) motion: Option<Vec<LocalMotion>>,
    /// Pose derivative per joint and row; empty without links.
    pub(crate) twist: Vec<Vec<Twist>>,
    pub(crate) position: Vec<Vector3<f64>>,
    /// Orientation of the handle.
    pub(crate) rotation: Vec<Matrix3<f64>>,
    /// Origin of the frame that each joint turns (or slides) in, frame (-1); per joint and row.
    pub(crate) origin: Vec<Vec<Vector3<f64>>>,
    /// The robot's base, frame (-1), per row.
    base_origin_m: Vec<Vector3<f64>>,
    /// Moment of hand and gravity about the robot's base, where either is known; frame (-1).
    pub(crate) base_moment_nm: Option<Vec<Vector3<f64>>>,
    pub(crate) cable: Option<CableGeometry>,
    pub(crate) torque_nm: Vec<Option<Vec<f64>>>,
    /// Force of the hand on the handle, frame (-1).
    pub(crate) force_n: Option<Vec<Vector3<f64>>>,
    /// Temperature less its mean.
    pub(crate) warming_k: Option<Vec<f64>>,
    touches: Touches,
}

/// Samples on each side over which torques and forces are averaged at most, ...
const LOAD_REACH: usize = 4;
/// ... and how far the joints may move meanwhile, as a share of their range.
const LOAD_IS_STEADY: f64 = 0.04;
/// The same for temperatures.
const TEMPERATURE_REACH: usize = 50;

impl<'a> Context<'a> {
    /// Evaluates the base device at every row.
    pub(crate) fn new(
        device: &'a Device,
        recording: &'a Recording,
        streams: &[Stream],
    ) -> Result<Self, DiagnosisError> {
        let rows = recording.len();
        let runs = runs_of(recording);
        let step = step_of_range(recording, &runs);
        // so closely that noise differs from row to row and effects do not
        let ordered = step.is_some_and(|step| step <= STEP_OF_A_MOTION)
            && (recording.time_s.is_some() || !streams.iter().any(Stream::is_touch));
        let load_reach = step.map_or(0, load_reach);
        let streams = streams.to_vec();
        let joints = device.joints.len();
        let mut output = vec![Vec::with_capacity(rows); joints];
        let has_links = device.has_links();
        let mut twist = vec![Vec::with_capacity(rows); if has_links { joints } else { 0 }];
        let mut position = Vec::new();
        let mut rotation = Vec::new();
        let mut force = recording.force_n.as_ref().map(|_| Vec::with_capacity(rows));
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; joints];
        for row in 0..rows {
            for (reading, column) in readings.iter_mut().zip(&recording.joint) {
                *reading = column[row];
            }
            evaluation
                .move_to(&readings)
                .map_err(|source| DiagnosisError::Row {
                    line: recording.line.get(row).copied().unwrap_or(0),
                    source,
                })?;
            for (joint, column) in output.iter_mut().enumerate() {
                column.push(evaluation.output_rad(joint));
            }
            if has_links && let Ok(pose) = evaluation.pose() {
                position.push(pose.position_m);
                rotation.push(pose.rotation);
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
        let motion = time_s.map(|time_s| {
            let columns = recording.joint.iter();
            columns
                .map(|column| local_motion(column, time_s, &runs))
                .collect()
        });
        let cable = cable_geometry(device, &streams, &position, time_s, &runs)?;
        let frames = Frames::new(device, &output, rows);
        let smoothed =
            |column: &Vec<f64>, reach| smooth(column, if ordered { reach } else { 0 }, &runs);
        let force_n: Option<Vec<Vector3<f64>>> =
            force.filter(|force| force.len() == rows).map(|force| {
                let axes: Vec<Vec<f64>> = (0..3)
                    .map(|axis| smoothed(&force.iter().map(|f| f[axis]).collect(), load_reach))
                    .collect();
                (0..rows)
                    .map(|row| Vector3::new(axes[0][row], axes[1][row], axes[2][row]))
                    .collect()
            });
        let loads = loads(device, recording, &output, force_n.as_deref())?;
        let torque_nm = (0..joints)
            .map(|joint| match recording.torque_nm.get(joint) {
                Some(Some(column)) => Some(smoothed(column, load_reach)),
                _ => loads.as_ref().map(|loads| loads.torque_nm[joint].clone()),
            })
            .collect();
        let base_moment_nm = loads.map(|loads| loads.base_moment_nm);
        let warming_k = recording.temperature_degc.as_ref().map(|column| {
            let smoothed = smoothed(column, TEMPERATURE_REACH);
            let mean = smoothed.iter().sum::<f64>() / smoothed.len().max(1) as f64;
            smoothed.into_iter().map(|value| value - mean).collect()
        });
        Ok(Self {
            device,
            recording,
            runs,
            ordered,
            streams,
            output,
            motion,
            twist,
            position,
            rotation,
            origin: frames.origin,
            base_origin_m: frames.base,
            base_moment_nm,
            cable,
            torque_nm,
            force_n,
            warming_k,
            touches: Touches::new(device, recording),
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.recording.len()
    }

    /// Time since the start of the run \[s\].
    pub(crate) fn elapsed_s(&self) -> Option<Vec<f64>> {
        let time_s = self.recording.time_s.as_ref()?;
        let mut elapsed = vec![0.0; time_s.len()];
        for run in &self.runs {
            for row in run.clone() {
                elapsed[row] = time_s[row] - time_s[run.start];
            }
        }
        Some(elapsed)
    }

    /// The stream of a joint's external encoder.
    pub(crate) fn output_stream(&self, joint: usize) -> Option<usize> {
        self.streams
            .iter()
            .position(|stream| stream.joint() == Some(joint))
    }

    /// Derivative of a stream with respect to a joint's output angle, behind its external encoder.
    pub(crate) fn sensitivity(&self, stream: usize, joint: usize, row: usize) -> f64 {
        let Some(twist) = self.twist.get(joint) else {
            return 0.0;
        };
        let twist = &twist[row];
        match self.streams[stream].channel {
            Channel::Output { .. } => 0.0,
            _ => self.seen(stream, row, &twist.linear, &twist.angular),
        }
    }

    /// What a stream of the chain shows of a small displacement of the handle, frame (-1).
    fn seen(
        &self,
        stream: usize,
        row: usize,
        linear: &Vector3<f64>,
        angular: &Vector3<f64>,
    ) -> f64 {
        let Stream { channel, axis, .. } = &self.streams[stream];
        match channel {
            Channel::Cable { index } => self.along_cable(*index, row, linear),
            Channel::Position => linear[*axis],
            Channel::Orientation => angular[*axis],
            Channel::Contact => self.touches.along_contact(*axis, linear),
            Channel::Plane => self.touches.along_plane(row, linear),
            // pairs say nothing of the handle; encoders and fixtures read joints
            Channel::ContactPair { .. }
            | Channel::PlanePair { .. }
            | Channel::Output { .. }
            | Channel::Fixture { .. } => 0.0,
        }
    }

    /// Change of a cable's length when the handle moves.
    fn along_cable(&self, index: usize, row: usize, moved: &Vector3<f64>) -> f64 {
        let anchor = self
            .device
            .cables
            .get(index)
            .map_or([0.0; 3], |c| c.anchor_m);
        let arm = self.position[row] - Vector3::from(anchor);
        let length = arm.norm();
        if length > 0.0 {
            arm.dot(moved) / length
        } else {
            0.0
        }
    }

    /// An error of a joint between motor encoder and external encoder: both the encoder and
    /// everything behind it see it (hook H2 of docs/diagnosis.md).
    pub(crate) fn upstream(&self, joint: usize, error: &[f64]) -> Signal {
        let mut signal = self.downstream(joint, error);
        if let Some(stream) = self.output_stream(joint) {
            signal.parts.push((stream, error.to_vec()));
        }
        // a fixture holds the link: it shows the drive's error as it is
        let fixture = Channel::Fixture { joint };
        if let Some(stream) = self.streams.iter().position(|s| s.channel == fixture) {
            signal.parts.push((stream, error.to_vec()));
        }
        signal
    }

    /// Errors of all joints at once in front of their external encoders, as large as they are: the chain is
    /// evaluated again, because the square of a few hundredths of a radian is more than a cable
    /// encoder's noise.
    pub(crate) fn upstream_of_all(&self, errors: &[Vec<f64>]) -> Signal {
        let mut signal = Signal::default();
        for (joint, error) in errors.iter().enumerate() {
            signal.add(&self.upstream(joint, error), 1.0);
        }
        if self.position.is_empty() {
            return signal;
        }
        let mut evaluation = Evaluation::new(self.device);
        let moved: Vec<Vector3<f64>> = (0..self.rows())
            .map(|row| {
                let output = self.output.iter().zip(errors);
                let output: Vec<f64> = output.map(|(q, error)| q[row] + error[row]).collect();
                let pose = evaluation
                    .move_outputs(&output)
                    .and_then(|()| evaluation.pose());
                pose.map_or(self.position[row], |pose| pose.position_m)
            })
            .collect();
        for (stream, values) in &mut signal.parts {
            for (row, value) in values.iter_mut().enumerate() {
                match self.streams[*stream].channel {
                    Channel::Cable { index } => {
                        let cable = self.device.cables.get(index);
                        let anchor = Vector3::from(cable.map_or([0.0; 3], |c| c.anchor_m));
                        *value =
                            (moved[row] - anchor).norm() - (self.position[row] - anchor).norm();
                    }
                    Channel::Position | Channel::Contact | Channel::Plane => {
                        let way = moved[row] - self.position[row];
                        *value = self.seen(*stream, row, &way, &Vector3::zeros());
                    }
                    _ => {}
                }
            }
        }
        signal
    }

    /// An error of an external encoder alone (H3).
    pub(crate) fn encoder(&self, joint: usize, error: &[f64]) -> Signal {
        let stream = self.output_stream(joint);
        Signal {
            parts: stream
                .map(|stream| (stream, error.to_vec()))
                .into_iter()
                .collect(),
        }
    }

    /// An error of a joint behind its external encoder (H4).
    pub(crate) fn downstream(&self, joint: usize, error: &[f64]) -> Signal {
        let parts = (0..self.streams.len())
            .filter(|&stream| self.streams[stream].shows_handle())
            .map(|stream| {
                let values = error
                    .iter()
                    .enumerate()
                    .map(|(row, error)| error * self.sensitivity(stream, joint, row));
                (stream, values.collect())
            })
            .collect();
        Signal { parts }
    }

    /// An error of the first cable's reading alone (H6).
    pub(crate) fn cable_error(&self, error: Vec<f64>) -> Signal {
        let stream = self.cable.as_ref().map(|cable| cable.stream);
        Signal {
            parts: stream.map(|stream| (stream, error)).into_iter().collect(),
        }
    }

    /// A small displacement of the handle, `(translation, rotation)` in frame (-1) (H5).
    pub(crate) fn handle(&self, moved: impl Fn(usize) -> (Vector3<f64>, Vector3<f64>)) -> Signal {
        let moved: Vec<_> = (0..self.rows()).map(moved).collect();
        let parts = (0..self.streams.len())
            .filter(|&stream| self.streams[stream].shows_handle())
            .map(|stream| {
                let moved = moved.iter().enumerate();
                let values =
                    moved.map(|(row, (linear, angular))| self.seen(stream, row, linear, angular));
                (stream, values.collect())
            })
            .collect();
        Signal { parts }
    }

    /// The way from the robot's base to the handle, frame (-1).
    pub(crate) fn way_from_base(&self, row: usize) -> Vector3<f64> {
        let base = self.base_origin_m.get(row).copied();
        self.position[row] - base.unwrap_or_else(Vector3::zeros)
    }

    /// A joint's axis and the way from its origin to the handle, frame (-1). None for a sliding joint.
    pub(crate) fn lever(&self, joint: usize, row: usize) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let axis = self.twist.get(joint)?.get(row)?.angular;
        if axis.norm_squared() < 0.5 {
            return None;
        }
        let origin = self.origin.get(joint)?.get(row)?;
        Some((axis, self.position[row] - origin))
    }
}

/// The streams of channels, axis by axis.
pub(crate) fn streams(device: &Device, channels: &[Channel]) -> Vec<Stream> {
    channels
        .iter()
        .flat_map(|&channel| {
            (0..channel.width()).map(move |axis| Stream {
                channel,
                axis,
                unit: channel.unit(device),
            })
        })
        .collect()
}

fn cable_geometry(
    device: &Device,
    streams: &[Stream],
    position: &[Vector3<f64>],
    time_s: Option<&[f64]>,
    runs: &[Range<usize>],
) -> Result<Option<CableGeometry>, DiagnosisError> {
    let Some(stream) = streams
        .iter()
        .position(|stream| stream.channel == Channel::Cable { index: 0 })
    else {
        return Ok(None);
    };
    let cable = device.cables.first();
    let anchor = Vector3::from(cable.map_or([0.0; 3], |cable| cable.anchor_m));
    let length_m: Vec<f64> = position.iter().map(|p| (p - anchor).norm()).collect();
    let direction: Vec<Vector3<f64>> = position
        .iter()
        .map(|p| (p - anchor).try_normalize(1e-12).unwrap_or(Vector3::x()))
        .collect();
    let exit_axis = match cable.and_then(|cable| cable.exit_axis) {
        Some(axis) => Vector3::from(axis),
        None => {
            let mut home = Evaluation::new(device);
            let readings = vec![0.0; device.joints.len()];
            match home.move_to(&readings) {
                Ok(()) => home
                    .pose()
                    .map_or(Vector3::x(), |pose| pose.position_m - anchor),
                Err(_) => direction.iter().sum(),
            }
        }
    };
    let motion = match time_s {
        Some(time_s) => local_motion(&length_m, time_s, runs),
        None => LocalMotion::default(),
    };
    Ok(Some(CableGeometry {
        stream,
        length_m,
        direction,
        exit_axis: exit_axis.try_normalize(1e-12).unwrap_or(Vector3::x()),
        motion,
    }))
}

/// Rows of one run each; a log without runs is one run.
fn runs_of(recording: &Recording) -> Vec<Range<usize>> {
    let rows = recording.len();
    let mut runs = Vec::new();
    let mut start = 0;
    for row in 1..=rows {
        let ends = row == rows
            || recording
                .run
                .as_ref()
                .is_some_and(|run| run[row] != run[row - 1])
            || recording
                .time_s
                .as_ref()
                .is_some_and(|time_s| time_s[row] <= time_s[row - 1]);
        if ends {
            runs.push(start..row);
            start = row;
        }
    }
    runs
}

/// A step between rows of at most this share of a joint's range is one of a motion, not one between postures.
const STEP_OF_A_MOTION: f64 = 0.05;
/// Fewer rows are taken as single postures.
const ROWS_OF_A_MOTION: usize = 64;

/// Samples on each side over which loads hardly change.
fn load_reach(step: f64) -> usize {
    if step * LOAD_REACH as f64 <= LOAD_IS_STEADY {
        LOAD_REACH
    } else {
        (LOAD_IS_STEADY / step) as usize
    }
}

/// Motion between successive rows: the median step of the joint that moves most, over its range; none for
/// a few rows, or where nothing moves between rows.
fn step_of_range(recording: &Recording, runs: &[Range<usize>]) -> Option<f64> {
    if recording.len() < ROWS_OF_A_MOTION {
        return None;
    }
    let mut largest: f64 = 0.0;
    for column in &recording.joint {
        let low = column.iter().copied().fold(f64::INFINITY, f64::min);
        let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if high <= low {
            continue;
        }
        let steps: Vec<f64> = runs
            .iter()
            .flat_map(|run| {
                (run.start + 1..run.end).map(|row| (column[row] - column[row - 1]).abs())
            })
            .collect();
        largest = largest.max(haptical_metrics::median(&steps).ok()? / (high - low));
    }
    Some(largest)
}
