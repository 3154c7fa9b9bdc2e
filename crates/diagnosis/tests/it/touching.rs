//! A heavy arm that touches points at unknown places: postures found on the true arm, so that only the recorded
//! angles tell of its errors.

use haptical_diagnosis::{Diagnosis, Options, diagnose};
use haptical_model::kinematics::nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use haptical_model::{ContactPair, Device, DeviceChain, Evaluation, Recording};

use crate::normal::Normal;

/// Standard deviation of a coordinate of a touch \[m\].
pub(crate) const TOUCH_SD_M: f64 = 1e-4;
const JOINTS: usize = 6;
/// Points, and touches of each.
const POINTS: [[f64; 3]; 4] = [
    [0.42, 0.10, 0.30],
    [0.42, 0.15, 0.30],
    [-0.20, 0.40, 0.45],
    [-0.20, 0.44, 0.42],
];
const TOUCHES: usize = 40;

/// The arm as its file describes it.
pub(crate) fn device() -> Device {
    let mut text = String::from(
        "[device]\nname = \"heavy arm\"\n[gravity]\nvector_mps2 = [0.0, 0.0, -9.81]\n",
    );
    // a, alpha, d, mass, centre of mass
    let rows = [
        (0.0, 0.0, 0.0, 0.0, [0.0, 0.0, 0.0]),
        (0.03, 1.55, 0.28, 4.0, [0.0, 0.02, -0.05]),
        (0.32, 0.02, 0.04, 5.0, [0.15, 0.01, 0.02]),
        (0.05, 1.52, -0.03, 3.0, [0.02, 0.06, 0.0]),
        (0.01, -1.54, 0.27, 2.0, [0.0, 0.03, 0.05]),
        (0.02, 1.56, 0.01, 1.5, [0.02, 0.0, 0.03]),
        (0.04, 0.3, 0.12, 0.8, [0.05, 0.01, 0.06]),
    ];
    for (a, alpha, d, mass, [x, y, z]) in rows {
        text += &format!(
            "[[link]]\na_m = {a}\nalpha_rad = {alpha}\nd_m = {d}\nmass_kg = {mass}\n\
             centre_of_mass_m = [{x}, {y}, {z}]\n"
        );
    }
    text += &"[[joint]]\n".repeat(JOINTS);
    let mut device = Device::from_toml(&text, "heavy.toml").unwrap().device;
    device.surroundings.contact_sd_m = Some(TOUCH_SD_M);
    device.contact_pairs = pairs();
    device
}

fn name(point: usize) -> String {
    format!("socket{}", point + 1)
}

/// The first two points and the last two are at known distances.
fn pairs() -> Vec<ContactPair> {
    let distance =
        |a: usize, b: usize| (Vector3::from(POINTS[a]) - Vector3::from(POINTS[b])).norm();
    let pair = |a: usize, b: usize| ContactPair {
        a: name(a),
        b: name(b),
        distance_m: distance(a, b),
        sd_m: 5e-5,
    };
    vec![pair(0, 1), pair(2, 3)]
}

/// The arm as it was built.
pub(crate) fn built() -> Device {
    let mut device = device();
    device.links[1].a_m += 1e-3;
    device.links[2].a_m -= 8e-4;
    device.links[2].theta_rad += 4e-3;
    device.links[3].alpha_rad += 3e-3;
    device.links[4].d_m += 9e-4;
    device.links[5].theta_rad -= 5e-3;
    device.links[6].a_m += 7e-4;
    device
}

/// What the file does not have.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Errors {
    /// How each joint yields to its weight \[rad/(N m)\].
    pub(crate) compliance_rad_per_nm: [f64; JOINTS],
    /// What is added to the touches' standard deviation [`TOUCH_SD_M`] \[m\].
    pub(crate) rough_m: f64,
    /// Where the tool sits in the handle's frame \[m\].
    pub(crate) tool_m: [f64; 3],
}

