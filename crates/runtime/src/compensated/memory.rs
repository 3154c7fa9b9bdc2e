//! What effects remember from step to step; the caller owns it.

use haptical_transmission::loops::{Creep, Dahl, Play};

use crate::{Effect, RuntimeError, Side, Turnover};

/// What the effects of a device remember. A loop makes one by
/// [`CompensatedModel::start`](crate::CompensatedModel::start) and hands it to every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectState<const EFFECTS: usize>(pub(super) [Memory; EFFECTS]);

/// What one effect remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Memory {
    Nothing,
    Play(Play),
    Dahl(Dahl),
    Creep(Creep),
    Axes([Dahl; 3]),
}

impl Memory {
    /// Nothing remembered yet.
    pub(super) const fn of(effect: &Effect) -> Self {
        match effect {
            Effect::Backlash {
                driven_by: Side::Motor,
                ..
            }
            | Effect::CoupledBacklash { .. } => Self::Play(Play::NEW),
            Effect::Backlash { .. }
            | Effect::Hysteresis { .. }
            | Effect::Friction {
                side: Turnover::Travel(_),
                ..
            } => Self::Dahl(Dahl::NEW),
            Effect::CapstanCreep { .. } => Self::Creep(Creep::NEW),
            Effect::ForceHysteresis { .. } => Self::Axes([Dahl::NEW; 3]),
            _ => Self::Nothing,
        }
    }
}

/// The memory of an effect is of another kind: it belongs to another model.
#[cold]
pub(super) const fn foreign(index: usize) -> RuntimeError {
    RuntimeError::ForeignState { effect: index + 1 }
}
