//! A recording from the inside: motion, torques, force and temperature first, then what sensors read.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Recording};

use crate::effects::{Effect, Stage};
use crate::gap::rounding;
use crate::random::Random;
use crate::rig::drive::Drive;
use crate::rig::dynamics::Dynamics;
use crate::rig::geometry::{Chain, Flex, HandlePose};
use crate::rig::motion::{Motion, MotionPlan};
use crate::rig::noise::NoisePlan;
use crate::rig::readings::rounded;
use crate::rig::surroundings::{hand_force, temperature_degc};

/// Streams of a recording's seed.
pub(crate) mod stream {
    pub(crate) const MOTION: u64 = 1;
    pub(crate) const FORCE: u64 = 2;
    pub(crate) const TEMPERATURE: u64 = 3;
    pub(crate) const TORQUE: u64 = 4;
    pub(crate) const CABLE: u64 = 5;
    pub(crate) const OUTPUT: u64 = 100;
    pub(crate) const EVENTS: u64 = 200;
}

/// Everything that is true during one recording.
#[derive(Debug)]
pub struct Scene<'d> {
    /// The true device.
    pub device: &'d Device,
    /// Angles at the output axes, where the external encoders sit.
    pub motion: Motion,
    /// Time between rows \[s\].
    pub step_s: f64,
    /// Torque of each drive on its link \[N m\].
    pub torque_nm: Vec<Vec<f64>>,
    /// Moment of the base on the first link, in the base's frame \[N m\].
    pub base_moment_nm: Vec<[f64; 3]>,
    /// Force of the hand in the handle's frame \[N\], row by row.
    pub force_n: Vec<[f64; 3]>,
    /// Temperature \[degC\].
    pub temperature_degc: Vec<f64>,
    /// The one at which nothing has grown: that of the first row of a cold start.
    pub cold_degc: f64,
    seed: u64,
}

/// A recording with its noise-free channels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recorded {
    /// What the sensors read.
    pub log: Recording,
    /// The same without noise on external encoders and cables, with all effects.
    pub clean: CleanChannels,
}

/// Channels without noise, effects included.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CleanChannels {
    /// External encoders \[rad\], one per joint.
    pub output_rad: Vec<Option<Vec<f64>>>,
    /// Cables \[m\].
    pub cable_m: Vec<Option<Vec<f64>>>,
    /// Root mean square of what rounding of the motor-side readings puts on a prediction, per channel
    /// (`out1`, ..., `cable`, `cable2`, ...), in its unit (rad or m): no model can come closer.
    pub rounding: BTreeMap<String, f64>,
}

/// Where the cable runs, row by row.
#[derive(Debug)]
pub struct CablePath {
    /// The handle.
    pub handle: Vec<HandlePose>,
    /// Where the cable leaves its guide \[m\].
    pub anchor_m: Vector3<f64>,
    /// Direction in which it leaves straight, unit length.
    pub exit_axis: Vector3<f64>,
}

impl<'d> Scene<'d> {
    /// Draws motion, hand force and temperature, and works out the torques.
    pub fn draw(device: &'d Device, plan: &MotionPlan, seed: u64) -> Result<Self> {
        let (name, has_joints) = (&device.name, !device.joints.is_empty());
        ensure!(
            device.has_links() && has_joints,
            "device `{name}`: a trial needs links and joints"
        );
        ensure!(
            device.is_plain_table(),
            "device `{name}`: a trial needs a plain table of rows: no origins, no b_m, no driven_by"
        );
        let motion = Motion::draw(device, plan, &mut Random::new(seed, stream::MOTION));
        let force_n = hand_force(motion.len(), plan, &mut Random::new(seed, stream::FORCE));
        Ok(Self::of_motion(device, plan, motion, force_n, None, seed))
    }

    /// A recording of a motion and of a hand's force that are given; the temperature is drawn, from `warm_degc` where the device
    /// was warmed up.
    pub(crate) fn of_motion(
        device: &'d Device,
        plan: &MotionPlan,
        motion: Motion,
        force_n: Vec<[f64; 3]>,
        warm_degc: Option<f64>,
        seed: u64,
    ) -> Self {
        let rows = motion.len();
        let mut random = Random::new(seed, stream::TEMPERATURE);
        let (temperature_degc, cold_degc) = temperature_degc(rows, plan, warm_degc, &mut random);
        let mut scene = Self {
            device,
            motion,
            step_s: 1.0 / plan.rate_hz,
            torque_nm: vec![Vec::with_capacity(rows); device.joints.len()],
            base_moment_nm: Vec::with_capacity(rows),
            force_n,
            temperature_degc,
            cold_degc,
            seed,
        };
        scene.work_out_torques();
        scene
    }

