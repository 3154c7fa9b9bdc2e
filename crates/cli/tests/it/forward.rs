//! `haptical simulate --forward`: two models of an arm beside its log, and what is refused.

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::{Sandbox, haptical, text};

/// Friction of the arm of `moving-sets/01-clean`, as a fit of its torques has it: viscous, Coulomb.
const FRICTION: [[f64; 2]; 6] = [
    [9.80, 8.65],
    [8.72, 10.28],
    [8.31, 4.49],
    [2.24, 1.72],
    [1.81, 1.61],
    [1.66, 1.10],
];

const CONTROLLER: &str = "\
kp_nm_per_rad = [4500, 5000, 2400, 420, 400, 380]
kd_nm_s_per_rad = [230, 250, 110, 14, 13, 12]
gravity_compensation = true
rate_hz = 1000
velocity_lowpass_hz = 60
";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    haptical()
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn told(output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Sizes of a key of a horizon, joint by joint.
fn sizes(told: &Value, device: usize, horizon: usize, key: &str) -> Vec<f64> {
    let joints = told["devices"][device]["drifts"][horizon]["joints"].as_array();
    let joints = joints.unwrap().iter();
    joints.map(|joint| joint[key].as_f64().unwrap()).collect()
}

fn moving_sets() -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/moving-sets");
    if path.exists() {
        return Some(path);
    }
    println!("skipped: no {}", path.display());
    None
}

#[test]
fn an_arm_with_friction_drifts_less_than_its_nominal_model() {
    let Some(sets) = moving_sets() else { return };
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| sets.join(name).display().to_string();
    let (arm, log) = (place("arm_a.xml"), place("01-clean/log.csv.gz"));
    let export = [
        "export",
        "--device",
        &arm,
        "--tip",
        "flange",
        "--format",
        "toml",
        "--out",
        "corrected.toml",
    ];
    assert!(run(folder.path(), &export).status.success());
    let corrected = folder.path().join("corrected.toml");
    let mut model = std::fs::read_to_string(&corrected).unwrap();
    for (joint, [viscous, coulomb]) in FRICTION.iter().enumerate() {
        model += &format!(
            "\n[[effect]]\nname = \"joint-friction\"\njoint = {}\ncoulomb_nm = {coulomb}\nviscous_nm_s_per_rad = {viscous}\n\
             stribeck_nm = 0.0\ntransition_rad_per_s = 0.01\n",
            joint + 1
        );
    }
    std::fs::write(&corrected, model).unwrap();
    std::fs::write(folder.path().join("controller.toml"), CONTROLLER).unwrap();
    let usual = [
        "simulate",
        "--forward",
        "--json",
        "--device",
        &arm,
        "--tip",
        "flange",
        "--with",
        "corrected.toml",
        "--log",
        &log,
    ];
    let by_torques = told(&run(
        folder.path(),
        &[&usual[..], &["--out", "forward.csv"]].concat(),
    ));
    for horizon in 0..3 {
        let (before, after) = (
            sizes(&by_torques, 0, horizon, "rms"),
            sizes(&by_torques, 1, horizon, "rms"),
        );
        for (before, after) in before.iter().zip(&after) {
            assert!(after < &(0.05 * before), "{horizon}: {before} {after}");
        }
    }
    for name in [
        "forward.csv",
        "forward.csv.html",
        "forward.csv.provenance.json",
    ] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    let further = ["--controller", "controller.toml", "--out", "controlled.csv"];
    let controlled = told(&run(folder.path(), &[&usual[..], &further].concat()));
    // torques of the controller within little more than the noise of the logged ones, 0.75 and 0.14 N m
    let (before, after) = (
        sizes(&controlled, 0, 4, "torque_rms"),
        sizes(&controlled, 1, 4, "torque_rms"),
    );
    for (joint, (before, after)) in before.iter().zip(&after).enumerate() {
        let noise = if joint < 3 { 0.75 } else { 0.14 };
        assert!(
            *after < 1.5 * noise && *before > 10.0 * noise,
            "{joint}: {before} {after}"
        );
    }
}

#[test]
fn what_a_forward_prediction_cannot_do_is_refused() {
    let sandbox = Sandbox::new();
    let folder = sandbox.folder.path();
    let refused = |further: &[&str]| {
        let usual = [
            "simulate",
            "--device",
            "device.toml",
            "--out",
            "forward.csv",
        ];
        let output = run(folder, &[&usual[..], further].concat());
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert!(!folder.join("forward.csv").exists());
        text(&output.stderr)
    };
    assert!(refused(&["--forward"]).contains("--log"));
    assert!(refused(&["--log", "log.csv"]).contains("--forward"));
    // a log without torques
    let error = refused(&["--forward", "--log", "log.csv"]);
    assert!(error.contains("no column"), "{error}");
    std::fs::write(folder.join("controller.toml"), CONTROLLER).unwrap();
    let error = refused(&[
        "--forward",
        "--log",
        "log.csv",
        "--controller",
        "controller.toml",
    ]);
    assert!(error.contains("`kp_nm_per_rad` has 6 numbers"), "{error}");
    std::fs::write(folder.join("controller.toml"), "kp = [1.0]\n").unwrap();
    let error = refused(&[
        "--forward",
        "--log",
        "log.csv",
        "--controller",
        "controller.toml",
    ]);
    assert!(
        error.contains("unknown field `kp`") && error.contains("controller.toml"),
        "{error}"
    );
}
