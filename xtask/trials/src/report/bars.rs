//! The figures that a batch is judged by (docs/blind-checks.md, What is counted), from the judged trials.

use xtask_blind::{Rate, TrialScore, Verdict};

use crate::batch::Case;
use crate::calibration::{calibration_error, probabilities};
use crate::measure::{Bar, Measure, Value, mean, number, quantile};

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

/// Scores of the suites asked for.
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

/// All figures, in the order of the report.
pub(crate) fn measures(cases: &[Case]) -> Vec<Measure> {
    let mut all = answered(cases);
    all.extend(clean(cases));
    all.extend(singles(cases));
    all.extend(precision(cases));
    all.extend(withheld(cases));
    all.extend(pairs(cases));
    all.extend(shrink(cases));
    all.extend(calibration(cases));
    all.extend(parameters(cases));
    all.extend(near(cases));
    all.extend(super::measured::measures(cases));
    all.extend(super::moving::measures(cases));
    all.extend(super::closed::measures(cases));
    all.extend(others(cases));
    all
}

fn answered(cases: &[Case]) -> Vec<Measure> {
    let answers = Rate::of_cases(cases.iter().map(|case| case.error.is_none()));
    vec![Measure::new(
        "every trial",
        "the diagnosis answers",
        Value::Share(answers),
        Some(Bar::AtLeast(1.0)),
    )]
}

