//! `haptical simulate`: the log that is written, what is refused, and the way back through `identify`.

use std::path::Path;

use haptical_data::{JointShape, LogShape, read_log};
use haptical_model::{Device, JointType, Recording};
use haptical_simulator::{Effects, HandMotion, MotionSettings, record_motion};
use serde_json::Value;

use crate::{Sandbox, haptical, names_in, text};

/// Effects that change every kind of channel.
const EFFECTS: &str = "\
[[effect]]
name = \"capstan-compliance\"
joint = 2
stiffness_nm_per_rad = 260

[[effect]]
name = \"cable-latency\"
delay_s = 0.004
";

fn simulate(sandbox: &Sandbox, further: &[&str]) -> std::process::Output {
    haptical()
        .current_dir(sandbox.folder.path())
        .args(["simulate", "--device", "device.toml"])
        .args(further)
        .output()
        .unwrap()
}

fn device(path: &Path) -> Device {
    Device::load(path).unwrap().device
}

fn read(path: &Path, device: &Device) -> Recording {
    let joints = device.joints.iter().map(|joint| JointShape {
        name: joint.name.clone(),
        prismatic: joint.joint_type == JointType::Prismatic,
        lower: joint.lower_rad,
        upper: joint.upper_rad,
    });
    let shape = LogShape {
        joints: joints.collect(),
        cable_count: device.cables.len(),
        hands: Vec::new(),
    };
    let log = read_log(path, &shape).unwrap();
    assert!(log.warnings.is_empty(), "{:?}", log.warnings);
    log.recording
}

#[test]
fn the_log_is_what_the_library_records_plain_and_compressed() {
    let sandbox = Sandbox::new();
    sandbox.write("effects.toml", EFFECTS);
    let device = device(&sandbox.path("device.toml"));
    let motion = HandMotion {
        seconds: 15.0,
        rate_hz: 100.0,
        ..HandMotion::default()
    };
    let settings = MotionSettings {
        motion,
        ..MotionSettings::default()
    };
    let effects = Effects::from_toml(EFFECTS, "effects.toml").unwrap();
    let want = record_motion(&device, &effects, &settings, 9).unwrap();
    assert_eq!(want.len(), 1500);
    for name in ["log.csv", "log.csv.gz"] {
        let output = simulate(
            &sandbox,
            &[
                "--effects",
                "effects.toml",
                "--seconds",
                "15",
                "--rate-hz",
                "100",
            ]
            .into_iter()
            .chain(["--seed", "9", "--force", "--out", name])
            .collect::<Vec<&str>>(),
        );
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("1500 rows"));
        let got = read(&sandbox.path(name), &device);
        assert!(got == want, "{name}");
    }
}

#[test]
fn json_says_what_was_written() {
    let sandbox = Sandbox::new();
    sandbox.write("effects.toml", EFFECTS);
    let output = simulate(
        &sandbox,
        &[
            "--effects",
            "effects.toml",
            "--seconds",
            "6",
            "--out",
            "a.csv",
            "--json",
        ],
    );
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["rows"], 6000);
    assert_eq!(json["seed"], 1);
    assert_eq!(json["effects"][0]["name"], "capstan-compliance");
    assert_eq!(json["effects"][0]["stiffness_nm_per_rad"], 260.0);
    assert_eq!(json["truth"], Value::Null);
}

#[test]
fn what_is_wrong_ends_with_status_2_and_leaves_no_log() {
    let sandbox = Sandbox::new();
    sandbox.write("bad.toml", EFFECTS.replace("capstan-comp", "capstan-kom"));
    sandbox.write("far.toml", EFFECTS.replace("joint = 2", "joint = 9"));
    sandbox.write("one.toml", "[[joint]]\nlower_rad = -1.0\nupper_rad = 1.0\n");
    for (arguments, words) in [
        (
            &["--effects", "bad.toml"][..],
            "did you mean `capstan-compliance`?",
        ),
        (&["--effects", "far.toml"], "joint 9"),
        (&["--effects", "none.toml"], "none.toml"),
        (&["--truth", "one.toml"], "1 joints"),
        (&["--truth", "none.toml"], "none.toml"),
        (&["--seconds", "1"], "give --seconds above 4"),
        (&["--seconds", "-5"], "--seconds"),
        (&["--seconds", "nan"], "a number above 0 is expected"),
        (&["--rate-hz", "0"], "--rate-hz"),
        (&["--seed", "x"], "--seed"),
        (&["--out", "one.toml/log.csv"], "one.toml"),
    ] {
        let mut all = arguments.to_vec();
        if arguments[0] != "--out" {
            all.extend(["--out", "new.csv"]);
        }
        let output = simulate(&sandbox, &all);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert!(!sandbox.path("new.csv").exists());
    }
    let temporary = |name: &String| name.starts_with('.');
    assert!(!names_in(sandbox.folder.path()).iter().any(temporary));
}

#[test]
fn help_has_an_example_and_the_names() {
    let output = haptical().args(["simulate", "--help"]).output().unwrap();
    let help = text(&output.stdout);
    assert!(output.status.success());
    for words in [
        "Example:",
        "--effects",
        "cable-exit-geometry",
        "stiffness_nm_per_rad",
    ] {
        assert!(help.contains(words), "{words}");
    }
}

