//! A 7-joint device near its nominal one, and poses of it with measured distances.
#![allow(dead_code, reason = "the bench uses more of it than the example")]

use haptical_batch::{BatchError, DistanceModel, PoseBatch};
use haptical_kinematics::{Chain, Convention, KinematicsError, Link, Motion, distance_m};

/// Nominal model, poses, and the paper's 28 free parameters.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) model: DistanceModel,
    pub(crate) poses: PoseBatch,
    /// What the batch was made of.
    pub(crate) joints: Vec<Vec<f64>>,
    pub(crate) distances_m: Vec<f64>,
    pub(crate) weights: Vec<f64>,
    pub(crate) free: Vec<usize>,
}

/// Twists as in Baser & Konukseven, Table 1, in quarter turns; lengths of about its size.
const ROWS: [(f64, f64, f64, f64); 8] = [
    (0.25, -1.0, 0.0, 0.0),
    (0.0, -1.0, 0.35, -5.0 / 3.0),
    (0.0, 1.0, 0.0, 1.0),
    (0.0, -1.0, 0.18, 0.0),
    (0.0, 1.0, 0.0, 1.0),
    (0.0, -1.0, 0.28, 0.0),
    (0.0, 1.0, 0.0, -1.0),
    (0.02, 0.0, 0.02, 0.0),
];

/// Numbers in -1..1 (Knuth's linear congruential generator, high bits).
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(52) - 1.0
    }
}

impl Arm {
    pub(crate) fn new(poses: usize) -> Result<Self, BatchError> {
        let mut number = numbers(7);
        let quarter = std::f64::consts::FRAC_PI_2;
        let nominal = ROWS.map(|(a_m, alpha, d_m, theta)| Link {
            a_m,
            alpha_rad: alpha * quarter,
            d_m,
            theta_rad: theta * quarter,
            beta_rad: 0.0,
            b_m: 0.0,
        });
        let mut motions = [Motion::Revolute; 8];
        motions[0] = Motion::Fixed;
        let model = DistanceModel::new(Convention::Standard, &nominal, &motions, [0.0; 3])?;
        // without alpha0, d0, theta0 and alpha7
        let free: Vec<usize> = (0..32)
            .filter(|index| ![1, 2, 3, 29].contains(index))
            .collect();
        let mut truth = nominal;
        for (row, link) in truth.iter_mut().enumerate() {
            link.a_m += 2e-3 * number();
            if row > 0 {
                link.d_m += 2e-3 * number();
                link.theta_rad += 1e-2 * number();
            }
            if row > 0 && row < 7 {
                link.alpha_rad += 1e-2 * number();
            }
        }
        let chain = Chain::new(Convention::Standard, &truth, &motions)?;
        let mut joints = vec![vec![0.0; poses]; 7];
        let distances_m: Vec<f64> = (0..poses)
            .map(|pose| {
                let variables: [f64; 7] = std::array::from_fn(|_| 1.2 * number());
                for (joint, variable) in joints.iter_mut().zip(variables) {
                    joint[pose] = variable;
                }
                let end = chain.pose(&variables)?;
                let distance = distance_m(&end.position_m, &[0.0; 3].into())?;
                Ok(distance + 2e-5 * (number() + number() + number()))
            })
            .collect::<Result<_, KinematicsError>>()?;
        let weights = vec![5e4; poses];
        let poses = PoseBatch::new(&motions, &joints, &distances_m, &weights)?;
        Ok(Self {
            model,
            poses,
            joints,
            distances_m,
            weights,
            free,
        })
    }
}
