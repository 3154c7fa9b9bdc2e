//! Scores: published intervals, verdicts against truths, calibration by hand, true reductions.

use std::collections::BTreeMap;

use xtask_blind::{
    Answer, CleanChannels, Prediction, Rate, Suite, TrialScore, Truth, Verdict, judge, summarise,
    true_reductions,
};

/// Newcombe, "Two-sided confidence intervals for the single proportion", Statistics in Medicine 17,
/// 1998, Table I, method 3 (Wilson's score): printed with four decimals.
#[test]
fn wilson_intervals_are_the_published_ones() {
    for (count, of, low, high) in [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ] {
        let ci = Rate::new(count, of).ci95.expect("an interval");
        assert!(
            (ci[0] - low).abs() < 5e-5 && (ci[1] - high).abs() < 5e-5,
            "{count}/{of}: {ci:?}"
        );
    }
    assert_eq!(Rate::new(0, 0).share, None);
    assert_eq!(Rate::new(20, 20).ci95.expect("an interval")[1], 1.0);
}

fn truth(suite: Suite, name: &str) -> Truth {
    let mut trials = (0..100).map(|index| suite.draw(index, 3).expect("a trial").truth);
    trials
        .find(|truth| truth.name.starts_with(name))
        .expect("a truth of that name")
}

fn judged(truth: &Truth, json: &str) -> TrialScore {
    let answer = Answer::from_json(json).expect("an answer");
    judge(truth, &answer, &BTreeMap::new())
}

/// A named cause at a joint, with more JSON fields.
fn named(effect: &str, joint: Option<usize>, more: &str) -> String {
    let joint = joint.map_or("null".to_owned(), |joint| joint.to_string());
    format!(
        r#"{{"verdict": "named", "causes": [{{"effect": "{effect}", "joint": {joint},
            "probability": 0.9{more}}}]}}"#
    )
}

