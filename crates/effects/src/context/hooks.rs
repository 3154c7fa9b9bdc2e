//! Changes of the measured streams by an error, for each hook where it may enter (docs/diagnosis.md).

use haptical_calibration::{Channel, Tracked};
use haptical_model::Evaluation;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Pose, Twist};

use super::cable::anchor_m;
use super::stream::stream_of;
use super::{Context, Stream};
use crate::Hook;
use crate::signal::Signal;

impl Context<'_> {
    /// Derivative of a stream with respect to a joint's output angle, behind its external encoder.
    pub fn sensitivity(&self, stream: usize, joint: usize, row: usize) -> f64 {
        let Some(twist) = self.twist.get(joint) else {
            return 0.0;
        };
        let twist = &twist[row];
        self.seen(stream, row, &twist.linear, &twist.angular)
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
            Channel::Position => self.carried(row, linear, angular).linear[*axis],
            Channel::Orientation => self.carried(row, linear, angular).angular[*axis],
            Channel::Contact => {
                let moved = self.touching(row, linear, angular);
                self.touches.along_contact(*axis, &moved)
            }
            Channel::Plane => {
                let moved = self.touching(row, linear, angular);
                self.touches.along_plane(row, &moved)
            }
            // pairs say nothing of the handle; encoders and fixtures read joints
            Channel::ContactPair { .. }
            | Channel::PlanePair { .. }
            | Channel::Output { .. }
            | Channel::Fixture { .. } => 0.0,
        }
    }

    /// What a tracker sees of a small displacement of the handle, in its own axes.
    fn carried(&self, row: usize, linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
        let twist = Twist {
            linear: *linear,
            angular: *angular,
        };
        let tracked = self.tracked.get(row).copied().flatten();
        tracked.map_or(twist, |tracked| tracked.carried(&twist))
    }

    /// How what touches moves when the handle does.
    fn touching(&self, row: usize, linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector3<f64> {
        linear + angular.cross(&self.arm_of(row, &self.rotation[row]))
    }

    /// From the handle to what touches at a row, with the handle turned so.
    fn arm_of(&self, row: usize, rotation: &Matrix3<f64>) -> Vector3<f64> {
        rotation * self.device.touching_m(self.mount(row))
    }

    /// Change of a cable's length when the handle moves.
    fn along_cable(&self, index: usize, row: usize, moved: &Vector3<f64>) -> f64 {
        let arm = self.position[row] - anchor_m(self.device, index);
        let length = arm.norm();
        if length > 0.0 {
            arm.dot(moved) / length
        } else {
            0.0
        }
    }

    /// An error of a joint between motor encoder and external encoder: both the encoder and
    /// everything behind it see it (hook H2 of docs/diagnosis.md).
    pub fn upstream(&self, joint: usize, error: &[f64]) -> Signal {
        let mut signal = self.downstream(joint, error);
        if let Some(stream) = self.output_stream(joint) {
            signal.parts.push((stream, error.to_vec()));
        }
        // a fixture holds the link: it shows the drive's error as it is
        let fixture = Channel::Fixture { joint };
        if let Some(stream) = stream_of(&self.streams, fixture) {
            signal.parts.push((stream, error.to_vec()));
        }
        signal
    }

    /// An error of a joint's angle or torque, or of the first cable's length, where it enters.
    pub(crate) fn entering(&self, hook: Hook, joint: Option<usize>, error: &[f64]) -> Signal {
        match (hook, joint) {
            (Hook::Transmission, Some(joint)) => self.upstream(joint, error),
            (Hook::ExternalEncoder, Some(joint)) => self.encoder(joint, error),
            (Hook::Joint, Some(joint)) => self.downstream(joint, error),
            (Hook::CableSensor, _) => self.cable_error(error.to_vec()),
            (Hook::Torque, Some(joint)) => self.drive(joint, error.to_vec()),
            _ => Signal::default(),
        }
    }

    /// Errors of all joints at once in front of their external encoders, as large as they are: the chain is
    /// evaluated again, because the square of a few hundredths of a radian is more than a cable
    /// encoder's noise.
    pub fn upstream_of_all(&self, errors: &[Vec<f64>]) -> Signal {
        let mut signal = Signal::default();
        for (joint, error) in errors.iter().enumerate() {
            signal.add(&self.upstream(joint, error), 1.0);
        }
        let errors: Vec<(usize, &[f64])> = errors.iter().map(Vec::as_slice).enumerate().collect();
        self.exactly(signal, &errors)
    }

    /// A signal of errors of joints (from 0), of which the chain's part is worked out with the chain moved so far; its
    /// orientations stay those to first order.
    pub(crate) fn exactly(&self, mut signal: Signal, errors: &[(usize, &[f64])]) -> Signal {
        if self.position.is_empty() {
            return signal;
        }
        let mut evaluation = Evaluation::new(self.device);
        let moved: Vec<Pose> = (0..self.rows())
            .map(|row| {
                let mut output: Vec<f64> = self.output.iter().map(|q| q[row]).collect();
                for (joint, error) in errors {
                    output[*joint] += error[row];
                }
                evaluation.choose_hand(self.device.hand_at(self.recording, row));
                let pose = evaluation
                    .move_outputs(&output)
                    .and_then(|()| evaluation.pose());
                pose.map_or(self.pose(row), |pose| *pose)
            })
            .collect();
        for (stream, values) in &mut signal.parts {
            for (row, value) in values.iter_mut().enumerate() {
                match self.streams[*stream].channel {
                    Channel::Cable { index } => {
                        let anchor = anchor_m(self.device, index);
                        *value = (moved[row].position_m - anchor).norm()
                            - (self.position[row] - anchor).norm();
                    }
                    Channel::Position => {
                        let way =
                            self.tracked_m(row, &moved[row]) - self.tracked_m(row, &self.pose(row));
                        *value = way[self.streams[*stream].axis];
                    }
                    Channel::Contact | Channel::Plane => {
                        let turned = self.arm_of(row, &moved[row].rotation)
                            - self.arm_of(row, &self.rotation[row]);
                        let way = moved[row].position_m - self.position[row] + turned;
                        *value = self.seen(*stream, row, &way, &Vector3::zeros());
                    }
                    _ => {}
                }
            }
        }
        signal
    }

    fn pose(&self, row: usize) -> Pose {
        Pose {
            position_m: self.position[row],
            rotation: self.rotation[row],
        }
    }

    /// The position that a tracker sees of a handle \[m\], in its own frame.
    fn tracked_m(&self, row: usize, handle: &Pose) -> Vector3<f64> {
        let tracked = Tracked::new(self.device, handle, self.mount(row));
        tracked.map_or(handle.position_m, |tracked| tracked.pose().position_m)
    }

    /// An error of an external encoder alone (H3).
    pub fn encoder(&self, joint: usize, error: &[f64]) -> Signal {
        on_one(self.output_stream(joint), error.to_vec())
    }

    /// An error of a joint behind its external encoder (H4).
    pub fn downstream(&self, joint: usize, error: &[f64]) -> Signal {
        self.on_handle(|stream, row| error[row] * self.sensitivity(stream, joint, row))
    }

    /// An error of the first cable's reading alone (H6).
    pub fn cable_error(&self, error: Vec<f64>) -> Signal {
        on_one(self.cable.as_ref().map(|cable| cable.stream), error)
    }

    /// What a tracker reads when its own frame is displaced a little, `(translation, rotation)` in that frame.
    pub fn tracker(&self, moved: impl Fn(usize) -> (Vector3<f64>, Vector3<f64>)) -> Signal {
        let mut signal = Signal::default();
        for channel in [Channel::Position, Channel::Orientation] {
            for (axis, stream) in self.streams_of(channel).enumerate() {
                let value = |row: usize| {
                    let (shift, tilt) = moved(row);
                    match channel {
                        Channel::Position => {
                            let seen = self.tracked_m(row, &self.pose(row));
                            -(shift + tilt.cross(&seen))[axis]
                        }
                        _ => -tilt[axis],
                    }
                };
                signal
                    .parts
                    .push((stream, (0..self.rows()).map(value).collect()));
            }
        }
        signal
    }

    /// What a tracker reads per unit of scale: the place of what it tracks, in its own frame.
    pub fn tracker_scaled(&self) -> Signal {
        let mut signal = Signal::default();
        for (axis, stream) in self.streams_of(Channel::Position).enumerate() {
            let rows = 0..self.rows();
            let values = rows.map(|row| self.tracked_m(row, &self.pose(row))[axis]);
            signal.parts.push((stream, values.collect()));
        }
        signal
    }

    /// A small displacement of the handle, `(translation, rotation)` in frame (-1) (H5).
    pub fn handle(&self, moved: impl Fn(usize) -> (Vector3<f64>, Vector3<f64>)) -> Signal {
        let moved: Vec<_> = (0..self.rows()).map(moved).collect();
        self.on_handle(|stream, row| {
            let (linear, angular) = &moved[row];
            self.seen(stream, row, linear, angular)
        })
    }

    /// A signal on every stream that moves with the handle, from its values by stream and row.
    fn on_handle(&self, value: impl Fn(usize, usize) -> f64) -> Signal {
        let shown = (0..self.streams.len()).filter(|&stream| self.streams[stream].shows_handle());
        let values = |stream: usize| (0..self.rows()).map(|row| value(stream, row)).collect();
        Signal {
            parts: shown.map(|stream| (stream, values(stream))).collect(),
        }
    }
}

/// A signal on one stream, where the recording has it.
pub(super) fn on_one(stream: Option<usize>, values: Vec<f64>) -> Signal {
    Signal {
        parts: stream.map(|stream| (stream, values)).into_iter().collect(),
    }
}
