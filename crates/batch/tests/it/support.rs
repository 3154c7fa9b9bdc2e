//! Random chains, poses and recordings of their distances.

use haptical_batch::{DistanceModel, PoseBatch};
use haptical_kinematics::{Chain, Convention, Link, Motion, Parameter, distance_m};
use haptical_linalg::Matrix;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A chain and its poses.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) convention: Convention,
    pub(crate) links: Vec<Link>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) anchor_m: [f64; 3],
    /// One per moving row, one entry per pose.
    pub(crate) joints: Vec<Vec<f64>>,
    pub(crate) distances_m: Vec<f64>,
    pub(crate) weights: Vec<f64>,
}

impl Case {
    pub(crate) fn model(&self) -> DistanceModel {
        DistanceModel::new(self.convention, &self.links, &self.motions, self.anchor_m).unwrap()
    }

    /// All six parameters of every row.
    pub(crate) fn full_model(&self) -> DistanceModel {
        let rows = 0..self.links.len();
        let all: Vec<(usize, Parameter)> = rows
            .flat_map(|row| Parameter::ALL.map(|parameter| (row, parameter)))
            .collect();
        self.model().with_parameters(&all).unwrap()
    }

    pub(crate) fn batch(&self) -> PoseBatch {
        let (motions, joints) = (&self.motions, &self.joints);
        PoseBatch::new(motions, joints, &self.distances_m, &self.weights).unwrap()
    }

    pub(crate) fn poses(&self) -> usize {
        self.distances_m.len()
    }

    pub(crate) fn variables(&self, pose: usize) -> Vec<f64> {
        self.joints.iter().map(|joint| joint[pose]).collect()
    }

    /// Distance of a pose by the chain itself.
    pub(crate) fn distance(&self, links: &[Link], pose: usize) -> f64 {
        let chain = Chain::new(self.convention, links, &self.motions).unwrap();
        let end = chain.pose(&self.variables(pose)).unwrap();
        distance_m(&end.position_m, &self.anchor_m.into()).unwrap()
    }
}

/// Numbers in -1..1 from a seed.
pub(crate) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    move || generator.random_range(-1.0..1.0)
}

/// A chain of `rows` rows, the first fixed, and poses; the measured distances are 1 mm off at random.
pub(crate) fn random_case(
    convention: Convention,
    motions: &[Motion],
    poses: usize,
    seed: u64,
) -> Case {
    let mut number = numbers(seed);
    let links: Vec<Link> = motions
        .iter()
        .map(|_| Link {
            a_m: 0.3 * number(),
            alpha_rad: 1.5 * number(),
            d_m: 0.3 * number(),
            theta_rad: 3.0 * number(),
            beta_rad: if number() > 0.0 { 0.2 * number() } else { 0.0 },
            b_m: if number() > 0.0 { 0.2 * number() } else { 0.0 },
        })
        .collect();
    let moving = motions.iter().filter(|motion| **motion != Motion::Fixed);
    let joints = moving
        .map(|motion| {
            let size = if *motion == Motion::Revolute {
                2.0
            } else {
                0.2
            };
            (0..poses).map(|_| size * number()).collect()
        })
        .collect();
    let anchor_m = [0.1 * number(), 0.1 * number(), 2.0 + number()];
    let mut case = Case {
        convention,
        links,
        motions: motions.to_vec(),
        anchor_m,
        joints,
        distances_m: vec![0.0; poses],
        weights: (0..poses).map(|_| 1000.0 + 500.0 * number()).collect(),
    };
    for pose in 0..poses {
        case.distances_m[pose] = case.distance(&case.links, pose) + 1e-3 * number();
    }
    case
}

pub(crate) fn convention() -> impl Strategy<Value = Convention> {
    prop_oneof![Just(Convention::Standard), Just(Convention::Modified)]
}

/// A fixed row and 1 to 8 joints, mostly revolute.
pub(crate) fn motions() -> impl Strategy<Value = Vec<Motion>> {
    let joint = prop_oneof![
        5 => Just(Motion::Revolute),
        1 => Just(Motion::Prismatic),
        1 => Just(Motion::Fixed)
    ];
    prop::collection::vec(joint, 1..=8).prop_map(|mut joints| {
        joints.insert(0, Motion::Fixed);
        joints
    })
}

pub(crate) fn case(poses: std::ops::Range<usize>) -> impl Strategy<Value = Case> {
    (convention(), motions(), poses, any::<u64>()).prop_map(|(convention, motions, poses, seed)| {
        random_case(convention, &motions, poses, seed)
    })
}

/// Residuals and derivatives of all poses, put together.
pub(crate) fn all_rows(
    poses: &PoseBatch,
    model: &DistanceModel,
    parameters: &[f64],
    free: &[usize],
) -> (Vec<f64>, Matrix) {
    let mut residuals = vec![0.0; poses.len()];
    let mut jacobian = Matrix::zeros(poses.len(), free.len());
    let visited = poses.visit(model, parameters, free, |tile| {
        let own = tile.first_pose()..tile.first_pose() + tile.residuals().len();
        residuals[own.clone()].copy_from_slice(tile.residuals());
        for (column, derivatives) in tile.derivatives().enumerate() {
            jacobian.column_mut(column)[own.clone()].copy_from_slice(derivatives);
        }
    });
    visited.unwrap();
    (residuals, jacobian)
}

pub(crate) fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    }
}
