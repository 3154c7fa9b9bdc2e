//! The gain of a criterion by one more pose: small determinants and traces, asked a million times.

/// det(I + G), and trace((I + G)^-1 H) where H is given (empty otherwise), of a pose with `count` readings; both matrices are used up.
///
/// With I + G = L D L^T the trace is the sum of the diagonal of L^-1 H L^-T over that of D, and each step of the elimination does to
/// H what it does to I + G, from both sides.
pub(crate) fn eliminate(count: usize, spread: &mut [f64], gained: &mut [f64]) -> (f64, f64) {
    let (mut det, mut trace) = (1.0, 0.0);
    for index in 0..count {
        spread[index * (count + 1)] += 1.0;
    }
    for k in 0..count {
        let pivot = spread[k * (count + 1)];
        // what is not positive by rounding is worth nothing
        if pivot.is_nan() || pivot <= 0.0 {
            return (1.0, 0.0);
        }
        det *= pivot;
        let (done, rest) = spread.split_at_mut((k + 1) * count);
        let column = &done[k * count..];
        for (j, into) in (k + 1..count).zip(rest.chunks_exact_mut(count)) {
            let factor = column[j] / pivot;
            for (entry, left) in into[j..].iter_mut().zip(&column[j..]) {
                *entry -= factor * left;
            }
        }
        if gained.is_empty() {
            continue;
        }
        trace += gained[k * (count + 1)] / pivot;
        // rows, then columns: H is symmetric, and what is left of it is kept so
        let whole = gained[k * (count + 1)];
        for j in k + 1..count {
            let (of_j, along) = (column[j] / pivot, gained[j + k * count]);
            for i in k + 1..count {
                let of_i = column[i] / pivot;
                gained[i + j * count] -=
                    of_i * along + of_j * gained[i + k * count] - of_i * of_j * whole;
            }
        }
    }
    (det, trace)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::eliminate;

    #[test]
    fn determinant_and_trace_are_those_of_the_inverse() {
        for count in 1..7 {
            let entry = |i: usize, j: usize| ((i * 5 + j * 3 + count) as f64).sin();
            let half = DMatrix::from_fn(count, count, entry);
            let other = DMatrix::from_fn(count, count, |i, j| entry(j, i + 1));
            let (spread, gained) = (&half * half.transpose(), &other * other.transpose());
            let sum = DMatrix::identity(count, count) + &spread;
            let wanted = (
                sum.determinant(),
                (sum.try_inverse().unwrap() * &gained).trace(),
            );
            let (mut g, mut h) = (spread.as_slice().to_vec(), gained.as_slice().to_vec());
            let found = eliminate(count, &mut g, &mut h);
            assert!((found.0 / wanted.0 - 1.0).abs() < 1e-12, "{found:?}");
            assert!((found.1 / wanted.1 - 1.0).abs() < 1e-12, "{found:?}");
        }
    }
}
