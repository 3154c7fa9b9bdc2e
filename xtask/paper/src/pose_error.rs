//! Errors of the handle's pose before and after, as they are and without what no distance shows.

use anyhow::Result;
use haptical_metrics::{best_rotation, orientation_angle_rad, position_errors_m};
use haptical_model::kinematics::Pose;
use haptical_model::{Device, Recording};
use haptical_simulator::true_poses;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Errors at the poses of a recording's joint readings.
#[derive(Debug, Clone)]
pub struct PoseErrors {
    pub(crate) position_before_m: Vec<f64>,
    pub(crate) position_after_m: Vec<f64>,
    /// After, with the best rotation about frame (-1)'s origin taken off.
    pub position_observable_m: Vec<f64>,
    pub(crate) orientation_before_rad: Vec<f64>,
    pub(crate) orientation_after_rad: Vec<f64>,
    /// After, with that rotation and the twist alpha_n taken off.
    pub(crate) orientation_observable_rad: Vec<f64>,
    pub(crate) distance_before_m: Vec<f64>,
    /// Error of the distance after \[m\], row by row.
    pub distance_after_m: Vec<f64>,
    /// Euclidean norm of all joint readings: how far the pose is from home.
    pub(crate) from_home_rad: Vec<f64>,
    /// The same of the cable-driven joints 1 to 4 alone, whose errors grow with their readings.
    pub(crate) driven_from_home_rad: Vec<f64>,
}

impl PoseErrors {
    /// Errors of two devices against the true one at the joint readings of a recording.
    pub fn new(
        truth: &Device,
        nominal: &Device,
        calibrated: &Device,
        readings: &Recording,
    ) -> Result<Self> {
        let actual = true_poses(truth, readings)?;
        let before = true_poses(nominal, readings)?;
        let after = true_poses(calibrated, readings)?;
        let observable = take_off_unobservable(&actual, &after)?;
        let angles = |poses: &[Pose]| -> Result<Vec<f64>> {
            let angle = |(pose, actual): (&Pose, &Pose)| {
                let turns = [rows(&pose.rotation), rows(&actual.rotation)];
                Ok(orientation_angle_rad(&turns[0], &turns[1])?)
            };
            poses.iter().zip(&actual).map(angle).collect()
        };
        let distances = |poses: &[Pose]| -> Vec<f64> {
            let pairs = poses.iter().zip(&actual);
            pairs
                .map(|(pose, actual)| pose.position_m.norm() - actual.position_m.norm())
                .collect()
        };
        let norms = |joints: usize| -> Vec<f64> {
            let norm = |row: usize| {
                let columns = readings.joint.iter().take(joints);
                let squares = columns.map(|column| column[row].powi(2));
                squares.sum::<f64>().sqrt()
            };
            (0..readings.len()).map(norm).collect()
        };
        Ok(Self {
            position_before_m: position_errors_m(&points(&before), &points(&actual))?,
            position_after_m: position_errors_m(&points(&after), &points(&actual))?,
            position_observable_m: position_errors_m(&points(&observable), &points(&actual))?,
            orientation_before_rad: angles(&before)?,
            orientation_after_rad: angles(&after)?,
            orientation_observable_rad: angles(&observable)?,
            distance_before_m: distances(&before),
            distance_after_m: distances(&after),
            from_home_rad: norms(readings.joint.len()),
            driven_from_home_rad: norms(4),
        })
    }
}

/// The calibrated poses turned by the best rotation about frame (-1)'s origin, and about the
/// handle's x axis by the best constant angle (docs/equations.md, "Unobservable part of the pose").
fn take_off_unobservable(actual: &[Pose], calibrated: &[Pose]) -> Result<Vec<Pose>> {
    let turn = Matrix3::from(best_rotation(&points(calibrated), &points(actual))?).transpose();
    let turned: Vec<Pose> = calibrated
        .iter()
        .map(|pose| Pose {
            position_m: turn * pose.position_m,
            rotation: turn * pose.rotation,
        })
        .collect();
    let twist: f64 = turned
        .iter()
        .zip(actual)
        .map(|(pose, actual)| {
            let rest = pose.rotation.transpose() * actual.rotation;
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rest))
                .scaled_axis()
                .x
        })
        .sum::<f64>()
        / turned.len() as f64;
    let twist = Rotation3::from_axis_angle(&Vector3::x_axis(), twist).into_inner();
    Ok(turned
        .into_iter()
        .map(|pose| Pose {
            rotation: pose.rotation * twist,
            ..pose
        })
        .collect())
}

fn points(poses: &[Pose]) -> Vec<[f64; 3]> {
    poses.iter().map(|pose| pose.position_m.into()).collect()
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    matrix.transpose().into()
}