fn clean(cases: &[Case]) -> Vec<Measure> {
    let group = "clean sets";
    let scores = scores_of(cases, &["s0"]);
    let mut all = Vec::new();
    let mut add = |what: &str, keep: &dyn Fn(&str) -> bool| {
        let kept: Vec<&TrialScore> = scores
            .iter()
            .copied()
            .filter(|score| keep(&score.name))
            .collect();
        all.push(Measure::new(
            group,
            format!("named, {what}"),
            share(&kept, any, named),
            Some(Bar::AtMost(0.01)),
        ));
        all.push(Measure::new(
            group,
            format!("any verdict but no-gap, {what}"),
            share(&kept, any, detected),
            Some(Bar::AtMost(0.03)),
        ));
    };
    add("all", &|_| true);
    add("white noise", &|name| name == "clean-white");
    add("rough noise together", &|name| {
        ROUGH.iter().any(|(rough, _)| *rough == name)
    });
    for (label, what) in ROUGH {
        add(what, &|name| name == label);
    }
    all
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

fn singles(cases: &[Case]) -> Vec<Measure> {
    let scores = scores_of(cases, &["s1"]);
    let strong = "strong singles";
    let family = "detected singles";
    vec![
        Measure::new(strong, "detected", share(&scores, any, detected), None),
        Measure::new(
            strong,
            "answered `named`",
            share(&scores, any, named),
            Some(Bar::AtLeast(0.7)),
        ),
        Measure::new(
            strong,
            "size of the declared class",
            class_sizes(&scores),
            Some(Bar::AtMost(2.0)),
        ),
        Measure::new(
            strong,
            "top name alone right",
            share(&scores, any, |score| score.top_right),
            Some(Bar::AtLeast(0.8)),
        ),
        Measure::new(
            family,
            "family right up to the declared class",
            share(&scores, detected, right),
            Some(Bar::AtLeast(0.97)),
        ),
        Measure::new(
            family,
            "joint right, of those found",
            joints(&scores),
            Some(Bar::AtLeast(0.95)),
        ),
        Measure::new(
            family,
            "named and wrong",
            share(&scores, detected, |score| score.confidently_wrong),
            None,
        ),
    ]
}

/// Whether a verdict `named` is right: one name of every effect is there, or of two effects one alone, with
/// nothing that was not put in. (That both are found is counted under two effects.)
pub(super) fn name_is_right(score: &TrialScore) -> bool {
    score.right || (score.groups > 1 && score.groups_found > 0 && score.false_causes == 0)
}

fn precision(cases: &[Case]) -> Vec<Measure> {
    let group = "precision of `named`";
    let everywhere: Vec<&TrialScore> = cases
        .iter()
        .filter_map(|case| case.score.as_ref())
        .collect();
    let bar = Some(Bar::AtLeast(0.98));
    vec![
        Measure::new(
            group,
            "strong singles",
            share(&scores_of(cases, &["s1"]), named, name_is_right),
            bar,
        ),
        Measure::new(
            group,
            "all suites together",
            share(&everywhere, named, name_is_right),
            bar,
        ),
        Measure::new(
            group,
            "all suites together, and nothing else named",
            share(&everywhere, named, |score| {
                name_is_right(score) && score.false_causes == 0
            }),
            None,
        ),
    ]
}

fn withheld(cases: &[Case]) -> Vec<Measure> {
    let group = "withheld and never in the catalogue";
    let mut all = Vec::new();
    for (what, suites) in [
        ("together", &["s2", "s3"][..]),
        ("withheld", &["s2"]),
        ("never in the catalogue", &["s3"]),
    ] {
        let scores = scores_of(cases, suites);
        let bar = Some(Bar::AtLeast(0.92));
        let name = format!("unknown or a twin class, {what}");
        all.push(Measure::new(
            group,
            name,
            share(&scores, detected, right),
            bar,
        ));
        let bar = Some(Bar::AtMost(0.03));
        let name = format!("confidently wrong, {what}");
        let wrong = share(&scores, detected, |score| score.confidently_wrong);
        all.push(Measure::new(group, name, wrong, bar));
    }
    for (what, suites) in [
        ("torques and forces, withheld", &["sfw"]),
        ("torques and forces, never in the catalogue", &["sfu"]),
    ] {
        let scores = scores_of(cases, suites);
        let mut add = |name: String, value: Value, bar: Option<Bar>| {
            all.push(Measure::new(group, name, value, bar));
        };
        let seen = share(&scores, any, detected);
        add(format!("any verdict but no-gap, {what}"), seen, None);
        let unknown = share(&scores, detected, right);
        add(format!("unknown or a twin class, {what}"), unknown, None);
        let wrong = share(&scores, detected, |score| score.confidently_wrong);
        let bar = Some(Bar::AtMost(0.03));
        add(format!("confidently wrong, {what}"), wrong, bar);
    }
    let s3 = scores_of(cases, &["s3"]);
    let judged = s3.iter().filter_map(|score| score.dependence_right);
    all.push(Measure::new(
        group,
        "what the gap depends on, never in the catalogue",
        Value::Share(Rate::of_cases(judged)),
        None,
    ));
    all
}

fn pairs(cases: &[Case]) -> Vec<Measure> {
    let group = "two effects";
    let scores = scores_of(cases, &["s4"]);
    let false_causes = |scores: &[&TrialScore]| {
        let counts: Vec<f64> = scores
            .iter()
            .map(|score| score.false_causes as f64)
            .collect();
        number(&counts, 2, "", mean)
    };
    vec![
        Measure::new(
            group,
            "both found",
            share(&scores, any, |score| score.groups_found == score.groups),
            Some(Bar::AtLeast(0.8)),
        ),
        Measure::new(
            group,
            "at least one found",
            share(&scores, any, |score| score.groups_found > 0),
            None,
        ),
        Measure::new(
            group,
            "false extra causes per set",
            false_causes(&scores),
            Some(Bar::AtMost(0.15)),
        ),
        Measure::new(
            group,
            "false extra causes per strong single",
            false_causes(&scores_of(cases, &["s1"])),
            None,
        ),
    ]
}

fn shrink(cases: &[Case]) -> Vec<Measure> {
    let group = "held-out gap where the name is right";
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
    let stated: Vec<f64> = strong
        .iter()
        .filter_map(|shrink| shrink.stated_percent)
        .collect();
    let truly: Vec<f64> = strong.iter().map(|shrink| shrink.true_percent).collect();
    let median = |values: &[&f64]| quantile(values, 0.5);
    vec![
        Measure::new(
            group,
            "truly closed, median, strong singles",
            number(&truly, 1, "%", median),
            Some(Bar::AtLeast(90.0)),
        ),
        Measure::new(
            group,
            "stated as closed, median, strong singles",
            number(&stated, 1, "%", median),
            None,
        ),
        Measure::new(
            group,
            "interval holds the true shrink, strong singles",
            covered(&strong),
            Some(Bar::AtLeast(0.9)),
        ),
        Measure::new(
            group,
            "interval holds the true shrink, all with names",
            covered(&all),
            Some(Bar::AtLeast(0.9)),
        ),
    ]
}

fn calibration(cases: &[Case]) -> Vec<Measure> {
    let group = "expected calibration error, unknown included";
    let error =
        |suites: Option<&[&str]>| number(&probabilities(cases, suites), 3, "", calibration_error);
    vec![
        Measure::new(
            group,
            "all suites together",
            error(None),
            Some(Bar::AtMost(0.05)),
        ),
        Measure::new(group, "strong singles", error(Some(&["s1"])), None),
        Measure::new(
            group,
            "withheld and never in the catalogue",
            error(Some(&["s2", "s3"])),
            None,
        ),
    ]
}

fn parameters(cases: &[Case]) -> Vec<Measure> {
    let group = "95 % intervals of effect parameters hold the truth";
    let covered = |suites: &[&str]| {
        let scores = scores_of(cases, suites);
        let all = scores.iter().flat_map(|score| &score.coverage);
        let with_interval = all.filter(|one| !CHOICES.contains(&one.parameter.as_str()));
        Value::Share(Rate::of_cases(with_interval.map(|one| one.covered)))
    };
    let bar = Some(Bar::Between(0.9, 0.99));
    vec![
        Measure::new(group, "all suites with names", covered(&NAMED), bar),
        Measure::new(group, "strong singles", covered(&["s1"]), None),
        Measure::new(group, "near-threshold singles", covered(&["s1n"]), None),
    ]
}

fn near(cases: &[Case]) -> Vec<Measure> {
    let group = "near-threshold effects";
    let scores = scores_of(cases, &["s1n"]);
    vec![
        Measure::new(
            group,
            "detected",
            share(&scores, any, detected),
            Some(Bar::AtLeast(0.85)),
        ),
        Measure::new(
            group,
            "right, of detected",
            share(&scores, detected, right),
            Some(Bar::AtLeast(0.9)),
        ),
        Measure::new(group, "joint right, of those found", joints(&scores), None),
    ]
}

/// Suites without a bar of their own.
fn others(cases: &[Case]) -> Vec<Measure> {
    let group = "other suites";
    let flagged = scores_of(cases, &["s10"]);
    let flagged = flagged.iter().filter_map(|score| score.implausible_flagged);
    let plain = |name: &str, suite: &str| {
        let value = share(&scores_of(cases, &[suite]), any, right);
        Measure::new(group, name, value, None)
    };
    vec![
        plain("twins: right up to the declared class", "s6"),
        plain("pathologies of the noise: right", "s7"),
        plain("ablation: every missing base term named", "s8"),
        Measure::new(
            group,
            "impossible magnitudes flagged",
            Value::Share(Rate::of_cases(flagged)),
            None,
        ),
        plain("force and torque: right", "sf"),
    ]
}
