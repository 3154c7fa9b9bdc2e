//! A fitted device, and what a robust loss found of its readings.

use haptical_identification::Loss;
use haptical_model::{Device, Recording};
use serde::Serialize;

use crate::{
    CalibrationError, Channel, ChannelResiduals, ParameterFit, TransmissionFit, Weights,
    channel_residuals, channels,
};

/// A fitted device with the fits that made it.
#[derive(Debug, Clone)]
pub struct FittedDevice {
    /// The device.
    pub device: Device,
    /// Step 1.
    pub transmissions: Vec<TransmissionFit>,
    /// Step 2, or the joint fit; none for a device without links.
    pub whole: Option<ParameterFit>,
    /// Noise sizes that the last fit used.
    pub weights: Weights,
    /// What a robust loss made of the readings; none for least squares.
    pub robust: Option<Robustness>,
}

/// What a robust loss made of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Robustness {
    /// The loss.
    pub loss: Loss,
    /// Reweighted fits.
    pub rounds: usize,
    /// Whether the weights stood still in the end.
    pub settled: bool,
    /// The channels' noise.
    pub channels: Vec<RobustChannel>,
    /// Readings that noise does not explain, the farthest first.
    pub outliers: Vec<Outlier>,
}

/// The noise of one channel, from its good readings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobustChannel {
    /// Channel.
    #[serde(serialize_with = "name")]
    pub channel: Channel,
    /// Standard deviation, from the median size of the residuals; of an axis for positions and orientations.
    pub scale: f64,
    /// Factor on the variances that least squares of the weighted readings would state.
    pub variance_factor: f64,
}

/// A reading that noise does not explain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlier {
    /// Line of the log.
    pub line: u64,
    /// Channel.
    #[serde(serialize_with = "name")]
    pub channel: Channel,
    /// Model minus measurement, in the channel's unit; its length for positions and orientations.
    pub residual: f64,
    /// The same in standard deviations of the good readings.
    pub deviations: f64,
}

fn name<S: serde::Serializer>(channel: &Channel, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&channel.name())
}

/// Degrees of freedom from which on a channel's residuals say what its noise is: one or two may be zero by chance,
/// and its readings would count as exact.
pub(crate) const LEAST_FREEDOM: f64 = 4.0;

impl FittedDevice {
    /// With step 2 or the joint fit.
    pub(crate) fn with_whole(self, whole: ParameterFit) -> Self {
        Self {
            device: whole.device.clone(),
            whole: Some(whole),
            ..self
        }
    }

    /// Whether a search of its fits was one that others are only compared with, and ended as such.
    pub(crate) fn is_coarse(&self) -> bool {
        let steps = self.transmissions.iter();
        let mut fits = steps
            .filter_map(|step| step.fit.as_ref())
            .chain(&self.whole);
        fits.any(|fit| fit.is_coarse)
    }

    /// Residuals of every channel of a recording.
    pub(crate) fn residuals(
        &self,
        recording: &Recording,
    ) -> Result<Vec<ChannelResiduals>, CalibrationError> {
        self.residuals_of(recording, &channels(&self.device, recording)?)
    }

    /// Residuals of some channels.
    pub(crate) fn residuals_of(
        &self,
        recording: &Recording,
        channels: &[Channel],
    ) -> Result<Vec<ChannelResiduals>, CalibrationError> {
        let (device, weights) = (&self.device, &self.weights);
        channel_residuals(device, device, recording, channels, weights)
    }
}

/// The last fit that saw the channel decides: the joint one, or in two steps the transmission's own.
pub(crate) fn parameters_paid_by(fitted: &FittedDevice, channel: Channel) -> f64 {
    let of = |fit: &ParameterFit| fit.channel_parameters.get(&channel).copied();
    let own = || {
        let fits = fitted.transmissions.iter();
        fits.filter_map(|fit| fit.fit.as_ref()).find_map(of)
    };
    fitted
        .whole
        .as_ref()
        .and_then(of)
        .or_else(own)
        .unwrap_or(0.0)
}
