//! A cos(k x - phase), as a cos(k x) + b sin(k x).

/// cos(k x) and sin(k x).
pub(crate) fn waves(angle: &[f64], order: f64) -> [Vec<f64>; 2] {
    let (sines, cosines) = angle.iter().map(|q| (order * q).sin_cos()).unzip();
    [cosines, sines]
}

/// A and phase of a and b.
pub(crate) fn polar(amplitudes: &[f64]) -> Vec<f64> {
    vec![
        amplitudes[0].hypot(amplitudes[1]),
        amplitudes[1].atan2(amplitudes[0]),
    ]
}

/// a and b of A and phase.
pub(crate) fn from_polar(values: &[f64]) -> Vec<f64> {
    let (sin, cos) = values[1].sin_cos();
    vec![values[0] * cos, values[0] * sin]
}
