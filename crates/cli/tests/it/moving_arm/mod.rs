//! Logs of a moving arm's positions and torques: what the command says of a sound one and of bad ones, and what it exports.

mod bad;
mod commands;
mod exported;
mod identified;
mod log;
mod scales;
mod second;
mod simulator;

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use self::log::{Arm, Log};
use crate::{haptical, text};

/// A folder with an arm's description and a log of it.
struct Trial {
    folder: tempfile::TempDir,
}

impl Trial {
    fn new(arm: Arm) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("arm.urdf"), log::URDF).unwrap();
        std::fs::write(folder.path().join("arm.xml"), log::MJCF).unwrap();
        let trial = Self { folder };
        trial.write("log.csv", &Log::of(arm, 1));
        trial
    }

    /// The sound arm, whose log is spoilt.
    fn with(spoil: impl Fn(&mut Log)) -> Self {
        let trial = Self::new(Arm::default());
        let mut log = Log::of(Arm::default(), 1);
        spoil(&mut log);
        trial.write("log.csv", &log);
        trial
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, log: &Log) {
        std::fs::write(self.path(name), log.text()).unwrap();
    }

    fn diagnose(&self, device: &str, log: &str, further: &[&str]) -> Output {
        haptical()
            .args(["diagnose", "--json", "--device"])
            .arg(self.path(device))
            .arg("--log")
            .arg(self.path(log))
            .arg("--out")
            .arg(self.path("out"))
            .args(further)
            .output()
            .unwrap()
    }

    /// The answer; the command must succeed.
    fn answer(&self, device: &str, log: &str, further: &[&str]) -> Value {
        let output = self.diagnose(device, log, further);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    fn check(&self, device: &Path) -> String {
        let output = haptical()
            .arg("check")
            .arg(device)
            .arg(self.path("log.csv"))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    }
}

/// Verdict and causes of an answer.
fn told(answer: &Value) -> (String, Vec<String>) {
    let causes = answer["causes"].as_array().unwrap().iter();
    (
        answer["verdict"].as_str().unwrap().to_owned(),
        causes
            .map(|own| own["effect"].as_str().unwrap().to_owned())
            .collect(),
    )
}

/// Whether a warning has all these words.
fn warns(answer: &Value, words: &[&str]) -> bool {
    let mut warnings = answer["warnings"].as_array().unwrap().iter();
    warnings.any(|own| {
        words
            .iter()
            .all(|word| own.as_str().unwrap().contains(word))
    })
}

#[test]
fn a_sound_arm_has_no_gap_and_a_check_says_what_the_log_is_good_for() {
    let trial = Trial::new(Arm::default());
    assert_eq!(told(&trial.answer("arm.urdf", "log.csv", &[])).0, "no-gap");
    let said = trial.check(&trial.path("arm.urdf"));
    for words in [
        "the equations of motion can be used",
        "200.0 rows a second",
        "the torques of joints 1, 2",
        "Every joint moves.",
        "no armature_kgm2 of joints 1, 2",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // the MJCF states them
    let said = trial.check(&trial.path("arm.xml"));
    assert!(!said.contains("armature_kgm2"), "{said}");
}
