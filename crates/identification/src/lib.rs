//! Nonlinear least squares that asks first which parameters the data can fix.
//!
#![doc = include_str!("../README.md")]

mod component;
mod correlated;
mod derivative_check;
mod error;
mod estimate;
mod identifiability;
mod interrupt;
mod lanes;
mod loss;
mod problem;
mod profile;
mod robust;
mod sandwich;
mod search;
mod settings;
mod solver;

pub use component::{Component, pooled};
pub use correlated::{
    CorrelatedNoise, FEWEST_ROWS, HeldEffect, OrderedProblem, Signal, Uneven, correlated_noise,
};
pub use derivative_check::{DerivativeMismatch, worst_derivative};
pub use error::IdentificationError;
pub use estimate::{Added, Estimate, HalfWidths, NoiseScale, Uncertainty, estimates, uncertainty};
pub use haptical_linalg::{Matrix, Reduction, Triangle};
pub use identifiability::observability::Observability;
pub use identifiability::rules::IdentifiabilityRules;
pub use identifiability::status::{ParameterInfo, Status, Term};
pub use identifiability::{Identifiability, analyse};
pub use interrupt::Interrupt;
pub use loss::{Loss, robust_scale};
pub use problem::{Problem, TriangleProblem, evaluate_jacobian};
pub use profile::{FARTHEST, Profile, TOLERATED, profiles};
pub use robust::{RobustFit, solve_robust};
pub use sandwich::robust_covariance;
pub use settings::{Convergence, Method, Settings};
pub use solver::{Fit, solve};
