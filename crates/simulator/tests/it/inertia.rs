//! Torques that move the links, by Lagrange's equations with mass matrices from differences of poses: another route than
//! the simulator's.

use haptical_simulator::model::kinematics::Chain;
use haptical_simulator::model::kinematics::nalgebra::{
    DMatrix, DVector, Matrix3, Rotation3, Vector3,
};
use haptical_simulator::model::{Device, JointType, Recording, RowBody, Segments};
use haptical_simulator::{Effects, record_motion, simulate_motion};

use crate::hand::{SEED, at_row, heavy_arm, quiet, time, torque};

/// Step of the poses' differences, and of the mass matrices'.
const STEPS: [f64; 2] = [1e-5, 1e-3];

/// Rotation of the frame behind a row's motion, and the centre of the row's mass.
fn body(
    device: &Device,
    row: usize,
    centre_m: &Vector3<f64>,
    angles: &[f64],
) -> (Matrix3<f64>, Vector3<f64>) {
    let (links, motions) = (device.chain_links(), device.motions());
    let chain = Chain::new(device.convention, &links[..row], &motions[..row]).expect("rows");
    let before = chain.pose(&angles[..row - 1]).expect("a pose");
    // a row's own turn is before what moves with it, its other numbers behind
    let (mut turn_rad, mut slide_m) = (links[row].theta_rad, 0.0);
    match device.joints[row - 1].joint_type {
        JointType::Revolute => turn_rad += angles[row - 1],
        JointType::Prismatic => {
            slide_m = links[row].d_m - device.links[row].d_m + angles[row - 1];
        }
    }
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), turn_rad);
    let place = turn * centre_m + Vector3::z() * slide_m;
    (
        before.rotation * turn.matrix(),
        before.position_m + before.rotation * place,
    )
}

fn mass_matrix(device: &Device, angles: &[f64]) -> DMatrix<f64> {
    let joints = device.joints.len();
    let rows = RowBody::of_rows(device, &Segments::of_device(device).expect("rows"));
    let mut all = DMatrix::zeros(joints, joints);
    for (index, own) in rows.iter().enumerate() {
        let row = index + 1;
        if device.bodies.get(row).copied().flatten().is_none() {
            continue;
        }
        let moved = |joint: usize, step: f64| {
            let mut angles = angles.to_vec();
            angles[joint] += step;
            body(device, row, &own.centre_m, &angles)
        };
        let here = body(device, row, &own.centre_m, angles).0;
        let inertia = here * own.inertia_kgm2 * here.transpose();
        let slopes: Vec<(Vector3<f64>, Vector3<f64>)> = (0..joints)
            .map(|joint| {
                let (after, before) = (moved(joint, STEPS[0]), moved(joint, -STEPS[0]));
                let turn = after.0 * before.0.transpose();
                let spin = (turn - turn.transpose()) / (4.0 * STEPS[0]);
                let spin = Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]);
                (spin, (after.1 - before.1) / (2.0 * STEPS[0]))
            })
            .collect();
        for (a, (spin_a, way_a)) in slopes.iter().enumerate() {
            for (b, (spin_b, way_b)) in slopes.iter().enumerate() {
                all[(a, b)] += own.mass_kg * way_a.dot(way_b) + spin_a.dot(&(inertia * spin_b));
            }
        }
    }
    for (joint, own) in device.joints.iter().enumerate() {
        all[(joint, joint)] += own.armature_kgm2.unwrap_or(0.0);
    }
    all
}

/// d/dt dT/dq' - dT/dq with T = q' M q' / 2.
fn lagrange_nm(device: &Device, angles: &[f64], rates: &[f64], changes: &[f64]) -> DVector<f64> {
    let rates = DVector::from_column_slice(rates);
    let mut sum = mass_matrix(device, angles) * DVector::from_column_slice(changes);
    for joint in 0..angles.len() {
        let moved = |step: f64| {
            let mut angles = angles.to_vec();
            angles[joint] += step;
            mass_matrix(device, &angles)
        };
        let slope = (moved(STEPS[1]) - moved(-STEPS[1])) / (2.0 * STEPS[1]);
        sum += &slope * &rates * rates[joint];
        sum[joint] -= 0.5 * rates.dot(&(&slope * &rates));
    }
    sum
}

