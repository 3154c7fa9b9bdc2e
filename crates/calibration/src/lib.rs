//! Calibration of a cable-driven device from a recording: two steps or all at once, checked on rows not seen.
//!
#![doc = include_str!("../README.md")]

mod above_floor;
mod automatic_loss;
mod cable_columns;
mod calibration;
mod candidates;
mod capstan_rows;
mod channel;
mod considered;
mod conventions;
mod distances;
mod error;
mod error_rows;
mod evidence;
mod fit;
mod force_direction;
mod form;
mod frame_origins;
mod free_set;
mod geometry_rank;
mod hand_eye;
mod held_out;
mod joint_fit;
mod lane_pass;
mod lane_rows;
mod lanes;
mod loads;
mod measurement;
mod merged;
mod multi_start;
mod open_direction;
mod outputs;
mod prediction;
mod prepare;
mod problem;
mod propagated;
mod reach;
mod reduced;
mod residuals;
mod robust;
mod rotation;
mod row_errors;
mod rows;
mod scale;
mod sink;
mod step_one_noise;
mod sufficiency;
mod transmission_step;
mod warnings;
mod weights;

pub use calibration::{Calibration, ChannelReport, calibrate};
pub use candidates::{candidate_parameters, parameter_infos, preference_order};
pub use channel::{Channel, channels};
pub use considered::Considered;
pub use error::CalibrationError;
pub use evidence::{EvidenceEntry, TransmissionTerms};
pub use fit::{
    CalibrationMethod, Degree, HIGH_CORRELATION, LossChoice, Options, ParameterFit, Weighting,
    fit_parameters, identifiability_at,
};
pub use force_direction::{ForceDirection, force_direction};
pub use frame_origins::frame_origins_m;
pub use geometry_rank::GeometryRank;
pub use held_out::{HeldOut, Split, split};
pub use joint_fit::{FittedDevice, fit_device, fit_kinematics};
pub use measurement::tracked::Tracked;
pub use merged::{ChannelRows, MergedProblem};
pub use multi_start::Starts;
pub use prediction::{Prediction, predict_distances, predict_positions};
pub use prepare::{check_rig, prepare_device};
pub use problem::DeviceProblem;
pub use reach::check_reach;
pub use reduced::ReducedProblem;
pub use residuals::{ChannelResiduals, channel_residuals, rows_with_known_errors};
pub use robust::{Outlier, RobustChannel, Robustness, far_out};
pub use step_one_noise::with_step_one_noise;
pub use sufficiency::check as check_recording;
pub use transmission_step::{TransmissionFit, fit_transmission, fit_transmissions};
pub use warnings::implausible_deviations;
pub use weights::Weights;
