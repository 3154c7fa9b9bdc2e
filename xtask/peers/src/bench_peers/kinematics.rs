//! Pose and 6x7 Jacobian of the nominal chain: ours and Pinocchio's, for one pose and for many.

use std::hint::black_box;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use haptical_batch::PoseLanes;
use haptical_model::kinematics::{Chain, Convention, Link, Motion, Pose, PreparedChain, Twist};
use serde_json::Value;

use super::contender::{Answer, Contender, Label};
use super::files::DataSet;
use super::ours::COLD;

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

    /// Every number of every pose, in the order in which the peer says them. The three ways of ours must
    /// agree.
    pub(crate) fn values(&self) -> Result<Vec<f64>> {
        let chain = Chain::new(self.convention, &self.links, &self.motions)?;
        let prepared = PreparedChain::<JOINTS>::new(&chain)?;
        let mut lanes = PoseLanes::<JOINTS>::new(&chain)?;
        lanes.evaluate(&self.columns())?;
        let [mut plain, mut fast, mut laned] = [const { Vec::new() }; 3];
        for (index, joints_rad) in self.joints_rad.iter().enumerate() {
            let mut columns = [Twist::default(); JOINTS];
            let pose = chain.geometric_jacobian(joints_rad, &mut columns)?;
            extend(&mut plain, &pose, &columns);
            let pose = prepared.pose_and_jacobian(joints_rad, &mut columns)?;
            extend(&mut fast, &pose, &columns);
            let found = lanes.pose(index).zip(lanes.jacobian(index));
            let (pose, columns) = found.context("a pose is missing")?;
            extend(&mut laned, &pose, &columns);
        }
        check_numbers("PreparedChain", &fast, &plain)?;
        check_numbers("PoseLanes", &laned, &plain)?;
        Ok(plain)
    }

    /// Joint variables joint by joint, as recordings hold them \[rad\].
    fn columns(&self) -> [Vec<f64>; JOINTS] {
        std::array::from_fn(|joint| self.joints_rad.iter().map(|pose| pose[joint]).collect())
    }

    fn first(&self, poses: usize) -> Self {
        let count = poses.min(self.joints_rad.len());
        Self {
            joints_rad: self.joints_rad[..count].to_vec(),
            ..self.clone()
        }
    }
}

/// Adds the numbers of a pose and its Jacobian, rows of [R p] and rows of the Jacobian.
fn extend(values: &mut Vec<f64>, pose: &Pose, columns: &[Twist; JOINTS]) {
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

/// Refuses a peer whose poses or Jacobians are not ours; `answer` is its line of JSON.
pub(crate) fn check_values(peer: &str, answer: &str, ours: &[f64]) -> Result<f64> {
    let value: Value = serde_json::from_str(answer)?;
    let theirs = value["values"].as_array().context("no values")?;
    let theirs: Option<Vec<f64>> = theirs.iter().map(Value::as_f64).collect();
    check_numbers(peer, &theirs.context("not a number")?, ours)
}

/// Refuses numbers that are not ours; the largest difference otherwise.
fn check_numbers(name: &str, found: &[f64], ours: &[f64]) -> Result<f64> {
    let (count, expected) = (found.len(), ours.len());
    ensure!(
        count == expected,
        "{name} answered {count} numbers, not {expected}"
    );
    let mut largest: f64 = 0.0;
    for (index, (found, ours)) in found.iter().zip(ours).enumerate() {
        let difference = (found - ours).abs();
        let (pose, number) = (index / NUMBERS, index % NUMBERS);
        // written so that a NaN is refused
        let agrees = difference <= VALUE_AGREEMENT;
        ensure!(
            agrees,
            "{name}: number {number} of pose {pose} is {found}, ours is {ours}: no times are reported"
        );
        largest = largest.max(difference);
    }
    Ok(largest)
}

/// Our fastest call: the first `poses` poses, `calls` times over. One pose is the prepared chain's, several
/// go through the lanes, whose joint variables are laid out joint by joint.
pub(crate) struct OursChain {
    label: Label,
    set: Poses,
    columns: [Vec<f64>; JOINTS],
    calls: usize,
}

impl OursChain {
    pub(crate) fn new(set: &Poses, poses: usize, calls: usize) -> Self {
        let set = set.first(poses);
        let name = match set.joints_rad.len() {
            1 => "PreparedChain::pose_and_jacobian",
            _ => "PoseLanes::evaluate",
        };
        Self {
            label: Label::new(COLD, name, 1),
            columns: set.columns(),
            set,
            calls,
        }
    }

    /// Times of `work`, one call over all poses.
    fn time(&self, repeats: usize, mut work: impl FnMut() -> Result<()>) -> Result<Answer> {
        let mut answer = Answer::default();
        for _ in 0..repeats.max(1) {
            let start = Instant::now();
            for _ in 0..self.calls {
                work()?;
            }
            let calls = self.calls * self.set.joints_rad.len();
            let call_s = start.elapsed().as_secs_f64() / calls as f64;
            answer.solve_s.push(call_s);
        }
        Ok(answer)
    }
}

impl Contender for OursChain {
    fn label(&self) -> &Label {
        &self.label
    }

    fn run(&mut self, repeats: usize) -> Result<Answer> {
        let Poses {
            convention,
            links,
            motions,
            joints_rad,
        } = &self.set;
        let chain = Chain::new(*convention, links, motions)?;
        if let [joints_rad] = joints_rad.as_slice() {
            let prepared = PreparedChain::new(&chain)?;
            let mut found = (Pose::default(), [Twist::default(); JOINTS]);
            return self.time(repeats, || {
                let (pose, columns) = &mut found;
                *pose = prepared.pose_and_jacobian(black_box(joints_rad), columns)?;
                black_box(&found);
                Ok(())
            });
        }
        let mut lanes = PoseLanes::<JOINTS>::new(&chain)?;
        lanes.evaluate(&self.columns)?;
        self.time(repeats, || {
            lanes.evaluate(black_box(&self.columns))?;
            black_box(&lanes);
            Ok(())
        })
    }
}
