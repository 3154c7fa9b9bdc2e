//! Middle and spread of points.

use haptical_model::kinematics::nalgebra::Vector3;

pub(crate) fn mean(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// Root mean square distance from the middle.
pub(crate) fn spread_m(points: &[Vector3<f64>]) -> f64 {
    let middle = mean(points);
    let square: f64 = points.iter().map(|at| (at - middle).norm_squared()).sum();
    (square / points.len().max(1) as f64).sqrt()
}
