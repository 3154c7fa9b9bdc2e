//! Calibration of a cable-driven device from a recording: two steps or all at once, checked on rows not seen.
//!
#![doc = include_str!("../README.md")]

mod calibration;
mod checks;
mod comparison;
mod error;
mod fit;
mod fit_device;
mod options;
mod problem;
mod report;
mod robust;
mod start;
mod steps;

pub use calibration::{Calibration, calibrate};
pub use checks::held_out::{HeldOut, Split, split, without_own_places};
pub use checks::otherwise::{apart, check_stands};
pub use checks::postures::{distinct_rows, without_copies};
pub use checks::reach::check_reach;
pub use checks::rejection::{Growth, Kept, Rejected};
pub use checks::rig::check_rig;
pub use checks::sufficiency::check as check_recording;
pub use error::CalibrationError;
pub use fit::considered::{Considered, Held, variance_by_held};
pub use fit::curvature::with_curvature;
pub use fit::length_scale::open_length_scales;
pub use fit::parameter_fit::{HIGH_CORRELATION, ParameterFit, Profiled, Starts};
pub use fit::request::{FitRequest, identifiability_at};
pub use fit::search::fit_parameters;
pub use fit::size::held_for_scale;
pub use fit_device::fit_device;
pub use options::{CalibrationMethod, Degree, LossChoice, Options, Weighting};
pub use problem::candidates::{candidate_parameters, parameter_infos, preference_order};
pub use problem::channel::{Channel, channels};
pub use problem::device_problem::DeviceProblem;
pub use problem::gauge::GaugedProblem;
pub use problem::measurement::tracked::Tracked;
pub use problem::reduced::{ChannelRows, ReducedProblem};
pub use problem::residuals::{
    ChannelResiduals, channel_residuals, is_in_range, rows_with_known_errors, with_ranges_of,
};
pub use problem::weights::Weights;
pub use report::channel_noise::{ChannelNoise, UnevenNoise};
pub use report::channel_report::{ChannelReport, HandReport};
pub use report::combinations::{Combination, Summand};
pub use report::force_direction::{ForceDirection, force_direction};
pub use report::frame_origins::frame_origins_m;
pub use report::intervals::{Intervals, ScaleOfLengths, SourceOfScale};
pub use report::prediction::{Prediction, predict_distances, predict_positions};
pub use report::warnings::implausible_deviations;
pub use start::prepare::{prepare_device, with_unseen_places};
pub use steps::device::{check_columns, fit_kinematics};
pub use steps::evidence::{EvidenceEntry, TransmissionTerms};
pub use steps::fitted::{FittedDevice, Outlier, RobustChannel, Robustness};
pub use steps::ordered_noise::with_ordered_noise;
pub use steps::step_one_noise::with_step_one_noise;
pub use steps::transmission_step::{TransmissionFit, fit_transmission, fit_transmissions};
