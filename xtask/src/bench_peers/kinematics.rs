//! Pose and 6x7 Jacobian of the nominal chain: ours beside Pinocchio's, for one pose and for many.

use std::hint::black_box;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use haptical_model::kinematics::{Chain, Convention, Link, Motion, Pose, Twist};
use serde_json::Value;

use super::contender::{Answer, Contender};
use super::files::DataSet;

/// Largest difference of a number of pose or Jacobian (m, m/rad, no unit).
pub(crate) const VALUE_AGREEMENT: f64 = 1e-10;
/// Poses of the batch; calls that one time covers where it is always the same pose.
pub(crate) const POSES: usize = 1000;
/// Numbers of a pose (rows of [R p]) and its Jacobian (rows).
const NUMBERS: usize = 12 + 42;
const JOINTS: usize = 7;

/// The chain and its poses, as the peer reads them from the file.
#[derive(Debug, Clone)]
pub(crate) struct Poses {
    convention: Convention,
    links: Vec<Link>,
    motions: Vec<Motion>,
    /// Joint variables of each pose \[rad\].
    joints_rad: Vec<[f64; JOINTS]>,
}

impl Poses {
    pub(crate) fn new(set: &DataSet) -> Result<Self> {
        let columns = &set.recording.joint;
        ensure!(
            columns.len() == JOINTS,
            "the chain has {} joints",
            columns.len()
        );
        let mut joints_rad = vec![[0.0; JOINTS]; set.poses()];
        for (joint, column) in columns.iter().enumerate() {
            for (pose, reading) in joints_rad.iter_mut().zip(column) {
                pose[joint] = *reading;
            }
        }
        Ok(Self {
            convention: set.nominal.convention,
            links: set.nominal.chain_links(),
            motions: set.nominal.motions(),
            joints_rad,
        })
    }

    /// Every number of every pose, in the order in which the peer says them.
    pub(crate) fn values(&self) -> Result<Vec<f64>> {
        let chain = Chain::new(self.convention, &self.links, &self.motions)?;
        let mut values = Vec::with_capacity(NUMBERS * self.joints_rad.len());
        for joints_rad in &self.joints_rad {
            let mut columns = [Twist::default(); JOINTS];
            let pose = chain.geometric_jacobian(joints_rad, &mut columns)?;
            for row in 0..3 {
                values.extend((0..3).map(|column| pose.rotation[(row, column)]));
                values.push(pose.position_m[row]);
            }
            for row in 0..3 {
                values.extend(columns.iter().map(|column| column.linear[row]));
            }
            for row in 0..3 {
                values.extend(columns.iter().map(|column| column.angular[row]));
            }
        }
        Ok(values)
    }
}

/// Refuses a peer whose poses or Jacobians are not ours; `answer` is its line of JSON.
pub(crate) fn check_values(peer: &str, answer: &str, ours: &[f64]) -> Result<f64> {
    let value: Value = serde_json::from_str(answer)?;
    let theirs = value["values"].as_array().context("no values")?;
    let (found, expected) = (theirs.len(), ours.len());
    ensure!(
        found == expected,
        "{peer} answered {found} numbers, not {expected}"
    );
    let mut largest: f64 = 0.0;
    for (index, (theirs, ours)) in theirs.iter().zip(ours).enumerate() {
        let difference = (theirs.as_f64().context("not a number")? - ours).abs();
        let (pose, number) = (index / NUMBERS, index % NUMBERS);
        // written so that a NaN is refused
        let agrees = difference <= VALUE_AGREEMENT;
        ensure!(
            agrees,
            "{peer}: number {number} of pose {pose} is {theirs}, ours is {ours}: no times are reported"
        );
        largest = largest.max(difference);
    }
    Ok(largest)
}

/// The chain's own call: the first `poses` poses, `calls` times over.
pub(crate) struct OursChain {
    pub(crate) set: Poses,
    pub(crate) calls: usize,
    pub(crate) found: Vec<(Pose, [Twist; JOINTS])>,
}

impl OursChain {
    pub(crate) fn new(set: &Poses, poses: usize, calls: usize) -> Self {
        let count = poses.min(set.joints_rad.len());
        Self {
            set: set.clone(),

            calls,
            found: vec![(Pose::default(), [Twist::default(); JOINTS]); count],
        }
    }
}

impl Contender for OursChain {
    fn name(&self) -> &str {
        "Chain::geometric_jacobian"
    }

    fn family(&self) -> &str {
        "ours"
    }

    fn run(&mut self, repeats: usize) -> Result<Answer> {
        let Poses {
            convention,
            links,
            motions,
            joints_rad,
        } = &self.set;
        let chain = Chain::new(*convention, links, motions)?;
        let mut answer = Answer::default();
        for _ in 0..repeats.max(1) {
            let start = Instant::now();
            for _ in 0..self.calls {
                for (joints_rad, (pose, columns)) in joints_rad.iter().zip(&mut self.found) {
                    *pose = chain.geometric_jacobian(black_box(joints_rad), columns)?;
                }
                black_box(&self.found);
            }
            let calls = self.calls * self.found.len();
            answer
                .solve_s
                .push(start.elapsed().as_secs_f64() / calls as f64);
        }
        Ok(answer)
    }
}
