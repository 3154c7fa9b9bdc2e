//! Answers that a truth allows besides its names, or forbids whatever they name.

use std::collections::BTreeMap;

use xtask_blind::{Answer, Besides, Said, Suite, Truth, judge, judge_refusal};

/// A truth with one right name, and what is right besides.
fn truth(besides: Besides) -> Truth {
    let mut truth = Suite::Singles.draw(0, 3).expect("a trial").truth;
    truth.right = vec![vec!["torque-gain".to_owned()]];
    truth.joint = None;
    truth.joints = vec![None];
    truth.besides = besides;
    truth
}

fn right(truth: &Truth, json: &str) -> bool {
    let answer = Answer::from_json(json).expect("an answer");
    judge(truth, &answer, &BTreeMap::new()).right
}

fn refusing(words: &[&str]) -> Besides {
    Besides {
        refusals: words.iter().map(|word| (*word).to_owned()).collect(),
        ..Besides::default()
    }
}

const UNKNOWN: &str = r#"{"verdict": "unknown"}"#;
const NO_GAP: &str = r#"{"verdict": "no-gap"}"#;

fn refused(question: &str, answer: &str, why: &str) -> String {
    format!(
        r#"{{"verdict": "unknown", "admission": {{"{question}": {{"answer": "{answer}", "why": "{why}"}}}}}}"#
    )
}

#[test]
fn nothing_is_allowed_that_is_not_said() {
    let truth = truth(Besides::default());
    assert!(!right(&truth, UNKNOWN) && !right(&truth, NO_GAP));
    assert!(!right(&truth, &refused("belongs", "no", "another unit")));
    assert!(judge_refusal(&truth, "the torques are in another unit").is_none());
    let text = serde_json::to_string(&truth).expect("JSON");
    assert!(!text.contains("besides"), "seals of other suites stay");
}

/// A refusal counts with its words alone: as an error, or as a question that is answered with no.
#[test]
fn a_refusal_must_say_why() {
    let truth = truth(refusing(&["another unit"]));
    let score = judge_refusal(&truth, "the torques are in another unit").expect("a score");
    assert!(score.right && score.detected && !score.confidently_wrong);
    assert_eq!(
        (score.answered.as_str(), score.probability),
        ("refusal", None)
    );
    assert!(judge_refusal(&truth, "the file cannot be read").is_none());
    assert!(judge_refusal(&truth, "panic: another unit").is_none());
    assert!(right(&truth, &refused("belongs", "no", "in another unit")));
    assert!(!right(
        &truth,
        &refused("belongs", "yes", "in another unit")
    ));
    assert!(!right(&truth, &refused("belongs", "no", "another joint")));
    assert!(!right(&truth, UNKNOWN) && !right(&truth, NO_GAP));
    // the name of the question is a word, too
    let by_question = self::truth(refusing(&["credible_base"]));
    assert!(right(
        &by_question,
        &refused("credible_base", "no", "it drives")
    ));
    assert!(!right(&by_question, &refused("belongs", "no", "it drives")));
}

#[test]
fn unknown_may_be_as_right_as_a_name() {
    let truth = truth(Besides {
        unknown: true,
        ..Besides::default()
    });
    assert!(right(&truth, UNKNOWN) && !right(&truth, NO_GAP));
    let wrong = r#"{"verdict": "named", "causes": [{"effect": "payload", "joint": null}]}"#;
    assert!(!right(&truth, wrong));
}

/// `no-gap` counts where the answer says what was left out, or which body was adjusted.
#[test]
fn no_gap_may_need_words() {
    let with = |said: Said| {
        truth(Besides {
            no_gap_with: Some(said),
            ..Besides::default()
        })
    };
    let (dropouts, bodies) = (with(Said::Dropouts), with(Said::Bodies));
    let warned = r#"{"verdict": "no-gap", "warnings": ["9 of 90 readings of torque1 read 0: they count for nothing"]}"#;
    assert!(right(&dropouts, warned) && !right(&bodies, warned));
    let odd =
        r#"{"verdict": "no-gap", "warnings": ["3 of 90 rows are not predicted and left out"]}"#;
    assert!(!right(&dropouts, odd) && !right(&dropouts, NO_GAP));
    let adjusted = |name: &str| {
        format!(
            r#"{{"verdict": "no-gap", "adjusted": [{{"name": "friction"}}, {{"name": "{name}"}}]}}"#
        )
    };
    assert!(right(&bodies, &adjusted("mass")) && !right(&bodies, &adjusted("armature")));
}

#[test]
fn a_factor_of_the_whole_arm_is_no_joint_s() {
    let at = |joint: &str| {
        format!(
            r#"{{"verdict": "named", "causes": [{{"effect": "torque-gain", "joint": {joint}}}]}}"#
        )
    };
    let whole = truth(Besides {
        is_of_whole: true,
        ..Besides::default()
    });
    assert!(right(&whole, &at("null")) && !right(&whole, &at("2")));
    assert!(right(&truth(Besides::default()), &at("2")));
}

/// Of another arm's recording no answer may say that the gap closes there.
#[test]
fn a_foreign_second_recording_has_a_gap() {
    let truth = truth(Besides {
        second_is_foreign: true,
        ..Besides::default()
    });
    let named = r#""verdict": "named", "causes": [{"effect": "torque-gain", "joint": null}]"#;
    let with = |gaps: &[bool]| {
        let channels = gaps
            .iter()
            .map(|gap| format!(r#"{{"channel": "torque1", "has_gap": {gap}}}"#));
        let channels: Vec<String> = channels.collect();
        format!(
            r#"{{{named}, "second_recording": {{"channels": [{}]}}}}"#,
            channels.join(", ")
        )
    };
    assert!(right(&truth, &with(&[false, true])));
    assert!(!right(&truth, &with(&[false, false])));
    assert!(right(&truth, &with(&[])), "nothing is said of it");
    assert!(right(&truth, &format!("{{{named}}}")));
}