/// Simulate a device that deviates by a few numbers, identify it from the log: the numbers are found,
/// and what is left on rows that the fit did not see is the encoders' noise.
#[test]
fn identify_recovers_the_true_device_from_a_simulated_log() {
    let sandbox = Sandbox::new();
    let device = device(&sandbox.path("device.toml"));
    let deviations = [
        ("a0", 1.9e-3),
        ("a3", -1.2e-3),
        ("d5", 1.4e-3),
        ("alpha2", 1.3e-3),
        ("theta4", 1.0e-3),
        ("ratio_deviation1", -0.025),
        ("ratio_deviation3", 0.015),
        ("output_drum_x2", 2.5e-4),
    ];
    let truth = haptical_simulator::apply_deviations(&device, &deviations).unwrap();
    let true_text = truth
        .to_toml(&sandbox.device_text(), "device.toml")
        .unwrap();
    sandbox.write("truth.toml", true_text);
    let output = simulate(
        &sandbox,
        &[
            "--truth",
            "truth.toml",
            "--rate-hz",
            "50",
            "--out",
            "log.csv",
            "--force",
        ],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = sandbox.identify(&["--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let channels = json["channels"].as_array().unwrap();
    for channel in channels {
        let name = channel["channel"].as_str().unwrap();
        let (after, floor) = (
            channel["rms_after"].as_f64().unwrap(),
            channel["noise_floor"].as_f64().unwrap(),
        );
        // nothing is in the log but what the device file says of its encoders
        assert!(after < 1.25 * floor, "{name}: {after} over {floor}");
    }
    assert_eq!(channels.len(), 5);
    let found = self::device(&sandbox.path("result/identified.toml"));
    for (name, _) in deviations {
        let value = |of: &Device| of.parameter(name).unwrap().value(of);
        let (error, deviation) = (
            (value(&found) - value(&truth)).abs(),
            (value(&device) - value(&truth)).abs(),
        );
        assert!(error < 0.1 * deviation, "{name}: {error} of {deviation}");
    }
}

/// Short logs of a sound device that often rests have no gap, and their torques are tested. Torques that only held the weights
/// had a false gain of the force at half of these seeds, and could not be tested at the others.
#[test]
fn a_sound_log_has_no_gap_and_its_torques_are_tested() {
    let sandbox = Sandbox::new();
    for (seed, rate_hz) in [("1", "100"), ("5", "100"), ("8", "100"), ("2", "200")] {
        let motion = ["--seconds", "30", "--rate-hz", rate_hz, "--seed", seed];
        let further = [&motion[..], &["--out", "sound.csv", "--force"]].concat();
        let output = simulate(&sandbox, &further);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .args(["diagnose", "--device", "device.toml", "--log", "sound.csv"])
            .args(["--out", "gap", "--force", "--json"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let gap: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(gap["verdict"], "no-gap", "{seed}: {}", gap["causes"]);
        assert_eq!(gap["warnings"], serde_json::json!([]), "{seed}");
        let untestable = gap["untestable"].as_array().unwrap();
        let mut of_torques = untestable
            .iter()
            .filter(|own| own["effect"] == "torque-gain");
        assert_eq!(of_torques.next(), None, "{seed}");
    }
}

/// What the diagnosis says, against the device as it was, of a sound log with a number added to a column.
fn against_the_device(column: &str, added: f64) -> Value {
    let sandbox = Sandbox::new();
    let motion = ["--seconds", "300", "--rate-hz", "10", "--seed", "3"];
    let output = simulate(&sandbox, &[&motion[..], &["--out", "sound.csv"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let sound = std::fs::read_to_string(sandbox.path("sound.csv")).unwrap();
    let mut lines = sound.lines();
    let head = lines.next().unwrap();
    let own = head.split(',').position(|name| name == column).unwrap();
    let mut log = format!("{head}\n");
    for line in lines {
        let cells = line.split(',').enumerate().map(|(place, cell)| {
            match (place == own, cell.parse::<f64>()) {
                (true, Ok(number)) => (number + added).to_string(),
                _ => cell.to_owned(),
            }
        });
        log.push_str(&(cells.collect::<Vec<_>>().join(",") + "\n"));
    }
    std::fs::write(sandbox.path("later.csv"), log).unwrap();
    let output = haptical()
        .current_dir(sandbox.folder.path())
        .args(["diagnose", "--device", "device.toml"])
        .args(["--model", "device.toml", "--log", "later.csv"])
        .args(["--out", "gap", "--json"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn holds(interval: &Value, truth: f64) {
    let [low, high] = [0, 1].map(|end: usize| interval[end].as_f64().unwrap());
    assert!(low < truth && truth < high, "{interval}");
}

/// A cable that was zeroed anew since the calibration: the effect is named, and no length that a fit without it would bend.
#[test]
fn a_cable_that_was_zeroed_anew_changes_no_length() {
    let gap = against_the_device("cable_m", 2e-4);
    assert_eq!(gap["verdict"], "named", "{}", gap["causes"]);
    let causes = gap["causes"].as_array().unwrap();
    assert_eq!(causes.len(), 1, "{}", gap["causes"]);
    assert_eq!(causes[0]["effect"], "cable-zero-offset");
    holds(&causes[0]["parameters"]["offset_m"]["ci95"], 2e-4);
}

/// An external encoder that was zeroed anew: the cable knows that the joint stands where it did, so the link's zero goes with the
/// drive's, and the number told is all of it.
#[test]
fn an_external_encoder_that_was_zeroed_anew_is_told_with_its_size() {
    let gap = against_the_device("out1_rad", 1e-3);
    let cause = &gap["causes"][0];
    assert_eq!(cause["effect"], "joint-offset", "{}", gap["causes"]);
    let changed = cause["changed"].as_array().unwrap();
    let offset = changed
        .iter()
        .find(|own| own["parameter"] == "offset1")
        .unwrap();
    holds(&offset["ci95"], 1e-3);
}
