//! The fit of a device to all rows of a recording, by the loss that its options choose.

use haptical_identification::Loss;
use haptical_model::{Device, Recording};

use crate::robust::{automatic, reweighted};
use crate::steps::device::fit_squares;
use crate::{CalibrationError, FittedDevice, LossChoice, Options};

/// Fits the device to all rows of a recording.
///
/// # Errors
/// [`CalibrationError`].
pub fn fit_device(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    fit_prepared_device(
        &crate::prepare_device(device, recording)?,
        recording,
        options,
    )
}

/// The same of a device with start values of its surroundings.
pub(crate) fn fit_prepared_device(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    match options.loss {
        LossChoice::Fixed(Loss::Squares) => fit_squares(device, recording, options),
        LossChoice::Fixed(loss) => reweighted::fit(device, recording, options, loss),
        LossChoice::Auto => {
            let plain = fit_squares(device, recording, options);
            automatic::automatic(device, recording, options, plain)
        }
    }
}
