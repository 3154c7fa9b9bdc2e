//! The problems of exponentials; numbers in brackets are the paper's.

use haptical_identification::Matrix;

use super::Entry;

/// The problems of this file in the sizes of MINPACK's tests.
pub(super) fn entries() -> Vec<Entry> {
    let bells = vec![1.3, 0.65, 0.65, 0.7, 0.6, 3.0, 5.0, 7.0, 2.0, 4.5, 5.5];
    vec![
        ("meyer", meyer, 16, vec![0.02, 4000.0, 250.0]),
        ("box-3d", box_3d, 10, vec![0.0, 10.0, 20.0]),
        ("jennrich-sampson", jennrich_sampson, 10, vec![0.3, 0.4]),
        (
            "brown-dennis",
            brown_dennis,
            20,
            vec![25.0, 5.0, -5.0, -1.0],
        ),
        ("osborne-1", osborne_1, 33, vec![0.5, 1.5, -1.0, 0.01, 0.02]),
        ("osborne-2", osborne_2, 65, bells),
    ]
}

/// (10) `x1 exp(x2 / (t + x3)) - y`.
pub(super) fn meyer(
    x: &[f64],
    observed: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, [t, y]) in observed.iter().enumerate() {
        let distance = t + x[2];
        let growth = (x[1] / distance).exp();
        residuals[row] = x[0] * growth - y;
        derivatives[(row, 0)] = growth;
        derivatives[(row, 1)] = x[0] * growth / distance;
        derivatives[(row, 2)] = -x[0] * growth * x[1] / (distance * distance);
    }
}

/// (12) `exp(-t x1) - exp(-t x2) - x3 (exp(-t) - exp(-10 t))` at t = i / 10.
pub(super) fn box_3d(x: &[f64], _: &[[f64; 2]], residuals: &mut [f64], derivatives: &mut Matrix) {
    for (row, residual) in residuals.iter_mut().enumerate() {
        let t = (row + 1) as f64 / 10.0;
        let (first, second) = ((-t * x[0]).exp(), (-t * x[1]).exp());
        let shape = (-10.0 * t).exp() - (-t).exp();
        *residual = first - second + shape * x[2];
        derivatives[(row, 0)] = -t * first;
        derivatives[(row, 1)] = t * second;
        derivatives[(row, 2)] = shape;
    }
}

/// (6) `2 + 2 i - exp(i x1) - exp(i x2)`.
pub(super) fn jennrich_sampson(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, residual) in residuals.iter_mut().enumerate() {
        let i = (row + 1) as f64;
        let (first, second) = ((i * x[0]).exp(), (i * x[1]).exp());
        *residual = 2.0 + 2.0 * i - first - second;
        derivatives[(row, 0)] = -i * first;
        derivatives[(row, 1)] = -i * second;
    }
}

/// (16) `(x1 + t x2 - exp t)^2 + (x3 + x4 sin t - cos t)^2` at t = i / 5.
pub(super) fn brown_dennis(
    x: &[f64],
    _: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, residual) in residuals.iter_mut().enumerate() {
        let t = (row + 1) as f64 / 5.0;
        let (sine, cosine) = t.sin_cos();
        let first = x[0] + t * x[1] - t.exp();
        let second = x[2] + x[3] * sine - cosine;
        *residual = first * first + second * second;
        derivatives[(row, 0)] = 2.0 * first;
        derivatives[(row, 1)] = 2.0 * first * t;
        derivatives[(row, 2)] = 2.0 * second;
        derivatives[(row, 3)] = 2.0 * second * sine;
    }
}

/// (17) `y - (x1 + x2 exp(-t x4) + x3 exp(-t x5))`.
pub(super) fn osborne_1(
    x: &[f64],
    observed: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, [t, y]) in observed.iter().enumerate() {
        let (first, second) = ((-t * x[3]).exp(), (-t * x[4]).exp());
        residuals[row] = y - (x[0] + x[1] * first + x[2] * second);
        derivatives[(row, 0)] = -1.0;
        derivatives[(row, 1)] = -first;
        derivatives[(row, 2)] = -second;
        derivatives[(row, 3)] = t * x[1] * first;
        derivatives[(row, 4)] = t * x[2] * second;
    }
}

/// (19) `y - (x1 exp(-t x5) + sum over k = 1 to 3 of x_(k + 1) exp(-(t - x_(8 + k))^2 x_(5 + k)))`.
pub(super) fn osborne_2(
    x: &[f64],
    observed: &[[f64; 2]],
    residuals: &mut [f64],
    derivatives: &mut Matrix,
) {
    for (row, [t, y]) in observed.iter().enumerate() {
        let decay = (-t * x[4]).exp();
        let mut value = x[0] * decay;
        derivatives[(row, 0)] = -decay;
        derivatives[(row, 4)] = t * x[0] * decay;
        for k in 1..=3 {
            let (height, width, centre) = (x[k], x[4 + k], x[7 + k]);
            let distance = t - centre;
            let bell = (-distance * distance * width).exp();
            value += height * bell;
            derivatives[(row, k)] = -bell;
            derivatives[(row, 4 + k)] = height * distance * distance * bell;
            derivatives[(row, 7 + k)] = -2.0 * height * distance * width * bell;
        }
        residuals[row] = y - value;
    }
}
