//! Logs with commands beside positions and torques.

use super::log::{Arm, Log};
use super::{Trial, told, warns};

/// Why an effect could not be tested.
fn untestable(answer: &serde_json::Value, effect: &str) -> Option<String> {
    let mut all = answer["untestable"].as_array().unwrap().iter();
    let own = all.find(|own| own["effect"] == effect)?;
    Some(own["why"].as_str().unwrap().to_owned())
}

#[test]
fn commands_that_are_heard_late_are_named_with_their_delay() {
    let trial = Trial::new(Arm::default());
    trial.write("late.csv", &Log::commanded(Arm::default(), 1, 0.01));
    let answer = trial.answer("arm.xml", "late.csv", &[]);
    assert_eq!(
        told(&answer),
        ("named".to_owned(), vec!["command-latency".to_owned()])
    );
    let delay = &answer["causes"][0]["parameters"]["delay_s"];
    let value = delay["value"].as_f64().unwrap();
    assert!((value - 0.01).abs() < 3e-4, "{value}");
    let region = answer["where"]["region"].as_str().unwrap();
    assert!(
        region.starts_with("between the command and the torque"),
        "{region}"
    );
    assert!(warns(&answer, &["delay the commands by hand"]), "{answer}");

    let withheld = trial.answer(
        "arm.xml",
        "late.csv",
        &["--without", "command-latency", "--force"],
    );
    assert_eq!(told(&withheld), ("unknown".to_owned(), Vec::new()));
}

#[test]
fn commands_that_are_heard_in_time_are_no_gap_and_none_are_not_tested() {
    let trial = Trial::new(Arm::default());
    trial.write("sound.csv", &Log::commanded(Arm::default(), 1, 0.0));
    let answer = trial.answer("arm.xml", "sound.csv", &[]);
    assert_eq!(told(&answer).0, "no-gap");
    assert_eq!(untestable(&answer, "command-latency"), None);

    let answer = trial.answer("arm.xml", "log.csv", &["--force"]);
    let why = untestable(&answer, "command-latency").unwrap();
    assert!(why.contains("command1_rad"), "{why}");
}
