//! Numbers that say how good a calibration is: improvements, position and orientation errors,
//! intervals, tests and frequencies, as pure functions on slices.
//!
//! Nothing here reads files, knows a device or keeps state. Every function either returns finite
//! numbers or an error that names the argument at fault.

mod bootstrap;
pub mod budget;
mod correlation;
mod coverage;
mod error;
mod fourier;
mod improvement;
mod inference;
mod pose;
mod quadratic_form;
mod quantile;

pub use bootstrap::Bootstrap;
pub use correlation::{correlation, spearman};
pub use coverage::{binomial_two_sided_p, holm_adjusted};
pub use error::MetricsError;
pub use fourier::{Complex, Fourier};
pub use improvement::{
    RmsImprovement, gap_reduction_percent, parameter_improvement_percent, rms,
    rms_improvement_percent,
};
pub use inference::{
    chi_square_p_value, chi_square_quantile, normal_two_sided_p, student_t_quantile,
    wilson_interval,
};
pub use pose::{best_rotation, orientation_angle_rad, position_errors_m};
pub use quadratic_form::quadratic_form_interval;
pub use quantile::{Interval, median, percentile_interval, quantile};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
