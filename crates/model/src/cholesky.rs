//! Small symmetric positive definite systems, such as a mass matrix, in place and without allocation.

use haptical_dynamics::DynamicsError;

/// A pivot, per diagonal entry, below which it is rounding.
const ROUNDING: f64 = 1e-14;

/// The Cholesky factor of a symmetric positive definite matrix (count x count, row by row), below and on its diagonal, in
/// its place.
///
/// ```
/// use haptical_model::cholesky::{factor, solve};
/// let (mut matrix, mut vector) = ([4.0, 2.0, 2.0, 5.0], [6.0, 7.0]);
/// factor(&mut matrix, 2)?;
/// solve(&matrix, &mut vector);
/// assert_eq!(vector, [1.0, 1.0]);
/// # Ok::<(), haptical_model::dynamics::DynamicsError>(())
/// ```
///
/// # Errors
/// [`DynamicsError::NoInertia`] for the first joint whose pivot is rounding.
pub fn factor(matrix: &mut [f64], count: usize) -> Result<(), DynamicsError> {
    for j in 0..count {
        let diagonal = matrix[j * count + j];
        let own = &matrix[j * count..][..j];
        let pivot = diagonal - own.iter().map(|entry| entry * entry).sum::<f64>();
        // not `<=`: a NaN is caught as well
        let resists = pivot > ROUNDING * diagonal;
        if !resists {
            return Err(DynamicsError::NoInertia { joint: j });
        }
        let pivot = libm::sqrt(pivot);
        matrix[j * count + j] = pivot;
        for i in j + 1..count {
            let products = (0..j).map(|k| matrix[i * count + k] * matrix[j * count + k]);
            let entry = matrix[i * count + j] - products.sum::<f64>();
            matrix[i * count + j] = entry / pivot;
        }
    }
    Ok(())
}

/// Solves with a factor of [`factor`], in the vector's place.
pub fn solve(factor: &[f64], vector: &mut [f64]) {
    let count = vector.len();
    for i in 0..count {
        let sum: f64 = (0..i).map(|k| factor[i * count + k] * vector[k]).sum();
        vector[i] = (vector[i] - sum) / factor[i * count + i];
    }
    for i in (0..count).rev() {
        let sum: f64 = (i + 1..count)
            .map(|k| factor[k * count + i] * vector[k])
            .sum();
        vector[i] = (vector[i] - sum) / factor[i * count + i];
    }
}
