//! The torques with which the drives hold a device at rest against gravity and the hand.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Chain, Convention, KinematicsError, Pose, Twist};

use crate::{Body, Device, DeviceChain, Drive, Recording};

/// Torques of the drives \[N m\] (\[N\] for a prismatic joint), joint by joint and row by row, that hold the
/// device at rest at the motor-side readings of a recording; positive along +theta.
///
/// With m the mass of a row and c its centre, F the force of the hand on the handle at P (the columns
/// `fx_n`, `fy_n`, `fz_n`, end-effector frame), the torque of joint i is
/// `-(sum_rows m g . dc/dq_i + F . dP/dq_i)` (virtual work; Siciliano et al. 2009, section 7.1), at the angles
/// to which joints with a compliance have yielded. The mass of row 0 stands still. Of a device that branches the masses
/// of all branches count, and the force is that on the hand of the row. `None` where neither masses
/// with gravity nor forces are known.
///
/// ```
/// use haptical_model::{Device, Recording, holding_torques_nm};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
///     [[joint]]\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
/// let lever = Device::from_toml(text, "lever.toml")?.device;
/// let level = Recording { joint: vec![vec![0.0]], ..Recording::default() };
/// let torques = holding_torques_nm(&lever, &level)?;
/// // 2 kg at 0.3 m, held up
/// assert!((torques.unwrap()[0][0] - 6.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`KinematicsError`] where the chain has no pose.
pub fn holding_torques_nm(
    device: &Device,
    recording: &Recording,
) -> Result<Option<Vec<Vec<f64>>>, KinematicsError> {
    let mut statics = Statics::new(device);
    let force_n = recording.force_n.as_ref();
    if !device.has_links() || (!statics.has_weights() && force_n.is_none()) {
        return Ok(None);
    }
    let rows = recording.len();
    let mut torques = vec![vec![0.0; rows]; device.joints.len()];
    let mut outputs = vec![0.0; device.joints.len()];
    let mut yielded = vec![0.0; device.joints.len()];
    let compliance = |joint| device.compliance_rad_per_nm(joint);
    for row in 0..rows {
        // two hands at one posture are two rows of one load
        let is_same = |column: &Vec<f64>| row > 0 && column[row] == column[row - 1];
        if force_n.is_none() && recording.joint.iter().all(is_same) {
            for column in &mut torques {
                column[row] = column[row - 1];
            }
            continue;
        }
        for (joint, output) in outputs.iter_mut().enumerate() {
            let reading = recording
                .joint
                .get(joint)
                .map_or(f64::NAN, |column| column[row]);
            // a transmission without a value moves its joint by next to nothing here
            *output = reading + device.joints[joint].error_rad(reading).unwrap_or(0.0);
        }
        statics.choose_hand(device.hand_at(recording, row));
        let hand_n = force_n.map(|axes| Vector3::from(axes.each_ref().map(|axis| axis[row])));
        let hand = |handle: &Pose| hand_n.map(|hand_n| handle.rotation * hand_n);
        yielded.copy_from_slice(&outputs);
        for _ in 0..MOST_SETTLINGS {
            let load = statics.load(&yielded, hand)?;
            let mut moved_rad = 0.0_f64;
            for (joint, (column, torque)) in torques.iter_mut().zip(load.torques_nm).enumerate() {
                column[row] = *torque;
                let settled = outputs[joint] - compliance(joint) * torque;
                moved_rad = moved_rad.max((settled - yielded[joint]).abs());
                yielded[joint] = settled;
            }
            if moved_rad <= SETTLED_RAD {
                break;
            }
        }
    }
    Ok(Some(torques))
}

/// Most repetitions of torques and yielding: each leaves a compliance times a stiffness of gravity of the error
/// before, some hundredths.
const MOST_SETTLINGS: usize = 16;
/// A joint that moves by less has settled \[rad\].
const SETTLED_RAD: f64 = 1e-12;

