//! The figures that a batch is judged by (docs/blind-checks.md, What is counted), from the judged trials.

use xtask_blind::{Rate, TrialScore, Verdict};

use crate::batch::Case;
use crate::calibration::{calibration_error, probabilities};
use crate::measure::{Bar, Group, Measure, Value, figures, mean, number, quantile};

/// Clean recordings whose noise is not white, of the stated size and free of outliers.
const ROUGH: [(&str, &str); 4] = [
    ("clean-ar", "AR(0.5) noise"),
    ("clean-unequal", "unequal channels"),
    ("clean-outliers", "2 % outliers"),
    ("clean-rounded", "rounded to counts"),
];
/// Suites whose answers are names at some place, with a truth that has the names.
const NAMED: [&str; 5] = ["s1", "s1n", "s4", "s5", "s6"];

/// Parameters that are chosen from a few: right or wrong, without an interval.
const CHOICES: [&str; 2] = ["order", "from_joint"];

pub(crate) fn scores_of<'c>(cases: &'c [Case], suites: &[&str]) -> Vec<&'c TrialScore> {
    let wanted = cases.iter().filter(|case| suites.contains(&case.suite));
    wanted.filter_map(|case| case.score.as_ref()).collect()
}

pub(super) fn share(
    scores: &[&TrialScore],
    of: impl Fn(&TrialScore) -> bool,
    is: impl Fn(&TrialScore) -> bool,
) -> Value {
    let among = scores.iter().filter(|score| of(score));
    Value::Share(Rate::of_cases(among.map(|score| is(score))))
}

pub(super) fn any(_: &TrialScore) -> bool {
    true
}

pub(super) fn detected(score: &TrialScore) -> bool {
    score.detected
}

pub(super) fn right(score: &TrialScore) -> bool {
    score.right
}

pub(super) fn named(score: &TrialScore) -> bool {
    score.verdict == Verdict::Named
}

/// The figures of one part of the report.
type Part = fn(&[Case]) -> Vec<Measure>;

/// All figures, in the order of the report.
pub(crate) fn measures(cases: &[Case]) -> Vec<Measure> {
    let parts: [Part; 15] = [
        answered,
        clean,
        singles,
        precision,
        withheld,
        pairs,
        shrink,
        calibration,
        parameters,
        near,
        super::measured::measures,
        super::moving::measures,
        super::admission::measures,
        super::closed::measures,
        others,
    ];
    parts.iter().flat_map(|of| of(cases)).collect()
}

fn answered(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("every trial");
    let answers = Rate::of_cases(cases.iter().map(|case| case.error.is_none()));
    let answers = Value::Share(answers);
    group.add("the diagnosis answers", answers, Bar::AtLeast(1.0));
    group.measures
}

fn clean(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("clean sets");
    let scores = scores_of(cases, &["s0"]);
    let mut add = |what: &str, keep: &dyn Fn(&str) -> bool| {
        let kept = scores.iter().copied().filter(|score| keep(&score.name));
        let kept: Vec<&TrialScore> = kept.collect();
        let name = format!("named, {what}");
        group.add(name, share(&kept, any, named), Bar::AtMost(0.01));
        let name = format!("any verdict but no-gap, {what}");
        group.add(name, share(&kept, any, detected), Bar::AtMost(0.03));
    };
    add("all", &|_| true);
    add("white noise", &|name| name == "clean-white");
    add("rough noise together", &|name| {
        ROUGH.iter().any(|(rough, _)| *rough == name)
    });
    for (label, what) in ROUGH {
        add(what, &|name| name == label);
    }
    group.measures
}

fn class_sizes(scores: &[&TrialScore]) -> Value {
    let sizes = scores.iter().filter_map(|score| score.class_size);
    let sizes: Vec<f64> = sizes.map(|size| size as f64).collect();
    number(&sizes, 2, "names", mean)
}

fn joints(scores: &[&TrialScore]) -> Value {
    let judged = scores.iter().filter_map(|score| score.joint_right);
    Value::Share(Rate::of_cases(judged))
}

pub(super) fn confidently_wrong(score: &TrialScore) -> bool {
    score.confidently_wrong
}

fn singles(cases: &[Case]) -> Vec<Measure> {
    let scores = scores_of(cases, &["s1"]);
    let strong = figures! { "strong singles":
        "detected", share(&scores, any, detected), None;
        "answered `named`", share(&scores, any, named), Bar::AtLeast(0.7);
        "size of the declared class", class_sizes(&scores), Bar::AtMost(2.0);
        "top name alone right", share(&scores, any, |score| score.top_right), Bar::AtLeast(0.8);
    };
    let seen = figures! { "detected singles":
        "family right up to the declared class", share(&scores, detected, right), Bar::AtLeast(0.97);
        "joint right, of those found", joints(&scores), Bar::AtLeast(0.95);
        "named and wrong", share(&scores, detected, confidently_wrong), None;
    };
    [strong, seen].concat()
}

/// Whether a verdict `named` is right: one name of every effect is there, or of two effects one alone, with
/// nothing that was not put in. (That both are found is counted under two effects.)
pub(super) fn name_is_right(score: &TrialScore) -> bool {
    score.right || (score.groups > 1 && score.groups_found > 0 && score.false_causes == 0)
}

fn precision(cases: &[Case]) -> Vec<Measure> {
    let strong = scores_of(cases, &["s1"]);
    let everywhere = cases.iter().filter_map(|case| case.score.as_ref());
    let everywhere: Vec<&TrialScore> = everywhere.collect();
    let alone = |score: &TrialScore| name_is_right(score) && score.false_causes == 0;
    figures! { "precision of `named`":
        "strong singles", share(&strong, named, name_is_right), Bar::AtLeast(0.98);
        "all suites together", share(&everywhere, named, name_is_right), Bar::AtLeast(0.98);
        "all suites together, and nothing else named", share(&everywhere, named, alone), None;
    }
}

