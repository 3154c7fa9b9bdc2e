//! What to do next.

use haptical_diagnosis::{CauseAnswer, Diagnosis, Verdict};
use haptical_effects::base_model::{JOINT_OFFSET, LINK_GEOMETRY};

use crate::diagnose::commands::is_settled_by_plan;
use crate::diagnose::faults::faults;
use crate::diagnose::words::{listed, main_channel, placed};

/// What to do next: the experiment that the diagnosis asks for, else what the verdict suggests; first the use of the log
/// that was `repaired`.
pub(crate) fn next_step(diagnosis: &Diagnosis, repaired: Option<&str>) -> String {
    let step = step_beside_the_log(diagnosis);
    let of_log = faults(diagnosis).into_iter().map(|fault| fault.cause);
    let names = of_log.map(placed);
    let names: Vec<String> = names.collect();
    let first = match (repaired, names.as_slice()) {
        (Some(log), _) => {
            format!("`haptical identify --log {log}` calibrates from the repaired log")
        }
        (None, []) => return step,
        (None, names) => format!("`--repair` writes the log without {}", listed(names)),
    };
    match diagnosis.verdict {
        Verdict::NoGap => first,
        _ => format!("{first}; {step}"),
    }
}

/// The next recording: chosen, where candidates with a size are left.
fn step_beside_the_log(diagnosis: &Diagnosis) -> String {
    match is_settled_by_plan(diagnosis) {
        true => format!("{CHOSEN}; by hand: {}", by_hand(diagnosis)),
        false => by_hand(diagnosis),
    }
}

/// How the next recording is chosen, where candidates with a size are left.
const CHOSEN: &str = "`haptical plan --settle gap.json` chooses the next recording, then `haptical diagnose --log log.csv --log \
                      next.csv`";

/// What to do without a chosen recording.
fn by_hand(diagnosis: &Diagnosis) -> String {
    if let Some(experiment) = &diagnosis.next_experiment {
        return experiment.clone();
    }
    match (diagnosis.verdict, diagnosis.causes.first()) {
        (Verdict::NoGap, _) => "nothing; the model is as good as these data can tell. What could \
                                still hide is under \"what cannot be seen\""
            .to_owned(),
        (Verdict::Named, Some(cause)) if !cause.changed.is_empty() => changed(cause),
        (Verdict::Named, Some(cause)) => match haptical_effects::spec(&cause.effect) {
            Some(spec) => format!(
                "check {}; mend it, or put the effect into the model with the parameters found, \
                 and record again to see that the gap is gone",
                spec.inspect
            ),
            None => "put the effect into the model with the parameters found, or mend it, and \
                     record again to see that the gap is gone"
                .to_owned(),
        },
        (Verdict::Ambiguous, _) => "record again with the load, the speed or the order of the \
                                    motions changed, so that the candidates behave differently"
            .to_owned(),
        _ => {
            let channel = main_channel(diagnosis).map(|channel| channel.channel.as_str());
            let channel = channel.unwrap_or("the residual");
            format!(
                "look at the device where {channel} shows the gap, and record it again more slowly and more densely there"
            )
        }
    }
}

/// Of a device that is no longer that of the earlier model.
fn changed(cause: &CauseAnswer) -> String {
    let joint = cause.joint.map(|joint| format!("joint {joint}"));
    let joint = joint.unwrap_or("a joint".to_owned());
    let look = match cause.effect.as_str() {
        name if name == JOINT_OFFSET.name => {
            format!("whether {joint} was homed anew, or its encoder or coupling slipped")
        }
        name if name == LINK_GEOMETRY.name => {
            format!("whether a link at {joint} was bent, or mounted anew")
        }
        _ => format!("what was changed at {joint}"),
    };
    format!(
        "the device is no longer that of the earlier model: look {look}; then identify it again"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::{named, no_gap, unknown};

    #[test]
    fn each_verdict_has_its_step_and_the_asked_for_experiment_comes_first() {
        assert!(next_step(&named(), None).starts_with("check the pre-tension"));
        assert!(next_step(&unknown(), None).contains("where out2 shows the gap"));
        assert!(next_step(&no_gap(), None).starts_with("nothing"));
        let mut open = named();
        open.verdict = Verdict::Ambiguous;
        open.next_experiment = Some("record it without a load".to_owned());
        assert_eq!(next_step(&open, None), "record it without a load");
    }

    #[test]
    fn a_repaired_log_is_calibrated_with_first() {
        let said = next_step(&named(), Some("repaired.csv"));
        assert!(
            said.starts_with("`haptical identify --log repaired.csv`"),
            "{said}"
        );
        assert!(said.contains("check the pre-tension"), "{said}");
        assert!(!next_step(&no_gap(), Some("repaired.csv")).contains("nothing"));
    }
}
