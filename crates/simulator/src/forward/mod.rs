//! A device that moves under the torques of its drives: its rigid bodies, friction and cogging through time.

pub(crate) mod controller;
mod joint;
pub(crate) mod step;

use haptical_model::cholesky::{factor, solve};
use haptical_model::dynamics::Inertia;
use haptical_model::dynamics::nalgebra::Matrix3;
use haptical_model::{Device, DeviceEffect, ModelError, RigidBodies, SizedEffect};

use self::joint::JointForces;
use self::step::{ForwardState, ForwardWork};

/// Longest step of the integration \[s\]: assumption A156.
pub const LONGEST_STEP_S: f64 = 5e-4;
/// Shortest step that friction asks for \[s\]: assumption A156.
const SHORTEST_STEP_S: f64 = 1e-5;
/// How far Coulomb's friction alone may change a rate in one step, per rate over which it changes sides: beyond a few of
/// them a step that ends a motion does not see that friction has turned round. Assumption A156.
const CHANGE: f64 = 2.0;

/// A device that moves under the torques of its drives.
///
/// Its links are [`RigidBodies`], the armatures of its drives among them; of its effects `joint-friction`, `motor-cogging` and a
/// `payload` at the handle act. `torque_offset_nm`, `torque_delay_s` and `torque-gain` say what a reading of a torque is worth and
/// when it acted: [`ForwardModel::given`], [`ForwardModel::delay_s`]. Joints do not yield, and transmission errors are left out: a
/// joint is where its motor is.
///
/// ```
/// use haptical_simulator::ForwardModel;
/// use haptical_simulator::model::Device;
/// // 2 kg at 0.5 m, about z; gravity along -y
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.5, 0.0, 0.0]\n\
///     inertia_kgm2 = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n[[joint]]\n[gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n";
/// let pendulum = Device::from_toml(text, "pendulum.toml")?.device;
/// let model = ForwardModel::of_device(&pendulum, (0, 1))?;
/// let (mut work, mut state) = (model.work(), model.start(&[-1.5], &[0.0]));
/// let zero = [0.0];
/// // swings to the other side of -pi/2 within half a period of 2 pi sqrt(0.5 / 9.81) s
/// model.run(&mut state, &mut work, 0.71, [&zero, &zero])?;
/// assert!((state.theta[0] + std::f64::consts::PI - 1.5).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ForwardModel {
    bodies: RigidBodies,
    joints: Vec<JointForces>,
    readings: Vec<TorqueReading>,
    left_out: Vec<String>,
    longest_step_s: f64,
}

/// What a reading of a torque says of what the drive gives.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TorqueReading {
    /// What 1 N m of it is worth.
    worth: f64,
    /// What it is where the drive gives nothing \[N m\], \[N\].
    offset: f64,
    /// How long after the torque it is logged \[s\].
    delay_s: f64,
}

impl ForwardModel {
    /// The model of a device in a run of a recording, from 0, of so many runs. A payload may be there from a run on; where a
    /// recording has fewer runs it is there in all of them (assumption A155).
    ///
    /// # Errors
    /// As [`RigidBodies::of_device`], which refuses a device without masses, inertias or gravity.
    pub fn of_device(device: &Device, (run, runs): (usize, usize)) -> Result<Self, ModelError> {
        let mut bodies = RigidBodies::of_device(device)?;
        let mut joints = vec![JointForces::default(); device.joints.len()];
        let readings = device.joints.iter().map(|joint| TorqueReading {
            worth: 1.0,
            offset: joint.torque_offset_nm.unwrap_or(0.0),
            delay_s: joint.torque_delay_s.unwrap_or(0.0),
        });
        let mut readings: Vec<TorqueReading> = readings.collect();
        let mut left_out = Vec::new();
        for effect in &device.effects {
            let joint = effect.joint.filter(|joint| *joint < joints.len());
            let number = |key: &str| effect.numbers.get(key).copied();
            let is_taken = match (effect.name.as_str(), joint) {
                ("payload", _) => match number("mass_kg") {
                    // at a place of its own, or on a link, it is another payload
                    Some(mass_kg) if is_at_handle(effect) => {
                        let from = number("from_run").unwrap_or(1.0);
                        if run as f64 + 1.0 >= from || from > runs as f64 {
                            bodies = with_payload(&bodies, mass_kg)?;
                        }
                        true
                    }
                    _ => false,
                },
                ("torque-gain", Some(joint)) => {
                    readings[joint].worth *= 1.0 - number("gain").unwrap_or(0.0);
                    true
                }
                (_, Some(joint)) => joints[joint].take(device, joint, effect),
                _ => false,
            };
            if !is_taken {
                left_out.push(SizedEffect(effect).to_string());
            }
        }
        for joint in 0..device.joints.len() {
            let compliance = device.compliance_rad_per_nm(joint);
            if compliance != 0.0 {
                let stiffness = 1.0 / compliance;
                left_out.push(format!(
                    "compliance of joint {} (stiffness {stiffness:.4e})",
                    joint + 1
                ));
            }
        }
        Ok(Self {
            longest_step_s: longest_step_s(&bodies, &joints)?,
            bodies,
            joints,
            readings,
            left_out,
        })
    }

