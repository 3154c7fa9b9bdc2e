//! What a partial explanation has taken up, and a hypothesis beside it.

use crate::engine::model::Refit;
use crate::engine::segments::Unseen;
use crate::engine::system::System;
use crate::select::rival::Rival;

/// Hypotheses taken up so far.
pub(super) struct Taken {
    pub(super) refit: Refit,
    pub(super) system: System,
    pub(super) unseen: Unseen,
    pub(super) rivals: Vec<Vec<Rival>>,
    /// Squares that their laws may get wrong.
    pub(super) wrong: f64,
}

/// A hypothesis in the model, with what it takes off unseen rows.
#[derive(Clone, Copy)]
pub(super) struct With<'w> {
    pub(super) system: &'w System,
    pub(super) unseen: &'w Unseen,
    pub(super) gain: f64,
}
