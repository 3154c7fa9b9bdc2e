//! The whole device at one instant: transmissions, arm, cables, without sensors' noise.

pub(crate) mod arm;
pub(crate) mod cable_path;
pub(crate) mod drive;
pub(crate) mod history;
mod inertia;

use haptical_model::kinematics::distance_m;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, ModelError};

use crate::effect::Effect;
use crate::motion::scene::arm::Arm;
use crate::motion::scene::cable_path::CablePath;
use crate::motion::scene::drive::{Drive, Instant};
use crate::motion::scene::inertia::Inertias;
use crate::motion::settings::Temperature;
use crate::waves::Waves;
use crate::{Motion, SimulatorError};

/// The hand's force along the handle's axes.
pub(crate) type Hand = [Waves; 3];

/// A device seen with one delay. It remembers its own past (plays), so it must go forward in time.
#[derive(Debug, Clone)]
pub(crate) struct Scene<'d> {
    device: &'d Device,
    pub(crate) delay_s: f64,
    pub(crate) drives: Vec<Drive<'d>>,
    pub(crate) arm: Arm,
    inertias: Inertias,
    paths: Vec<CablePath>,
    unloaded: Vec<f64>,
    pub(crate) force_n: Vector3<f64>,
    /// What the cables would show without counts and noise \[m\].
    pub(crate) cables_m: Vec<f64>,
    /// Time seen \[s\].
    pub(crate) time_s: f64,
}

impl<'d> Scene<'d> {
    pub(crate) fn new(
        device: &'d Device,
        effects: &[Effect],
        delay_s: f64,
    ) -> Result<Self, SimulatorError> {
        let drives = device.joints.iter().enumerate();
        let refuse = |source| SimulatorError::Row { row: 0, source };
        let arm = Arm::new(device, effects).map_err(refuse)?;
        let inertias = Inertias::new(device).map_err(refuse)?;
        let cables: &[_] = if device.has_links() {
            &device.cables
        } else {
            &[]
        };
        let mut paths = Vec::new();
        if !cables.is_empty() {
            let mut evaluation = Evaluation::new(device);
            evaluation.move_pose_to(&vec![0.0; device.joints.len()])?;
            let handle_m = evaluation.pose()?.position_m;
            for (index, cable) in cables.iter().enumerate() {
                let home = handle_m - Vector3::from(cable.anchor_m);
                let own = if index == 0 { effects } else { &[] };
                paths.push(CablePath::new(cable, &home, own));
            }
        }
        Ok(Self {
            device,
            delay_s,
            drives: drives
                .map(|(index, joint)| Drive::new(joint, index, effects))
                .collect(),
            arm,
            inertias,
            cables_m: vec![0.0; paths.len()],
            paths,
            unloaded: vec![0.0; device.joints.len()],
            force_n: Vector3::zeros(),
            time_s: 0.0,
        })
    }

    /// Moves to the instant that is seen at the time of a row.
    pub(crate) fn move_to(
        &mut self,
        row: usize,
        time_s: f64,
        motion: &Motion,
        hand: &Hand,
        temperature: Option<&Temperature>,
    ) -> Result<(), SimulatorError> {
        let time_s = time_s - self.delay_s;
        let at = Instant {
            time_s,
            rise_k: temperature.map_or(0.0, |warm| warm.rise_at(time_s)),
        };
        self.time_s = time_s;
        let model = |source: ModelError| SimulatorError::Row { row, source };
        for (joint, drive) in self.drives.iter_mut().enumerate() {
            let wanted = motion.joint_motion(joint, time_s);
            drive
                .move_to(wanted.position, wanted.velocity, at)
                .map_err(model)?;
            self.unloaded[joint] = drive.unloaded;
            self.inertias.move_joint(joint, drive.unloaded, &wanted);
        }
        let inertial_nm = self.inertias.torques_nm().map_err(model)?;
        self.force_n = Vector3::from(hand.each_ref().map(|axis| axis.value(time_s)));
        let settled = self.arm.settle(&self.unloaded, inertial_nm, &self.force_n);
        if !settled.map_err(model)? {
            return Err(SimulatorError::NoBalance { row });
        }
        let position_m = &self.arm.pose.position_m;
        for (index, path) in self.paths.iter().enumerate() {
            let anchor_m = Vector3::from(self.device.cables[index].anchor_m);
            let distance_m = distance_m(position_m, &anchor_m).map_err(|why| model(why.into()))?;
            let reading = path.reading_m(&(position_m - anchor_m), distance_m, at);
            self.cables_m[index] =
                reading.ok_or(SimulatorError::InsideGuide { row, distance_m })?;
        }
        Ok(())
    }
}
