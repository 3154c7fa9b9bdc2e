//! Torques of the drives: what errors of the drives and of the hand's force sensor show on them
//! (docs/diagnosis-force.md).

use haptical_model::kinematics::nalgebra::Vector3;

use super::Context;
use super::hooks::on_one;
use crate::signal::{LocalMotion, Signal, smooth};

/// Time on each side over which rates are averaged \[s\], and the rows of it that they are already.
const MOTION_REACH_S: f64 = 0.03;
const LOCAL_REACH: usize = 3;

impl Context<'_> {
    /// A joint's torque readings, where there are any.
    pub fn recorded_torque_nm(&self, joint: usize) -> Option<&[f64]> {
        let values = self.recording.torque_nm.get(joint)?.as_ref()?;
        let is_read = values.iter().any(|value| value.is_finite());
        is_read.then_some(values.as_slice())
    }

    /// Stream of a joint's recorded torque; these streams follow the others, joint after joint.
    pub fn torque_stream(&self, joint: usize) -> Option<usize> {
        self.recorded_torque_nm(joint)?;
        Some(self.streams.len() + joint)
    }

    /// An error of one drive's torque.
    pub fn drive(&self, joint: usize, error: Vec<f64>) -> Signal {
        on_one(self.torque_stream(joint), error)
    }

    /// A force that the sensor reads and the hand does not exert, in the handle's frame: every torque is then taken to
    /// exceed what the links need by the transposed Jacobian times that force.
    pub fn sensor(&self, error_n: impl Fn(usize) -> Vector3<f64>) -> Signal {
        let errors: Vec<Vector3<f64>> = (0..self.rows()).map(error_n).collect();
        let along = |joint: usize| {
            let rows = errors.iter().enumerate();
            rows.map(|(row, error)| self.arm(joint, row).dot(error))
                .collect()
        };
        let joints = 0..self.twist.len();
        let parts = joints.filter_map(|joint| Some((self.torque_stream(joint)?, along(joint))));
        Signal {
            parts: parts.collect(),
        }
    }

    /// Row of the transposed Jacobian in the handle's frame: times a force of the handle on the hand it is the torque
    /// \[N m\] that the joint's drive exerts for it.
    pub fn arm(&self, joint: usize, row: usize) -> Vector3<f64> {
        self.rotation[row].tr_mul(&self.twist[joint][row].linear)
    }

    /// Readings of the force sensor along an axis of the handle's frame.
    pub(crate) fn read_force_n(&self, axis: usize) -> Vec<f64> {
        match &self.recording.force_n {
            Some(axes) => axes[axis].clone(),
            None => vec![0.0; self.rows()],
        }
    }

    /// A joint's reading with its rates, averaged further than [`Context::motion`] where the rows are so close that
    /// counts show in them; none without a time column.
    pub fn drive_motion(&self, joint: usize) -> Option<LocalMotion> {
        let mut motion = self.motion.as_ref()?.get(joint)?.clone();
        let reach = self.drive_reach();
        if reach > 0 {
            motion.velocity = smooth(&motion.velocity, reach, &self.runs);
            motion.acceleration = smooth(&motion.acceleration, reach, &self.runs);
        }
        Some(motion)
    }

    /// Rows on each side over which rates and accelerations are averaged beyond their local fits.
    pub(crate) fn drive_reach(&self) -> usize {
        ((MOTION_REACH_S / self.step_s()) as usize).saturating_sub(LOCAL_REACH)
    }

    /// Median time between rows \[s\]; 1 s where they have none.
    pub fn step_s(&self) -> f64 {
        let Some(time_s) = &self.recording.time_s else {
            return 1.0;
        };
        let mut steps: Vec<f64> = Vec::new();
        for run in &self.runs {
            steps.extend(time_s[run.clone()].windows(2).map(|pair| pair[1] - pair[0]));
        }
        if steps.is_empty() {
            return 1.0;
        }
        let middle = steps.len() / 2;
        let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        median.max(1e-9)
    }
}
