//! Regressor, Jacobian and geometry against virtual work and finite differences; the score against
//! a projection.

use haptical_effects::Context;
use haptical_model::{Device, DeviceChain, JointType, RigidBodies};
use nalgebra::{DMatrix, DVector, Vector3};

use super::arm::{Noise, Scene, arm, masses, other_arm, parameters, virtual_work};
use crate::engine::Regression;
use crate::force::Means;
use crate::force::along::Along;
use crate::force::fast::within;
use crate::force::posture::{PER_LINK, Posture};
use crate::force::recorded::{Besides, Recorded};
use crate::force::rows::{TorqueRows, Whitener};
use crate::select::{Candidate, excess};
use crate::thresholds::torque::{ANGLE_SD_RAD, LENGTH_SD_M};

/// Finite differences of second order over steps of 1e-3 s.
const DIFFERENCES: f64 = 2e-5;

/// Position, rate and acceleration of five joints.
fn moving(noise: &mut Noise) -> [Vec<f64>; 3] {
    [0.5, 1.0, 3.0].map(|size| (0..5).map(|_| size * noise.normal()).collect())
}

fn torques(
    device: &Device,
    joints: &[Vec<f64>; 3],
    inertia: &[f64],
    force: &Vector3<f64>,
) -> Vec<f64> {
    let (posture, columns) = placed(device, joints);
    let torque = |joint: usize| {
        let links = columns[inertia.len() * joint..].iter().zip(inertia);
        links.map(|(column, number)| column * number).sum::<f64>() - posture.hand(joint).dot(force)
    };
    (0..5).map(torque).collect()
}

/// The arm at one instant, with the columns of its links.
fn placed(device: &Device, joints: &[Vec<f64>; 3]) -> (Posture, Vec<f64>) {
    let bodies = RigidBodies::plausible(device).unwrap();
    let (mut work, mut columns) = (bodies.work(), vec![0.0; 5 * 5 * PER_LINK]);
    let [position, rate, acceleration] = joints;
    bodies
        .regressor(position, rate, acceleration, &mut work, &mut columns)
        .unwrap();
    let chain = DeviceChain::of_hand(device, 0);
    let posture = Posture::new(&chain, position, &work).unwrap();
    (posture, columns)
}

/// Both conventions, without and with a sliding joint whose row has a length behind it.
fn arms() -> [Device; 3] {
    let mut arms = [arm(), arm(), other_arm()];
    for device in &mut arms[1..] {
        device.joints[2].joint_type = JointType::Prismatic;
        device.links[3].d_m = 0.2;
    }
    arms
}

#[test]
fn the_regressor_agrees_with_virtual_work() {
    let mut noise = Noise(5);
    for device in arms() {
        let masses = masses(&device);
        let inertia = parameters(&masses);
        for _ in 0..10 {
            let joints = moving(&mut noise);
            let force = Vector3::new(noise.normal(), noise.normal(), noise.normal());
            let step_s = 1e-3;
            let at = |time: f64| -> Vec<f64> {
                (0..5)
                    .map(|k| joints[0][k] + time * (joints[1][k] + 0.5 * time * joints[2][k]))
                    .collect()
            };
            let three = [at(-step_s), at(0.0), at(step_s)];
            let expected = virtual_work(&device, &masses, &three, step_s, &force);
            for (own, other) in torques(&device, &joints, &inertia, &force)
                .iter()
                .zip(&expected)
            {
                assert!(
                    (own - other).abs() < DIFFERENCES * (1.0 + other.abs()),
                    "{own} {other}"
                );
            }
        }
    }
}

