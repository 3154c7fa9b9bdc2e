//! Laws of moving arms: bodies against other programs, energies, steps of integration, sizes of effects, strata, faults.

mod admission;
mod laws;
mod motion;
mod rigid;
mod strata;
