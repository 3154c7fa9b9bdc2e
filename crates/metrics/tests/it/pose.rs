//! Orientation angles against planted rotations, Kabsch against planted frames.

use std::f64::consts::PI;

use haptical_metrics::{MetricsError, best_rotation, orientation_angle_rad, position_errors_m};
use proptest::prelude::*;

type Rotation = [[f64; 3]; 3];

/// Rounding of two 3 by 3 products near the identity.
const ANGLE_ROUNDING_RAD: f64 = 1e-14;
/// Rounding of a singular value decomposition of well separated points.
const ROTATION_ROUNDING: f64 = 1e-12;

/// Rodrigues' formula, written out independently of the crate.
fn rotation_about(axis: [f64; 3], angle_rad: f64) -> Rotation {
    let norm = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|v| v / norm);
    let (s, c) = angle_rad.sin_cos();
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

fn product(a: &Rotation, b: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(a: &Rotation, p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * p[k]).sum())
}

fn determinant(a: &Rotation) -> f64 {
    (0..3)
        .map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[0][i] * (a[1][j] * a[2][k] - a[1][k] * a[2][j])
        })
        .sum()
}

fn largest_difference(a: &Rotation, b: &Rotation) -> f64 {
    (0..9)
        .map(|k| (a[k / 3][k % 3] - b[k / 3][k % 3]).abs())
        .fold(0.0, f64::max)
}

const POINTS: [[f64; 3]; 5] = [
    [0.3, 0.1, -0.2],
    [-0.1, 0.4, 0.25],
    [0.2, -0.35, 0.1],
    [0.05, 0.2, 0.5],
    [-0.3, -0.1, 0.15],
];

#[test]
fn orientation_angle_is_accurate_from_zero_to_pi() {
    let start = rotation_about([1.0, -2.0, 0.5], 0.8);
    for angle in [
        0.0,
        1e-12,
        1e-9,
        1e-5,
        0.03,
        1.0,
        2.5,
        PI - 1e-5,
        PI - 1e-9,
        PI,
    ] {
        let end = product(&start, &rotation_about([0.3, 0.4, -1.0], angle));
        let found = orientation_angle_rad(&start, &end).unwrap();
        assert!(
            (found - angle).abs() < ANGLE_ROUNDING_RAD,
            "{angle}: {found}"
        );
    }
}