#[test]
fn wrong_rows_change_torques_as_differences_do() {
    let mut noise = Noise(6);
    for device in arms() {
        let inertia = parameters(&masses(&device));
        let gravity = Vector3::from(device.gravity_mps2.unwrap());
        let mut joints = moving(&mut noise);
        joints[1].fill(0.0);
        joints[2].fill(0.0);
        let force = Vector3::new(0.7, -0.4, 1.1);
        let (posture, _) = placed(&device, &joints);
        let order = device.convention.order();
        let mut changes = vec![[0.0; 5]; order.len() * device.links.len()];
        posture.geometry(&inertia, &gravity, &force, |number, joint, change| {
            changes[number][joint] = change;
        });
        for (number, change) in changes.iter().enumerate() {
            let (row, parameter) = (number / order.len(), order[number % order.len()]);
            let with = |by: f64| {
                let mut other = device.clone();
                let value = other.links[row].get(parameter);
                other.links[row].set(parameter, value + by);
                torques(&other, &joints, &inertia, &force)
            };
            let (more, less) = (with(1e-6), with(-1e-6));
            for joint in 0..5 {
                let expected = (more[joint] - less[joint]) / 2e-6;
                let error = (change[joint] - expected).abs();
                assert!(
                    error < 1e-7,
                    "{row} {parameter:?} {joint}: {} {expected}",
                    change[joint]
                );
            }
        }
    }
}

