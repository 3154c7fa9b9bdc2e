//! The torques with which the drives hold a device at rest against gravity and the hand.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Chain, Convention, KinematicsError, Motion, Pose, Twist};

use crate::{Body, Device, DeviceChain, Recording};

/// Torques of the drives \[N m\] (\[N\] for a prismatic joint), joint by joint and row by row, that hold the
/// device at rest at the motor-side readings of a recording; positive along +theta.
///
/// With m the mass of a row and c its centre, F the force of the hand on the handle at P (the columns
/// `fx_n`, `fy_n`, `fz_n`, end-effector frame), the torque of joint i is
/// `-(sum_rows m g . dc/dq_i + F . dP/dq_i)` (virtual work; Siciliano et al. 2009, section 7.1). The mass of
/// row 0 stands still. `None` where neither masses with gravity nor forces are known.
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
    let gravity = device.gravity_mps2.map(Vector3::from);
    let bodies: Vec<(usize, Body)> = device
        .bodies
        .iter()
        .enumerate()
        .filter_map(|(row, body)| Some((row, (*body)?)))
        .filter(|(row, body)| *row > 0 && body.mass_kg > 0.0)
        .collect();
    let is_heavy = gravity.is_some() && !bodies.is_empty();
    if !device.has_links() || (!is_heavy && recording.force_n.is_none()) {
        return Ok(None);
    }
    let chain = DeviceChain::new(device);
    let arms: Vec<Arm> = match gravity {
        Some(gravity) => bodies
            .iter()
            .map(|(row, body)| Arm::new(device, &chain, *row, body, &gravity))
            .collect(),
        None => Vec::new(),
    };
    let rows = recording.len();
    let mut torques = vec![vec![0.0; rows]; device.joints.len()];
    let mut variables = vec![0.0; chain.drives().len()];
    let mut columns = vec![Twist::default(); chain.drives().len()];
    let mut outputs = vec![0.0; device.joints.len()];
    for row in 0..rows {
        for (joint, output) in outputs.iter_mut().enumerate() {
            let reading = recording
                .joint
                .get(joint)
                .map_or(f64::NAN, |column| column[row]);
            // a transmission without a value moves its joint by next to nothing here
            *output = reading + device.joints[joint].error_rad(reading).unwrap_or(0.0);
        }
        chain.variables(&outputs, &mut variables);
        let mut add = |columns: &[Twist], force: &Vector3<f64>| {
            for (column, drive) in columns.iter().zip(chain.drives()) {
                torques[drive.joint][row] -= drive.multiplier * column.linear.dot(force);
            }
        };
        for arm in &arms {
            let count = arm.motions.len() - 1;
            arm.chain(device.convention)?
                .geometric_jacobian(&variables[..count], &mut columns[..count])?;
            add(&columns[..count], &arm.weight_n);
        }
        if let Some(force) = &recording.force_n {
            let force = Vector3::from(force.each_ref().map(|axis| axis[row]));
            let pose = chain
                .chain()?
                .geometric_jacobian(&variables, &mut columns)?;
            if force.iter().all(|part| part.is_finite()) {
                add(&columns, &(pose.rotation * force));
            }
        }
    }
    Ok(Some(torques))
}

/// The rows up to a mass, ending at its centre.
struct Arm {
    links: Vec<haptical_kinematics::Link>,
    motions: Vec<Motion>,
    origins: Vec<Option<Pose>>,
    weight_n: Vector3<f64>,
}

impl Arm {
    fn new(
        device: &Device,
        chain: &DeviceChain,
        row: usize,
        body: &Body,
        gravity: &Vector3<f64>,
    ) -> Self {
        let mut links = chain.links[..=row].to_vec();
        let mut origins = chain.origins().to_vec();
        origins.resize(row + 1, None);
        // the centre is given behind the turn about z, before the row's own lengths and twists
        origins.push(Some(Pose {
            position_m: Vector3::from(body.centre_of_mass_m),
            rotation: Matrix3::identity(),
        }));
        let link = &mut links[row];
        link.d_m -= device.links[row].d_m;
        if device.convention == Convention::Standard {
            (link.a_m, link.b_m) = (0.0, 0.0);
            (link.alpha_rad, link.beta_rad) = (0.0, 0.0);
        }
        Self {
            links,
            motions: chain.motions()[..=row].to_vec(),
            origins,
            weight_n: gravity * body.mass_kg,
        }
    }

    fn chain(&self, convention: Convention) -> Result<Chain<'_>, KinematicsError> {
        Chain::with_origins(convention, &self.links, &self.motions, &self.origins)
    }
}