#[test]
fn orientation_angle_refuses_what_is_no_rotation() {
    let identity = rotation_about([0.0, 0.0, 1.0], 0.0);
    let mirror = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    let stretched = [[1.001, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let nan = [[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for bad in [mirror, stretched, [[0.0; 3]; 3]] {
        let error = orientation_angle_rad(&identity, &bad).unwrap_err();
        assert!(
            matches!(error, MetricsError::NotARotation { what: "b", .. }),
            "{error}"
        );
    }
    assert!(matches!(
        orientation_angle_rad(&nan, &identity),
        Err(MetricsError::NonFinite {
            what: "a",
            index: 0,
            ..
        })
    ));
    let written_with_seven_digits = [
        [1.0, 0.0, 0.0],
        [0.0, 0.5403023, -0.841471],
        [0.0, 0.841471, 0.5403023],
    ];
    let angle = orientation_angle_rad(&identity, &written_with_seven_digits).unwrap();
    assert!((angle - 1.0).abs() < 1e-6, "{angle}");
}

#[test]
fn position_errors_are_pairwise_distances() {
    let errors = position_errors_m(
        &[[1.0, 2.0, 3.0], [0.0; 3]],
        &[[1.0, 2.0, 3.5], [3.0, 4.0, 12.0]],
    );
    assert_eq!(errors.unwrap(), [0.5, 13.0]);
    assert!(matches!(
        position_errors_m(&[[0.0; 3]], &[]),
        Err(MetricsError::LengthMismatch {
            left_len: 1,
            right_len: 0,
            ..
        })
    ));
    assert!(position_errors_m(&[], &[]).is_err());
    assert!(position_errors_m(&[[0.0, f64::NAN, 0.0]], &[[0.0; 3]]).is_err());
    assert!(position_errors_m(&[[-1e308, 0.0, 0.0]], &[[1e308, 0.0, 0.0]]).is_err());
}

#[test]
fn kabsch_recovers_a_planted_rotation() {
    for angle in [0.0, 1e-8, 0.4, 2.0, PI] {
        let planted = rotation_about([0.2, -1.0, 0.7], angle);
        let moved = POINTS.map(|p| apply(&planted, p));
        let found = best_rotation(&POINTS, &moved).unwrap();
        assert!(
            largest_difference(&found, &planted) < ROTATION_ROUNDING,
            "{angle}: {found:?}"
        );
    }
}

#[test]
fn kabsch_recovers_from_points_in_a_plane_and_from_two_points() {
    let planted = rotation_about([1.0, 1.0, -0.3], 1.9);
    let plane = POINTS.map(|p| [p[0], p[1], 0.0]);
    for points in [&plane[..], &POINTS[..2]] {
        let moved: Vec<[f64; 3]> = points.iter().map(|&p| apply(&planted, p)).collect();
        let found = best_rotation(points, &moved).unwrap();
        assert!(
            largest_difference(&found, &planted) < ROTATION_ROUNDING,
            "{found:?}"
        );
    }
}

#[test]
fn kabsch_never_returns_a_reflection() {
    let mirrored = POINTS.map(|p| [p[0], p[1], -p[2]]);
    let found = best_rotation(&POINTS, &mirrored).unwrap();
    assert!((determinant(&found) - 1.0).abs() < ROTATION_ROUNDING);
    // No rotation in the neighbourhood carries the points closer to their mirror image.
    let cost = |r: &Rotation| -> f64 {
        let pairs = POINTS.iter().zip(&mirrored);
        pairs
            .map(|(&p, q)| position_errors_m(&[apply(r, p)], &[*q]).unwrap()[0].powi(2))
            .sum()
    };
    let best = cost(&found);
    for axis in [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, -1.0, 2.0],
    ] {
        for angle in [-2.0, -0.5, -0.01, 0.01, 0.5, 2.0, PI] {
            assert!(cost(&product(&found, &rotation_about(axis, angle))) > best);
        }
    }
}

#[test]
fn kabsch_refuses_points_that_leave_the_rotation_open() {
    let line = [[0.1, 0.2, 0.3], [-0.2, -0.4, -0.6], [1.0, 2.0, 3.0]];
    let error = best_rotation(&line, &line).unwrap_err();
    assert!(
        matches!(error, MetricsError::RotationNotUnique { .. }),
        "{error}"
    );
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let inverted = axes.map(|p| p.map(|v| -v));
    assert!(best_rotation(&axes, &inverted).is_err());
    assert!(best_rotation(&[[0.0; 3]], &[[0.0; 3]]).is_err());
    assert!(best_rotation(&[], &[]).is_err());
    assert!(best_rotation(&[[f64::NAN; 3]], &[[0.0; 3]]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn orientation_angle_is_symmetric_and_bounded(
        first in prop::array::uniform3(0.1..1.0_f64), a in -3.0..3.0_f64,
        second in prop::array::uniform3(-1.0..-0.1_f64), b in -3.0..3.0_f64,
    ) {
        let (p, q) = (rotation_about(first, a), rotation_about(second, b));
        let forward = orientation_angle_rad(&p, &q).unwrap();
        let backward = orientation_angle_rad(&q, &p).unwrap();
        prop_assert!((forward - backward).abs() < 1e-12);
        prop_assert!((0.0..=PI).contains(&forward));
    }

    #[test]
    fn kabsch_result_is_proper_for_any_points(
        from in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 3..8),
        noise in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 8),
    ) {
        let to: Vec<[f64; 3]> = from.iter().zip(&noise).map(|(_, n)| *n).collect();
        if let Ok(found) = best_rotation(&from, &to) {
            let transposed: Rotation = std::array::from_fn(|i| std::array::from_fn(|j| found[j][i]));
            let identity = rotation_about([0.0, 0.0, 1.0], 0.0);
            prop_assert!(largest_difference(&product(&transposed, &found), &identity) < 1e-12);
            prop_assert!((determinant(&found) - 1.0).abs() < 1e-12);
        }
    }
}
