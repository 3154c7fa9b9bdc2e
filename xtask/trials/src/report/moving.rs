//! Figures of arms that a controller moves (docs/blind-checks.md, Moving arms).

use std::collections::BTreeMap;

use haptical_report::{Cell, ReportError, Table};
use xtask_blind::{Rate, TrialScore};
use xtask_output::cells;

use crate::batch::Case;
use crate::measure::{Bar, Group, Measure, Value, figures, number, quantile};
use crate::report::bars::{any, confidently_wrong, detected, named, right, scores_of, share};

/// The suite, and that of clean arms whose noise has a memory.
const SUITE: &str = "moving";
const MEMORY: &str = "moving-memory";
/// That of faults of log, file and laws.
pub(super) const ADMISSION: &str = "moving-admission";
/// Labels of trials whose torques are of something else begin so.
const SLOPPY: &str = "torques-of-";

/// A part of the suite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stratum {
    Clean,
    Strong,
    Weak,
    Withheld,
    Foreign,
    Pair,
    Sloppy,
}

impl Stratum {
    /// Where a trial of the suite belongs.
    fn of(case: &Case) -> Self {
        let truth = &case.truth;
        if truth.name.starts_with(SLOPPY) {
            Self::Sloppy
        } else if truth.is_clean() {
            Self::Clean
        } else if !truth.without.is_empty() {
            Self::Withheld
        } else if truth.is_unknown() {
            Self::Foreign
        } else if truth.effects.len() > 1 {
            Self::Pair
        } else if is_weak(case) {
            Self::Weak
        } else {
            Self::Strong
        }
    }
}

/// Whether a trial of the suite has one weak effect.
pub(crate) fn is_weak(case: &Case) -> bool {
    case.suite == SUITE && case.truth.effects.iter().any(|effect| effect.size < 1.0)
}

/// Trials of the suite that belong to these strata.
fn of<'c>(cases: &'c [Case], strata: &[Stratum]) -> Vec<&'c Case> {
    let own = cases.iter().filter(|case| case.suite == SUITE);
    own.filter(|case| strata.contains(&Stratum::of(case)))
        .collect()
}

fn scores<'c>(cases: &[&'c Case]) -> Vec<&'c TrialScore> {
    let cases = cases.iter().filter_map(|case| case.score.as_ref());
    cases.collect()
}

pub(super) fn measures(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("moving arms");
    clean(cases, &mut group);
    listed(cases, &mut group);
    nameless(cases, &mut group);
    let is_moving = |case: &&Case| [SUITE, MEMORY].contains(&case.suite);
    let times_s = cases.iter().filter(is_moving).map(|case| case.time_s);
    let times_s: Vec<f64> = times_s.collect();
    let time = number(&times_s, 2, "s", |values| quantile(values, 0.5));
    group.add("time of a diagnosis, median", time, None);
    group.measures
}

fn clean(cases: &[Case], group: &mut Group) {
    let own = scores(&of(cases, &[Stratum::Clean]));
    let memory = scores_of(cases, &[MEMORY]);
    figures! { group:
        "clean: any verdict but no-gap", share(&own, any, detected), Bar::AtMost(0.03);
        "clean: named", share(&own, any, named), Bar::AtMost(0.01);
        "noise with a memory: named", share(&memory, any, named), Bar::AtMost(0.02);
        "noise with a memory: any verdict but no-gap", share(&memory, any, detected), None;
    }
}

/// Effects that the catalogue has.
fn listed(cases: &[Case], group: &mut Group) {
    let strong_cases = of(cases, &[Stratum::Strong]);
    let strong = scores(&strong_cases);
    let weak = scores(&of(cases, &[Stratum::Weak]));
    let pairs = scores(&of(cases, &[Stratum::Pair]));
    let joints = strong.iter().filter_map(|score| score.joint_right);
    let joints = Value::Share(Rate::of_cases(joints));
    let right_of = |scores: &[&TrialScore]| share(scores, detected, right);
    let both = share(&pairs, any, |score| score.groups_found == score.groups);
    let wrong = share(&strong, detected, confidently_wrong);
    figures! { group:
        "strong: detected", share(&strong, any, detected), None;
        "strong: right, of detected", right_of(&strong), Bar::AtLeast(0.9);
        "strong: joint right, of those found", joints, Bar::AtLeast(0.95);
        "strong: confidently wrong, of detected", wrong, Bar::AtMost(0.03);
        "strong, name right: gap stated as closed, median", stated(&strong_cases), None;
        "weak: detected", share(&weak, any, detected), None;
        "weak: right, of detected", right_of(&weak), Bar::AtLeast(0.9);
        "two effects: both found", both, Bar::AtLeast(0.8);
    }
}

