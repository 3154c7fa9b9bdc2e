//! The figures that a batch is judged by (docs/blind-checks.md, What is counted), from the judged trials.

use xtask_blind::{Rate, TrialScore, Verdict};

use crate::batch::Case;
use crate::calibration::{calibration_error, probabilities};
use crate::measure::{Bar, Group, Measure, Value, mean, number, quantile};

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
    let mut group = Group::new("every trial");
    let answers = Rate::of_cases(cases.iter().map(|case| case.error.is_none()));
    group.add(
        "the diagnosis answers",
        Value::Share(answers),
        Bar::AtLeast(1.0),
    );
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
    let top = share(&scores, any, |score| score.top_right);
    let mut strong = Group::new("strong singles");
    strong.add("detected", share(&scores, any, detected), None);
    strong.add(
        "answered `named`",
        share(&scores, any, named),
        Bar::AtLeast(0.7),
    );
    strong.add(
        "size of the declared class",
        class_sizes(&scores),
        Bar::AtMost(2.0),
    );
    strong.add("top name alone right", top, Bar::AtLeast(0.8));
    let family = share(&scores, detected, right);
    let wrong = share(&scores, detected, confidently_wrong);
    let mut seen = Group::new("detected singles");
    seen.add(
        "family right up to the declared class",
        family,
        Bar::AtLeast(0.97),
    );
    seen.add(
        "joint right, of those found",
        joints(&scores),
        Bar::AtLeast(0.95),
    );
    seen.add("named and wrong", wrong, None);
    strong.measures.extend(seen.measures);
    strong.measures
}

/// Whether a verdict `named` is right: one name of every effect is there, or of two effects one alone, with
/// nothing that was not put in. (That both are found is counted under two effects.)
pub(super) fn name_is_right(score: &TrialScore) -> bool {
    score.right || (score.groups > 1 && score.groups_found > 0 && score.false_causes == 0)
}

fn precision(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("precision of `named`");
    let strong = scores_of(cases, &["s1"]);
    let everywhere = cases.iter().filter_map(|case| case.score.as_ref());
    let everywhere: Vec<&TrialScore> = everywhere.collect();
    let bar = Bar::AtLeast(0.98);
    group.add("strong singles", share(&strong, named, name_is_right), bar);
    let all = share(&everywhere, named, name_is_right);
    group.add("all suites together", all, bar);
    let alone = share(&everywhere, named, |score| {
        name_is_right(score) && score.false_causes == 0
    });
    group.add("all suites together, and nothing else named", alone, None);
    group.measures
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
        let name = format!("unknown or a twin class, {what}");
        group.add(name, share(&scores, detected, right), bar);
        let wrong = share(&scores, detected, confidently_wrong);
        group.add(
            format!("confidently wrong, {what}"),
            wrong,
            Bar::AtMost(0.03),
        );
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
    let both = share(&scores, any, |score| score.groups_found == score.groups);
    let one = share(&scores, any, |score| score.groups_found > 0);
    group.add("both found", both, Bar::AtLeast(0.8));
    group.add("at least one found", one, None);
    group.add(
        "false extra causes per set",
        false_causes(&scores),
        Bar::AtMost(0.15),
    );
    let single = false_causes(&scores_of(cases, &["s1"]));
    group.add("false extra causes per strong single", single, None);
    group.measures
}

fn shrink(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("held-out gap where the name is right");
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
    group.add(
        "truly closed, median, strong singles",
        truly,
        Bar::AtLeast(90.0),
    );
    group.add("stated as closed, median, strong singles", stated, None);
    let bar = Bar::AtLeast(0.9);
    let name = "interval holds the true shrink, strong singles";
    group.add(name, covered(&strong), bar);
    let name = "interval holds the true shrink, all with names";
    group.add(name, covered(&all), bar);
    group.measures
}

fn calibration(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("expected calibration error, unknown included");
    let error =
        |suites: Option<&[&str]>| number(&probabilities(cases, suites), 3, "", calibration_error);
    group.add("all suites together", error(None), Bar::AtMost(0.05));
    group.add("strong singles", error(Some(&["s1"])), None);
    let nameless = error(Some(&["s2", "s3"]));
    group.add("withheld and never in the catalogue", nameless, None);
    group.measures
}

fn parameters(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("95 % intervals of effect parameters hold the truth");
    let covered = |suites: &[&str]| {
        let scores = scores_of(cases, suites);
        let all = scores.iter().flat_map(|score| &score.coverage);
        let with_interval = all.filter(|one| !CHOICES.contains(&one.parameter.as_str()));
        Value::Share(Rate::of_cases(with_interval.map(|one| one.covered)))
    };
    group.add(
        "all suites with names",
        covered(&NAMED),
        Bar::Between(0.9, 0.99),
    );
    group.add("strong singles", covered(&["s1"]), None);
    group.add("near-threshold singles", covered(&["s1n"]), None);
    group.measures
}

fn near(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("near-threshold effects");
    let scores = scores_of(cases, &["s1n"]);
    group.add(
        "detected",
        share(&scores, any, detected),
        Bar::AtLeast(0.85),
    );
    group.add(
        "right, of detected",
        share(&scores, detected, right),
        Bar::AtLeast(0.9),
    );
    group.add("joint right, of those found", joints(&scores), None);
    group.measures
}

/// Suites without a bar of their own.
fn others(cases: &[Case]) -> Vec<Measure> {
    let mut group = Group::new("other suites");
    let flagged = scores_of(cases, &["s10"]);
    let flagged = flagged.iter().filter_map(|score| score.implausible_flagged);
    let plain = |suite: &str| share(&scores_of(cases, &[suite]), any, right);
    group.add("twins: right up to the declared class", plain("s6"), None);
    group.add("pathologies of the noise: right", plain("s7"), None);
    group.add("ablation: every missing base term named", plain("s8"), None);
    let flagged = Value::Share(Rate::of_cases(flagged));
    group.add("impossible magnitudes flagged", flagged, None);
    group.add("force and torque: right", plain("sf"), None);
    group.measures
}
