//! A transmission's error at many readings at once: what does not change with its parameters is worked out once.

use haptical_model::transmission::chebyshev;
use haptical_model::{Device, Joint, ParameterId, Recording, TransmissionError};

use crate::problem::lanes::capstan::{CapstanReadings, ErrorValues};

/// Readings of one joint, ready for the law of its transmission.
#[derive(Debug)]
pub(crate) enum ErrorRows {
    /// Equation (1): sines and cosines of the drums' angles.
    Capstan(Box<CapstanReadings>),
    /// A polynomial, which is linear: its basis at the readings, one column for each coefficient.
    Series {
        range_rad: [f64; 2],
        basis: Vec<Vec<f64>>,
    },
}

impl ErrorRows {
    /// None for a law that has no form of this kind, or where ratio and distances are refused.
    pub(crate) fn new(joint: &Joint, readings: &[f64]) -> Option<Self> {
        match &joint.transmission_error {
            TransmissionError::Capstan(_) => {
                let rows = CapstanReadings::new(joint.capstan().ok()?, readings);
                Some(Self::Capstan(Box::new(rows)))
            }
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            } => {
                chebyshev::check(*range_rad, coefficients).ok()?;
                let count = coefficients.len();
                let mut basis = vec![vec![0.0; readings.len()]; count];
                let mut at_row = vec![0.0; count];
                for (row, &reading) in readings.iter().enumerate() {
                    chebyshev::basis(*range_rad, reading, &mut at_row);
                    for (column, value) in basis.iter_mut().zip(&at_row) {
                        column[row] = *value;
                    }
                }
                Some(Self::Series {
                    range_rad: *range_rad,
                    basis,
                })
            }
            TransmissionError::Parallelogram { .. } => None,
        }
    }

    /// Errors at all readings, and where `derivatives` says so their derivatives; none where the law
    /// refuses the parameters.
    pub(crate) fn evaluate(
        &self,
        parameters: &[f64],
        derivatives: bool,
        into: &mut ErrorValues,
    ) -> Option<()> {
        match self {
            Self::Capstan(rows) => rows.evaluate(parameters, derivatives, into),
            Self::Series { range_rad, basis } => {
                chebyshev::check(*range_rad, parameters).ok()?;
                let rows = basis.first().map_or(0, Vec::len);
                into.values.clear();
                into.values.resize(rows, 0.0);
                for (column, coefficient) in basis.iter().zip(parameters) {
                    for (value, entry) in into.values.iter_mut().zip(column) {
                        *value += coefficient * entry;
                    }
                }
                Some(())
            }
        }
    }

    /// The derivatives of the last [`ErrorRows::evaluate`] that was asked for them, one column for each
    /// parameter.
    pub(crate) fn derivatives<'v>(&'v self, at: &'v ErrorValues) -> &'v [Vec<f64>] {
        match self {
            Self::Capstan(_) => &at.derivatives,
            Self::Series { basis, .. } => basis,
        }
    }
}

/// Readings whose sines, or whose basis, are held at a time.
const READINGS_AT_ONCE: usize = 4096;

/// A joint, and the parameters of its transmission's error.
pub(crate) fn error_of(device: &Device, joint: usize) -> Option<(&Joint, Vec<f64>)> {
    let described = device.joints.get(joint)?;
    let parameters = 0..described.error_parameter_count();
    let value = |index| ParameterId::Transmission { joint, index }.value(device);
    Some((described, parameters.map(value).collect()))
}

/// Errors of a joint's transmission as the device has it, at many readings; none where the law refuses a number.
pub(crate) fn errors_in_bulk(device: &Device, joint: usize, readings: &[f64]) -> Option<Vec<f64>> {
    let (described, error) = error_of(device, joint)?;
    if error.iter().all(|value| *value == 0.0) {
        // nothing to add; whether the law accepts the joint's dimensions is asked all the same
        described.error_rad(0.0).ok()?;
        return Some(vec![0.0; readings.len()]);
    }
    if ErrorRows::new(described, &[]).is_some() {
        let mut values = Vec::with_capacity(readings.len());
        let mut at = ErrorValues::default();
        for part in readings.chunks(READINGS_AT_ONCE) {
            ErrorRows::new(described, part)?.evaluate(&error, false, &mut at)?;
            values.extend_from_slice(&at.values);
        }
        return Some(values);
    }
    let each = readings.iter().map(|reading| described.error_rad(*reading));
    each.collect::<Result<_, _>>().ok()
}

/// Errors of a joint's transmission as the device has it, and the slopes 1 + d error / d reading of its output, at
/// many readings; none where the law refuses a number.
pub(crate) fn values_and_slopes(
    device: &Device,
    joint: usize,
    readings: &[f64],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let (described, error) = error_of(device, joint)?;
    if !readings.iter().all(|reading| reading.is_finite()) {
        return None;
    }
    if error.iter().all(|value| *value == 0.0) {
        described.error_rad(0.0).ok()?;
        return Some((vec![0.0; readings.len()], vec![1.0; readings.len()]));
    }
    if let TransmissionError::Capstan(own) = &described.transmission_error {
        let rows = CapstanReadings::new(described.capstan().ok()?, readings);
        let mut at = ErrorValues::default();
        rows.evaluate(&error, false, &mut at)?;
        return Some((at.values, rows.slopes(own)));
    }
    let mut derivatives = vec![0.0; error.len()];
    let (mut values, mut slopes) = (Vec::new(), Vec::new());
    for reading in readings {
        let at = described.evaluate_error(*reading, &mut derivatives);
        let (value, slope) = at.ok()?;
        values.push(value);
        slopes.push(1.0 + slope);
    }
    Some((values, slopes))
}

/// Output angles, row by row, joint by joint with what its readings share worked out once; none where a parameter
/// can change them or a number is refused.
pub(crate) fn outputs_in_bulk(
    device: &Device,
    recording: &Recording,
    parameters: &[ParameterId],
) -> Option<Vec<f64>> {
    let is_link = |parameter: &ParameterId| matches!(parameter, ParameterId::Link { .. });
    if !parameters.iter().all(is_link) || recording.joint.len() != device.joints.len() {
        return None;
    }
    let joints = device.joints.len();
    let mut outputs = vec![0.0; recording.len() * joints];
    for (joint, readings) in recording.joint.iter().enumerate() {
        let errors = errors_in_bulk(device, joint, readings)?;
        let into = outputs.iter_mut().skip(joint).step_by(joints);
        for ((output, reading), error) in into.zip(readings).zip(&errors) {
            *output = reading + error;
        }
    }
    outputs
        .iter()
        .all(|output| output.is_finite())
        .then_some(outputs)
}
