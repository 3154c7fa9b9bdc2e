//! The cable encoder is sampled late.

use crate::clock::OtherClock;
use crate::laws::Delay;
use crate::{Follows, Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: OtherClock::Cables.latency(),
    meaning: "the cable encoder is sampled later or earlier than the joints",
    inspect: "the time stamps of its channel",
    adds: "L(t - d) - L(t)",
    source: "C13",
    hook: Hook::CableSensor,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    follows: Follows::CableSpeed,
    log_fault: Some(LogFault::Late),
    ..Delay::SPEC
};

pub(crate) const LAW: Delay = Delay;
