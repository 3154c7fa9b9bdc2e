//! An effect that competes with a named cause.

use haptical_effects::Effect;

use crate::engine::model::Cause;

/// An effect in a cause's place.
#[derive(Debug, Clone)]
pub(crate) struct Rival {
    /// Position in the catalogue, and its fit, where it was refitted.
    pub(crate) cause: Option<Cause>,
    /// Whether its refit, if any, ended at a minimum; one that did not is no further behind than its end promises.
    pub(crate) has_converged: bool,
    pub(crate) name: &'static str,
    pub(crate) joint: Option<usize>,
    /// Share of the squared residual that it explains of what the cause explains.
    pub(crate) share: f64,
    /// Nats behind the best, misfit allowed for.
    pub(crate) nats_behind: f64,
    pub(crate) probability: f64,
}

impl Rival {
    /// An effect that was not refitted; its probability is that of nothing yet.
    pub(crate) fn new(effect: &dyn Effect, share: f64, nats_behind: f64) -> Self {
        Self {
            cause: None,
            has_converged: true,
            name: effect.name(),
            joint: effect.joint(),
            share,
            nats_behind,
            probability: 0.0,
        }
    }
}
