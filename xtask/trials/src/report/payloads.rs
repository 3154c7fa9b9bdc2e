//! Figures of the suites of arms that log torques alone.

use xtask_blind::TrialScore;

use super::bars::{any, confidently_wrong, detected, named, right, scores_of, share};
use crate::batch::Case;
use crate::measure::{Bar, Group, Measure, figures};

/// Payloads named, withheld, and none where nothing changed.
pub(crate) fn payloads(cases: &[Case]) -> Vec<Measure> {
    let changed = scores_of(cases, &["sp"]);
    let withheld = scores_of(cases, &["spw"]);
    let same = scores_of(cases, &["spc"]);
    let (clean, rubbing): (Vec<&TrialScore>, Vec<&TrialScore>) =
        same.iter().partition(|score| score.is_clean);
    let all = [&changed[..], &withheld, &same].concat();
    let is_wrong = |score: &TrialScore| named(score) && !score.right;
    figures! { "torques alone":
        "payload: any verdict but no-gap", share(&changed, any, detected), None;
        "payload: named right of detected", share(&changed, detected, right), Bar::AtLeast(0.95);
        "withheld: unknown or a twin class", share(&withheld, detected, right), None;
        "all: confidently wrong", share(&all, any, confidently_wrong), Bar::AtMost(0.02);
        "no change, no friction: any verdict but no-gap", share(&clean, any, detected), Bar::AtMost(0.01);
        "no change, friction: a wrong name", share(&rubbing, any, is_wrong), Bar::AtMost(0.01);
    }
}
