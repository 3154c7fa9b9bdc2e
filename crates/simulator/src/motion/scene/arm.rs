//! The chain under weights, its own inertia and the hand's force: drive torques, and what gives way.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Chain, Convention, Link, Motion as RowMotion, Pose, Twist};
use haptical_model::{Device, DeviceChain, ModelError};

use crate::effect::Effect;

/// Steps to the balance of springs and loads; each shrinks the error by a load's change over a
/// stiffness.
const MAX_STEPS: usize = 200;
/// Relative change of the torques at which they balance.
const BALANCE: f64 = 1e-13;

/// A tilt of a joint's axis about the x axis of the link before.
#[derive(Debug, Clone, Copy)]
struct Wobble {
    joint: usize,
    /// Row whose twist turns the axis.
    row: usize,
    amplitude_rad: f64,
    phase_rad: f64,
    order: f64,
}

/// A mass with the table of links that ends in its frame.
#[derive(Debug, Clone)]
struct Body {
    links: Vec<Link>,
    mass_kg: f64,
    centre_m: Vector3<f64>,
}

/// The chain of a device with its loads. Its results are those of the last [`Arm::settle`].
#[derive(Debug, Clone)]
pub(crate) struct Arm {
    has_links: bool,
    convention: Convention,
    motions: Vec<RowMotion>,
    origins: Vec<Option<Pose>>,
    /// Twists of the rows without wobble.
    twists_rad: Vec<f64>,
    links: Vec<Link>,
    bodies: Vec<Body>,
    gravity_mps2: Vector3<f64>,
    wobbles: Vec<Wobble>,
    /// Give of each joint before and behind its external encoder \[rad/Nm\].
    drum_give: Vec<f64>,
    joint_give: Vec<f64>,
    base_give: f64,
    tool_give: f64,
    base_origin_m: Vector3<f64>,
    base_turn_rad: Vector3<f64>,
    jacobian: Vec<Twist>,
    loads_nm: Vec<f64>,
    /// Outputs as the external encoders see them.
    pub(crate) outputs: Vec<f64>,
    /// Angles of the links, behind whatever gives.
    pub(crate) angles: Vec<f64>,
    /// Drive torques that hold weights and hand, and move the links.
    pub(crate) torques_nm: Vec<f64>,
    /// Handle in frame (-1).
    pub(crate) pose: Pose,
}

impl Arm {
    pub(crate) fn new(device: &Device, effects: &[Effect]) -> Result<Self, ModelError> {
        let joints = device.joints.len();
        let links = device.chain_links();
        let motions = device.motions();
        if !device.drives_are_plain() {
            let device = device.name.clone();
            return Err(ModelError::FollowingRows { device });
        }
        let bodies = bodies(device, &links);
        let mut arm = Self {
            has_links: device.has_links(),
            convention: device.convention,
            twists_rad: links.iter().map(|link| link.alpha_rad).collect(),
            bodies,
            gravity_mps2: Vector3::from(device.gravity_mps2.unwrap_or_default()),
            wobbles: Vec::new(),
            drum_give: vec![0.0; joints],
            joint_give: vec![0.0; joints],
            base_give: 0.0,
            tool_give: 0.0,
            base_origin_m: Vector3::zeros(),
            base_turn_rad: Vector3::zeros(),
            jacobian: vec![Twist::default(); joints],
            loads_nm: vec![0.0; joints],
            outputs: vec![0.0; joints],
            angles: vec![0.0; joints],
            torques_nm: vec![0.0; joints],
            pose: Pose::default(),
            links,
            motions,
            origins: device.chain_origins(),
        };
        if device.has_links() {
            arm.base_origin_m = DeviceChain::new(device).part(1)?.pose(&[])?.position_m;
        }
        for effect in effects {
            arm.add(effect);
        }
        Ok(arm)
    }

