//! A second recording of a moving arm is judged beside the log: that of another arm, or with a payload, is no recording of this one.

use super::log::{Arm, Log};
use super::{Trial, told, warns};

/// The answer on a sound log with this second recording.
fn beside(second: &Log, device: &str) -> serde_json::Value {
    let trial = Trial::new(Arm::default());
    trial.write("second.csv", second);
    let second = trial.path("second.csv");
    trial.answer(device, "log.csv", &["--validate", second.to_str().unwrap()])
}

fn channels_with_gap(answer: &serde_json::Value) -> usize {
    let channels = answer["second_recording"]["channels"].as_array().unwrap();
    channels.iter().filter(|own| own["has_gap"] == true).count()
}

#[test]
fn a_second_recording_of_the_same_arm_has_no_gap() {
    for (seed, device) in [(2, "arm.urdf"), (3, "arm.xml"), (4, "arm.urdf")] {
        let answer = beside(&Log::of(Arm::default(), seed), device);
        assert_eq!(told(&answer).0, "no-gap", "{seed}: {answer}");
        assert_eq!(channels_with_gap(&answer), 0);
    }
}

#[test]
fn a_second_recording_that_the_first_does_not_predict_is_a_gap() {
    let with = |arm: Arm| Log::of(arm, 2);
    let payload = Arm {
        payload_kg: 0.6,
        ..Arm::default()
    };
    let tilted = Arm {
        tilt_rad: 0.1,
        ..Arm::default()
    };
    let mut swapped = with(Arm::default());
    swapped.torque_nm.swap(0, 1);
    for second in [with(payload), with(tilted), swapped] {
        let answer = beside(&second, "arm.urdf");
        let (verdict, causes) = told(&answer);
        assert_eq!((verdict.as_str(), causes.len()), ("unknown", 0), "{answer}");
        assert!(channels_with_gap(&answer) > 0, "{answer}");
        let words = ["does not hold for the second recording", "N m left, noise"];
        assert!(warns(&answer, &words), "{answer}");
        // verdict, sentence and table agree
        let said = answer["answer"].as_str().unwrap();
        assert!(said.contains("The log has no gap, but"), "{said}");
        let table = answer["gap"]["channels"].as_array().unwrap();
        let gap = table.iter().find(|own| own["has_gap"] == true).unwrap();
        let number = |name: &str| gap[name].as_f64().unwrap();
        assert!(number("rms_before") > 1.2 * number("noise_floor"), "{gap}");
    }
}

#[test]
fn a_second_recording_that_cannot_be_predicted_is_said_not_to_be_judged() {
    let mut silent = Log::of(Arm::default(), 2);
    silent.torque_nm[1].fill(0.0);
    let mut short = Log::of(Arm::default(), 2);
    short.time_s.truncate(20);
    for second in [silent, short] {
        let answer = beside(&second, "arm.urdf");
        assert!(warns(&answer, &["second recording", "not"]), "{answer}");
        let said = answer["answer"].as_str().unwrap();
        let is_unjudged = said.contains("The second recording was not judged");
        assert!(is_unjudged || told(&answer).0 != "no-gap", "{said}");
    }
}
