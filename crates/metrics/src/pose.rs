//! Position and orientation errors between two sets of poses, and the rotation between two frames.

use nalgebra::{DMatrix, Matrix3};

use crate::error::{
    MetricsError, check_all_finite, check_same_length, check_values, finite_result, largest_size,
};

/// Largest entry of `|A^T A - I|` accepted of a rotation: matrices read from files carry 7 digits.
const ROTATION_TOLERANCE: f64 = 1e-6;
/// Smallest separation of singular values that determines a rotation, over the largest of them.
const SEPARATION_NEEDED: f64 = 1e-10;
/// Bound on the iterations of the singular value decomposition; a 3 by 3 matrix takes about ten.
const SVD_ITERATIONS: usize = 1000;

/// Angle of the rotation from `a` to `b`, in rad, from 0 to pi.
///
/// With `R = a^T b` and `w = (R32 - R23, R13 - R31, R21 - R12)` the angle is
/// `atan2(|w|, trace(R) - 1)`: both arguments carry the same factor 2, and the quotient is accurate
/// near 0 and near pi, where the arc cosine of the trace alone is not. `a` and `b` are rotation
/// matrices, rows first. Source: Shuster, A survey of attitude representations, 1993.
///
/// # Errors
/// [`MetricsError::NonFinite`], [`MetricsError::NotARotation`] when an entry of `|A^T A - I|`
/// exceeds 1e-6 or the determinant is negative.
///
/// # Examples
/// ```
/// let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let (sin, cos) = 1e-9_f64.sin_cos();
/// let turned = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
/// let angle = haptical_metrics::orientation_angle_rad(&identity, &turned)?;
/// assert!((angle - 1e-9).abs() < 1e-22);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn orientation_angle_rad(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> Result<f64, MetricsError> {
    let relative = rotation("a", a)?.transpose() * rotation("b", b)?;
    let twice_axis = [
        relative[(2, 1)] - relative[(1, 2)],
        relative[(0, 2)] - relative[(2, 0)],
        relative[(1, 0)] - relative[(0, 1)],
    ];
    Ok(norm(twice_axis).atan2(relative.trace() - 1.0))
}

/// Distances between paired points, in m: `|b[k] - a[k]|`.
///
/// # Errors
/// [`MetricsError::LengthMismatch`], [`MetricsError::TooFew`] for empty slices,
/// [`MetricsError::NonFinite`], [`MetricsError::Overflow`].
///
/// # Examples
/// ```
/// let errors = haptical_metrics::position_errors_m(&[[0.0, 0.0, 1.0]], &[[2.0, 3.0, 7.0]])?;
/// assert_eq!(errors, [7.0]);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn position_errors_m(a: &[[f64; 3]], b: &[[f64; 3]]) -> Result<Vec<f64>, MetricsError> {
    check_point_pairs(("a", a), ("b", b))?;
    a.iter()
        .zip(b)
        .map(|(p, q)| {
            let distance = norm([q[0] - p[0], q[1] - p[1], q[2] - p[2]]);
            finite_result("a position error", distance)
        })
        .collect()
}

/// Rotation about the origin that best carries `from` onto `to`, rows first.
///
/// `R` minimises `sum |R from[k] - to[k]|^2` over proper rotations: with the singular value
/// decomposition `sum to[k] from[k]^T = U S V^T`, `R = U diag(1, 1, det(U V^T)) V^T`. No
/// translation is fitted; both sets are in frames that share the origin. Any unit, the same within
/// each set. Source: Kabsch, A discussion of the solution for the best rotation to relate two sets
/// of vectors, 1978.
///
/// # Errors
/// [`MetricsError::LengthMismatch`], [`MetricsError::TooFew`] for empty slices,
/// [`MetricsError::NonFinite`], [`MetricsError::RotationNotUnique`] when the points lie on one line
/// through the origin or several rotations fit equally well, [`MetricsError::NoConvergence`].
///
/// # Examples
/// ```
/// let from = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
/// let to = [[0.0, 1.0, 0.0], [-2.0, 0.0, 0.0]];
/// let rotation = haptical_metrics::best_rotation(&from, &to)?;
/// assert!((rotation[1][0] - 1.0).abs() < 1e-12 && (rotation[0][1] + 1.0).abs() < 1e-12);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn best_rotation(from: &[[f64; 3]], to: &[[f64; 3]]) -> Result<[[f64; 3]; 3], MetricsError> {
    check_point_pairs(("from", from), ("to", to))?;
    let scale = |points: &[[f64; 3]]| largest_size(points.as_flattened());
    let (from_scale, to_scale) = (scale(from), scale(to));
    if from_scale == 0.0 || to_scale == 0.0 {
        return Err(not_unique(0.0));
    }
    // A dynamic matrix on purpose: nalgebra's own 3 by 3 decomposition squares the matrix, which
    // halves the digits of the small singular values. Scaled first, so that products stay finite.
    let mut sum = DMatrix::<f64>::zeros(3, 3);
    for (p, q) in from.iter().zip(to) {
        for row in 0..3 {
            for column in 0..3 {
                sum[(row, column)] += (q[row] / to_scale) * (p[column] / from_scale);
            }
        }
    }
    let iterations = SVD_ITERATIONS;
    let what = "the singular value decomposition";
    let no_convergence = MetricsError::NoConvergence { what, iterations };
    let svd = sum
        .try_svd(true, true, 5.0 * f64::EPSILON, iterations)
        .ok_or_else(|| no_convergence.clone())?;
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Err(no_convergence);
    };
    let sign = if u.determinant() * v_t.determinant() < 0.0 {
        -1.0
    } else {
        1.0
    };
    let singular = svd.singular_values;
    // The sum of the two smallest, the last one signed, is the curvature at the optimum.
    let separation = if singular[0] > 0.0 {
        (singular[1] + sign * singular[2]) / singular[0]
    } else {
        0.0
    };
    if separation < SEPARATION_NEEDED {
        return Err(not_unique(separation));
    }
    let mut rotation = [[0.0; 3]; 3];
    for (row, entries) in rotation.iter_mut().enumerate() {
        for (column, entry) in entries.iter_mut().enumerate() {
            *entry = u[(row, 0)] * v_t[(0, column)]
                + u[(row, 1)] * v_t[(1, column)]
                + sign * u[(row, 2)] * v_t[(2, column)];
        }
    }
    Ok(rotation)
}

fn not_unique(separation: f64) -> MetricsError {
    MetricsError::RotationNotUnique {
        separation,
        needed: SEPARATION_NEEDED,
    }
}

/// The matrix as nalgebra's type, once it is known to be a rotation.
fn rotation(what: &'static str, rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, MetricsError> {
    check_values(what, rows.as_flattened(), 9)?;
    let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
    let mut deviation = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    if deviation <= ROTATION_TOLERANCE && matrix.determinant() < 0.0 {
        deviation = 2.0;
    }
    if deviation <= ROTATION_TOLERANCE {
        Ok(matrix)
    } else {
        Err(MetricsError::NotARotation {
            what,
            deviation,
            tolerance: ROTATION_TOLERANCE,
        })
    }
}

fn check_point_pairs(
    (left, a): (&'static str, &[[f64; 3]]),
    (right, b): (&'static str, &[[f64; 3]]),
) -> Result<(), MetricsError> {
    check_same_length((left, a.len()), (right, b.len()))?;
    check_values(left, a.as_flattened(), 1)?;
    check_all_finite(right, b.as_flattened())
}

/// Euclidean norm without overflow of the squares.
fn norm(vector: [f64; 3]) -> f64 {
    vector[0].hypot(vector[1]).hypot(vector[2])
}
