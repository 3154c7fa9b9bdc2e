//! Residuals of a device on a recording, channel by channel, in the channel's own unit.

use std::borrow::Cow;

use haptical_identification::Problem;
use haptical_model::{Device, Recording, TransmissionError};

use crate::error::wrap;
use crate::problem::loads::Loads;
use crate::problem::propagated::propagated_variances;
use crate::{CalibrationError, Channel, DeviceProblem, Weights};

/// Residuals of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelResiduals {
    /// Channel.
    pub channel: Channel,
    /// Rows of the recording that the residuals belong to; a position or orientation row has three
    /// successive residuals.
    pub rows: Vec<usize>,
    /// Model minus measurement, in the channel's unit.
    pub residuals: Vec<f64>,
    /// Rows with a reading that were left out, because a polynomial would have been evaluated
    /// outside the range that it was fitted on.
    pub outside_range: usize,
    /// Root mean square of the stated noise, quantization included.
    pub noise_floor: f64,
}

impl ChannelResiduals {
    /// Root mean square of the residuals: per axis for positions and orientations.
    pub fn rms(&self) -> Option<f64> {
        if self.residuals.is_empty() {
            return None;
        }
        let sum: f64 = self.residuals.iter().map(|value| value * value).sum();
        Some((sum / self.residuals.len() as f64).sqrt())
    }

    /// One error for each of the recording's `rows` rows, in the channel's unit; none for a row
    /// without a residual.
    ///
    /// Model minus measurement with its sign for an encoder or a cable; for a position or an
    /// orientation the Euclidean length of its three residuals, never negative.
    ///
    /// # Examples
    /// ```
    /// use haptical_calibration::{Channel, ChannelResiduals};
    /// let position = ChannelResiduals {
    ///     channel: Channel::Position,
    ///     rows: vec![1],
    ///     residuals: vec![2e-3, -3e-3, 6e-3],
    ///     outside_range: 0,
    ///     noise_floor: 1e-4,
    /// };
    /// let errors_m = position.by_row(3);
    /// assert_eq!((errors_m[0], errors_m[2]), (None, None));
    /// assert!((errors_m[1].unwrap_or(0.0) - 7e-3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn by_row(&self, rows: usize) -> Vec<Option<f64>> {
        let mut errors = vec![None; rows];
        for (&row, error) in self.rows.iter().zip(lengths(self.channel, &self.residuals)) {
            if let Some(place) = errors.get_mut(row) {
                *place = Some(error);
            }
        }
        errors
    }
}

/// Residuals of the given channels. Rows where a transmission polynomial is outside its range are
/// left out and counted (`range_of` gives the polynomials' ranges: usually the fitted device).
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value.
pub fn channel_residuals(
    device: &Device,
    range_of: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
) -> Result<Vec<ChannelResiduals>, CalibrationError> {
    channels
        .iter()
        // a part of a recording may have one member of a pair alone
        .filter(|channel| channel.is_placed(device))
        .map(|&channel| {
            let (known, unknown): (Vec<usize>, Vec<usize>) = (0..recording.len())
                .filter(|&row| channel.has_reading(recording, row))
                .partition(|&row| is_in_range(range_of, recording, channel, row));
            let part = match unknown.is_empty() && known.len() == recording.len() {
                true => Cow::Borrowed(recording),
                false => Cow::Owned(recording.select(&known)),
            };
            let floor = Weights {
                factor: Default::default(),
                ..weights.trusting()
            };
            let loads = Loads::new(device, &part)?;
            let variances = propagated_variances(device, &part, channel, loads.as_ref())?;
            let deviations = floor.with_variances(&part, channel, variances);
            let problem = DeviceProblem::unweighted(device, &part, channel, loads)?;
            let mut residuals = vec![0.0; problem.residual_count()];
            problem
                .evaluate(&[], &mut residuals, None)
                .map_err(|source| wrap(&channel.name(), source))?;
            let mean_square: f64 =
                deviations.iter().map(|sd| sd * sd).sum::<f64>() / deviations.len().max(1) as f64;
            Ok(ChannelResiduals {
                channel,
                rows: known,
                residuals,
                outside_range: unknown.len(),
                noise_floor: mean_square.sqrt(),
            })
        })
        .collect()
}

