//! The problems of polynomials, quotients and an angle; numbers in brackets are the paper's.

use std::f64::consts::TAU;

use haptical_identification::Matrix;

use super::Entry;

/// The problems of this file in the sizes of MINPACK's tests.
pub(super) fn entries() -> Vec<Entry> {
    let mut entries: Vec<Entry> = vec![
        ("linear-full-rank", linear_full_rank, 10, vec![1.0; 5]),
        ("linear-full-rank", linear_full_rank, 50, vec![1.0; 5]),
        ("linear-rank-1", linear_rank_1, 10, vec![1.0; 5]),
        ("linear-rank-1", linear_rank_1, 50, vec![1.0; 5]),
        ("linear-rank-1-zeros", linear_rank_1_zeros, 10, vec![1.0; 5]),
        ("linear-rank-1-zeros", linear_rank_1_zeros, 50, vec![1.0; 5]),
        ("rosenbrock", rosenbrock, 2, vec![-1.2, 1.0]),
        ("helical-valley", helical_valley, 3, vec![-1.0, 0.0, 0.0]),
        (
            "powell-singular",
            powell_singular,
            4,
            vec![3.0, -1.0, 0.0, 1.0],
        ),
        ("freudenstein-roth", freudenstein_roth, 2, vec![0.5, -2.0]),
        ("bard", bard, 15, vec![1.0; 3]),
        (
            "kowalik-osborne",
            kowalik_osborne,
            11,
            vec![0.25, 0.39, 0.415, 0.39],
        ),
        ("watson", watson, 31, vec![0.0; 6]),
        ("watson", watson, 31, vec![0.0; 9]),
        ("watson", watson, 31, vec![0.0; 12]),
    ];
    for (parameters, residuals) in [(1, 8), (8, 8), (9, 9), (10, 10)] {
        let spacing = 1.0 / f64::from(parameters + 1);
        let start = (1..=parameters).map(|index| f64::from(index) * spacing);
        entries.push(("chebyquad", chebyquad, residuals, start.collect()));
    }
    for size in [10, 30, 40] {
        let start = vec![0.5; size];
        entries.push(("brown-almost-linear", brown_almost_linear, size, start));
    }
    entries
}

/// (32) `r_i = x_i - 2/m sum x - 1` for i <= n, `-2/m sum x - 1` beyond.
pub(super) fn linear_full_rank(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let share = 2.0 / residuals.len() as f64;
    let sum: f64 = x.iter().sum();
    for (row, residual) in residuals.iter_mut().enumerate() {
        *residual = x.get(row).unwrap_or(&0.0) - share * sum - 1.0;
        for column in 0..x.len() {
            derivatives[(row, column)] = f64::from(u8::from(row == column)) - share;
        }
    }
}

/// (33) `r_i = i sum_j j x_j - 1`.
pub(super) fn linear_rank_1(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let sum: f64 = (1..).zip(x).map(|(j, x)| f64::from(j) * x).sum();
    for (row, residual) in residuals.iter_mut().enumerate() {
        let i = (row + 1) as f64;
        *residual = i * sum - 1.0;
        for column in 0..x.len() {
            derivatives[(row, column)] = i * (column + 1) as f64;
        }
    }
}

/// (34) `r_i = (i - 1) sum_{j = 2}^{n - 1} j x_j - 1`; the first and the last residual are -1.
pub(super) fn linear_rank_1_zeros(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let inner = 1..x.len() - 1;
    let sum: f64 = inner.clone().map(|j| (j + 1) as f64 * x[j]).sum();
    let last = residuals.len() - 1;
    for (row, residual) in residuals.iter_mut().enumerate() {
        let i = if row == last { 0.0 } else { row as f64 };
        *residual = i * sum - 1.0;
        for column in inner.clone() {
            derivatives[(row, column)] = i * (column + 1) as f64;
        }
    }
}

/// (1) `10 (x2 - x1^2)`, `1 - x1`.
pub(super) fn rosenbrock(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    residuals[0] = 10.0 * (x[1] - x[0] * x[0]);
    residuals[1] = 1.0 - x[0];
    derivatives[(0, 0)] = -20.0 * x[0];
    derivatives[(0, 1)] = 10.0;
    derivatives[(1, 0)] = -1.0;
}

/// (7) `10 (x3 - 10 theta)`, `10 (|(x1, x2)| - 1)`, `x3`; theta the angle of (x1, x2) in turns,
/// from -1/4 to 3/4.
pub(super) fn helical_valley(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let square = x[0] * x[0] + x[1] * x[1];
    let radius = square.sqrt();
    let turns = if x[0] == 0.0 {
        0.25_f64.copysign(x[1])
    } else {
        (x[1] / x[0]).atan() / TAU + if x[0] < 0.0 { 0.5 } else { 0.0 }
    };
    residuals.copy_from_slice(&[10.0 * (x[2] - 10.0 * turns), 10.0 * (radius - 1.0), x[2]]);
    derivatives[(0, 0)] = 100.0 * x[1] / (TAU * square);
    derivatives[(0, 1)] = -100.0 * x[0] / (TAU * square);
    derivatives[(0, 2)] = 10.0;
    derivatives[(1, 0)] = 10.0 * x[0] / radius;
    derivatives[(1, 1)] = 10.0 * x[1] / radius;
    derivatives[(2, 2)] = 1.0;
}

