//! Rigid bodies of a device against its chain, its statics and the laws that tie both.

use haptical_model::dynamics::TorqueDerivatives;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, DeviceChain, Missing, ModelError, RigidBodies, Statics};

/// A planar arm with a parallelogram: row 3 follows joint 2 backwards, so that the forearm keeps its direction; a slide
/// that row 4's joint drives at a third of its angle hangs on row 1, and homes and offsets are not 0.
const PARALLELOGRAM: &str = "
[device]
handle_xyz_m = [0.05, 0.0, 0.1]
[[link]]
a_m = 0.1
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.0
alpha_rad = 1.4
d_m = 0.3
theta_offset_rad = 0.2
mass_kg = 3.0
centre_of_mass_m = [0.02, -0.1, 0.04]
inertia_kgm2 = [0.03, 0.02, 0.025, 0.001, -0.002, 0.003]
[[link]]
a_m = 0.4
alpha_rad = 0.1
d_m = 0.05
theta_offset_rad = -0.4
driven_by = 2
mass_kg = 2.0
centre_of_mass_m = [0.2, 0.01, 0.0]
inertia_kgm2 = [0.004, 0.03, 0.031, 0.0005, 0.0, 0.001]
[[link]]
a_m = 0.35
alpha_rad = -0.7
d_m = 0.0
driven_by = 2
driven_multiplier = -1.0
driven_offset_rad = 0.3
mass_kg = 1.2
centre_of_mass_m = [0.15, 0.0, 0.03]
inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]
[[link]]
a_m = 0.02
alpha_rad = 0.5
d_m = 0.1
theta_offset_rad = 0.6
driven_by = 3
driven_type = \"prismatic\"
driven_multiplier = 0.3
driven_offset_m = 0.07
mass_kg = 0.8
centre_of_mass_m = [0.01, 0.02, 0.05]
inertia_kgm2 = [0.001, 0.002, 0.0015, 0.0001, 0.0, 0.0]
[[joint]]
home_rad = 0.4
armature_kgm2 = 0.05
[[joint]]
home_rad = -0.3
armature_kgm2 = 0.2
[[joint]]
home_rad = 0.5
[gravity]
vector_mps2 = [1.0, -3.0, -9.0]
";

fn device(text: &str) -> Device {
    Device::from_toml(text, "arm.toml").unwrap().device
}

const THETA: [f64; 3] = [0.3, -0.7, 0.45];
const SPEED: [f64; 3] = [0.9, -1.3, 0.6];
const ACCELERATION: [f64; 3] = [2.0, 1.5, -3.0];

#[test]
fn at_rest_the_torques_are_those_of_the_statics() {
    let device = device(PARALLELOGRAM);
    let bodies = RigidBodies::of_device(&device).unwrap();
    let (mut work, mut torques) = (bodies.work(), [0.0; 3]);
    bodies
        .bias(&THETA, &[0.0; 3], &mut work, &mut torques)
        .unwrap();
    let mut statics = Statics::new(&device);
    let load = statics.load(&THETA, |_| None).unwrap();
    for (own, other) in torques.iter().zip(load.torques_nm) {
        assert!((own - other).abs() < 1e-12, "{own} {other}");
    }
}

