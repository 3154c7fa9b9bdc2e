//! An external encoder is sampled late.

use crate::clock::OtherClock;
use crate::laws::Delay;
use crate::transmission::HOLD_THE_MOTOR;
use crate::{Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: OtherClock::ExternalEncoders.latency(),
    meaning: "an external encoder is sampled later or earlier than the motor encoders",
    inspect: "the time stamps of its channel",
    confirm: HOLD_THE_MOTOR,
    adds: "theta(t - d) - theta(t)",
    source: "B5",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Time, Need::Motion, Need::Output],
    log_fault: Some(LogFault::Late),
    ..Delay::SPEC
};

pub(crate) const LAW: Delay = Delay;
