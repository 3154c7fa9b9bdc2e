//! Dynamics of rigid-body trees on a fixed base: inverse and forward dynamics, mass matrix, energies, the
//! regressor of the inertial parameters, and the analytic derivatives of inverse dynamics.
//!
//! [`Tree`] joins [`Body`]s, each behind one revolute or prismatic [`Joint`] along any axis.
//! [`Tree::inverse_dynamics`] and [`Tree::bias_forces`] are torques of a motion, [`Tree::forward_dynamics`] the
//! accelerations that torques make, [`Tree::mass_matrix`] what ties both, [`Tree::regressor`] how torques depend on
//! the [`Inertia::parameters`], [`Tree::torque_derivatives`] how on positions and velocities.
//!
//! # Why along the base's axes
//!
//! Every spatial vector is about the base's origin, along the base's axes. What changes with a joint is then the
//! body's own inertia alone, turned once; forces, composite inertias, articulated inertias and the sums behind
//! derivatives are added up from child to parent as they are, where vectors along each body's axes are transformed at
//! every joint. And the derivatives have a form in which all that
//! depends on velocities is one vector and one 3x3 matrix for each body.
//!
//! Nothing is allocated: the caller owns a slice of [`Scratch`], one for each body. Sines and cosines come from
//! `libm`, so the same input gives the same bits on every machine.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

mod articulated;
mod body;
mod derivatives;
mod error;
mod forward;
mod inertia;
mod inverse;
mod mass;
mod passes;
mod regressor;
mod scratch;
mod spatial;
mod tree;

pub use haptical_kinematics::{Pose, nalgebra};

pub use crate::body::{Body, Joint, Wrench};
pub use crate::derivatives::TorqueDerivatives;
pub use crate::error::DynamicsError;
pub use crate::inertia::Inertia;
pub use crate::scratch::Scratch;
pub use crate::tree::Tree;
