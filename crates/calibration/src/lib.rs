//! Calibration of a cable-driven device from a recording: two steps or all at once, checked on rows not seen.
//!
#![doc = include_str!("../README.md")]

mod calibration;
mod candidates;
mod channel;
mod distances;
mod error;
mod error_rows;
mod evidence;
mod fit;
mod force_direction;
mod form;
mod frame_origins;
mod held_out;
mod joint_fit;
mod outputs;
mod problem;
mod reduced;
mod residuals;
mod rotation;
mod row_errors;
mod sink;
mod sufficiency;
mod transmission_step;
mod warnings;
mod weights;

pub use calibration::{Calibration, ChannelReport, calibrate};
pub use candidates::{candidate_parameters, parameter_infos, preference_order};
pub use channel::{Channel, channels};
pub use error::CalibrationError;
pub use evidence::{EvidenceEntry, TransmissionTerms};
pub use fit::{
    CalibrationMethod, Degree, Options, ParameterFit, Weighting, fit_parameters, identifiability_at,
};
pub use force_direction::{ForceDirection, force_direction};
pub use frame_origins::frame_origins_m;
pub use held_out::{HeldOut, Split, split};
pub use joint_fit::{FittedDevice, fit_device, fit_kinematics};
pub use problem::DeviceProblem;
pub use reduced::ReducedProblem;
pub use residuals::{ChannelResiduals, channel_residuals, rows_with_known_errors};
pub use sufficiency::check as check_recording;
pub use transmission_step::{TransmissionFit, fit_transmission, fit_transmissions};
pub use weights::Weights;