/// Torque that holds a joint: the slope of the potential energy, by differences.
fn torque_nm(device: &Device, chain: &DeviceChain, angles: &[f64], joint: usize) -> f64 {
    let energy = |by: f64| -> f64 {
        let mut angles = angles.to_vec();
        angles[joint] += by;
        let bodies = device.bodies.iter().enumerate().skip(1);
        bodies
            .filter_map(|(row, body)| Some((row, (*body)?)))
            .map(|(row, body)| {
                let before = chain.part(row).unwrap().pose(&angles[..row - 1]).unwrap();
                let (sin, cos) = (chain.links[row].theta_rad + angles[row - 1]).sin_cos();
                let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
                let centre = turn * Vector3::from(body.centre_of_mass_m);
                9.81 * body.mass_kg * (before.position_m + before.rotation * centre).z
            })
            .sum()
    };
    let step = 1e-5;
    (energy(step) - energy(-step)) / (2.0 * step)
}

/// Where the true tool is at readings, and how it moves with them.
fn tool(built: &Device, errors: &Errors, readings: &[f64]) -> (Vector3<f64>, DMatrix<f64>) {
    let chain = DeviceChain::new(built);
    let outputs: Vec<f64> = (0..JOINTS)
        .map(|joint| {
            let yields = errors.compliance_rad_per_nm[joint];
            let torque = if yields == 0.0 {
                0.0
            } else {
                torque_nm(built, &chain, readings, joint)
            };
            readings[joint] - yields * torque
        })
        .collect();
    let mut evaluation = Evaluation::new(built);
    evaluation.move_outputs(&outputs).unwrap();
    let pose = *evaluation.pose().unwrap();
    let arm = pose.rotation * Vector3::from(errors.tool_m);
    let slopes = DMatrix::from_fn(3, JOINTS, |axis, joint| {
        let twist = evaluation.joint_twist(joint);
        (twist.linear + twist.angular.cross(&arm))[axis]
    });
    (pose.position_m + arm, slopes)
}

/// Readings at which the true tool is at a place, by Newton's method from a random start; none where it does not
/// get there.
fn reach(
    built: &Device,
    errors: &Errors,
    place: &Vector3<f64>,
    noise: &mut Normal,
) -> Option<Vec<f64>> {
    let mut readings: Vec<f64> = (0..JOINTS).map(|_| 0.8 * noise.next()).collect();
    for _ in 0..60 {
        let (at, slopes) = tool(built, errors, &readings);
        let way = place - at;
        if way.norm() < 1e-10 {
            let is_within = readings.iter().all(|reading| reading.abs() < 2.5);
            return is_within.then_some(readings);
        }
        let normal = &slopes * slopes.transpose() + DMatrix::identity(3, 3) * 1e-6;
        let step = slopes.transpose()
            * normal
                .cholesky()?
                .solve(&DVector::from_column_slice(way.as_slice()));
        let share = (0.3 / step.amax().max(1e-12)).min(1.0);
        for (reading, change) in readings.iter_mut().zip(step.iter()) {
            *reading += share * change;
        }
    }
    None
}

/// Touches of all points.
pub(crate) fn record(seed: u64, errors: &Errors) -> Recording {
    let built = built();
    let mut noise = Normal::new(seed);
    let mut recording = Recording {
        joint: vec![Vec::new(); JOINTS],
        output: vec![None; JOINTS],
        torque_nm: vec![None; JOINTS],
        ..Recording::default()
    };
    let mut contact = Vec::new();
    for (point, place) in POINTS.iter().enumerate() {
        let mut touches = 0;
        while touches < TOUCHES {
            let wobble = Vector3::from_fn(|_, _| (TOUCH_SD_M + errors.rough_m) * noise.next());
            let Some(readings) = reach(
                &built,
                errors,
                &(Vector3::from(*place) + wobble),
                &mut noise,
            ) else {
                continue;
            };
            for (column, reading) in recording.joint.iter_mut().zip(readings) {
                column.push(reading);
            }
            contact.push(name(point));
            touches += 1;
        }
    }
    recording.line = (2..).take(contact.len()).collect();
    recording.contact = Some(contact);
    recording
}

/// Diagnoses touches, against a model where there is one.
pub(crate) fn diagnosed(
    device: &Device,
    recording: &Recording,
    model: Option<&Device>,
) -> Diagnosis {
    let options = Options {
        model,
        ..Options::default()
    };
    diagnose(device, recording, &options).unwrap()
}