#[test]
fn a_single_effect_is_named_or_not() {
    let truth = truth(Suite::Singles, "capstan-compliance");
    let right = judged(&truth, &named("capstan-compliance", truth.joint, ""));
    assert!(right.right && right.top_right && !right.confidently_wrong);
    assert_eq!((right.joint_right, right.false_causes), (Some(true), 0));
    assert_eq!(right.probability, Some((0.9, true)));

    let elsewhere = judged(&truth, &named("capstan-compliance", Some(99), ""));
    assert!(elsewhere.right);
    assert_eq!(elsewhere.joint_right, Some(false));
    assert_eq!(elsewhere.probability, Some((0.9, false)));

    let wrong = judged(&truth, &named("cable-drift", None, ""));
    assert!(!wrong.right && wrong.confidently_wrong && wrong.detected);
    assert_eq!((wrong.joint_right, wrong.false_causes), (None, 1));

    let declared = named(
        "viscous-lag",
        truth.joint,
        r#", "confusable_with": ["capstan-compliance"]"#,
    );
    let declared = judged(&truth, &declared.replace("named", "ambiguous"));
    assert!(declared.right && !declared.top_right && !declared.confidently_wrong);
    assert_eq!((declared.class_size, declared.false_causes), (Some(2), 0));

    let declined = judged(
        &truth,
        r#"{"verdict": "unknown", "probability_unknown": 0.7}"#,
    );
    assert!(!declined.right && declined.detected && !declined.confidently_wrong);
    assert_eq!(declined.probability, Some((0.7, false)));
    let missed = judged(&truth, r#"{"verdict": "no-gap", "causes": []}"#);
    assert!(!missed.right && !missed.detected && missed.probability.is_none());
}

#[test]
fn clean_unknown_and_withheld_truths_have_their_own_right_answers() {
    let no_gap = r#"{"verdict": "no-gap"}"#;
    let unknown = r#"{"verdict": "unknown", "where": {"joint": 2, "depends_on": ["theta2_rad"]}}"#;
    let clean = truth(Suite::Clean, "clean-ar");
    assert!(judged(&clean, no_gap).right && !judged(&clean, unknown).right);
    assert!(judged(&clean, &named("cable-drift", None, "")).confidently_wrong);

    let dent = truth(Suite::Unknown, "drum-dent");
    assert!(judged(&dent, unknown).right && !judged(&dent, no_gap).right);
    assert_eq!(
        judged(&dent, unknown).joint_right,
        Some(dent.joint == Some(2))
    );
    assert!(judged(&dent, &named("hysteresis", dent.joint, "")).confidently_wrong);
    let stem = dent.depends_on[0].clone();
    for (column, is_right) in [("_rad", true), ("5_rad", false)] {
        let json = format!(
            r#"{{"verdict": "unknown", "where": {{"depends_on": ["temp_degc", "{stem}{column}"]}}}}"#
        );
        assert_eq!(judged(&dent, &json).dependence_right, Some(is_right));
    }
    let walk = truth(Suite::Unknown, "random-walk");
    assert!(
        judged(&walk, &named("joint-drift", walk.joint, "")).right,
        "a part of it"
    );

    let withheld = truth(Suite::Withheld, "backlash");
    assert_eq!(withheld.without, ["backlash", "hysteresis"]);
    assert!(judged(&withheld, unknown).right);
    assert!(judged(&withheld, &named("viscous-lag", withheld.joint, "")).confidently_wrong);

    let noisy = truth(Suite::Noise, "outliers");
    assert!(judged(&noisy, no_gap).right && judged(&noisy, &named("outliers", None, "")).right);
    assert!(!judged(&noisy, &named("cable-drift", None, "")).right);
}

#[test]
fn both_of_two_effects_must_be_found() {
    let truth = truth(Suite::Pairs, "backlash");
    let cause = |name: &str, joint: Option<usize>| {
        let joint = joint.map_or("null".to_owned(), |joint| joint.to_string());
        format!(r#"{{"effect": "{name}", "joint": {joint}}}"#)
    };
    let first = cause(&truth.effects[0].effect, truth.joints[0]);
    let second = cause(&truth.effects[1].effect, truth.joints[1]);
    let answer = |causes: &[&str]| {
        let json = format!(
            r#"{{"verdict": "named", "causes": [{}]}}"#,
            causes.join(",")
        );
        judged(&truth, &json)
    };
    let both = answer(&[&first, &second]);
    assert!(both.right && both.groups_found == 2 && both.false_causes == 0);
    let one = answer(&[&second]);
    assert!(!one.right && one.groups_found == 1 && one.top_right);
    let three = answer(&[&first, &cause("cable-sag", None), &second]);
    assert!(three.right && three.false_causes == 1);
}

#[test]
fn parameters_are_compared_where_both_have_them() {
    let truth = truth(Suite::Singles, "capstan-compliance");
    let stiffness = truth.effects[0].parameters["stiffness_nm_per_rad"];
    let with = |low: f64, high: f64| {
        let parameters = format!(
            r#", "parameters": {{"stiffness_nm_per_rad": {{"value": {}, "ci95": [{low}, {high}]}},
                "other": {{"value": 1.0}}}}"#,
            0.5 * (low + high)
        );
        judged(
            &truth,
            &named("capstan-compliance", truth.joint, &parameters),
        )
        .coverage
    };
    let inside = with(0.9 * stiffness, 1.1 * stiffness);
    assert!(inside.len() == 1 && inside[0].covered);
    assert!(!with(1.1 * stiffness, 1.2 * stiffness)[0].covered);
}

/// Two answers at 0.9, one right; two unknowns at 0.6, both right: |1.8 - 1| + |1.2 - 2| over 4.
#[test]
fn calibration_by_hand() {
    let single = truth(Suite::Singles, "capstan-compliance");
    let dent = truth(Suite::Unknown, "drum-dent");
    let unknown = r#"{"verdict": "unknown", "probability_unknown": 0.6}"#;
    let scores = [
        judged(&single, &named("capstan-compliance", single.joint, "")),
        judged(&single, &named("cable-drift", None, "")),
        judged(&dent, unknown),
        judged(&dent, unknown),
    ];
    let summary = summarise("mixed", &scores);
    let error = summary.calibration.expected_error.expect("an error");
    assert!((error - 0.4).abs() < 1e-12, "{error}");
    assert_eq!(
        (
            summary.right_of_detected.count,
            summary.right_of_detected.of
        ),
        (3, 4)
    );
    assert_eq!(
        (summary.right_of_named.count, summary.right_of_named.of),
        (1, 2)
    );
    assert_eq!(summary.confusion["capstan-compliance"]["cable-drift"], 1);
    assert_eq!(summary.confusion[&dent.name]["unknown"], 2);
    assert!(serde_json::to_string(&summary).is_ok());
    assert_eq!(scores[2].verdict, Verdict::Unknown);
}

