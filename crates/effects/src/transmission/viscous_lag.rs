//! The output follows the motor late.

use crate::laws::Delay;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "viscous-lag",
    meaning: "the joint lags behind its motor in proportion to the speed",
    inspect: "grease, damping and the load of the transmission",
    adds: "theta(t - d) - theta(t)",
    source: "A6",
    hook: Hook::Transmission,
    needs: &[Need::Time, Need::Motion],
    is_positive: true,
    ..Delay::SPEC
};

pub(crate) const LAW: Delay = Delay;
