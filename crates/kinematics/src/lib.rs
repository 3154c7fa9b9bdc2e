//! Pose of a serial chain of Denavit-Hartenberg rows, and its derivatives with respect to every
//! parameter and every joint.
//!
//! [`Chain`] joins [`Link`]s under a [`Convention`]; [`Chain::pose`], [`Chain::derivatives`] and
//! [`Chain::geometric_jacobian`] evaluate it; [`distance_m`] and [`distance_derivative`] reduce the
//! pose to what a measurement cable sees; [`joint_torques_nm`] maps a wrench to the joints. Lengths
//! are in m, angles in rad, and every vector is expressed in frame (-1), the first row's frame.
//!
//! # Why every derivative is a unit twist
//!
//! A chain is a product of elementary motions `E_1(x_1) E_2(x_2) ... E_m(x_m)`, six per row, each a
//! turn about or a slide along one axis of the frame reached so far. Split the product at motion
//! `k` into `U E_k(x_k) V`. Changing `x_k` by `dx` moves everything after it, `V`, rigidly:
//!
//! - a slide along the axis `w` (a column of `U`'s rotation): `dP = w dx`, `dR = 0`;
//! - a turn about the axis `w` through `U`'s origin `p`: `dP = w x (P - p) dx`, `dR = [w]x R dx`.
//!
//! `w` and `p` depend only on what comes before motion `k`, and the turn itself leaves both
//! unchanged. A constant transform between two motions ([`Chain::with_origins`]) is part of `U` or of
//! `V` and has no derivative. One forward pass therefore stores `(p, w)` for every parameter; a second loop over
//! the rows, which needs no sine or cosine, adds the end point `P`. Nothing is approximated.
//!
//! Sines and cosines come from `libm`, so the same input gives the same bits on every machine.
//! [`PreparedChain`] answers pose and Jacobian in less time, by other steps and with the sines of
//! [`trigonometry`]: its numbers differ from the chain's by rounding, and are the same on every machine too.
#![no_std]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

mod across;
mod chain;
mod derivatives;
mod distance;
mod error;
mod frame;
mod link;
mod pose;
mod preparation;
mod prepared;
mod sines;
mod statics;
pub mod trigonometry;

pub use nalgebra;

pub use crate::chain::Chain;
pub use crate::derivatives::LinkDerivatives;
pub use crate::distance::{distance_derivative, distance_m};
pub use crate::error::KinematicsError;
pub use crate::link::{Convention, Link, Motion, Parameter};
pub use crate::pose::{Pose, Twist};
pub use crate::preparation::{ChainConstants, JointConstants, Preparation};
pub use crate::prepared::PreparedChain;
pub use crate::statics::joint_torques_nm;
