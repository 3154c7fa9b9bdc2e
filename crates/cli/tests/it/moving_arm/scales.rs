//! Readings that are off as a whole: a joint's zero, the unit of all torques, messages that were lost.

use serde_json::Value;

use super::log::{Arm, Log};
use super::{Trial, told};

fn number(answer: &Value, name: &str) -> f64 {
    answer["causes"][0]["parameters"][name]["value"]
        .as_f64()
        .unwrap()
}

#[test]
fn a_joints_zero_is_named_and_the_corrected_file_has_it() {
    let moved = |log: &mut Log| {
        log.theta_rad[1]
            .iter_mut()
            .for_each(|reading| *reading += 0.06);
    };
    let trial = Trial::with(moved);
    let answer = trial.answer("arm.urdf", "log.csv", &[]);
    let (verdict, causes) = told(&answer);
    assert_eq!(
        (verdict.as_str(), &causes[..]),
        ("named", &["joint-offset".to_owned()][..])
    );
    assert_eq!(answer["causes"][0]["joint"], 2);
    // the links stand behind what is read
    let offset_rad = number(&answer, "offset_rad");
    assert!((offset_rad + 0.06).abs() < 0.01, "{offset_rad}");
    let corrected = trial.path("kept.toml");
    std::fs::copy(trial.path("out").join("corrected.toml"), &corrected).unwrap();
    let mut second = Log::of(Arm::default(), 2);
    moved(&mut second);
    trial.write("log2.csv", &second);
    let model = ["--model", corrected.to_str().unwrap()];
    let again = trial.answer("arm.urdf", "log2.csv", &model);
    assert_eq!(told(&again).0, "no-gap", "{}", again["answer"]);
}

#[test]
fn a_factor_on_all_torques_is_among_what_is_named() {
    for factor in [0.7, 1.5, 3.0] {
        let trial = Trial::with(|log| {
            let columns = log.torque_nm.iter_mut();
            columns.for_each(|column| column.iter_mut().for_each(|reading| *reading *= factor));
        });
        let answer = trial.answer("arm.urdf", "log.csv", &[]);
        let (verdict, causes) = told(&answer);
        assert!(
            ["named", "ambiguous"].contains(&verdict.as_str()),
            "{factor}: {}",
            answer["answer"]
        );
        let rivals = answer["causes"][0]["confusable_with"].as_array().unwrap();
        let is_rival = rivals.iter().any(|reading| reading == "torque-gain");
        assert!(
            causes[0] == "torque-gain" || is_rival,
            "{factor}: {}",
            answer["answer"]
        );
        if causes[0] == "torque-gain" {
            assert!(
                (number(&answer, "factor") / factor - 1.0).abs() < 0.15,
                "{factor}"
            );
        }
    }
}

#[test]
fn lost_messages_are_named_and_what_is_left_is_judged() {
    let lose = |log: &mut Log| {
        for row in (50..log.torque_nm[0].len() - 1).step_by(29) {
            log.torque_nm[0][row] = 0.0;
            log.torque_nm[0][row + 1] = 0.0;
        }
    };
    let sound = Trial::with(lose).answer("arm.urdf", "log.csv", &[]);
    let (verdict, causes) = told(&sound);
    assert_eq!(
        (verdict.as_str(), &causes[..]),
        ("named", &["dropouts".to_owned()][..])
    );
    let share = number(&sound, "share");
    assert!((0.05..0.08).contains(&share), "{share}");

    // a load is found next to them
    let loaded = Arm {
        payload_kg: 1.2,
        ..Arm::default()
    };
    let trial = Trial::new(loaded);
    let mut log = Log::of(loaded, 1);
    lose(&mut log);
    trial.write("log.csv", &log);
    let (verdict, causes) = told(&trial.answer("arm.urdf", "log.csv", &[]));
    assert_eq!(verdict, "named");
    assert_eq!(causes, ["payload", "dropouts"]);
}
