//! The sensors of single postures.

/// Noise of a sensor whose file states none: a tenth of a millimetre or milliradian, as a calibration takes it then.
pub(crate) const UNSTATED_SD: f64 = 1e-4;

/// What is read at each posture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PostureSensors {
    /// For each joint, whether it has an external encoder.
    pub outputs: Vec<bool>,
    /// For each cable, whether it is read.
    pub cables: Vec<bool>,
    /// Whether a tracker sees positions.
    pub position: bool,
    /// Whether it sees orientations.
    pub orientation: bool,
}