/// M of the joints from the places of the masses and the turns of the rows alone, by central differences of the chain.
fn mass_matrix_by_differences(device: &Device) -> [[f64; 3]; 3] {
    let step = 1e-5;
    let rows = device.links.len();
    // place of each mass, and rotation of each row's frame
    let at = |theta: &[f64; 3]| -> Vec<(Vector3<f64>, Matrix3<f64>)> {
        let weights = Statics::new(device).weights(theta).unwrap();
        (1..rows)
            .map(|row| {
                let own = weights.iter().find(|weight| weight.row == row).unwrap();
                let chain = DeviceChain::to_row(device, row);
                (own.place_m, chain.pose(theta).unwrap().rotation)
            })
            .collect()
    };
    let here = at(&THETA);
    let moved: Vec<Vec<(Vector3<f64>, Vector3<f64>)>> = (0..3)
        .map(|joint| {
            let shifted = |by: f64| {
                let mut theta = THETA;
                theta[joint] += by;
                at(&theta)
            };
            let (up, down) = (shifted(step), shifted(-step));
            up.iter()
                .zip(&down)
                .zip(&here)
                .map(|((up, down), here)| {
                    let turn = (up.1 - down.1) * here.1.transpose() / (2.0 * step);
                    let turn = Vector3::new(turn.m32, turn.m13, turn.m21);
                    ((up.0 - down.0) / (2.0 * step), turn)
                })
                .collect()
        })
        .collect();
    let mut matrix = [[0.0; 3]; 3];
    for row in 1..rows {
        let body = device.bodies[row].unwrap();
        let [xx, yy, zz, xy, xz, yz] = body.inertia_kgm2.unwrap();
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        // the inertia is along the frame behind Rz(theta), before the translation along x and the twist about x
        let twist = device.links[row].alpha_rad;
        let back = Matrix3::new(
            1.0,
            0.0,
            0.0,
            0.0,
            twist.cos(),
            twist.sin(),
            0.0,
            -twist.sin(),
            twist.cos(),
        );
        let frame = here[row - 1].1 * back;
        let inertia = frame * inertia * frame.transpose();
        for (i, by_i) in moved.iter().enumerate() {
            for (j, by_j) in moved.iter().enumerate() {
                let ((v, w), (other_v, other_w)) = (by_i[row - 1], by_j[row - 1]);
                matrix[i][j] += body.mass_kg * v.dot(&other_v) + w.dot(&(inertia * other_w));
            }
        }
    }
    for (joint, own) in device.joints.iter().enumerate() {
        matrix[joint][joint] += own.armature_kgm2.unwrap_or(0.0);
    }
    matrix
}

#[test]
fn the_mass_matrix_is_that_of_moved_masses() {
    let device = device(PARALLELOGRAM);
    let bodies = RigidBodies::of_device(&device).unwrap();
    let (mut work, mut matrix) = (bodies.work(), [0.0; 9]);
    bodies.mass_matrix(&THETA, &mut work, &mut matrix).unwrap();
    let expected = mass_matrix_by_differences(&device);
    for (entry, expected) in matrix.iter().zip(expected.as_flattened()) {
        assert!((entry - expected).abs() < 1e-9, "{entry} {expected}");
    }
}

