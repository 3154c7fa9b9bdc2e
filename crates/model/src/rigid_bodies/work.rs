//! Room for the numbers of an evaluation of rigid bodies.

use haptical_dynamics::Scratch;
use haptical_kinematics::Pose;

/// Room for the numbers of one evaluation of [`crate::RigidBodies`], made by [`crate::RigidBodies::work`] and used again:
/// nothing is allocated after that.
#[derive(Debug, Clone)]
pub struct MotionWork {
    pub(crate) scratch: Vec<Scratch>,
    /// Positions, velocities, accelerations and torques of the rows.
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) ddq: Vec<f64>,
    pub(crate) tau: Vec<f64>,
    /// Two matrices of rows by rows.
    pub(crate) matrices: [Vec<f64>; 2],
    /// Rows by ten for each row.
    pub(crate) regressor: Vec<f64>,
    /// Joints by joints.
    pub(crate) joint_matrix: Vec<f64>,
    pub(crate) joint_vector: Vec<f64>,
}

impl MotionWork {
    pub(crate) fn new(bodies: usize, joints: usize) -> Self {
        let square = || vec![0.0; bodies * bodies];
        Self {
            scratch: vec![Scratch::default(); bodies],
            q: vec![0.0; bodies],
            dq: vec![0.0; bodies],
            ddq: vec![0.0; bodies],
            tau: vec![0.0; bodies],
            matrices: [square(), square()],
            regressor: vec![0.0; 10 * bodies * bodies],
            joint_matrix: vec![0.0; joints * joints],
            joint_vector: vec![0.0; joints],
        }
    }

    /// The frame of a body (from 0) in frame (-1), at the positions of the last evaluation that succeeded.
    pub fn pose(&self, body: usize) -> Option<&Pose> {
        self.scratch.get(body).map(Scratch::pose)
    }
}
