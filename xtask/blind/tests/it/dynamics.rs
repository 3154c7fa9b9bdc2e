//! Inverse dynamics against a closed form, the statics of another crate, and the balance of power.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Twist, joint_torques_nm};
use haptical_model::{Device, Evaluation};
use xtask_blind::{Dynamics, NOMINALS, Random};

/// Sums of a few dozen products of numbers of the order of 1.
const ROUNDING: f64 = 1e-12;
/// Radius of gyration of the bodies, as the documentation of `Dynamics` says \[m\].
const GYRATION_M: f64 = 0.03;

/// Two links in the plane x-y of frame (-1), gravity along -y.
const PLANAR: &str = r#"
[device]
name = "planar"
dof = 2
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
mass_kg = 1.2
centre_of_mass_m = [0.11, 0.0, 0.0]
[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
mass_kg = 0.7
centre_of_mass_m = [0.13, 0.0, 0.0]
[[joint]]
name = "1"
[[joint]]
name = "2"
[gravity]
vector_mps2 = [0.0, -9.81, 0.0]
"#;

fn planar() -> Device {
    Device::from_toml(PLANAR, "planar")
        .expect("a device")
        .device
}

/// Spong, Hutchinson & Vidyasagar, *Robot Modeling and Control*, section 7.4, the planar elbow arm.
#[test]
fn planar_arm_matches_its_lagrangian() {
    let device = planar();
    let mut dynamics = Dynamics::new(&device);
    let (m1, m2, l1, c1, c2, g) = (1.2, 0.7, 0.3, 0.11, 0.13, 9.81);
    let gyration = GYRATION_M * GYRATION_M;
    let (i1, i2) = (m1 * gyration, m2 * gyration);
    let mut random = Random::new(3, 0);
    for _ in 0..50 {
        let mut draw = |size: f64| [(); 2].map(|()| random.uniform(-size, size));
        let (q, v, a) = (draw(3.0), draw(4.0), draw(20.0));
        let (cos2, sin2) = (q[1].cos(), q[1].sin());
        let d11 = m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2.0 * l1 * c2 * cos2) + i1 + i2;
        let d12 = m2 * (c2 * c2 + l1 * c2 * cos2) + i2;
        let d22 = m2 * c2 * c2 + i2;
        let h = -m2 * l1 * c2 * sin2;
        let g2 = m2 * c2 * g * (q[0] + q[1]).cos();
        let g1 = (m1 * c1 + m2 * l1) * g * q[0].cos() + g2;
        let expected = [
            d11 * a[0] + d12 * a[1] + 2.0 * h * v[0] * v[1] + h * v[1] * v[1] + g1,
            d12 * a[0] + d22 * a[1] - h * v[0] * v[0] + g2,
        ];
        let mut torque = [0.0; 2];
        let moment = dynamics.torques_nm(&q, &v, &a, [0.0; 3], &mut torque);
        for (got, want) in torque.iter().zip(expected) {
            assert!((got - want).abs() < ROUNDING * 100.0, "{got} for {want}");
        }
        // the first axis is the base's z: the base carries the first torque
        assert!((moment[2] - torque[0]).abs() < ROUNDING * 100.0);
    }
}

/// A hand that pushes takes load off the drives: the torques fall by J^T F.
#[test]
fn hand_force_enters_by_the_jacobian() {
    for nominal in NOMINALS {
        let device = nominal.device().expect("a device");
        let joints = device.joints.len();
        let mut dynamics = Dynamics::new(&device);
        let mut random = Random::new(8, 1);
        let q: Vec<f64> = (0..joints).map(|_| random.uniform(-0.7, 0.7)).collect();
        let zero = vec![0.0; joints];
        let force = [0.7, -1.1, 0.4];
        let (mut with, mut without) = (zero.clone(), zero.clone());
        dynamics.torques_nm(&q, &zero, &zero, force, &mut with);
        dynamics.torques_nm(&q, &zero, &zero, [0.0; 3], &mut without);

        let mut evaluation = Evaluation::new(&device);
        evaluation.move_to(&q).expect("a pose");
        let jacobian: Vec<Twist> = (0..joints)
            .map(|joint| evaluation.joint_twist(joint))
            .collect();
        let world = evaluation.pose().expect("a pose").rotation * Vector3::from(force);
        let mut expected = zero.clone();
        joint_torques_nm(&jacobian, &world, &Vector3::zeros(), &mut expected).expect("torques");
        for joint in 0..joints {
            let change = without[joint] - with[joint];
            assert!((change - expected[joint]).abs() < ROUNDING, "joint {joint}");
        }
    }
}

