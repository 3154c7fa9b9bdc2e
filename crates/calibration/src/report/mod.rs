//! Figures and warnings of a finished calibration.

pub(crate) mod above_floor;
pub(crate) mod channel_noise;
pub(crate) mod channel_report;
pub(crate) mod combinations;
pub(crate) mod force_direction;
pub(crate) mod frame_origins;
pub(crate) mod intervals;
pub(crate) mod open_direction;
pub(crate) mod prediction;
pub(crate) mod warnings;
