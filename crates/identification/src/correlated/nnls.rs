//! Least squares with unknowns that are not negative.

use nalgebra::{Cholesky, DMatrix, DVector};

/// Turns of the active set over the number of unknowns.
const TURNS: usize = 10;

/// The x >= 0 of least |A x - b|, by active sets (Lawson & Hanson, *Solving Least Squares Problems*, section 23.3) over the
/// normal matrix with unit columns.
pub(super) fn nnls(matrix: &DMatrix<f64>, rhs: &DVector<f64>) -> Vec<f64> {
    let count = matrix.ncols();
    let norms: Vec<f64> = matrix
        .column_iter()
        .map(|column| column.norm().max(f64::MIN_POSITIVE))
        .collect();
    let normal = matrix.tr_mul(matrix);
    let normal = DMatrix::from_fn(count, count, |a, b| normal[(a, b)] / norms[a] / norms[b]);
    let wanted = matrix.tr_mul(rhs);
    let wanted = DVector::from_fn(count, |k, _| wanted[k] / norms[k]);
    let tolerance = 1e-12 * wanted.amax();
    let mut x = DVector::zeros(count);
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..TURNS * count {
        let slope = &wanted - &normal * &x;
        let free = (0..count).filter(|k| !passive.contains(k) && slope[*k] > tolerance);
        let Some(next) = free.max_by(|a, b| slope[*a].total_cmp(&slope[*b])) else {
            break;
        };
        passive.push(next);
        loop {
            let Some(solved) = solve(&normal, &wanted, &passive) else {
                // it repeats what the others say
                passive.retain(|k| *k != next);
                return unscaled(&x, &norms);
            };
            let negative = passive
                .iter()
                .zip(solved.iter())
                .filter(|(_, value)| **value <= 0.0);
            let share = negative
                .map(|(&k, value)| x[k] / (x[k] - value))
                .fold(f64::INFINITY, f64::min);
            if share == f64::INFINITY {
                x.fill(0.0);
                passive
                    .iter()
                    .zip(solved.iter())
                    .for_each(|(&k, value)| x[k] = *value);
                break;
            }
            for (&k, value) in passive.iter().zip(solved.iter()) {
                x[k] += share * (value - x[k]);
            }
            passive.retain(|&k| x[k] > 1e-15);
            if passive.is_empty() {
                break;
            }
        }
    }
    unscaled(&x, &norms)
}

fn solve(normal: &DMatrix<f64>, wanted: &DVector<f64>, passive: &[usize]) -> Option<DVector<f64>> {
    let count = passive.len();
    let own = DMatrix::from_fn(count, count, |a, b| normal[(passive[a], passive[b])]);
    let rhs = DVector::from_fn(count, |k, _| wanted[passive[k]]);
    Some(Cholesky::new(own)?.solve(&rhs))
}

fn unscaled(x: &DVector<f64>, norms: &[f64]) -> Vec<f64> {
    x.iter()
        .zip(norms)
        .map(|(value, norm)| value.max(0.0) / norm)
        .collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::nnls;

    /// Of a few unknowns every set of free ones can be tried.
    #[test]
    fn no_set_of_free_unknowns_fits_better() {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for _ in 0..200 {
            let matrix = DMatrix::from_fn(6, 4, |_, _| next());
            let rhs = DVector::from_fn(6, |_, _| next());
            let found = nnls(&matrix, &rhs);
            assert!(found.iter().all(|value| *value >= 0.0));
            let rest = (&matrix * DVector::from_vec(found) - &rhs).norm_squared();
            for set in 0..16_usize {
                let free: Vec<usize> = (0..4).filter(|k| set >> k & 1 == 1).collect();
                let own = matrix.select_columns(&free);
                let solved = match free.is_empty() {
                    true => DVector::zeros(0),
                    false => own.clone().svd(true, true).solve(&rhs, 1e-12).unwrap(),
                };
                if solved.iter().all(|value| *value >= 0.0) {
                    let other = (own * solved - &rhs).norm_squared();
                    assert!(rest <= other + 1e-12, "{rest} {other}");
                }
            }
        }
    }
}
