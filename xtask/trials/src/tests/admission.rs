//! Figures of moving arms with faults from answers written by hand.

use xtask_blind::{Suite, judge_refusal};

use super::{NO_GAP, UNKNOWN, case, cause};
use crate::batch::Case;
use crate::measure::Value;
use crate::quick::assert_sound;
use crate::report::bars::measures;
use crate::report::moving::table;
use crate::report::wrong::{Fault, fault};

/// Places in the order of the suite.
const PARTIAL: u64 = 0;
const SCALE: u64 = 2;
const SHORT: u64 = 5;
const SECOND: u64 = 13;

fn answered(index: u64, answer: &str) -> Case {
    case(Suite::MovingAdmission, index, answer)
}

/// A trial that ended with an error, as a batch opens it.
fn refused(index: u64, error: &str) -> Case {
    let mut case = answered(index, "no JSON");
    case.score = judge_refusal(&case.truth, error);
    case.error = case.score.is_none().then(|| error.to_owned());
    case.refusal = case.score.is_some().then(|| error.to_owned());
    case
}

#[test]
fn each_fault_is_counted_by_itself() {
    let cases = [
        answered(PARTIAL, &cause("named", "payload", None)),
        answered(PARTIAL, UNKNOWN),
        answered(PARTIAL, &cause("named", "contact", None)),
        answered(SCALE, &cause("named", "torque-gain", None)),
        answered(SCALE, &cause("named", "torque-gain", Some(2))),
        refused(SHORT, "1.5 s of motion are too little"),
        answered(SHORT, NO_GAP),
        refused(SHORT, "the disk is full"),
        answered(SECOND, UNKNOWN),
    ];
    let all = measures(&cases);
    let of = |name: &str| {
        let own = all
            .iter()
            .find(|one| one.group == "moving arms with faults" && one.name == name);
        let own = own.unwrap_or_else(|| panic!("no figure `{name}`"));
        assert!(own.bar.is_none(), "{name}");
        match &own.value {
            Value::Share(rate) => (rate.count, rate.of),
            Value::Number(number) => (0, number.of),
        }
    };
    for (name, count, among) in [
        ("right, of all", 4, 8),
        ("right, of detected", 4, 7),
        ("confidently wrong, of detected", 2, 7),
        ("right, friction of its own beside an effect", 1, 3),
        (
            "confidently wrong, friction of its own beside an effect",
            1,
            3,
        ),
        ("right, one factor on all torques", 1, 2),
        ("right, too short a log", 1, 2),
        ("right of detected, too short a log", 1, 1),
        ("right, another arm in the second recording", 1, 1),
        ("right, another arm", 0, 0),
    ] {
        assert_eq!(of(name), (count, among), "{name}");
    }
    assert_eq!(fault(&cases[5]), None);
    assert_eq!(fault(&cases[7]), Some(Fault::NoAnswer));
    assert!(table(&cases).unwrap().is_some());
}

/// A refusal that is right is an answer; another error is none.
#[test]
fn a_right_refusal_fails_no_batch() {
    let share = |case: Case| {
        let sound = assert_sound(std::slice::from_ref(&case), true).is_ok();
        let all = measures(&[case]);
        let answers = all
            .iter()
            .find(|one| one.name == "the diagnosis answers")
            .unwrap();
        (sound, answers.value.value())
    };
    assert_eq!(share(refused(SHORT, "rows are too few")), (true, Some(1.0)));
    assert_eq!(
        share(refused(SHORT, "the disk is full")),
        (false, Some(0.0))
    );
}