/// What a device at rest carries: its masses under gravity, and the hand.
///
/// The one place where torques are computed from statics: a calibration's compliances and a diagnosis's are
/// those of the same torques.
///
/// ```
/// use haptical_model::{Device, Statics};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
///     [[joint]]\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
/// let lever = Device::from_toml(text, "lever.toml")?.device;
/// let mut statics = Statics::new(&lever);
/// let load = statics.load(&[0.0], |_| None)?;
/// // held up by the drive, pulled down about the base
/// assert!((load.torques_nm[0] - 6.0).abs() < 1e-12);
/// assert!((load.base_moment_nm.z + 6.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Statics {
    /// One for each hand.
    chains: Vec<DeviceChain>,
    hand: usize,
    convention: Convention,
    arms: Vec<Arm>,
    variables: Vec<f64>,
    columns: Vec<Twist>,
    torques_nm: Vec<f64>,
    beyond: Vec<Beyond>,
}

/// What pulls at the parts beyond a joint: their weights and the hand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beyond {
    /// Sum of the forces \[N\], frame (-1).
    pub force_n: Vector3<f64>,
    /// Their moment about the origin of frame (-1) \[N m\].
    pub moment_nm: Vector3<f64>,
}

impl Beyond {
    /// Their moment about a place, both in frame (-1) \[N m\].
    ///
    /// ```
    /// use haptical_model::Beyond;
    /// use haptical_model::kinematics::nalgebra::Vector3;
    /// // 10 N down at 2 m, seen from 0.5 m
    /// let pulled = Beyond { force_n: -10.0 * Vector3::z(), moment_nm: 20.0 * Vector3::y() };
    /// assert_eq!(pulled.moment_about_nm(&(0.5 * Vector3::x())), 15.0 * Vector3::y());
    /// ```
    pub fn moment_about_nm(&self, place_m: &Vector3<f64>) -> Vector3<f64> {
        self.moment_nm - place_m.cross(&self.force_n)
    }
}

/// What drives and base bear at one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load<'s> {
    /// Torque of each drive \[N m\] (\[N\] where it slides), positive along +theta.
    pub torques_nm: &'s [f64],
    /// What pulls beyond each joint.
    pub beyond: &'s [Beyond],
    /// Moment of weights and hand about the robot's base, the end of row 0 \[N m\], frame (-1).
    pub base_moment_nm: Vector3<f64>,
}

impl Statics {
    /// The masses of a device; without `[gravity]` they weigh nothing. The mass of row 0 stands still.
    pub fn new(device: &Device) -> Self {
        let hands = 0..device.chain_count();
        let chains: Vec<DeviceChain> = hands
            .map(|hand| DeviceChain::of_hand(device, hand))
            .collect();
        let rows = device.links.len().saturating_sub(1);
        let gravity = device.gravity_mps2.map(Vector3::from);
        let bodies = device.bodies.iter().enumerate();
        let bodies = bodies.filter_map(|(row, body)| Some((row, (*body)?)));
        let heavy = bodies.filter(|(row, body)| *row > 0 && body.mass_kg > 0.0);
        let arms = gravity.map_or_else(Vec::new, |gravity| {
            heavy
                .map(|(row, body)| Arm::new(device, row, &body, &gravity))
                .collect()
        });
        Self {
            convention: device.convention,
            arms,
            variables: vec![0.0; rows],
            columns: vec![Twist::default(); rows],
            torques_nm: vec![0.0; device.joints.len()],
            beyond: vec![Beyond::default(); device.joints.len()],
            chains,
            hand: 0,
        }
    }

    /// Chooses the hand (from 0) that the next force is on; the first one without a choice.
    pub fn choose_hand(&mut self, hand: Option<usize>) {
        self.hand = hand.unwrap_or(0).min(self.chains.len() - 1);
    }

    /// Whether gravity pulls at any moving mass.
    pub fn has_weights(&self) -> bool {
        !self.arms.is_empty()
    }

