//! Which causes of a diagnosis are faults of its log, and not of the device.

use haptical_diagnosis::{CauseAnswer, Diagnosis, Verdict};
use haptical_effects::LogFault;
use haptical_effects::device::{bare, effects_of};
use haptical_model::DeviceEffect;

/// Least probability of a cause that the log is changed for.
const LEAST_PROBABILITY: f64 = 0.8;

/// A cause that is a fault of the log.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnose) struct Fault<'d> {
    pub(in crate::diagnose) cause: &'d CauseAnswer,
    pub(in crate::diagnose) kind: LogFault,
}

/// The causes that are faults of the log: those of a verdict that names them. Of wild readings alone a verdict of no gap
/// may tell too.
pub(in crate::diagnose) fn faults(diagnosis: &Diagnosis) -> Vec<Fault<'_>> {
    if !matches!(diagnosis.verdict, Verdict::Named | Verdict::NoGap) {
        return Vec::new();
    }
    let causes = diagnosis.causes.iter();
    let likely = causes.filter(|cause| cause.probability >= LEAST_PROBABILITY);
    let faults = likely.filter_map(|cause| {
        let kind = log_fault(diagnosis, cause)?;
        Some(Fault { cause, kind })
    });
    faults.collect()
}

/// What a log has wrong by a cause. Of two laws of one name, what the cable's encoder and what the links grow by, the numbers
/// tell.
fn log_fault(diagnosis: &Diagnosis, cause: &CauseAnswer) -> Option<LogFault> {
    let named = || haptical_effects::specs().filter(|spec| spec.name == cause.effect);
    let kind = named().find_map(|spec| spec.log_fault)?;
    if named().any(|spec| spec.log_fault.is_none()) {
        let corrected = diagnosis.corrected.as_ref()?;
        let entry = corrected.effects.iter().find(|own| is_of(own, cause))?;
        let mut alone = bare(corrected);
        alone.effects = vec![entry.clone()];
        return effects_of(&alone).ok()?.first()?.effect.spec().log_fault;
    }
    Some(kind)
}

/// Whether an effect of a device is a cause.
pub(in crate::diagnose) fn is_of(own: &DeviceEffect, cause: &CauseAnswer) -> bool {
    own.name == cause.effect && own.joint.map(|joint| joint + 1) == cause.joint
}