    /// Its links.
    pub fn bodies(&self) -> &RigidBodies {
        &self.bodies
    }

    /// Effects of the device that are not part of its motion here, with their sizes: joints that yield, and what sensors read
    /// too much.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// What the drive of a joint (from 0) gives where its torque reads `reading` \[N m\], \[N\]: the reading less
    /// `torque_offset_nm`, less the gain of `torque-gain`.
    pub fn given(&self, joint: usize, reading: f64) -> f64 {
        let own = self.readings.get(joint);
        own.map_or(reading, |own| own.worth * (reading - own.offset))
    }

    /// How long after it acts the torque of a joint (from 0) is logged: `torque_delay_s`.
    pub fn delay_s(&self, joint: usize) -> f64 {
        self.readings.get(joint).map_or(0.0, |own| own.delay_s)
    }

    /// The longest step of its integration \[s\]: [`LONGEST_STEP_S`], or less where its friction changes sides over a small
    /// rate.
    pub fn longest_step_s(&self) -> f64 {
        self.longest_step_s
    }

    /// Room for a step.
    pub fn work(&self) -> ForwardWork {
        ForwardWork::new(&self.bodies)
    }

    /// Joints at a place \[rad\], \[m\] with velocities, friction on no side.
    ///
    /// # Panics
    /// If either has not one number for each joint.
    pub fn start(&self, theta: &[f64], dtheta: &[f64]) -> ForwardState {
        assert_eq!([theta.len(), dtheta.len()], [self.joints.len(); 2]);
        let joints = self.joints.iter().zip(theta);
        ForwardState {
            theta: theta.to_vec(),
            dtheta: dtheta.to_vec(),
            settled: joints.map(|(joint, theta)| joint.settled(*theta)).collect(),
        }
    }

    /// Moves a state on by `seconds` in steps of at most [`ForwardModel::longest_step_s`], under torques of the drives that go in a
    /// straight line from what they are now to what they are then \[N m\], \[N\].
    ///
    /// # Errors
    /// [`ModelError::Dynamics`] where a joint moves nothing with inertia, and where numbers leave the range.
    pub fn run(
        &self,
        state: &mut ForwardState,
        work: &mut ForwardWork,
        seconds: f64,
        torques: [&[f64]; 2],
    ) -> Result<(), ModelError> {
        self.run_by(state, work, (seconds, self.longest_step_s), torques)
    }

    /// As [`ForwardModel::run`], with (seconds, the longest step in s).
    ///
    /// # Errors
    /// As [`ForwardModel::run`].
    pub fn run_by(
        &self,
        state: &mut ForwardState,
        work: &mut ForwardWork,
        (seconds, longest_s): (f64, f64),
        [from, to]: [&[f64]; 2],
    ) -> Result<(), ModelError> {
        let steps = libm::ceil(seconds / longest_s - 1e-9).max(1.0);
        let step_s = seconds / steps;
        let mut ends = std::mem::take(&mut work.ends);
        let mix = |share: f64, out: &mut Vec<f64>| {
            out.clear();
            out.extend(
                from.iter()
                    .zip(to)
                    .map(|(from, to)| from + share * (to - from)),
            );
        };
        let mut result = Ok(());
        for step in 0..steps as usize {
            let share = |step: f64| step / steps;
            mix(share(step as f64), &mut ends[0]);
            mix(share(step as f64 + 1.0), &mut ends[1]);
            let [start, end] = &ends;
            result = work.step(&self.bodies, &self.joints, state, step_s, [start, end]);
            if result.is_err() {
                break;
            }
        }
        work.ends = ends;
        result
    }
}

/// Whether a payload is a mass at the handle and nothing else.
fn is_at_handle(effect: &DeviceEffect) -> bool {
    let mut keys = effect.numbers.keys();
    keys.all(|key| ["mass_kg", "from_run"].contains(&key.as_str()))
}

/// The same with a point mass at the handle.
fn with_payload(bodies: &RigidBodies, mass_kg: f64) -> Result<RigidBodies, ModelError> {
    let mut inertias: Vec<Inertia> = bodies.masses().iter().map(|own| own.inertia).collect();
    if let Some(flange) = bodies.flange(0)
        && let Some(body) = flange.body
    {
        let place_m = flange.pose.position_m;
        inertias[body] += Inertia::about_centre(mass_kg, &place_m, &Matrix3::zeros());
    }
    bodies.with_inertias(&inertias)
}

/// The step in which no joint's friction changes its rate by much, at home.
fn longest_step_s(bodies: &RigidBodies, joints: &[JointForces]) -> Result<f64, ModelError> {
    let count = joints.len();
    let (mut work, mut mass) = (bodies.work(), vec![0.0; count * count]);
    bodies.mass_matrix(&vec![0.0; count], &mut work, &mut mass)?;
    factor(&mut mass, count)?;
    let mut longest_s = LONGEST_STEP_S;
    for (joint, own) in joints.iter().enumerate() {
        let mut unit = vec![0.0; count];
        unit[joint] = 1.0;
        solve(&mass, &mut unit);
        longest_s = longest_s.min(CHANGE * own.steadiness() / unit[joint]);
    }
    Ok(longest_s.max(SHORTEST_STEP_S))
}
