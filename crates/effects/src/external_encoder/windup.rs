//! The coupling of an external encoder winds up at reversals, after Dahl.

use crate::laws::Reversal;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "external-encoder-windup",
    meaning: "the coupling of an external encoder winds up at each reversal",
    inspect: "the coupling and the bearing of that encoder",
    adds: "Dahl's loop",
    source: "B2",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Motion, Need::Output],
    ..Reversal::SPEC
};

pub(crate) const LAW: Reversal = Reversal;