    /// Takes up an effect of the structure; others are not this part's.
    fn add(&mut self, effect: &Effect) {
        match *effect {
            Effect::CapstanCompliance {
                joint,
                stiffness_nm_per_rad,
            } => self.drum_give[joint - 1] += 1.0 / stiffness_nm_per_rad,
            Effect::JointCompliance {
                joint,
                stiffness_nm_per_rad,
            } => self.joint_give[joint - 1] += 1.0 / stiffness_nm_per_rad,
            Effect::BaseCompliance { rad_per_nm } => self.base_give += rad_per_nm,
            Effect::ToolCompliance { m_per_n } => self.tool_give += m_per_n,
            Effect::AxisWobble {
                joint,
                amplitude_rad,
                phase_rad,
                order,
            } => self.wobbles.push(Wobble {
                joint: joint - 1,
                // Standard: Rx(alpha) of the row before is the last turn in front of the axis;
                // modified: it is the first of the joint's own row
                row: match self.convention {
                    Convention::Standard => joint - 1,
                    Convention::Modified => joint,
                },
                amplitude_rad,
                phase_rad,
                order,
            }),
            _ => {}
        }
    }

    /// Moves to outputs that the drives would give without load, and finds where springs, weights, the torques that move the
    /// links and the hand's force (on the handle, in the handle's frame) balance; false where a spring is too weak for its load.
    ///
    /// Drive torques by virtual work: tau_j = i_j - sum_b m_b g . dr_b/dq_j - F . dP/dq_j, i_j those of the motion.
    pub(crate) fn settle(
        &mut self,
        unloaded: &[f64],
        inertial_nm: &[f64],
        force_n: &Vector3<f64>,
    ) -> Result<bool, ModelError> {
        let gives = self.drum_give.iter().chain(&self.joint_give);
        let is_rigid = gives.chain([&self.base_give]).all(|give| *give == 0.0);
        for _ in 0..MAX_STEPS {
            for (joint, &unloaded) in unloaded.iter().enumerate() {
                let torque_nm = self.torques_nm[joint];
                self.outputs[joint] = unloaded - torque_nm * self.drum_give[joint];
                self.angles[joint] = self.outputs[joint] - torque_nm * self.joint_give[joint];
            }
            if !self.has_links {
                return Ok(true);
            }
            let change = self.load(inertial_nm, force_n)?;
            if is_rigid || change <= BALANCE {
                return Ok(true);
            }
            if !change.is_finite() {
                break;
            }
        }
        Ok(false)
    }

