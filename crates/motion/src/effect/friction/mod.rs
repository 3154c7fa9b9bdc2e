//! Friction beyond the viscous and Coulomb parts of the base model, one law a file.

mod asymmetry;
mod drift;
mod load;
mod presliding;
mod stribeck;

pub(super) use self::asymmetry::EFFECT as ASYMMETRY;
pub(super) use self::drift::EFFECT as DRIFT;
pub(super) use self::load::EFFECT as LOAD;
pub(super) use self::presliding::EFFECT as PRESLIDING;
pub(super) use self::stribeck::EFFECT as STRIBECK;
