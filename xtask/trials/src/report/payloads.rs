//! Figures of the suites of arms that log torques alone.

use xtask_blind::TrialScore;

use super::bars::{any, confidently_wrong, detected, named, right, scores_of, share};
use crate::batch::Case;
use crate::measure::{Bar, Group, Measure};

/// Payloads named, withheld, and none where nothing changed.
pub(crate) fn payloads(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("torques alone");
    let changed = scores_of(cases, &["sp"]);
    let withheld = scores_of(cases, &["spw"]);
    let same = scores_of(cases, &["spc"]);
    let (clean, rubbing): (Vec<&TrialScore>, Vec<&TrialScore>) =
        same.iter().partition(|score| score.is_clean);
    let all = [&changed[..], &withheld, &same].concat();
    let seen = share(&changed, any, detected);
    group.add("payload: any verdict but no-gap", seen, None);
    let rightly = share(&changed, detected, right);
    group.add(
        "payload: named right of detected",
        rightly,
        Bar::AtLeast(0.95),
    );
    let unknown = share(&withheld, detected, right);
    group.add("withheld: unknown or a twin class", unknown, None);
    let wrong = share(&all, any, confidently_wrong);
    group.add("all: confidently wrong", wrong, Bar::AtMost(0.02));
    let name = "no change, no friction: any verdict but no-gap";
    group.add(name, share(&clean, any, detected), Bar::AtMost(0.01));
    let wrong = share(&rubbing, any, |score| named(score) && !score.right);
    group.add(
        "no change, friction: a wrong name",
        wrong,
        Bar::AtMost(0.01),
    );
    group.measures
}
