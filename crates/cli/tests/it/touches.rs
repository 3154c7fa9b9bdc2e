//! `haptical diagnose` on touches of real arms, where the data are there; otherwise the tests say that they skip.

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::{haptical, text};

/// The measured arms, or a printed line.
fn mukca() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/measured/mukca");
    if path.exists() {
        return Some(path);
    }
    println!("skipped: no {}", path.display());
    None
}

/// A folder with the logs of an arm, and its description.
struct Arm {
    folder: tempfile::TempDir,
    urdf: PathBuf,
}

impl Arm {
    fn new(urdf: &str) -> Option<Self> {
        Some(Self {
            folder: tempfile::tempdir().unwrap(),
            urdf: mukca()?.join("urdf_nominal").join(urdf),
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes `NAME.csv` and `NAME.rig.toml`.
    fn import(&self, robot: &Path, name: &str, joints: &str) {
        let out = self.path(&format!("{name}.csv"));
        let mut command = haptical();
        command.args(["import", "mukca", "--joints", joints]);
        let output = command.arg(robot).arg("--out").arg(out).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
    }

    fn run(&self, command: &str, log: &str, further: &[&str]) -> Output {
        haptical()
            .args([command, "--json", "--tip", "ball_link", "--device"])
            .arg(&self.urdf)
            .arg("--rig")
            .arg(self.path(&format!("{log}.rig.toml")))
            .arg("--log")
            .arg(self.path(&format!("{log}.csv")))
            .arg("--out")
            .arg(self.path(&format!("{command}-{log}")))
            .args(further)
            .output()
            .unwrap()
    }

    /// The model that a log gives.
    fn model(&self, log: &str) -> String {
        let output = self.run("identify", log, &["--held-out", "0"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let model = self
            .path(&format!("identify-{log}"))
            .join("identified.toml");
        model.to_str().unwrap().to_owned()
    }

    fn diagnosed(&self, log: &str, further: &[&str]) -> Value {
        let output = self.run("diagnose", log, further);
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The authors' description of the arm with the sensor (`panda_plus_bota.urdf`) has it 38 mm high, along the
/// flange's z.
#[test]
fn a_sensor_before_the_tool_is_another_tool() {
    let (Some(folder), Some(arm)) = (mukca(), Arm::new("panda.urdf")) else {
        return;
    };
    arm.import(&folder.join("panda_1"), "before", "7");
    arm.import(&folder.join("panda_1_with_sensor"), "after", "7");
    let model = arm.model("before");
    // with the noise that the sockets' makers state, too
    let stated = std::fs::read_to_string(arm.path("after.rig.toml")).unwrap();
    let stated = format!("[contact]\nsd_m = 1e-4\n{stated}");
    for rig in [None, Some(stated)] {
        if let Some(rig) = rig {
            std::fs::write(arm.path("after.rig.toml"), rig).unwrap();
        }
        let gap = arm.diagnosed("after", &["--model", &model]);
        assert_eq!(gap["verdict"], "named", "{}", gap["causes"]);
        let causes = gap["causes"].as_array().unwrap();
        assert_eq!(causes[0]["effect"], "tool-changed", "{causes:?}");
        let shift = &causes[0]["parameters"]["shift_m"];
        let (value, low, high) = (&shift["value"], &shift["ci95"][0], &shift["ci95"][1]);
        assert!((number(value) - 0.0346).abs() < 1e-3, "{shift}");
        assert!(
            number(low) < number(value) && number(value) < number(high),
            "{shift}"
        );
        assert!(number(high) - number(low) < 5e-3, "{shift}");
        assert_eq!(gap["where"]["joint"], 7);
        assert!(
            gap["where"]["region"]
                .as_str()
                .unwrap()
                .contains("behind joint 7")
        );
    }
}

/// The tool stays when the sockets are put elsewhere: a model of two places is wrong by other things at the third.
#[test]
fn the_same_tool_at_another_place_is_not_another_tool() {
    let (Some(folder), Some(arm)) = (mukca(), Arm::new("panda.urdf")) else {
        return;
    };
    let places = ["back-high", "front", "right"];
    for unseen in places {
        let (fit, check) = (arm.path("fit"), arm.path("check"));
        for (robot, is_own) in [(&fit, false), (&check, true)] {
            for place in places.iter().filter(|place| (**place == unseen) == is_own) {
                let from = folder.join("panda_1").join(place);
                let to = robot.join(place);
                std::fs::create_dir_all(&to).unwrap();
                for hole in ["hole_0.csv", "hole_1.csv"] {
                    std::fs::copy(from.join(hole), to.join(hole)).unwrap();
                }
            }
        }
        arm.import(&fit, &format!("without-{unseen}"), "7");
        arm.import(&check, unseen, "7");
        let model = arm.model(&format!("without-{unseen}"));
        let gap = arm.diagnosed(unseen, &["--model", &model]);
        let causes = gap["causes"].as_array().unwrap();
        let named = causes.iter().any(|cause| cause["effect"] == "tool-changed");
        assert!(!named, "{unseen}: {causes:?}");
        for folder in [fit, check] {
            std::fs::remove_dir_all(folder).unwrap();
        }
    }
}

/// Its authors blame the play of its gears, which no log of postures can show: the answer must not name anything,
/// and must say what it asked.
#[test]
fn worn_gears_stay_unknown_on_postures() {
    let (Some(folder), Some(arm)) = (mukca(), Arm::new("gen3lite.urdf")) else {
        return;
    };
    arm.import(&folder.join("dinova_1"), "dinova", "6");
    let gap = arm.diagnosed("dinova", &[]);
    assert_eq!(gap["verdict"], "unknown", "{}", gap["causes"]);
    let asked = gap["where"]["dependence"].as_array().unwrap();
    let of = |column: &str| {
        asked
            .iter()
            .filter(|found| found["column"] == column)
            .count()
    };
    for joint in 1..=6 {
        assert_eq!(of(&format!("theta{joint}_rad")), 1, "{asked:?}");
    }
    // the description has masses; gravity along the first axis loads all joints but that one
    assert!(
        (2..=6).all(|joint| of(&format!("torque{joint}_nm")) == 1),
        "{asked:?}"
    );
    assert_eq!(of("contact"), 1, "{asked:?}");
    for found in asked {
        assert!((0.0..=1.0).contains(&number(&found["p_value"])), "{found}");
        assert!(
            number(&found["p_adjusted"]) >= number(&found["p_value"]),
            "{found}"
        );
    }
    let untestable = gap["untestable"].as_array().unwrap();
    for effect in ["backlash", "hysteresis"] {
        let found = untestable.iter().find(|entry| entry["effect"] == effect);
        assert!(
            found.unwrap()["why"]
                .as_str()
                .unwrap()
                .contains("no stated order")
        );
    }
    let next = gap["next_experiment"].as_str().unwrap();
    assert!(next.contains("no direction of motion"), "{next}");
}
