//! Logs of an arm whose device file `identify --with dynamics` wrote: its friction accounts for no torques but its own.

use super::log::{Arm, Log, Noise};
use super::{Trial, told};
use crate::{haptical, text};

/// A folder with identified.toml of the sound arm.
fn identified() -> Trial {
    let trial = Trial::new(Arm::default());
    let output = haptical()
        .args(["identify", "--with", "dynamics", "--device"])
        .arg(trial.path("arm.urdf"))
        .arg("--log")
        .arg(trial.path("log.csv"))
        .arg("--out")
        .arg(trial.path("model"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let written = std::fs::read_to_string(trial.path("model/identified.toml")).unwrap();
    assert!(written.contains("joint-friction"), "{written}");
    trial
}

/// Verdict of a log, or the refusal's exit status.
fn judged(trial: &Trial, log: &Log) -> String {
    trial.write("other.csv", log);
    let output = trial.diagnose("model/identified.toml", "other.csv", &[]);
    match output.status.code() {
        Some(0) => told(&serde_json::from_slice(&output.stdout).unwrap()).0,
        status => format!("{status:?}"),
    }
}

#[test]
fn torques_that_have_nothing_to_do_with_the_motion_are_a_gap() {
    let trial = identified();
    let sound = Log::of(Arm::default(), 1);
    assert_eq!(judged(&trial, &sound), "no-gap");
    let spoilt = |spoil: &dyn Fn(&mut Vec<f64>)| {
        let mut log = sound.clone();
        log.torque_nm.iter_mut().for_each(spoil);
        log
    };
    let noise = |own: &mut Vec<f64>| {
        let mut noise = Noise(7);
        own.iter_mut()
            .for_each(|value| *value = 4.0 * noise.normal());
    };
    let mut swapped = sound.clone();
    swapped.torque_nm.swap(0, 1);
    let kinds = [
        ("backwards", spoilt(&|own| own.reverse())),
        ("of another time", spoilt(&|own| own.rotate_left(1300))),
        (
            "in newton millimetres",
            spoilt(&|own| own.iter_mut().for_each(|value| *value *= 1000.0)),
        ),
        ("noise", spoilt(&noise)),
        ("of other joints", swapped),
    ];
    for (kind, log) in kinds {
        let verdict = judged(&trial, &log);
        // of noise a refusal says as much
        let is_refused = kind == "noise" && verdict == "Some(3)";
        assert!(is_refused || verdict == "unknown", "{kind}: {verdict}");
    }
    // nothing was measured
    let zero = spoilt(&|own| own.fill(0.0));
    assert_eq!(judged(&trial, &zero), "Some(3)");
}

#[test]
fn a_load_on_an_identified_arm_is_a_gap() {
    let trial = identified();
    for payload_kg in [0.25, 0.5, 1.0] {
        let loaded = Arm {
            payload_kg,
            ..Arm::default()
        };
        let verdict = judged(&trial, &Log::of(loaded, 1));
        assert!(
            ["named", "ambiguous", "unknown"].contains(&verdict.as_str()),
            "{payload_kg}: {verdict}"
        );
    }
}
