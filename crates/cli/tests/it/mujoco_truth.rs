//! A device that another program made: MuJoCo simulates an arm with a spring behind its second motor, Haptical has a log of it and
//! the model without the spring. What it finds goes back into MuJoCo, and the gap is measured there.
//!
//! Python with `mujoco` and `numpy` is asked for, as in `mujoco.rs`.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::mujoco::python;
use crate::{haptical, text};

/// Stiffness of the spring in tests/fixtures/mujoco_truth.xml \[N m/rad\].
const STIFFNESS: f64 = 900.0;
const RIG: &str =
    "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 5e-5\nscale_sd = 0.0\n";

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures")
        .join(name)
}

/// Runs tests/fixtures/mujoco_truth.py in a folder; what it prints.
fn run(python: &str, folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(python)
        .arg(fixture("mujoco_truth.py"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

/// Runs the command in a folder; what it prints.
fn command(folder: &Path, arguments: &[&str]) -> String {
    let output = haptical()
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

#[test]
fn a_spring_of_mujoco_is_named_and_its_gap_closes_in_mujoco() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["mujoco_truth.xml", "mujoco_rigid.xml"] {
        std::fs::copy(fixture(name), at.join(name)).unwrap();
    }
    std::fs::write(at.join("rig.toml"), RIG).unwrap();
    let record = |seed, rows, log| {
        run(
            &python,
            at,
            &["record", "mujoco_truth.xml", seed, rows, log],
        );
    };
    record("1", "150", "log.csv");
    record("2", "60", "fresh.csv");
    let device = [
        "--device",
        "mujoco_rigid.xml",
        "--tip",
        "handle",
        "--rig",
        "rig.toml",
    ];
    let diagnose = |further: &[&str]| {
        let told = command(
            at,
            &[&["diagnose", "--json"], &device[..], further].concat(),
        );
        serde_json::from_str::<Value>(&told).unwrap()
    };

    let gap = diagnose(&["--log", "log.csv", "--out", "gap"]);
    assert_eq!(gap["verdict"], "named", "{gap:#}");
    let cause = &gap["causes"][0];
    assert_eq!(
        (&cause["effect"], &cause["joint"]),
        (&"joint-compliance".into(), &2.into())
    );
    let found = &cause["parameters"]["stiffness_nm_per_rad"];
    let of = |value: &Value| value.as_f64().unwrap();
    assert!(
        (of(&found["value"]) / STIFFNESS - 1.0).abs() < 0.03,
        "{found}"
    );
    assert!(
        of(&found["ci95"][0]) < STIFFNESS && STIFFNESS < of(&found["ci95"][1]),
        "{found}"
    );
    let again = diagnose(&[
        "--log",
        "fresh.csv",
        "--model",
        "gap/corrected.toml",
        "--out",
        "check",
    ]);
    assert_eq!(again["verdict"], "no-gap", "{again:#}");

    // the same loads and angles of the motors, in MuJoCo: distance of the handles
    command(
        at,
        &[
            "export",
            "--device",
            "gap/corrected.toml",
            "--format",
            "mjcf",
            "--out",
            "corrected.xml",
        ],
    );
    let gap_m = |model| -> f64 {
        let told = run(&python, at, &["gap", model, "mujoco_truth.xml", "3", "30"]);
        told.trim().parse().unwrap()
    };
    let (before_m, after_m) = (gap_m("mujoco_rigid.xml"), gap_m("corrected.xml"));
    println!("gap in MuJoCo: {before_m:.2e} m before, {after_m:.2e} m after");
    assert!(
        before_m > 5e-3 && after_m < 0.03 * before_m,
        "{before_m:e} {after_m:e}"
    );
}
