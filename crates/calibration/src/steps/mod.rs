//! Calibration in steps: transmissions first, then the chain, or all at once.

pub(crate) mod device;
pub(crate) mod evidence;
pub(crate) mod fitted;
pub(crate) mod ordered_noise;
mod robust_floor;
pub(crate) mod step_one_noise;
pub(crate) mod transmission_step;
