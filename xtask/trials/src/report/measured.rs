//! Figures of the suites that are like measured sets (docs/blind-checks.md).

use xtask_blind::TrialScore;

use crate::batch::Case;
use crate::measure::{Bar, Group, Measure, figures};
use crate::report::bars::{detected, name_is_right, named, right, scores_of, share};

/// Suites that are like measured sets, with what is in them: names, withheld ones, clean recordings.
const LIKE_MEASURED: [(&str, &str); 5] = [
    ("se", "group elasticity"),
    ("sr", "postures with repeats"),
    ("sm", "moved trackers"),
    ("sc", "coloured noise"),
    ("sw", "wrists"),
];

/// Named rightly, confidently wrong, clean flagged, of each.
pub(super) fn measures(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("suites like measured sets");
    for (suite, what) in LIKE_MEASURED {
        let scores = scores_of(cases, &[suite]);
        let is_gap = |score: &TrialScore| !score.is_clean;
        let is_seen_gap = |score: &TrialScore| !score.is_clean && score.detected;
        let is_listed = |score: &TrialScore| !score.is_clean && !score.is_unknown;
        let is_wrong = |score: &TrialScore| named(score) && !name_is_right(score);
        let rightly = share(&scores, is_seen_gap, name_is_right);
        let flagged = share(&scores, |score| score.is_clean, detected);
        figures! { group:
            format!("gaps detected, {what}"), share(&scores, is_gap, detected), None;
            format!("right of detected, {what}"), rightly, Bar::AtLeast(0.95);
            format!("confidently wrong, {what}"), share(&scores, detected, is_wrong), Bar::AtMost(0.02);
            format!("clean flagged, {what}"), flagged, Bar::AtMost(0.01);
            format!("every effect found, {what}"), share(&scores, is_listed, right), None;
        }
    }
    group.measures
}
