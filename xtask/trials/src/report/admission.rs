//! Figures of moving arms with faults of log, file and laws (docs/blind-checks.md, Faults that bar a verdict).

use xtask_blind::TrialScore;

use crate::batch::Case;
use crate::measure::{Group, Measure, figures};
use crate::report::bars::{any, confidently_wrong, detected, right, scores_of, share};
use crate::report::moving::ADMISSION;

/// How labels of a kind of trial begin, and what it is.
const KINDS: [(&str, &str); 8] = [
    ("partial-", "friction of its own beside an effect"),
    ("dropouts-", "torque readings that are none"),
    ("scale", "one factor on all torques"),
    ("zero", "a joint's zero"),
    ("description-", "a wrong description"),
    ("short-", "too short a log"),
    ("other-arm", "another arm"),
    ("other-second", "another arm in the second recording"),
];

/// Right and confidently wrong: of all trials, and kind by kind. None has a bar.
pub(super) fn measures(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("moving arms with faults");
    let all = scores_of(cases, &[ADMISSION]);
    figures! { group:
        "right, of all", share(&all, any, right), None;
        "right, of detected", share(&all, detected, right), None;
        "confidently wrong, of detected", share(&all, detected, confidently_wrong), None;
    }
    for (label, what) in KINDS {
        let is_own = |score: &TrialScore| score.name.starts_with(label);
        let is_seen = |score: &TrialScore| is_own(score) && detected(score);
        figures! { group:
            format!("right, {what}"), share(&all, is_own, right), None;
            format!("right of detected, {what}"), share(&all, is_seen, right), None;
            format!("confidently wrong, {what}"), share(&all, is_own, confidently_wrong), None;
        }
    }
    group.measures
}