/// Effects that the catalogue does not have, and torques that no effect makes.
fn nameless(cases: &[Case], group: &mut Group) {
    let withheld = scores(&of(cases, &[Stratum::Withheld]));
    let foreign = scores(&of(cases, &[Stratum::Foreign]));
    let both = scores(&of(cases, &[Stratum::Withheld, Stratum::Foreign]));
    let sloppy = scores(&of(cases, &[Stratum::Sloppy]));
    let right_of = |scores: &[&TrialScore]| share(scores, detected, right);
    let wrong = share(&both, detected, confidently_wrong);
    let unknown = share(&sloppy, any, right);
    figures! { group:
        "withheld: unknown or a twin class, of detected", right_of(&withheld), None;
        "in no catalogue: unknown, of detected", right_of(&foreign), None;
        "no name is right: unknown, of detected", right_of(&both), Bar::AtLeast(0.9);
        "no name is right: confidently wrong, of detected", wrong, Bar::AtMost(0.03);
        "torques of something else: unknown", unknown, Bar::AtLeast(1.0);
    }
}

/// Stated reduction of the gap on the second recording, where the first name is right.
fn stated(cases: &[&Case]) -> Value {
    let right = cases
        .iter()
        .filter(|case| case.score.as_ref().is_some_and(|score| score.top_right));
    let percents: Vec<f64> = right
        .filter_map(|case| {
            let cause = case.answer.as_ref()?.causes.first()?;
            cause.held_out.as_ref()?.reduction_percent
        })
        .collect();
    number(&percents, 1, "%", |values| quantile(values, 0.5))
}

/// Effect by effect; none without trials.
pub(crate) fn table(cases: &[Case]) -> Result<Option<Table>, ReportError> {
    let mut by_label: BTreeMap<&str, Vec<&Case>> = BTreeMap::new();
    let cases = cases.iter();
    for case in cases.filter(|case| [SUITE, MEMORY, ADMISSION].contains(&case.suite)) {
        by_label.entry(&case.truth.name).or_default().push(case);
    }
    if by_label.is_empty() {
        return Ok(None);
    }
    let heads = "trials with | trials | change over noise, median | detected | right | first name right | joint right \
                 | confidently wrong | answered first";
    let mut table = Table::with_heads("", heads);
    for (label, own) in by_label {
        let scores = scores(&own);
        let count = |is: fn(&TrialScore) -> bool| {
            Cell::number(scores.iter().filter(|score| is(score)).count() as f64, 0)
        };
        let joints = scores.iter().filter_map(|score| score.joint_right);
        let joints: Vec<bool> = joints.collect();
        let at_joint = joints.iter().filter(|right| **right).count();
        let changes: Vec<f64> = own.iter().filter_map(|case| change(case)).collect();
        let changes: Vec<&f64> = changes.iter().collect();
        let joint = match joints.len() {
            0 => Cell::Missing,
            of => Cell::Text(format!("{at_joint} of {of}")),
        };
        table.push(cells! {
            label.to_owned(), own.len() => 0, quantile(&changes, 0.5) => 1,
            count(|score| score.detected), count(|score| score.right),
            count(|score| score.top_right), joint, count(|score| score.confidently_wrong),
            answers(&scores),
        })?;
    }
    let note = "Change: of the torque, filtered at 10 Hz, root mean square over the noise, worst joint, against the same arm and \
         controller without the effect; of what shows on second encoders or in lost rows it says nothing.";
    Ok(Some(table.with_note(note)))
}

/// The larger of the changes against the arm and, where the log has a command, the controller.
fn change(case: &Case) -> Option<f64> {
    let law = &case.truth.effects.first()?.law;
    let arm = law.get("change_arm_over_noise")?;
    let controller = law.get("change_controller_over_noise").copied();
    Some(controller.map_or(*arm, |own| own.max(*arm)))
}

/// `payload 3, unknown 2`, most frequent first.
fn answers(scores: &[&TrialScore]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for score in scores {
        *counts.entry(&score.answered).or_default() += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let words: Vec<String> = counts
        .into_iter()
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    words.join(", ")
}