#[test]
fn a_column_of_the_mass_matrix_is_that_of_the_links() {
    let mut noise = Noise(8);
    for device in arms() {
        let inertia = parameters(&masses(&device));
        let mut joints = moving(&mut noise);
        joints[1].fill(0.0);
        for joint in 0..5 {
            let mut with = |acceleration: f64| {
                joints[2].fill(0.0);
                joints[2][joint] = acceleration;
                torques(&device, &joints, &inertia, &Vector3::zeros())
            };
            let (still, moved) = (with(0.0), with(1.0));
            let (posture, _) = placed(&device, &joints);
            for (other, torque) in posture.mass_column(joint, &inertia).iter().enumerate() {
                assert!((torque - (moved[other] - still[other])).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn a_score_is_what_a_projection_gives() {
    let mut noise = Noise(7);
    let (channels, blocks) = (2, 40);
    let rows = channels * blocks;
    let covariances: Vec<DMatrix<f64>> = (0..blocks)
        .map(|_| {
            let spread = DMatrix::from_fn(2, 2, |_, _| noise.normal());
            &spread * spread.transpose() + DMatrix::identity(2, 2)
        })
        .collect();
    let whitener = Whitener::new(covariances.clone().into_iter()).unwrap();
    let mut column = || -> Vec<f64> { (0..rows).map(|_| noise.normal()).collect() };
    let reading = column();
    let base: Vec<Vec<f64>> = (0..4).map(|_| column()).collect();
    let added = [column(), column()];
    // priors of variance 0.04 on the last two base columns
    let priors = [0.0, 0.0, 25.0, 25.0];
    let layout = TorqueRows::new(whitener.clone(), (blocks, channels), 4);
    let means = |column: &[f64]| Means::from_column_slice(blocks, channels, column);
    let lengthened = |column: &[f64]| {
        let mut white = whitener.whiten(&means(column)).as_slice().to_vec();
        white.resize(rows + 4, 0.0);
        white
    };
    let mut regression = Regression::new(layout.clone(), Vec::new(), lengthened(&reading));
    for (index, column) in base.iter().enumerate() {
        let mut column = lengthened(column);
        column[layout.prior(index)] = f64::sqrt(priors[index]);
        regression.add(column);
    }
    let system = &regression.system;
    let column = |column: &Vec<f64>| layout.split(&layout.of_means(&means(column)));
    let columns = added.iter().map(column).collect();
    let score = Candidate::of_columns(system, columns, 0, 0.0).score(system);

    // the same with the priors as rows of their own
    let inverse = |column: &[f64]| -> Vec<f64> {
        let block = |block: usize| DVector::from_fn(2, |row, _| column[row * blocks + block]);
        let white = |index: usize| {
            let factor = covariances[index].clone().cholesky().unwrap();
            factor.l().solve_lower_triangular(&block(index)).unwrap()
        };
        let white: Vec<DVector<f64>> = (0..blocks).map(white).collect();
        (0..rows)
            .map(|row| white[row % blocks][row / blocks])
            .collect()
    };
    let whole = |count: usize| {
        let white: Vec<Vec<f64>> = base
            .iter()
            .chain(&added)
            .map(|column| inverse(column))
            .collect();
        let matrix = DMatrix::from_fn(rows + 4, count, |row, column| {
            if row < rows {
                white[column][row]
            } else if row - rows == column {
                f64::sqrt(priors[column])
            } else {
                0.0
            }
        });
        let mut right = inverse(&reading);
        right.extend([0.0; 4]);
        let right = DVector::from_vec(right);
        let solution =
            (matrix.transpose() * &matrix).try_inverse().unwrap() * matrix.transpose() * &right;
        ((right - matrix * &solution).norm_squared(), solution)
    };
    let ((before, _), (after, solution)) = (whole(4), whole(6));
    assert!((score.score - (before - after)).abs() < 1e-6 * (before - after));
    assert_eq!(score.rank, 2);
    for k in 0..2 {
        assert!((score.amplitudes[k] - solution[4 + k]).abs() < 1e-6);
    }
    // taken up, they have these coefficients, and the residual is what is left
    for column in &added {
        regression.add(lengthened(column));
    }
    for (own, other) in regression.solution().iter().zip(solution.iter()) {
        assert!((own - other).abs() < 1e-9, "{own} {other}");
    }
    let left = &regression.system.residual;
    let left = left.iter().map(|entry| entry * entry).sum::<f64>();
    assert!((left - after).abs() < 1e-9 * after);
    let behind = regression.truncate(4);
    assert_eq!((behind.len(), regression.len()), (2, 4));
    let left = &regression.system.residual;
    let left = left.iter().map(|entry| entry * entry).sum::<f64>();
    assert!((left - before).abs() < 1e-9 * before);
}

#[test]
fn block_means_of_a_quartic_give_it_back() {
    let quartic = |x: f64| 0.3 + x * (1.0 + x * (-2.0 + x * (0.7 + x * 0.4)));
    let integral = |x: f64| x * (0.3 + x * (0.5 + x * (-2.0 / 3.0 + x * (0.7 / 4.0 + x * 0.08))));
    let means = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| integral(k + 0.5) - integral(k - 0.5));
    for place in [-0.5, -0.2, 0.1, 0.4] {
        let expected = quartic(place) - quartic(0.0);
        assert!((within(means, place) - expected).abs() < 1e-12);
    }
}

#[test]
fn slow_energy_of_noise_is_its_freedom() {
    let mut sum = 0.0;
    let seeds = 31..=38;
    for seed in seeds.clone() {
        let (device, recording) = (arm(), Scene::new(seed, 3000).record());
        let context = Context::new(&device, &recording, &[]).unwrap();
        let recorded = Recorded::new(&context, false).unwrap();
        let along = Along::new(recorded).unwrap();
        let base = along.fit(Besides::Nothing).unwrap();
        let (energy, sd) = excess(&base.energy(0));
        sum += energy / sd;
    }
    // eight of unit variance, and the noise of each column is known to a few percent
    let mean = sum / seeds.count() as f64;
    assert!(mean.abs() < 1.5, "{mean}");
}

/// About an upright first axis no torque depends on the first moment of the link behind it; on a tilted base one does.
#[test]
fn what_no_torque_shows_is_as_assumed() {
    let (device, recording) = (arm(), Scene::new(39, 3000).record());
    let context = Context::new(&device, &recording, &[]).unwrap();
    let recorded = Recorded::new(&context, false).unwrap();
    let along = Along::new(recorded).unwrap();
    let base = along.fit(Besides::Nothing).unwrap();
    // 0.3 kg at 0.02 m
    let [x, y] = [1, 2].map(|number| base.linearised_at[number]);
    assert!(x == 0.0 && (y - 0.006).abs() < 1e-15, "{x} {y}");
    // theta, a, b, d, alpha, beta
    let [length, angle] = [LENGTH_SD_M, ANGLE_SD_RAD];
    let sds = [angle, length, length, length, angle, angle];
    assert_eq!(along.geometry_sds()[..6], sds);
}

#[test]
fn parameters_are_ten_a_link() {
    assert_eq!(parameters(&masses(&arm())).len(), 5 * PER_LINK);
}
