//! Figures of the suites of arms that log torques alone.

use xtask_blind::TrialScore;

use super::bars::{any, detected, named, right, scores_of, share};
use crate::batch::Case;
use crate::measure::{Bar, Measure};

/// Payloads named, withheld, and none where nothing changed.
pub(crate) fn payloads(cases: &[Case]) -> Vec<Measure> {
    let group = "torques alone";
    let is_wrong = |score: &TrialScore| score.confidently_wrong;
    let changed = scores_of(cases, &["sp"]);
    let withheld = scores_of(cases, &["spw"]);
    let same = scores_of(cases, &["spc"]);
    let (clean, rubbing): (Vec<&TrialScore>, Vec<&TrialScore>) =
        same.iter().partition(|score| score.is_clean);
    let all: Vec<&TrialScore> = changed
        .iter()
        .chain(&withheld)
        .chain(&same)
        .copied()
        .collect();
    let figure = |what: &str, value, bar| Measure::new(group, what, value, bar);
    vec![
        figure(
            "payload: any verdict but no-gap",
            share(&changed, any, detected),
            None,
        ),
        figure(
            "payload: named right of detected",
            share(&changed, detected, right),
            Some(Bar::AtLeast(0.95)),
        ),
        figure(
            "withheld: unknown or a twin class",
            share(&withheld, detected, right),
            None,
        ),
        figure(
            "all: confidently wrong",
            share(&all, any, is_wrong),
            Some(Bar::AtMost(0.02)),
        ),
        figure(
            "no change, no friction: any verdict but no-gap",
            share(&clean, any, detected),
            Some(Bar::AtMost(0.01)),
        ),
        figure(
            "no change, friction: a wrong name",
            share(&rubbing, any, |score| named(score) && !score.right),
            Some(Bar::AtMost(0.01)),
        ),
    ]
}
