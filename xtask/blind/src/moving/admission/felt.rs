//! How much of a wrong zero or a wrong description the torques feel.

use crate::moving::arms::Arm;
use crate::moving::motion::rigid::{At, Chain};
use crate::moving::scene::Scene;

/// Share of the moments at which the difference is at least as large as stated.
const PEAK_SHARE: f64 = 0.02;
/// From this share of a drive's range on a difference is felt.
pub(super) const FELT: f64 = 0.03;

/// What the bodies of a chain and the rotors ask for along the first course, joint by joint.
pub(super) fn needed(scene: &Scene, chain: &Chain) -> Vec<Vec<f64>> {
    let mut at = At::default();
    let mut columns = vec![Vec::new(); scene.arm.count()];
    for asked in scene.asked() {
        chain.at(&asked.angle, &asked.rate, &mut at);
        for (joint, axis) in scene.arm.axes.iter().enumerate() {
            columns[joint].push(at.needed(joint, &asked.acceleration, axis.armature));
        }
    }
    columns
}

/// The part of gravity alone, one angle off by so much.
pub(super) fn held(scene: &Scene, joint: usize, off: f64) -> Vec<Vec<f64>> {
    let (chain, still) = (scene.arm.chain(), vec![0.0; scene.arm.count()]);
    let mut at = At::default();
    let mut columns = vec![Vec::new(); scene.arm.count()];
    for mut asked in scene.asked() {
        asked.angle[joint] += off;
        chain.at(&asked.angle, &still, &mut at);
        for (column, bias) in columns.iter_mut().zip(&at.bias) {
            column.push(*bias);
        }
    }
    columns
}

/// What a fiftieth of the moments exceeds of the difference of torques, over the range of the drive, worst joint.
pub(crate) fn largest_apart(arm: &Arm, one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let of_joint = |(axis, (one, other)): (&crate::moving::arms::Axis, (&Vec<f64>, &Vec<f64>))| {
        let apart = one
            .iter()
            .zip(other)
            .map(|(one, other)| (one - other).abs());
        let mut apart: Vec<f64> = apart.collect();
        apart.sort_by(f64::total_cmp);
        let place = ((1.0 - PEAK_SHARE) * apart.len() as f64) as usize;
        apart.get(place).map_or(0.0, |apart| apart / axis.range)
    };
    let joints = arm.axes.iter().zip(one.iter().zip(other)).map(of_joint);
    joints.fold(0.0, f64::max)
}