#[test]
fn the_laws_of_the_joints_fit_each_other() {
    let bodies = RigidBodies::of_device(&device(PARALLELOGRAM)).unwrap();
    let mut work = bodies.work();
    let mut torques = |theta: &[f64; 3], speed: &[f64; 3], acceleration: &[f64; 3]| {
        let mut torques = [0.0; 3];
        bodies
            .torques(theta, speed, acceleration, &mut work, &mut torques)
            .unwrap();
        torques
    };
    let here = torques(&THETA, &SPEED, &ACCELERATION);
    // power of a motion: tau = M ddtheta + b, the rest is checked against energies below
    let step = 1e-5;
    let mut by = [[[0.0; 3]; 3]; 3];
    for (which, by) in by.iter_mut().enumerate() {
        for joint in 0..3 {
            let mut shifted = |sign: f64| {
                let mut motion = [THETA, SPEED, ACCELERATION];
                motion[which][joint] += sign * step;
                torques(&motion[0], &motion[1], &motion[2])
            };
            let (up, down) = (shifted(1.0), shifted(-1.0));
            for torque in 0..3 {
                by[torque][joint] = (up[torque] - down[torque]) / (2.0 * step);
            }
        }
    }
    let mut work = bodies.work();
    let (mut by_theta, mut by_speed, mut mass) = ([0.0; 9], [0.0; 9], [0.0; 9]);
    let out = TorqueDerivatives {
        by_q: &mut by_theta,
        by_dq: &mut by_speed,
    };
    bodies
        .derivatives(&THETA, &SPEED, &ACCELERATION, &mut work, out)
        .unwrap();
    bodies.mass_matrix(&THETA, &mut work, &mut mass).unwrap();
    for (found, by) in [by_theta, by_speed, mass].iter().zip(&by) {
        for (found, expected) in found.iter().zip(by.as_flattened()) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
    // regressor times parameters, and armatures
    let mut regressor = [0.0; 3 * 40];
    bodies
        .regressor(&THETA, &SPEED, &ACCELERATION, &mut work, &mut regressor)
        .unwrap();
    let parameters: Vec<f64> = bodies
        .masses()
        .iter()
        .flat_map(|own| own.inertia.parameters())
        .collect();
    let armatures = [0.05, 0.2, 0.0];
    for (joint, row) in regressor.chunks(40).enumerate() {
        let sum: f64 = row.iter().zip(&parameters).map(|(y, pi)| y * pi).sum();
        let expected = here[joint] - armatures[joint] * ACCELERATION[joint];
        assert!((sum - expected).abs() < 1e-12, "{sum} {expected}");
    }
    // and back
    let mut acceleration = [0.0; 3];
    bodies
        .forward(&THETA, &SPEED, &here, &mut work, &mut acceleration)
        .unwrap();
    for (own, expected) in acceleration.iter().zip(ACCELERATION) {
        assert!((own - expected).abs() < 1e-10, "{own} {expected}");
    }
}

#[test]
fn the_torques_do_the_work_that_energies_gain() {
    let device = device(PARALLELOGRAM);
    let bodies = RigidBodies::of_device(&device).unwrap();
    let mut work = bodies.work();
    // kinetic from the mass matrix, potential from the places of the masses
    let energy = |theta: &[f64; 3], speed: &[f64; 3]| -> f64 {
        let (mut work, mut mass) = (bodies.work(), [0.0; 9]);
        bodies.mass_matrix(theta, &mut work, &mut mass).unwrap();
        let kinetic: f64 = (0..9)
            .map(|at| 0.5 * speed[at / 3] * mass[at] * speed[at % 3])
            .sum();
        let weights = Statics::new(&device).weights(theta).unwrap();
        kinetic
            - weights
                .iter()
                .map(|own| own.force_n.dot(&own.place_m))
                .sum::<f64>()
    };
    let mut torques = [0.0; 3];
    bodies
        .torques(&THETA, &SPEED, &ACCELERATION, &mut work, &mut torques)
        .unwrap();
    let power: f64 = torques
        .iter()
        .zip(SPEED)
        .map(|(own, speed)| own * speed)
        .sum();
    let step = 1e-5;
    let at = |time: f64| {
        let theta = std::array::from_fn(|i| {
            THETA[i] + time * SPEED[i] + 0.5 * time * time * ACCELERATION[i]
        });
        let speed = std::array::from_fn(|i| SPEED[i] + time * ACCELERATION[i]);
        energy(&theta, &speed)
    };
    let gained = (at(step) - at(-step)) / (2.0 * step);
    assert!((gained - power).abs() < 1e-7, "{gained} {power}");
}

#[test]
fn what_a_file_does_not_say_is_named() {
    let bare = PARALLELOGRAM
        .replace("mass_kg = 2.0\n", "")
        .replace(
            "inertia_kgm2 = [0.004, 0.03, 0.031, 0.0005, 0.0, 0.001]\n",
            "",
        )
        .replace(
            "inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]\n",
            "",
        )
        .replace("[gravity]\nvector_mps2 = [1.0, -3.0, -9.0]\n", "");
    let device = device(&bare);
    let missing = vec![
        Missing::Mass { row: 2 },
        Missing::Inertia { row: 3 },
        Missing::Gravity,
    ];
    let refused = RigidBodies::of_device(&device).unwrap_err();
    assert!(
        refused.to_string().contains("no mass of row 2 (`mass_kg`)"),
        "{refused}"
    );
    let ModelError::Unweighed { missing: named, .. } = refused else {
        panic!("{refused}");
    };
    assert_eq!(named, missing);
    let plausible = RigidBodies::plausible(&device).unwrap();
    assert_eq!(plausible.assumed(), missing);
    let given: Vec<[bool; 3]> = plausible
        .masses()
        .iter()
        .map(|own| [own.has_mass, own.has_centre, own.has_inertia])
        .collect();
    let all = [true; 3];
    assert_eq!(given, [all, [false; 3], [true, true, false], all]);
    assert_eq!(plausible.gravity_mps2().z, -9.81);
    assert!(
        plausible
            .masses()
            .iter()
            .all(|own| own.inertia.is_physical())
    );
}

#[test]
fn the_flange_leads_to_the_handle() {
    let device = device(PARALLELOGRAM);
    let bodies = RigidBodies::of_device(&device).unwrap();
    let mut work = bodies.work();
    bodies
        .bias(&THETA, &SPEED, &mut work, &mut [0.0; 3])
        .unwrap();
    let flange = bodies.flange(0).unwrap();
    let found = haptical_model::rigid::then(work.pose(flange.body.unwrap()).unwrap(), &flange.pose);
    let expected = DeviceChain::new(&device).pose(&THETA).unwrap();
    assert!((found.position_m - expected.position_m).amax() < 1e-14);
    assert!((found.rotation - expected.rotation).amax() < 1e-14);
}