    /// Pose, torques and turn of the base at the angles; how much the two changed.
    fn load(&mut self, inertial_nm: &[f64], force_n: &Vector3<f64>) -> Result<f64, ModelError> {
        self.tilt_axes();
        let back_rad = -self.base_turn_rad;
        let gravity_mps2 = turned(&self.gravity_mps2, &back_rad);
        let chain =
            Chain::with_origins(self.convention, &self.links, &self.motions, &self.origins)?;
        let mut pose = chain.geometric_jacobian(&self.angles, &mut self.jacobian)?;
        let force_n = pose.rotation * force_n;
        pose.position_m += force_n * self.tool_give;
        let mut moment_nm = (pose.position_m - self.base_origin_m).cross(&force_n);
        let loads = self.loads_nm.iter_mut().zip(inertial_nm);
        for ((load, inertial_nm), column) in loads.zip(&self.jacobian) {
            // the tool gives along the force, which changes no lever of it
            *load = inertial_nm - column.linear.dot(&force_n);
        }
        for body in &self.bodies {
            let rows = body.links.len();
            let (motions, origins) = (&self.motions[..rows], self.origins.get(..rows));
            let origins = origins.unwrap_or_default();
            let chain = Chain::with_origins(self.convention, &body.links, motions, origins)?;
            let (angles, columns) = (&self.angles[..rows - 1], &mut self.jacobian[..rows - 1]);
            let frame = chain.geometric_jacobian(angles, columns)?;
            let weight_n = gravity_mps2 * body.mass_kg;
            let arm_m = frame.rotation * body.centre_m;
            for (load, column) in self.loads_nm.iter_mut().zip(columns) {
                *load -= (column.linear + column.angular.cross(&arm_m)).dot(&weight_n);
            }
            let place_m = frame.position_m + arm_m;
            moment_nm += (place_m - self.base_origin_m).cross(&weight_n);
        }
        let mut change = 0.0_f64;
        for (torque, &load) in self.torques_nm.iter_mut().zip(&self.loads_nm) {
            // NaN must not be lost, as it would be by f64::max
            let step = (load - *torque).abs() / (1.0 + load.abs());
            change = if step <= change { change } else { step };
            *torque = load;
        }
        let turn_rad = turned(&moment_nm, &self.base_turn_rad) * self.base_give;
        let step = libm::sqrt((turn_rad - self.base_turn_rad).norm_squared());
        change = if step <= change { change } else { step };
        self.pose = if self.base_give == 0.0 {
            pose
        } else {
            let lever_m = pose.position_m - self.base_origin_m;
            let axes = [0, 1, 2].map(|axis| {
                turned(
                    &pose.rotation.column(axis).into_owned(),
                    &self.base_turn_rad,
                )
            });
            Pose {
                position_m: self.base_origin_m + turned(&lever_m, &self.base_turn_rad),
                rotation: Matrix3::from_columns(&axes),
            }
        };
        self.base_turn_rad = turn_rad;
        Ok(change)
    }

    /// Turns the axes of joints that wobble, here and in the tables of the masses.
    fn tilt_axes(&mut self) {
        for wobble in &self.wobbles {
            let angle = wobble.order * self.angles[wobble.joint] - wobble.phase_rad;
            let tilt_rad = wobble.amplitude_rad * libm::cos(angle);
            let twist_rad = self.twists_rad[wobble.row] + tilt_rad;
            self.links[wobble.row].alpha_rad = twist_rad;
            for body in &mut self.bodies {
                // in the frame of a mass of a standard row there is no twist behind the joint's turn
                let last = body.links.len() - 1;
                let is_cut = wobble.row == last && self.convention == Convention::Standard;
                if wobble.row <= last && !is_cut {
                    body.links[wobble.row].alpha_rad = twist_rad;
                }
            }
        }
    }
}

/// The masses of links 1 and on, each with the table that ends in the frame after Rz(theta_i). A slide carries its mass
/// by all of its variable, home included.
fn bodies(device: &Device, links: &[Link]) -> Vec<Body> {
    let with_row = device.bodies.iter().enumerate().skip(1);
    with_row
        .filter_map(|(row, body)| {
            let (body, link) = (body.as_ref()?, links.get(row)?);
            let home_m = link.d_m - device.links.get(row)?.d_m;
            let mut table = links.get(..row)?.to_vec();
            table.push(match device.convention {
                Convention::Standard => Link {
                    theta_rad: link.theta_rad,
                    d_m: home_m,
                    ..Link::default()
                },
                Convention::Modified => Link {
                    d_m: home_m,
                    ..*link
                },
            });
            Some(Body {
                links: table,
                mass_kg: body.mass_kg,
                centre_m: Vector3::from(body.centre_of_mass_m),
            })
        })
        .collect()
}

/// A vector turned by a rotation vector: Rodrigues' formula, with libm's sine and cosine.
fn turned(vector: &Vector3<f64>, turn_rad: &Vector3<f64>) -> Vector3<f64> {
    let angle_rad = libm::sqrt(turn_rad.norm_squared());
    if angle_rad == 0.0 {
        return *vector;
    }
    let axis = turn_rad / angle_rad;
    let (sine, cosine) = libm::sincos(angle_rad);
    vector * cosine + axis.cross(vector) * sine + axis * (axis.dot(vector) * (1.0 - cosine))
}