    /// The load at output angles (one per joint, \[rad\] or \[m\]). `hand` gives the force of the hand on the
    /// handle \[N\], frame (-1), at the handle's pose; none, or one that is not finite, is no force.
    ///
    /// # Errors
    /// [`KinematicsError`] where the chain has no pose.
    pub fn load(
        &mut self,
        outputs: &[f64],
        hand: impl FnOnce(&Pose) -> Option<Vector3<f64>>,
    ) -> Result<Load<'_>, KinematicsError> {
        self.torques_nm.fill(0.0);
        self.beyond.fill(Beyond::default());
        let mut base_moment_nm = Vector3::zeros();
        let base_m = self.chains[self.hand].part(1)?.pose(&[])?.position_m;
        let (torques_nm, beyond) = (&mut self.torques_nm, &mut self.beyond);
        let mut bear = |drives: &[Drive],
                        columns: &[Twist],
                        place_m: &Vector3<f64>,
                        force_n: &Vector3<f64>| {
            let moment_nm = place_m.cross(force_n);
            for (index, (column, drive)) in columns.iter().zip(drives).enumerate() {
                torques_nm[drive.joint] -= drive.multiplier * column.linear.dot(force_n);
                // a joint that moves several rows bears a force once
                if drives[..index]
                    .iter()
                    .all(|before| before.joint != drive.joint)
                {
                    beyond[drive.joint].force_n += force_n;
                    beyond[drive.joint].moment_nm += moment_nm;
                }
            }
            base_moment_nm += (place_m - base_m).cross(force_n);
        };
        for arm in &self.arms {
            let count = arm.chain.drives().len();
            let (variables, columns) = (&mut self.variables[..count], &mut self.columns[..count]);
            arm.chain.variables(outputs, variables);
            let centre = arm
                .chain(self.convention)?
                .geometric_jacobian(variables, columns)?;
            bear(
                arm.chain.drives(),
                columns,
                &centre.position_m,
                &arm.weight_n,
            );
        }
        let own = &self.chains[self.hand];
        let count = own.drives().len();
        let (variables, columns) = (&mut self.variables[..count], &mut self.columns[..count]);
        own.variables(outputs, variables);
        let handle = own.chain()?.geometric_jacobian(variables, columns)?;
        let hand_n = hand(&handle).filter(|hand_n| hand_n.iter().all(|part| part.is_finite()));
        if let Some(hand_n) = hand_n {
            bear(own.drives(), columns, &handle.position_m, &hand_n);
        }
        Ok(Load {
            torques_nm: &self.torques_nm,
            beyond: &self.beyond,
            base_moment_nm,
        })
    }
}

/// The rows up to a mass, ending at its centre.
#[derive(Debug, Clone)]
struct Arm {
    chain: DeviceChain,
    origins: Vec<Option<Pose>>,
    weight_n: Vector3<f64>,
}

impl Arm {
    fn new(device: &Device, row: usize, body: &Body, gravity: &Vector3<f64>) -> Self {
        let mut chain = DeviceChain::to_row(device, row);
        let mut origins = chain.origins().to_vec();
        origins.resize(chain.row_count(), None);
        // the centre is given behind the turn about z, before the row's own lengths and twists
        origins.push(Some(Pose {
            position_m: Vector3::from(body.centre_of_mass_m),
            rotation: Matrix3::identity(),
        }));
        if let Some(link) = chain.links.last_mut() {
            link.d_m -= device.links[row].d_m;
            if device.convention == Convention::Standard {
                (link.a_m, link.b_m) = (0.0, 0.0);
                (link.alpha_rad, link.beta_rad) = (0.0, 0.0);
            }
        }
        Self {
            chain,
            origins,
            weight_n: gravity * body.mass_kg,
        }
    }

    fn chain(&self, convention: Convention) -> Result<Chain<'_>, KinematicsError> {
        Chain::with_origins(
            convention,
            &self.chain.links,
            self.chain.motions(),
            &self.origins,
        )
    }
}
