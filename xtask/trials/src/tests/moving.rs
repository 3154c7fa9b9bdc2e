//! Figures of moving arms from answers written by hand.

use xtask_blind::Suite;

use super::{NO_GAP, UNKNOWN, case, cause};
use crate::batch::Case;
use crate::measure::{Measure, Value};
use crate::report::bars::measures;
use crate::report::moving::{is_weak, table};
use crate::report::wrong::{Fault, fault};

/// Places in the order of the suite.
const STRONG: u64 = 0;
const CLEAN: u64 = 1;
const FOREIGN: u64 = 3;
const WEAK: u64 = 6;
const WITHHELD: u64 = 8;
const PAIR: u64 = 11;
const SLOPPY: u64 = 19;
const MODE: u64 = 33;

fn of(all: &[Measure], name: &str) -> (u64, u64) {
    let found = all
        .iter()
        .find(|one| one.group == "moving arms" && one.name == name);
    match &found.unwrap_or_else(|| panic!("no figure `{name}`")).value {
        Value::Share(rate) => (rate.count, rate.of),
        Value::Number(number) => (0, number.of),
    }
}

fn answered(index: u64, answer: &str) -> Case {
    case(Suite::Moving, index, answer)
}

#[test]
fn each_stratum_is_counted_by_itself() {
    let payload = cause("named", "payload", None);
    let cases = [
        answered(STRONG, &payload),
        answered(STRONG, &cause("named", "contact", None)),
        answered(STRONG, NO_GAP),
        answered(CLEAN, NO_GAP),
        answered(CLEAN, &payload),
        answered(FOREIGN, UNKNOWN),
        answered(FOREIGN, &cause("named", "stribeck-friction", Some(1))),
        answered(WEAK, NO_GAP),
        answered(WEAK, UNKNOWN),
        answered(WITHHELD, UNKNOWN),
        answered(PAIR, &payload),
        answered(SLOPPY, UNKNOWN),
        answered(SLOPPY, NO_GAP),
        case(Suite::MovingMemory, 0, UNKNOWN),
    ];
    let all = measures(&cases);
    for (name, count, among) in [
        ("clean: any verdict but no-gap", 1, 2),
        ("clean: named", 1, 2),
        ("noise with a memory: named", 0, 1),
        ("noise with a memory: any verdict but no-gap", 1, 1),
        ("strong: detected", 2, 3),
        ("strong: right, of detected", 1, 2),
        ("strong: confidently wrong, of detected", 1, 2),
        ("weak: detected", 1, 2),
        ("weak: right, of detected", 0, 1),
        ("withheld: unknown or a twin class, of detected", 1, 1),
        ("in no catalogue: unknown, of detected", 1, 2),
        ("no name is right: unknown, of detected", 2, 3),
        ("no name is right: confidently wrong, of detected", 1, 3),
        ("two effects: both found", 0, 1),
        ("torques of something else: unknown", 1, 2),
        ("time of a diagnosis, median", 0, 14),
    ] {
        assert_eq!(of(&all, name), (count, among), "{name}");
    }
    let table = table(&cases).unwrap().unwrap();
    assert_eq!(table.rows().len(), 8, "labels, two of them clean");
    assert!(table_of(&[case(Suite::Clean, 0, NO_GAP)]));
    assert_eq!(fault(&cases[7]), Some(Fault::Missed));
    assert!(is_weak(&cases[7]) && !is_weak(&cases[0]));
}

fn table_of(cases: &[Case]) -> bool {
    table(cases).unwrap().is_none()
}

/// What a controller does of its own accord may stay unseen, and may not be named.
#[test]
fn a_mode_that_changes_may_stay_unseen() {
    let right = |answer: &str| answered(MODE, answer).score.unwrap().right;
    assert!(right(NO_GAP) && right(UNKNOWN));
    assert!(!right(&cause("named", "command-latency", None)));
    let dent = answered(FOREIGN, NO_GAP).score.unwrap();
    assert!(!dent.right);
}

/// The stated reduction counts where the first name is right.
#[test]
fn the_stated_gap_counts_with_the_right_name() {
    let held = r#""held_out": {"channel": "torque2", "reduction_percent": 80.0}"#;
    let with = |name: &str| {
        format!(
            r#"{{"verdict": "named", "causes": [{{"effect": "{name}", "joint": null, {held}}}]}}"#
        )
    };
    let cases = [
        answered(STRONG, &with("payload")),
        answered(STRONG, &with("contact")),
    ];
    let all = measures(&cases);
    let found = all
        .iter()
        .find(|one| one.name == "strong, name right: gap stated as closed, median");
    let value = &found.unwrap().value;
    assert_eq!(
        (
            value.value(),
            of(&all, "strong, name right: gap stated as closed, median").1
        ),
        (Some(80.0), 1)
    );
}
