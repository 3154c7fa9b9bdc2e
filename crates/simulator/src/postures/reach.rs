//! The posture near another one in which a point on the hand is where it touches something.

use haptical_model::kinematics::nalgebra::{Matrix4, Vector3, Vector4};
use haptical_model::{Device, Evaluation};

/// Steps of the search.
const STEPS: usize = 80;
/// Tolerance of a touch \[m\], rounding.
const MET_M: f64 = 1e-11;
/// Longest step of a joint \[rad, m\]: far from there the slopes mean little.
const MOST: f64 = 0.3;
/// Share of the slopes' squares that keeps a singular posture from a step without end.
const DAMPING: f64 = 1e-10;

/// What a point on the hand is to meet.
#[derive(Debug, Clone, Default)]
pub(crate) struct Target {
    /// The point, seen from the handle \[m\].
    pub(crate) arm_m: Vector3<f64>,
    /// Directions in frame (-1), and how far along each the point is to be \[m\]; four at most.
    pub(crate) along: Vec<(Vector3<f64>, f64)>,
}

impl Target {
    /// A point in frame (-1) \[m\].
    pub(crate) fn add_point(&mut self, point_m: &Vector3<f64>) {
        for axis in 0..3 {
            self.along.push((Vector3::ith(axis, 1.0), point_m[axis]));
        }
    }
}

/// Readings near `start`, within the joints' limits, at which a target is met: Newton's steps of least length. A joint
/// that comes to a limit stays there. None where they do not get there.
///
/// `evaluation` is of the hand that touches.
pub(crate) fn reach(
    device: &Device,
    evaluation: &mut Evaluation<'_>,
    start: &[f64],
    target: &Target,
) -> Option<Vec<f64>> {
    let mut readings = start.to_vec();
    let mut is_free = vec![true; readings.len()];
    for _ in 0..STEPS {
        evaluation.move_to(&readings).ok()?;
        let handle = *evaluation.pose().ok()?;
        let arm = handle.rotation * target.arm_m;
        let at_m = handle.position_m + arm;
        let mut gap = Vector4::zeros();
        for (gap, (direction, wanted)) in gap.iter_mut().zip(&target.along) {
            *gap = wanted - direction.dot(&at_m);
        }
        if gap.norm() < MET_M {
            return Some(readings);
        }
        // for each joint, how the point moves along each direction
        let slopes: Vec<Vector4<f64>> = (0..readings.len())
            .map(|joint| {
                let twist = evaluation.reading_twist(joint);
                let moved = twist.linear + twist.angular.cross(&arm);
                let mut slope = Vector4::zeros();
                let along = slope.iter_mut().zip(&target.along);
                for (slope, (direction, _)) in along.filter(|_| is_free[joint]) {
                    *slope = direction.dot(&moved);
                }
                slope
            })
            .collect();
        let mut square: Matrix4<f64> = slopes.iter().map(|slope| slope * slope.transpose()).sum();
        let damping = DAMPING * square.trace().max(f64::MIN_POSITIVE);
        for row in 0..4 {
            // directions that are not there have no gap
            square[(row, row)] += if row < target.along.len() {
                damping
            } else {
                1.0
            };
        }
        let way = square.lu().solve(&gap)?;
        let step: Vec<f64> = slopes.iter().map(|slope| slope.dot(&way)).collect();
        if !step.iter().all(|step| step.is_finite()) {
            return None;
        }
        let longest = step
            .iter()
            .fold(f64::MIN_POSITIVE, |most, step| most.max(step.abs()));
        let share = (MOST / longest).min(1.0);
        for (joint, step) in step.iter().enumerate() {
            let there = readings[joint] + share * step;
            let [low, high] = [
                device.joints[joint].lower_rad,
                device.joints[joint].upper_rad,
            ];
            readings[joint] = match () {
                () if there > high && *step > 0.0 => high.max(readings[joint]),
                () if there < low && *step < 0.0 => low.min(readings[joint]),
                () => there,
            };
            is_free[joint] &= readings[joint] == there;
        }
    }
    None
}
