//! Numbers of the base model as an earlier model has them.

use std::f64::consts::PI;
use std::mem::discriminant;

use haptical_model::{Device, ParameterId, TransmissionError};

/// A number of the base model as the earlier model has it. A polynomial of another degree or range is taken at this one's
/// Chebyshev points (Trefethen 2019, chapter 4); none where the earlier model has another law.
pub(crate) fn earlier_value(
    parameter: ParameterId,
    model: &Device,
    device: &Device,
) -> Option<f64> {
    let (joint, index) = match parameter {
        ParameterId::Transmission { joint, index } => (joint, index),
        // the model may have other effects, or none
        ParameterId::Effect { .. } => return None,
        _ => return Some(parameter.value(model)),
    };
    let (earlier, own) = (
        &model.joints[joint],
        &device.joints[joint].transmission_error,
    );
    let TransmissionError::Chebyshev {
        range_rad: [low, high],
        coefficients,
    } = own
    else {
        let is_same = discriminant(own) == discriminant(&earlier.transmission_error);
        return is_same.then(|| parameter.value(model));
    };
    let count = coefficients.len() as f64;
    let mut sum = 0.0;
    for point in 0..coefficients.len() {
        let angle = PI * (point as f64 + 0.5) / count;
        let reading_rad = 0.5 * (low + high) + 0.5 * (high - low) * angle.cos();
        sum += earlier.error_rad(reading_rad).ok()? * (index as f64 * angle).cos();
    }
    Some(sum * if index == 0 { 1.0 } else { 2.0 } / count)
}
