//! Shrink of the gap on data that the fit did not see: a second recording, or rows held back.

mod held_back;
mod reduction;
mod second;

use crate::answer::Prediction;

pub(crate) use self::held_back::on_held_back;
pub use self::reduction::BOOTSTRAP_SEED;
pub(crate) use self::reduction::Unseen;
pub(crate) use self::second::{device_on_second, model_residual, on_second};

/// Residuals on unseen data.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shrink {
    pub(crate) channels: Vec<Unseen>,
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) description: String,
    pub(crate) warnings: Vec<String>,
}
