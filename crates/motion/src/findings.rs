//! What was picked, as findings: with the rivals of each, and a fault of the log first.

use crate::effect::delay::TORQUE_LATENCY;
use crate::effect::{Found, change, is_delay_of_all};
use crate::examined::{Finding, NearRival};
use crate::fit::problem::Problem;
use crate::select::{Pick, Rival, Selection};

/// The fault of a log that repeats rows or lacks some.
pub(crate) const SAMPLING: &str = "sampling";

/// What was found, a fault of the log first.
pub(crate) fn findings(problem: &Problem, selection: &Selection) -> Vec<Finding> {
    let rival = |own: &Rival| NearRival {
        effect: own.name.0,
        joint: own.name.1,
        behind_nats: own.behind,
        share: own.fit,
    };
    let findings = selection.picks.iter().map(|pick| {
        let (effect, numbers) = by_sense(pick);
        let found = Found {
            arm: &problem.arm,
            joint: pick.joint,
            numbers: &pick.numbers,
            read_off: &pick.read_off,
        };
        Finding {
            effect,
            joint: pick.joint,
            change: change(pick.effect, &found),
            nats: pick.nats,
            numbers,
            rivals: pick.rivals.iter().map(rival).collect(),
            is_told: pick.is_told,
        }
    });
    let of_log = problem.samples.sampling.map(|[repeated, missing]| Finding {
        effect: SAMPLING,
        joint: None,
        change: None,
        // it is seen row by row, not by what it explains
        nats: selection.bare.excess.abs().max(1.0)
            + selection.picks.first().map_or(0.0, |own| own.nats),
        numbers: vec![("share", repeated + missing, 0.0)],
        rivals: Vec::new(),
        is_told: true,
    });
    of_log.into_iter().chain(findings).collect()
}

/// Name and numbers of a pick: where positions of all joints seem early, it is the torques that are late.
fn by_sense(pick: &Pick) -> (&'static str, Vec<(&'static str, f64, f64)>) {
    let mut numbers = pick.numbers.clone();
    let is_early = is_delay_of_all(pick.effect, pick.joint)
        && numbers.iter().any(|own| own.0 == "delay_s" && own.1 < 0.0);
    if !is_early {
        return (pick.effect, numbers);
    }
    numbers.iter_mut().for_each(|own| own.1 = -own.1);
    (TORQUE_LATENCY.name, numbers)
}
