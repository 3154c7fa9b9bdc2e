//! Small inputs of strangers, next to the project, each with the answer that it must get. Without them the tests say that they skip.

use std::path::PathBuf;

use serde_json::Value;

use crate::{haptical, text};

/// The folder of an input, or a printed line.
fn folder(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases");
    let path = path.join(name);
    match path.exists() {
        true => Some(path),
        false => {
            println!("skipped: no {}", path.display());
            None
        }
    }
}

/// gap.json of a diagnosis in a folder.
fn diagnosed(name: &str, args: &str) -> Option<Value> {
    let folder = folder(name)?;
    let out = tempfile::tempdir().unwrap();
    let result = out.path().join("out");
    let output = haptical()
        .current_dir(&folder)
        .arg("diagnose")
        .args(args.split(' '))
        .arg("--out")
        .arg(&result)
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{name}: {said}");
    let gap = std::fs::read(result.join("gap.json")).unwrap();
    Some(serde_json::from_slice(&gap).unwrap())
}

/// Status and words of a command that refuses.
fn refused(name: &str, args: &str, status: i32, words: &[&str]) {
    let Some(folder) = folder(name) else {
        return;
    };
    let out = tempfile::tempdir().unwrap();
    let mut command = haptical();
    command.current_dir(&folder).args(args.split(' '));
    let output = command
        .arg("--out")
        .arg(out.path().join("out"))
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{name}: {said}");
    for word in words {
        assert!(said.contains(word), "{name}, {word}: {said}");
    }
}

fn causes(gap: &Value) -> Vec<String> {
    let all = gap["causes"].as_array().unwrap().iter();
    all.map(|cause| match cause["joint"].as_u64() {
        Some(joint) => format!("{}@{joint}", cause["effect"].as_str().unwrap()),
        None => cause["effect"].as_str().unwrap().to_owned(),
    })
    .collect()
}

/// The verdict with its causes, and a number of the first one.
fn assert_named(name: &str, args: &str, wanted: &[&str], number: (&str, f64, f64)) {
    let Some(gap) = diagnosed(name, args) else {
        return;
    };
    assert_eq!(
        (gap["verdict"].as_str(), causes(&gap)),
        (
            Some("named"),
            wanted.iter().map(|entry| (*entry).to_owned()).collect()
        ),
        "{name}"
    );
    let value = gap["causes"][0]["parameters"][number.0]["value"]
        .as_f64()
        .unwrap();
    assert!(
        (value - number.1).abs() < number.2,
        "{name}: {} {value}",
        number.0
    );
}

/// A question of the admission that is answered with no.
fn assert_barred(name: &str, args: &str, question: &str) {
    let Some(gap) = diagnosed(name, args) else {
        return;
    };
    assert_eq!(gap["verdict"], "unknown", "{name}");
    assert_eq!(
        gap["admission"][question]["answer"], "no",
        "{name}: {}",
        gap["admission"]
    );
    assert_eq!(causes(&gap), Vec::<String>::new());
}

#[test]
fn zeros_of_a_bus_are_dropouts_and_no_noise() {
    let arm = "--device arm.xml --tip tool --log log.csv";
    assert_named(
        "01-torque-dropouts",
        arm,
        &["dropouts@2"],
        ("share", 0.097, 0.01),
    );
}

#[test]
fn an_elbow_that_is_counted_from_horizontal_is_refused_with_its_sum() {
    for args in [
        "identify --device device.toml --log random-raw.csv",
        "diagnose --device device-noise-0.2mm.toml --log one-axis-raw.csv",
        "diagnose --device device-noise-unstated.toml --log one-axis-raw.csv",
    ] {
        refused(
            "02-elbow-counted-from-horizontal",
            args,
            2,
            &["`theta3_rad` plus `theta2_rad`"],
        );
    }
    let half = "diagnose --device arm.urdf --rig rig.toml --log z_half3.csv";
    refused(
        "17-half-reading-named-eccentricity",
        half,
        2,
        &["`theta3_rad` times 2"],
    );
}

#[test]
fn what_stands_still_was_not_measured() {
    let stuck = "--device arm.urdf --rig rig.toml --log stuck.csv";
    for command in ["identify", "diagnose"] {
        let args = format!("{command} {stuck}");
        refused(
            "04-stuck-tracker",
            &args,
            2,
            &["x_m, y_m, z_m have one value throughout"],
        );
    }
    let one_axis = "diagnose --device arm.urdf --rig rig0.toml --log z_constz.csv";
    refused(
        "16-nonsense-called-no-gap",
        one_axis,
        2,
        &["z_m has one value throughout"],
    );
}

#[test]
fn a_log_of_another_arm_has_no_verdict() {
    let name = "16-nonsense-called-no-gap";
    for log in ["otherlog", "permuted"] {
        let args = format!("--device arm.urdf --rig rig0.toml --log z_{log}.csv");
        assert_barred(name, &args, "belongs");
    }
    for job in ["diagnose", "identify"] {
        let args = format!("{job} --device arm.urdf --rig rig0.toml --log z_zero3.csv");
        let words = [
            "`theta3_rad` as the tracker shows that joint",
            "an encoder of that joint that answers",
        ];
        refused(name, &args, 2, &words);
    }
}