/// Energy of all bodies at angles and rates, by central differences of their positions.
fn energy_j(device: &Device, q: &[f64], v: &[f64]) -> f64 {
    let centres = |q: &[f64]| -> Vec<(f64, Vector3<f64>)> {
        (1..device.links.len())
            .filter_map(|row| {
                let body = device.bodies[row]?;
                // the chain up to the body, its centre as the last row's translation
                let mut part = device.clone();
                part.links.truncate(row + 1);
                part.joints.truncate(row);
                let [x, y, z] = body.centre_of_mass_m;
                let link = &mut part.links[row];
                link.theta_rad += y.atan2(x);
                link.a_m = x.hypot(y);
                link.d_m = z;
                let mut evaluation = Evaluation::new(&part);
                evaluation.move_outputs(&q[..row]).expect("a pose");
                Some((body.mass_kg, evaluation.pose().expect("a pose").position_m))
            })
            .collect()
    };
    let step_s = 1e-4;
    let moved = |sign: f64| -> Vec<f64> {
        q.iter()
            .zip(v)
            .map(|(q, v)| q + sign * step_s * v)
            .collect()
    };
    let gravity = Vector3::from(device.gravity_mps2.expect("gravity"));
    let (now, after, before) = (centres(q), centres(&moved(1.0)), centres(&moved(-1.0)));
    let mut energy = 0.0;
    for (((mass, here), (_, ahead)), (_, behind)) in now.iter().zip(&after).zip(&before) {
        let speed = (ahead - behind) / (2.0 * step_s);
        energy += mass * (0.5 * speed.norm_squared() - gravity.dot(here));
    }
    energy + spin_energy_j(device, q, v)
}

/// Energy of the balls' spin: half of m k^2 omega^2, omega the sum of the axes' rates.
fn spin_energy_j(device: &Device, q: &[f64], v: &[f64]) -> f64 {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_outputs(q).expect("a pose");
    let mut spin = Vector3::zeros();
    let mut energy = 0.0;
    for (joint, rate) in v.iter().enumerate() {
        spin += evaluation.joint_twist(joint).angular * *rate;
        let mass = device.bodies[joint + 1].map_or(0.0, |body| body.mass_kg);
        energy += 0.5 * mass * GYRATION_M * GYRATION_M * spin.norm_squared();
    }
    energy
}

/// Power of the drives is the rate of the energy, for every device along a motion.
#[test]
fn drives_feed_the_energy() {
    /// Second differences over 1e-3 s of motions with rates of 2 rad/s: relative error below 1e-5.
    const TOLERANCE: f64 = 2e-5;
    for nominal in NOMINALS {
        let device = nominal.device().expect("a device");
        let joints = device.joints.len();
        let mut random = Random::new(21, 0);
        let waves: Vec<[f64; 3]> = (0..joints)
            .map(|_| {
                [
                    random.uniform(0.2, 0.6),
                    random.uniform(1.0, 4.0),
                    random.phase_rad(),
                ]
            })
            .collect();
        let at = |t: f64, order: usize| -> Vec<f64> {
            let wave = |[size, rate, phase]: &[f64; 3]| match order {
                0 => size * (rate * t + phase).sin(),
                1 => size * rate * (rate * t + phase).cos(),
                _ => -size * rate * rate * (rate * t + phase).sin(),
            };
            waves.iter().map(wave).collect()
        };
        let mut dynamics = Dynamics::new(&device);
        let mut torque = vec![0.0; joints];
        for t in [0.3, 1.1, 2.7] {
            dynamics.torques_nm(&at(t, 0), &at(t, 1), &at(t, 2), [0.0; 3], &mut torque);
            let power: f64 = torque
                .iter()
                .zip(at(t, 1))
                .map(|(torque, rate)| torque * rate)
                .sum();
            let step = 1e-3;
            let energy = |t: f64| energy_j(&device, &at(t, 0), &at(t, 1));
            let rate = (energy(t + step) - energy(t - step)) / (2.0 * step);
            let scale = power.abs().max(0.1);
            assert!(
                (power - rate).abs() < TOLERANCE * scale,
                "{power} W for {rate} W at {t} s"
            );
        }
    }
}