/// Rows at which every transmission's error is known: those within the ranges that polynomials were fitted on.
/// Beyond its range a polynomial continues on its tangent, and what that gets wrong would bend the links that are
/// fitted to such a row.
///
/// ```
/// use haptical_calibration::rows_with_known_errors;
/// use haptical_model::{Device, Recording, TransmissionError};
/// let mut device = Device::from_toml("[[joint]]\nname = \"one\"\n", "one.toml")?.device;
/// device.joints[0].transmission_error =
///     TransmissionError::Chebyshev { range_rad: [-0.5, 0.5], coefficients: vec![0.0, 1e-3] };
/// let recording = Recording { joint: vec![vec![0.1, 0.6, -0.5]], ..Recording::default() };
/// assert_eq!(rows_with_known_errors(&device, &recording), [0, 2]);
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
pub fn rows_with_known_errors(device: &Device, recording: &Recording) -> Vec<usize> {
    let rows = 0..recording.len();
    rows.filter(|&row| all_known(device, recording, row))
        .collect()
}

fn all_known(device: &Device, recording: &Recording, row: usize) -> bool {
    let joints = device.joints.iter().zip(&recording.joint);
    let mut known = joints.map(|(joint, readings)| joint.error_is_known_at(readings[row]));
    known.all(|known| known)
}

/// Whether a channel's reading lies within the ranges that the polynomials which it depends on were fitted on: that of an
/// encoder on a joint's output depends on its own joint's, what measures the chain on all.
///
/// ```
/// use haptical_calibration::{Channel, is_in_range};
/// use haptical_model::{Device, Recording, TransmissionError};
/// let mut device = Device::from_toml("[[joint]]\n[[joint]]\n", "two.toml")?.device;
/// device.joints[0].transmission_error =
///     TransmissionError::Chebyshev { range_rad: [-0.5, 0.5], coefficients: vec![0.0, 1e-3] };
/// let recording = Recording { joint: vec![vec![0.6], vec![0.6]], ..Recording::default() };
/// let [first, second] = [0, 1].map(|joint| is_in_range(&device, &recording, Channel::Output { joint }, 0));
/// assert!(!first && second && !is_in_range(&device, &recording, Channel::Position, 0));
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
pub fn is_in_range(device: &Device, recording: &Recording, channel: Channel, row: usize) -> bool {
    match channel {
        Channel::Output { joint } => {
            device.joints[joint].error_is_known_at(recording.joint[joint][row])
        }
        _ => all_known(device, recording, row),
    }
}

/// The device with its polynomials' ranges no wider than the readings of some rows: those of a fit that saw no others.
///
/// ```
/// use haptical_calibration::{Channel, is_in_range, with_ranges_of};
/// use haptical_model::{Device, Recording, TransmissionError};
/// let mut device = Device::from_toml("[[joint]]\n", "one.toml")?.device;
/// device.joints[0].transmission_error =
///     TransmissionError::Chebyshev { range_rad: [-0.5, 0.5], coefficients: vec![0.0, 1e-3] };
/// let recording = Recording { joint: vec![vec![-0.2, 0.4, 0.1]], ..Recording::default() };
/// let seen = with_ranges_of(&device, &recording, &|row| row != 1);
/// let is_in_range = |row| is_in_range(&seen, &recording, Channel::Output { joint: 0 }, row);
/// assert_eq!([0, 1, 2].map(is_in_range), [true, false, true]);
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
#[must_use]
pub fn with_ranges_of(
    device: &Device,
    recording: &Recording,
    seen: &dyn Fn(usize) -> bool,
) -> Device {
    let mut device = device.clone();
    for (joint, readings) in device.joints.iter_mut().zip(&recording.joint) {
        if let TransmissionError::Chebyshev { range_rad, .. } = &mut joint.transmission_error {
            let rows = readings.iter().enumerate();
            let seen = rows.filter(|(row, reading)| seen(*row) && reading.is_finite());
            let [low, high] = seen.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], own| {
                [low.min(*own.1), high.max(*own.1)]
            });
            *range_rad = [range_rad[0].max(low), range_rad[1].min(high)];
        }
    }
    device
}

/// Each reading's residual: signed of one axis, the Euclidean length of three.
pub(crate) fn lengths(channel: Channel, residuals: &[f64]) -> impl Iterator<Item = f64> {
    residuals
        .chunks_exact(channel.width())
        .map(|reading| match reading {
            [signed] => *signed,
            // `hypot`, because the squares of a wild reading are not representable
            axes => axes.iter().fold(0.0, |sum: f64, axis| sum.hypot(*axis)),
        })
}
