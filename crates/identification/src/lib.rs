//! Nonlinear least squares that asks first which parameters the data can fix.
//!
#![doc = include_str!("../README.md")]

mod derivative_check;
mod error;
mod estimate;
mod identifiability;
mod linear;
mod loss;
mod observability;
mod problem;
mod profile;
mod proven;
mod robust;
mod rules;
mod search;
mod selection;
mod settings;
mod solver;
mod status;
mod triangle;

pub use derivative_check::{DerivativeMismatch, worst_derivative};
pub use error::IdentificationError;
pub use estimate::{Estimate, NoiseScale, Uncertainty, estimates, uncertainty};
pub use haptical_linalg::{Matrix, Reduction, Triangle};
pub use identifiability::{Identifiability, analyse};
pub use loss::{Loss, robust_scale};
pub use observability::Observability;
pub use problem::{Problem, TriangleProblem, evaluate_jacobian};
pub use profile::{FARTHEST, Profile, TOLERATED, profiles};
pub use robust::{RobustFit, solve_robust};
pub use rules::IdentifiabilityRules;
pub use settings::{Convergence, Method, Settings};
pub use solver::{Fit, solve};
pub use status::{ParameterInfo, Status, Term};
