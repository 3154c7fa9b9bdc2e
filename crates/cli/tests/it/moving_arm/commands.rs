//! Logs with commands beside positions and torques.

use super::log::{Arm, Log};
use super::{Trial, told, warns};
use crate::{haptical, text};

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

/// What is printed runs where the command was started, wherever the files lie, whatever they are called.
#[test]
fn printed_commands_have_the_places_of_the_files() {
    let trial = Trial::new(Arm {
        payload_kg: 1.2,
        ..Arm::default()
    });
    let device = trial.path("the arm.urdf");
    std::fs::rename(trial.path("arm.urdf"), &device).unwrap();
    let output = haptical()
        .arg("diagnose")
        .args(["--device".as_ref(), device.as_os_str()])
        .args(["--log".as_ref(), trial.path("log.csv").as_os_str()])
        .args(["--out".as_ref(), trial.path("out").as_os_str()])
        .output()
        .unwrap();
    let said = text(&output.stdout);
    let check = format!(
        "haptical diagnose --device '{}' --model {} --log NEW_LOG",
        device.display(),
        trial.path("out/corrected.toml").display()
    );
    assert!(said.contains(&check), "{said}");
}