/// The same at a row of a quiet recording without memory.
pub(crate) fn motion_nm(device: &Device, recording: &Recording, row: usize) -> DVector<f64> {
    let simulation = simulate_motion(device, &Effects::none(), &quiet(), SEED).expect("ready");
    let evaluation = at_row(device, recording, row);
    let joints = 0..device.joints.len();
    let angles: Vec<f64> = joints
        .clone()
        .map(|joint| evaluation.output_rad(joint))
        .collect();
    let time_s = time(recording)[row];
    let wanted = joints.map(|joint| simulation.motion().joint_motion(joint, time_s));
    let (rates, changes): (Vec<f64>, Vec<f64>) =
        wanted.map(|way| (way.velocity, way.acceleration)).unzip();
    lagrange_nm(device, &angles, &rates, &changes)
}

/// Two point-like links in a plane: Siciliano et al., *Robotics: Modelling, Planning and Control* (2009), eq. (7.82) without
/// friction: b_11, b_12 and h of the arm's equations of motion.
#[test]
fn the_route_of_this_file_is_the_textbook_s_for_two_links() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.2, 0.0, 0.0]\n\
        inertia_kgm2 = [0.01, 0.03, 0.03, 0.0, 0.0, 0.0]\n\
        [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 1.5\ncentre_of_mass_m = [0.1, 0.0, 0.0]\n\
        inertia_kgm2 = [0.01, 0.02, 0.02, 0.0, 0.0, 0.0]\n\
        [[joint]]\narmature_kgm2 = 0.07\n[[joint]]\n";
    let device = Device::from_toml(text, "two.toml")
        .expect("a device")
        .device;
    let (q, dq, ddq) = ([0.3, 0.8], [1.2, -0.7], [2.0, 3.0]);
    let got = lagrange_nm(&device, &q, &dq, &ddq);
    // centres from the axes of their own joints, in the frame behind the turn
    let (a1, own, far) = (0.5, 0.2, 0.1);
    let (m1, m2, i1, i2) = (2.0, 1.5, 0.03, 0.02);
    let cross = m2 * a1 * far;
    let b11 = i1 + m1 * own * own + i2 + m2 * (a1 * a1 + far * far) + 2.0 * cross * q[1].cos();
    let b12 = i2 + m2 * far * far + cross * q[1].cos();
    let b22 = i2 + m2 * far * far;
    let h = -cross * q[1].sin();
    let want = [
        (b11 + 0.07) * ddq[0] + b12 * ddq[1] + 2.0 * h * dq[0] * dq[1] + h * dq[1] * dq[1],
        b12 * ddq[0] + b22 * ddq[1] - h * dq[0] * dq[0],
    ];
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() < 1e-5, "{got} {want}");
    }
}

#[test]
fn drives_move_the_links_too() {
    let mut device = heavy_arm();
    device.joints[1].armature_kgm2 = Some(0.05);
    let free = {
        let mut weightless = device.clone();
        weightless.gravity_mps2 = Some([0.0; 3]);
        weightless
    };
    let mut settings = quiet();
    settings.force_rms_n = 0.0;
    let recording = record_motion(&free, &Effects::none(), &settings, SEED).expect("rows");
    let mut sizes = [0.0_f64; 4];
    for row in (0..recording.len()).step_by(97) {
        for (joint, want) in motion_nm(&free, &recording, row).iter().enumerate() {
            let got = torque(&recording, joint)[row];
            assert!(
                (got - want).abs() < 1e-5,
                "row {row}, {joint}: {got} {want}"
            );
            sizes[joint] = sizes[joint].max(got.abs());
        }
    }
    assert!(sizes.iter().all(|size| *size > 2e-3), "{sizes:?}");
    // where the file weighs nothing, rotors alone are moved
    let mut light = device;
    light.bodies = vec![None; 5];
    let recording = record_motion(&light, &Effects::none(), &settings, SEED).expect("rows");
    let simulation = simulate_motion(&light, &Effects::none(), &settings, SEED).expect("ready");
    for (row, &time_s) in time(&recording).iter().enumerate() {
        for joint in 0..4 {
            let change = simulation.motion().joint_motion(joint, time_s).acceleration;
            let want = if joint == 1 { 0.05 * change } else { 0.0 };
            assert!((torque(&recording, joint)[row] - want).abs() < 1e-12);
        }
    }
}