/// (13) `x1 + 10 x2`, `sqrt 5 (x3 - x4)`, `(x2 - 2 x3)^2`, `sqrt 10 (x1 - x4)^2`.
pub(super) fn powell_singular(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let (five, ten) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
    let (inner, outer) = (x[1] - 2.0 * x[2], x[0] - x[3]);
    residuals[0] = x[0] + 10.0 * x[1];
    residuals[1] = five * (x[2] - x[3]);
    residuals[2] = inner * inner;
    residuals[3] = ten * outer * outer;
    derivatives[(0, 0)] = 1.0;
    derivatives[(0, 1)] = 10.0;
    derivatives[(1, 2)] = five;
    derivatives[(1, 3)] = -five;
    derivatives[(2, 1)] = 2.0 * inner;
    derivatives[(2, 2)] = -4.0 * inner;
    derivatives[(3, 0)] = 2.0 * ten * outer;
    derivatives[(3, 3)] = -2.0 * ten * outer;
}

/// (2) `-13 + x1 + ((5 - x2) x2 - 2) x2`, `-29 + x1 + ((x2 + 1) x2 - 14) x2`.
pub(super) fn freudenstein_roth(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let y = x[1];
    residuals[0] = -13.0 + x[0] + ((5.0 - y) * y - 2.0) * y;
    residuals[1] = -29.0 + x[0] + ((y + 1.0) * y - 14.0) * y;
    derivatives[(0, 0)] = 1.0;
    derivatives[(0, 1)] = (10.0 - 3.0 * y) * y - 2.0;
    derivatives[(1, 0)] = 1.0;
    derivatives[(1, 1)] = (3.0 * y + 2.0) * y - 14.0;
}

/// (8) `y_i - (x1 + u / (v x2 + w x3))`, u = i, v = 16 - i, w the smaller of both.
pub(super) fn bard(
    x: &[f64],
    observed: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, [u, y]) in observed.iter().enumerate() {
        let (v, w) = (16.0 - u, u.min(16.0 - u));
        let bottom = v * x[1] + w * x[2];
        residuals[row] = y - (x[0] + u / bottom);
        derivatives[(row, 0)] = -1.0;
        derivatives[(row, 1)] = u * v / (bottom * bottom);
        derivatives[(row, 2)] = u * w / (bottom * bottom);
    }
}

/// (15) `y_i - x1 (u^2 + u x2) / (u^2 + u x3 + x4)`.
pub(super) fn kowalik_osborne(
    x: &[f64],
    observed: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, [u, y]) in observed.iter().enumerate() {
        let (top, bottom) = (u * (u + x[1]), u * (u + x[2]) + x[3]);
        residuals[row] = y - x[0] * top / bottom;
        derivatives[(row, 0)] = -top / bottom;
        derivatives[(row, 1)] = -x[0] * u / bottom;
        derivatives[(row, 2)] = x[0] * top * u / (bottom * bottom);
        derivatives[(row, 3)] = x[0] * top / (bottom * bottom);
    }
}

/// (20) `sum (j - 1) x_j t^(j - 2) - (sum x_j t^(j - 1))^2 - 1` at t = i / 29, then `x1` and
/// `x2 - x1^2 - 1`.
pub(super) fn watson(x: &[f64], _: &[[f64; 2]], residuals: &mut [f64], derivatives: &mut Matrix) {
    for row in 0..29 {
        let t = (row + 1) as f64 / 29.0;
        let powers = || std::iter::successors(Some(1.0), |power| Some(power * t));
        let sum: f64 = powers().zip(x).map(|(power, x)| power * x).sum();
        let slopes = (1..).zip(powers());
        let slope: f64 = slopes
            .zip(&x[1..])
            .map(|((j, power), x)| f64::from(j) * power * x)
            .sum();
        residuals[row] = slope - sum * sum - 1.0;
        for (column, power) in powers().take(x.len()).enumerate() {
            derivatives[(row, column)] = column as f64 * power / t - 2.0 * sum * power;
        }
    }
    residuals[29] = x[0];
    residuals[30] = x[1] - x[0] * x[0] - 1.0;
    derivatives[(29, 0)] = 1.0;
    derivatives[(30, 0)] = -2.0 * x[0];
    derivatives[(30, 1)] = 1.0;
}

/// (35) mean over j of the shifted Chebyshev polynomial T_i(2 x_j - 1) less its integral over
/// \[0, 1\], which is 0 for odd i and -1 / (i^2 - 1) for even.
pub(super) fn chebyquad(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let share = 1.0 / x.len() as f64;
    for (row, residual) in residuals.iter_mut().enumerate() {
        let i = (row + 1) as f64;
        *residual = if row % 2 == 1 {
            1.0 / (i * i - 1.0)
        } else {
            0.0
        };
    }
    for (column, x) in x.iter().enumerate() {
        // values and slopes by T_(i+1)(z) = 2 z T_i(z) - T_(i-1)(z), dz/dx = 2
        let z = 2.0 * x - 1.0;
        let (mut before, mut value) = (1.0, z);
        let (mut slope_before, mut slope) = (0.0, 2.0);
        for (row, residual) in residuals.iter_mut().enumerate() {
            *residual += share * value;
            derivatives[(row, column)] = share * slope;
            let next_slope = 4.0 * value + 2.0 * z * slope - slope_before;
            let next = 2.0 * z * value - before;
            (before, value) = (value, next);
            (slope_before, slope) = (slope, next_slope);
        }
    }
}

/// (27) `x_i + sum x - (n + 1)` for i < n, and the product of all less 1.
pub(super) fn brown_almost_linear(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    let last = x.len() - 1;
    let sum: f64 = x.iter().sum::<f64>() - (x.len() + 1) as f64;
    for row in 0..last {
        residuals[row] = x[row] + sum;
        for column in 0..x.len() {
            derivatives[(row, column)] = if row == column { 2.0 } else { 1.0 };
        }
    }
    residuals[last] = x.iter().product::<f64>() - 1.0;
    for column in 0..x.len() {
        let others = x[..column].iter().chain(&x[column + 1..]);
        derivatives[(last, column)] = others.product();
    }
}