    fn work_out_torques(&mut self) {
        let joints = self.device.joints.len();
        let mut dynamics = Dynamics::new(self.device);
        let mut buffers = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
        let mut torque_nm = vec![0.0; joints];
        for row in 0..self.motion.len() {
            let columns = [
                &self.motion.angle_rad,
                &self.motion.rate_rad_s,
                &self.motion.acceleration_rad_s2,
            ];
            for (buffer, column) in buffers.iter_mut().zip(columns) {
                for (entry, values) in buffer.iter_mut().zip(column) {
                    *entry = values[row];
                }
            }
            let [angle, rate, acceleration] = &buffers;
            let moment_nm =
                dynamics.torques_nm(angle, rate, acceleration, self.force_n[row], &mut torque_nm);
            self.base_moment_nm.push(moment_nm);
            for (column, torque) in self.torque_nm.iter_mut().zip(&torque_nm) {
                column.push(*torque);
            }
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.motion.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.motion.is_empty()
    }

    /// Time since the first row \[s\], across runs.
    pub fn elapsed_s(&self, row: usize) -> f64 {
        row as f64 * self.step_s
    }

    /// The seed of every stream of this recording.
    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    /// Random numbers for events of this recording; `tag` separates effects.
    pub fn events(&self, tag: u64) -> Random {
        Random::new(self.seed, stream::EVENTS + tag)
    }

    /// What the sensors read.
    pub fn record(
        &self,
        effects: &[Effect],
        noise: &NoisePlan,
        torque_scale: &[f64],
    ) -> Result<Recorded> {
        let device = self.device;
        let mut noise = noise.clone();
        for effect in effects {
            effect.noise(self, &mut noise);
        }
        let exact = self.motor_readings(effects)?;
        let joint = self.counted(&exact);
        let rounding = rounding(device, &exact, &joint)?;
        let mut clean_output = self.motion.angle_rad.clone();
        let mut link = self.motion.angle_rad.clone();
        let mut flex = Flex {
            tilt_rad: vec![None; device.joints.len()],
            tool_m: None,
        };
        for effect in effects {
            effect.columns(Stage::External, self, &mut clean_output);
            effect.columns(Stage::Link, self, &mut link);
            effect.flex(self, &mut flex);
        }
        let path = self.cable_path(&link, &flex);
        let clean_cable = self.cable_lengths(effects, path.as_ref());
        let time_s = self.motion.time_s.iter().map(|time| rounded(*time, 1e3));
        let mut recorded = Recorded {
            log: Recording {
                line: (0..self.len() as u64).map(|row| row + 2).collect(),
                time_s: Some(time_s.collect()),
                run: (self.motion.run.last() != Some(&0)).then(|| self.motion.run.clone()),
                joint,
                ..Recording::default()
            },
            clean: CleanChannels {
                rounding,
                ..CleanChannels::default()
            },
        };
        self.read_outputs(clean_output, &noise, &mut recorded);
        self.read_cables(clean_cable, &noise, &mut recorded);
        self.read_covariates(effects, torque_scale, &mut recorded.log);
        Ok(recorded)
    }

    fn motor_readings(&self, effects: &[Effect]) -> Result<Vec<Vec<f64>>> {
        let mut windup = vec![vec![0.0; self.len()]; self.device.joints.len()];
        for effect in effects {
            effect.columns(Stage::Upstream, self, &mut windup);
        }
        let mut readings = Vec::with_capacity(windup.len());
        for (index, joint) in self.device.joints.iter().enumerate() {
            let mut drive = Drive::new(joint, index);
            let column: Result<Vec<f64>, _> = self.motion.angle_rad[index]
                .iter()
                .zip(&windup[index])
                .map(|(angle, extra)| drive.reading_rad(angle + extra))
                .collect();
            readings.push(column?);
        }
        for effect in effects {
            effect.columns(Stage::Motor, self, &mut readings);
        }
        Ok(readings)
    }

    /// Readings of the motor side in whole counts.
    fn counted(&self, exact: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut readings = exact.to_vec();
        for (joint, column) in self.device.joints.iter().zip(&mut readings) {
            if let Some(count) = joint.reading_quantum_rad() {
                for reading in column {
                    *reading = rounded(libm::round(*reading / count) * count, 1e7);
                }
            }
        }
        readings
    }

    fn cable_path(&self, link: &[Vec<f64>], flex: &Flex) -> Option<CablePath> {
        let cable = self.device.cables.first()?;
        let chain = Chain::new(self.device);
        let anchor_m = Vector3::from(cable.anchor_m);
        let home = chain.pose(|_| 0.0, &Flex::default(), 0);
        let exit_axis = cable
            .exit_axis
            .map_or(home.position_m - anchor_m, Vector3::from)
            .normalize();
        let handle = (0..self.len())
            .map(|row| chain.pose(|joint| link[joint][row], flex, row))
            .collect();
        Some(CablePath {
            handle,
            anchor_m,
            exit_axis,
        })
    }

    /// Lengths that an encoder without noise would read, one column per cable; effects act on the
    /// first cable.
    fn cable_lengths(&self, effects: &[Effect], path: Option<&CablePath>) -> Vec<Vec<f64>> {
        let Some(path) = path else {
            return Vec::new();
        };
        let straight = |anchor_m: Vector3<f64>| -> Vec<f64> {
            path.handle
                .iter()
                .map(|handle| (handle.position_m - anchor_m).norm())
                .collect()
        };
        let cables = self.device.cables.iter();
        let lengths = cables.map(|cable| straight(Vector3::from(cable.anchor_m)));
        let mut lengths: Vec<Vec<f64>> = lengths.collect();
        if let Some(first) = lengths.first_mut() {
            for effect in effects {
                effect.path(self, path, first);
            }
            for effect in effects {
                effect.columns(Stage::Cable, self, std::slice::from_mut(first));
            }
        }
        lengths
    }
}
