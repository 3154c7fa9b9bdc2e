//! Figures of the suites that are like measured sets (docs/blind-checks.md).

use xtask_blind::{TrialScore, Verdict};

use crate::batch::Case;
use crate::measure::{Bar, Group, Measure, Value};
use crate::report::bars::{detected, name_is_right, right, scores_of, share};

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
        let mut add = |name: &str, value: Value, bar: Option<Bar>| {
            group.add(format!("{name}, {what}"), value, bar);
        };
        let is_gap = |score: &TrialScore| !score.is_clean;
        let is_seen_gap = |score: &TrialScore| !score.is_clean && score.detected;
        let is_listed = |score: &TrialScore| !score.is_clean && !score.is_unknown;
        add("gaps detected", share(&scores, is_gap, detected), None);
        let rightly = share(&scores, is_seen_gap, name_is_right);
        add("right of detected", rightly, Some(Bar::AtLeast(0.95)));
        let wrong = share(&scores, detected, |score| {
            score.verdict == Verdict::Named && !name_is_right(score)
        });
        add("confidently wrong", wrong, Some(Bar::AtMost(0.02)));
        let flagged = share(&scores, |score| score.is_clean, detected);
        add("clean flagged", flagged, Some(Bar::AtMost(0.01)));
        let found = share(&scores, is_listed, right);
        add("every effect found", found, None);
    }
    group.measures
}
