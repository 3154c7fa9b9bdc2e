//! A device with its effects: readings and loads in; true joint values, pose and torques out, and back.

mod check;
mod drives;
mod effect;
mod inputs;
mod inverse;
mod memory;
mod model;
mod place;
mod pose_inverse;
mod root;
mod state;
mod structure;
mod torques;

pub use effect::{Effect, Over, Side, Turnover};
pub use inputs::Inputs;
pub use memory::EffectState;
pub use model::CompensatedModel;
pub use state::CompensatedState;

/// An entry; 0 where there is none: indices are checked when the model is made.
#[inline]
fn at(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(0.0)
}

/// Adds to an entry that is there.
#[inline]
fn add(values: &mut [f64], index: usize, value: f64) {
    if let Some(sum) = values.get_mut(index) {
        *sum += value;
    }
}