#[test]
fn true_reductions_compare_with_channels_without_noise() {
    let clean = CleanChannels {
        output_rad: vec![None, Some(vec![1.0, 2.0, 3.0])],
        cable_m: vec![Some(vec![0.5, 0.6, 0.7])],
        rounding: BTreeMap::new(),
    };
    let off = |truth: f64, row, before: f64, after: f64| Prediction {
        row,
        before: truth + before,
        after: truth + after,
    };
    let predictions = BTreeMap::from([
        (
            "out2".to_owned(),
            vec![off(1.0, 0, 0.2, 0.1), off(3.0, 2, -0.2, 0.1)],
        ),
        (
            "cable".to_owned(),
            vec![off(0.6, 1, 0.0, 0.1), off(0.0, 7, 1.0, 1.0)],
        ),
        ("out1".to_owned(), vec![off(1.0, 0, 0.2, 0.1)]),
    ]);
    let reductions = true_reductions(&predictions, &clean);
    assert_eq!(reductions.len(), 2, "out1 has no truth");
    let out2 = reductions["out2"];
    assert!((out2.percent.expect("a reduction") - 50.0).abs() < 1e-9);
    assert!(
        reductions["cable"]
            .percent
            .is_none_or(|percent| percent < -1e6),
        "made a gap"
    );
    // before: 0.2^2 - 0.06^2 = 0.0364; after: 0.1^2 - 0.06^2 = 0.0064; beyond the rounding nothing is left
    let rounded = |rounding: f64| {
        let rounding = BTreeMap::from([("out2".to_owned(), rounding)]);
        let clean = CleanChannels {
            rounding,
            ..clean.clone()
        };
        true_reductions(&predictions, &clean)["out2"].percent
    };
    let percent = rounded(0.06).expect("a reduction");
    assert!((percent - 100.0 * (1.0 - (0.0064_f64 / 0.0364).sqrt())).abs() < 1e-9);
    assert!((rounded(0.15).expect("a reduction") - 100.0).abs() < 1e-9);
    assert_eq!(rounded(0.3), None);
}

/// The true device predicts a clean recording up to the rounding of its motor-side readings.
#[test]
fn rounding_is_all_that_the_true_device_leaves() {
    let trial = Suite::Clean.draw(0, 3).expect("a trial");
    for (channel, rounding) in &trial.clean2.rounding {
        let Some(gap) = trial.truth.gap.get(channel) else {
            continue;
        };
        // two recordings of one device: the shares of a count differ by a few percent
        let ratio = rounding / gap.rms;
        assert!((0.8..1.25).contains(&ratio), "{channel}: {ratio}");
    }
}

#[test]
fn stated_reductions_are_checked_against_true_ones() {
    let truth = truth(Suite::Singles, "capstan-compliance");
    let held_out = r#", "held_out": {"channel": "out2", "reduction_percent": 95.0, "reduction_ci95": [90.0, 97.0]}"#;
    let answer =
        Answer::from_json(&named("capstan-compliance", truth.joint, held_out)).expect("JSON");
    let with = |percent: f64| {
        let reduction = xtask_blind::TrueReduction {
            rms_before: 1.0,
            rms_after: 0.1,
            rounding: 0.0,
            percent: Some(percent),
        };
        let reductions = BTreeMap::from([("out2".to_owned(), reduction)]);
        judge(&truth, &answer, &reductions)
            .shrink
            .expect("a comparison")
            .covered
    };
    assert_eq!((with(96.0), with(89.0)), (Some(true), Some(false)));
}