fn withheld(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("withheld and never in the catalogue");
    for (what, suites) in [
        ("together", &["s2", "s3"][..]),
        ("withheld", &["s2"]),
        ("never in the catalogue", &["s3"]),
        ("torques and forces, withheld", &["sfw"]),
        ("torques and forces, never in the catalogue", &["sfu"]),
    ] {
        let scores = scores_of(cases, suites);
        let of_torques = what.starts_with("torques");
        if of_torques {
            let name = format!("any verdict but no-gap, {what}");
            group.add(name, share(&scores, any, detected), None);
        }
        let bar = (!of_torques).then_some(Bar::AtLeast(0.92));
        let wrong = share(&scores, detected, confidently_wrong);
        figures! { group:
            format!("unknown or a twin class, {what}"), share(&scores, detected, right), bar;
            format!("confidently wrong, {what}"), wrong, Bar::AtMost(0.03);
        }
    }
    let s3 = scores_of(cases, &["s3"]);
    let judged = s3.iter().filter_map(|score| score.dependence_right);
    let name = "what the gap depends on, never in the catalogue";
    group.add(name, Value::Share(Rate::of_cases(judged)), None);
    group.measures
}

fn pairs(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("two effects");
    let scores = scores_of(cases, &["s4"]);
    let false_causes = |scores: &[&TrialScore]| {
        let counts = scores.iter().map(|score| score.false_causes as f64);
        number(&counts.collect::<Vec<f64>>(), 2, "", mean)
    };
    let all_found = |score: &TrialScore| score.groups_found == score.groups;
    let singles = scores_of(cases, &["s1"]);
    figures! { group:
        "both found", share(&scores, any, all_found), Bar::AtLeast(0.8);
        "at least one found", share(&scores, any, |score| score.groups_found > 0), None;
        "false extra causes per set", false_causes(&scores), Bar::AtMost(0.15);
        "false extra causes per strong single", false_causes(&singles), None;
    }
    group.measures
}

fn shrink(cases: &[Case]) -> Vec<Measure> {
    let of_right = |suites: &[&str]| {
        let scores = scores_of(cases, suites);
        let right = scores.into_iter().filter(|score| score.top_right);
        right
            .filter_map(|score| score.shrink.clone())
            .collect::<Vec<_>>()
    };
    let (strong, all) = (of_right(&["s1"]), of_right(&NAMED));
    let covered = |shrinks: &[xtask_blind::ShrinkScore]| {
        let stated = shrinks.iter().filter_map(|shrink| shrink.covered);
        Value::Share(Rate::of_cases(stated))
    };
    let median = |percents: Vec<f64>| number(&percents, 1, "%", |values| quantile(values, 0.5));
    let truly = median(strong.iter().map(|own| own.true_percent).collect());
    let stated = median(strong.iter().filter_map(|own| own.stated_percent).collect());
    figures! { "held-out gap where the name is right":
        "truly closed, median, strong singles", truly, Bar::AtLeast(90.0);
        "stated as closed, median, strong singles", stated, None;
        "interval holds the true shrink, strong singles", covered(&strong), Bar::AtLeast(0.9);
        "interval holds the true shrink, all with names", covered(&all), Bar::AtLeast(0.9);
    }
}

fn calibration(cases: &[Case]) -> Vec<Measure> {
    let error =
        |suites: Option<&[&str]>| number(&probabilities(cases, suites), 3, "", calibration_error);
    figures! { "expected calibration error, unknown included":
        "all suites together", error(None), Bar::AtMost(0.05);
        "strong singles", error(Some(&["s1"])), None;
        "withheld and never in the catalogue", error(Some(&["s2", "s3"])), None;
    }
}

fn parameters(cases: &[Case]) -> Vec<Measure> {
    let covered = |suites: &[&str]| {
        let scores = scores_of(cases, suites);
        let all = scores.iter().flat_map(|score| &score.coverage);
        let with_interval = all.filter(|one| !CHOICES.contains(&one.parameter.as_str()));
        Value::Share(Rate::of_cases(with_interval.map(|one| one.covered)))
    };
    figures! { "95 % intervals of effect parameters hold the truth":
        "all suites with names", covered(&NAMED), Bar::Between(0.9, 0.99);
        "strong singles", covered(&["s1"]), None;
        "near-threshold singles", covered(&["s1n"]), None;
    }
}

fn near(cases: &[Case]) -> Vec<Measure> {
    let scores = scores_of(cases, &["s1n"]);
    figures! { "near-threshold effects":
        "detected", share(&scores, any, detected), Bar::AtLeast(0.85);
        "right, of detected", share(&scores, detected, right), Bar::AtLeast(0.9);
        "joint right, of those found", joints(&scores), None;
    }
}

/// Suites without a bar of their own.
fn others(cases: &[Case]) -> Vec<Measure> {
    let flagged = scores_of(cases, &["s10"]);
    let flagged = flagged.iter().filter_map(|score| score.implausible_flagged);
    let plain = |suite: &str| share(&scores_of(cases, &[suite]), any, right);
    figures! { "other suites":
        "twins: right up to the declared class", plain("s6"), None;
        "pathologies of the noise: right", plain("s7"), None;
        "ablation: every missing base term named", plain("s8"), None;
        "impossible magnitudes flagged", Value::Share(Rate::of_cases(flagged)), None;
        "force and torque: right", plain("sf"), None;
    }
}