#[test]
fn a_displacement_within_a_run_has_its_name_size_and_row() {
    let args = |log: &str| format!("--device arm.urdf --rig rig.toml --log {log}.csv");
    let name = "08-step-within-a-run";
    for log in ["tracker-moved", "tracker-moved-no-times"] {
        assert_named(
            name,
            &args(log),
            &["tracker-moved"],
            ("shift_m", 3.75e-3, 1e-4),
        );
    }
    assert_named(
        name,
        &args("elbow-slipped"),
        &["zero-changed@3"],
        ("offset_rad", -0.02, 3e-4),
    );
    if let Some(gap) = diagnosed(name, &args("clean")) {
        assert_eq!(gap["verdict"], "no-gap");
    }
}

#[test]
fn moving_arms_have_one_rule_for_the_rate() {
    let args = "diagnose --device arm1.urdf --log a.csv.gz";
    refused("23-moving-20-rows-a-second", args, 3, &["cannot be tested"]);
    refused(
        "24-moving-10-rows-nan",
        args,
        3,
        &["20 rows a second are needed"],
    );
}

#[test]
fn a_factor_on_all_torques_and_a_joints_zero_have_names() {
    let args = |arm: &str| format!("--device {arm}.urdf --log a.csv.gz --validate b.csv.gz");
    assert_named(
        "20-moving-common-scale",
        &args("arm1"),
        &["torque-gain"],
        ("factor", 4.0, 0.5),
    );
    let zero = ("offset_rad", -0.05, 0.01);
    assert_named(
        "21-moving-joint-zero",
        &args("arm0"),
        &["joint-offset@2"],
        zero,
    );
}

#[test]
fn logs_of_a_six_axis_arm_in_motion_are_told_apart() {
    let args =
        |log: &str| format!("--device bob6.urdf --log {log}_1.csv.gz --validate {log}_2.csv.gz");
    let name = "moving-six-axis";
    assert_named(name, &args("payload"), &["payload"], ("mass_kg", 1.8, 0.25));
    assert_named(
        name,
        &args("delay"),
        &["encoder-latency"],
        ("delay_s", 0.014, 2e-3),
    );
    for (log, verdict) in [
        ("ok", "no-gap"),
        ("pendulum", "unknown"),
        ("bungee", "unknown"),
    ] {
        if let Some(gap) = diagnosed(name, &args(log)) {
            assert_eq!(gap["verdict"], verdict, "{log}");
            let is_open = verdict == "unknown";
            assert_eq!(
                is_open,
                !gap["candidates"].as_array().unwrap().is_empty(),
                "{log}"
            );
        }
    }
    if let Some(gap) = diagnosed(name, &args("friction")) {
        assert_eq!(gap["verdict"], "no-gap");
        let adjusted = gap["adjusted"].as_array().unwrap().iter();
        let mut entry =
            adjusted.filter(|entry| entry["number"] == "coulomb_nm" && entry["joint"] == 2);
        let friction = entry.next().unwrap()["after"].as_f64().unwrap();
        assert!((friction - 5.4).abs() < 0.05, "{friction}");
    }
}

#[test]
fn torques_without_gravitys_part_are_said_to_lack_it() {
    for args in [
        "--device arm.xml --tip tool --log log.csv",
        "--device arm-without-attribute.xml --tip tool --log log-gravity-subtracted.csv",
    ] {
        if let Some(gap) = diagnosed("06-gravcomp", args) {
            assert_eq!(gap["verdict"], "unknown");
            let mut warnings = gap["warnings"].as_array().unwrap().iter();
            let is_it = |entry: &Value| entry.as_str().unwrap().contains("lack what gravity asks");
            assert!(warnings.any(is_it), "{}", gap["warnings"]);
        }
    }
}

#[test]
fn a_noise_of_two_parts_is_no_gap() {
    let args = "--device ../../devices/haptic7.toml --log log.csv.gz";
    if let Some(gap) = diagnosed("33-noise-of-two-parts", args) {
        assert_eq!(gap["verdict"], "no-gap");
    }
}

#[test]
fn a_large_effect_excuses_no_gap_of_another_channel() {
    let Some(folder) = folder("32-large-effect-hides-a-gap") else {
        return;
    };
    let out = tempfile::tempdir().unwrap();
    let mut command = haptical();
    command
        .current_dir(&folder)
        .args(["diagnose", "--device", "../../devices/haptic7.toml"]);
    command
        .args(["--log", "log.csv.gz", "--out"])
        .arg(out.path().join("out"));
    let output = command.output().unwrap();
    let answer = text(&output.stdout)
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert!(answer.contains("explains a part of the gap"), "{answer}");
    assert!(
        answer.contains("out3 keeps 0.3377 mrad, 3.2 times its noise"),
        "{answer}"
    );
}
