//! A loop that turns over within a travel, after Dahl, in the transmission.

use crate::laws::Reversal;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "hysteresis",
    meaning: "friction bends the transmission, with the sign of the last motion",
    inspect: "bearings, guides and cables that rub",
    adds: "Dahl's loop",
    source: "A5",
    hook: Hook::Transmission,
    needs: &[Need::Order],
    ..Reversal::SPEC
};

pub(crate) const LAW: Reversal = Reversal;
