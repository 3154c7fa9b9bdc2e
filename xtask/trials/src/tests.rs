//! Parts of the blind check, each against something worked out by hand.

mod admission;
mod arguments;
mod end_to_end;
mod moving;
mod scores;
mod seeds;

use std::collections::BTreeMap;
use std::sync::Mutex;

use xtask_blind::{Answer, Suite, Truth, judge, seal};

use super::batch::Case;

/// The truth of a trial, which is drawn once: a moving arm takes its time.
fn drawn(suite: Suite, index: u64) -> Truth {
    static DRAWN: Mutex<BTreeMap<(&str, u64), Truth>> = Mutex::new(BTreeMap::new());
    let mut drawn = DRAWN.lock().unwrap();
    let truth = drawn
        .entry((suite.name(), index))
        .or_insert_with(|| suite.draw(index, 3).unwrap().truth);
    truth.clone()
}

/// A trial that was answered with this gap.json; an error where it is none.
fn case(suite: Suite, index: u64, gap_json: &str) -> Case {
    let truth = drawn(suite, index);
    let sealed = seal(&truth, &mut xtask_blind::Random::new(1, 1)).unwrap();
    let answer = Answer::from_json(gap_json);
    let score = answer
        .as_ref()
        .ok()
        .map(|answer| judge(&truth, answer, &BTreeMap::new()));
    Case {
        suite: suite.name(),
        index,
        rerun: String::new(),
        commitment: sealed.commitment,
        salt: sealed.salt,
        truth_json: sealed.truth_json,
        answer_sha256: None,
        error: answer.as_ref().err().map(ToString::to_string),
        refusal: None,
        answer: answer.ok(),
        score,
        closing: None,
        fit: None,
        truth,
        rows: 6000,
        time_s: 0.5,
    }
}

const NO_GAP: &str = r#"{"verdict": "no-gap"}"#;
const UNKNOWN: &str = r#"{"verdict": "unknown", "probability_unknown": 0.8}"#;

/// One cause, given as `verdict`.
fn cause(verdict: &str, effect: &str, joint: Option<usize>) -> String {
    let joint = joint.map_or("null".to_owned(), |joint| joint.to_string());
    format!(
        r#"{{"verdict": "{verdict}", "causes": [{{"effect": "{effect}", "joint": {joint}, "probability": 0.9}}]}}"#
    )
}

/// A strong single effect that is answered rightly.
fn right_single(index: u64) -> Case {
    let truth = Suite::Singles.draw(index, 3).unwrap().truth;
    let gap_json = cause("named", &truth.right[0][0], truth.joint);
    case(Suite::Singles, index, &gap_json)
}
