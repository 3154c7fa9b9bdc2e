//! Device files of `diagnose` and `identify` leave, replayed on the log of their fit, what that fit leaves.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{Sandbox, haptical, text};

/// Share of a channel's root mean square by which a replay may differ from the fit.
const SHARE: f64 = 0.01;

/// What a device leaves of a log, replayed: channel and root mean square.
fn replayed(folder: &Path, device: &str, log: &str) -> Vec<(String, f64)> {
    let flags = [
        "--replay",
        log,
        "--out",
        "replayed.csv",
        "--force",
        "--json",
    ];
    let output = haptical()
        .current_dir(folder)
        .args(["simulate", "--device", device])
        .args(flags)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let channels = told["channels"].as_array().unwrap().iter();
    let own = |channel: &Value| {
        let name = channel["channel"].as_str().unwrap().to_owned();
        (name, channel["rms"].as_f64().unwrap())
    };
    channels.map(own).collect()
}

/// The channels of a result that a replay has all leave what their fit leaves; how many these are.
fn reproduced(told: &Value, replayed: &[(String, f64)]) -> usize {
    let mut count = 0;
    for channel in told.as_array().unwrap() {
        let own = replayed
            .iter()
            .find(|(name, _)| channel["channel"] == **name);
        let Some((name, rms)) = own else { continue };
        let fit = channel["rms_fit"].as_f64().unwrap();
        assert!(
            (rms / fit - 1.0).abs() <= SHARE,
            "{name}: {rms:e}, fit {fit:e}"
        );
        count += 1;
    }
    count
}

fn gap(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("gap.json")).unwrap()).unwrap()
}

/// A log whose first motor is ahead of its link by half a play of 1.2 mrad, on the side that the link's own motion says: a clean
/// log whose motor reads more where the link moves on.
fn with_play(sandbox: &Sandbox) {
    let flags = [
        "--seconds",
        "30",
        "--rate-hz",
        "100",
        "--seed",
        "5",
        "--out",
        "clean.csv",
    ];
    sandbox.ran(&[&["simulate", "--device", "device.toml"][..], &flags].concat());
    let clean = std::fs::read_to_string(sandbox.path("clean.csv")).unwrap();
    let mut rows = clean
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let at = head.iter().position(|name| *name == "theta1_rad").unwrap();
    let half_rad = 0.6e-3;
    let mut behind: Option<f64> = None;
    let mut lines = vec![head.join(",")];
    for row in rows {
        let link: f64 = row[at].parse().unwrap();
        let before = behind.unwrap_or(link);
        let play = before.max(link - half_rad).min(link + half_rad);
        behind = Some(play);
        let motor = format!("{}", link + (link - play));
        let mut cells: Vec<&str> = row;
        cells[at] = &motor;
        lines.push(cells.join(","));
    }
    sandbox.write("play.csv", lines.join("\n") + "\n");
}

#[test]
fn a_play_that_the_hand_decides_is_written_on_the_side_on_which_it_is() {
    let sandbox = Sandbox::new();
    with_play(&sandbox);
    sandbox.ran(&[
        "diagnose",
        "--device",
        "device.toml",
        "--log",
        "play.csv",
        "--out",
        "gap",
    ]);
    let told = gap(&sandbox.path("gap"));
    assert_eq!(told["verdict"], "named");
    assert_eq!(told["causes"][0]["effect"], "backlash");
    let width = told["causes"][0]["parameters"]["width_rad"]["value"]
        .as_f64()
        .unwrap();
    assert!((width / 1.2e-3 - 1.0).abs() < 0.1, "{width}");
    let after = replayed(&sandbox.path("."), "gap/corrected.toml", "play.csv");
    assert_eq!(reproduced(&told["gap"]["channels"], &after), 5);
    // what it leaves is little of what there is without it
    let out1 = &told["gap"]["channels"][0];
    let fit = out1["rms_fit"].as_f64().unwrap();
    assert!(fit < 0.4 * out1["rms_before"].as_f64().unwrap(), "{out1}");
    let file = std::fs::read_to_string(sandbox.path("gap/corrected.toml")).unwrap();
    let line = format!("# provenance: fit of out1: rms_fit = {fit:e} rad");
    assert!(file.contains(&line), "{file}");
    // a file that is made of it does not keep the figures of another fit
    let identify = [
        "identify",
        "--device",
        "gap/corrected.toml",
        "--log",
        "play.csv",
        "--held-out",
        "0",
    ];
    sandbox.ran(&[&identify[..], &["--out", "result"]].concat());
    let file = std::fs::read_to_string(sandbox.path("result/identified.toml")).unwrap();
    assert!(
        file.contains("fit of out1: rms_fit = ") && !file.contains(&line),
        "{file}"
    );
    let told = std::fs::read_to_string(sandbox.path("result/identified.json")).unwrap();
    let told: Value = serde_json::from_str(&told).unwrap();
    let after = replayed(&sandbox.path("."), "result/identified.toml", "play.csv");
    assert_eq!(reproduced(&told["channels_fit"], &after), 5);
}

/// Lost counts belong to the log: the device with the other cause, replayed on that log, would leave them, and is not written; on the
/// log without them it is.
#[test]
fn a_device_beside_lost_counts_is_written_for_the_repaired_log_alone() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "effects.toml",
        "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 300.0\n\
         [[effect]]\nname = \"encoder-count-loss\"\njoint = 1\ncounts = 30\ntime_s = 17.0\n",
    );
    let flags = [
        "--seconds",
        "40",
        "--rate-hz",
        "100",
        "--seed",
        "7",
        "--out",
        "log.csv",
        "--force",
    ];
    let simulate = [
        "simulate",
        "--device",
        "device.toml",
        "--effects",
        "effects.toml",
    ];
    sandbox.ran(&[&simulate[..], &flags].concat());
    let diagnose = [
        "diagnose",
        "--device",
        "device.toml",
        "--log",
        "log.csv",
        "--out",
    ];
    sandbox.ran(&[&diagnose[..], &["gap"]].concat());
    let told = gap(&sandbox.path("gap"));
    let names: Vec<&str> = told["causes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|cause| cause["effect"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"capstan-compliance") && names.contains(&"encoder-count-loss"),
        "{names:?}"
    );
    let left_out = told["not_in_file"].as_array().unwrap();
    assert!(
        left_out[0]
            .as_str()
            .unwrap()
            .starts_with("encoder-count-loss at joint 1: ")
    );
    assert!(!sandbox.path("gap/corrected.toml").exists());
    let warnings = told["warnings"].as_array().unwrap().iter();
    let mut said = warnings.filter_map(Value::as_str);
    assert!(said.any(|own| {
        own.starts_with("corrected.toml is not written: replayed on the log of its fit")
            && own.contains("out1 is ")
    }));
    sandbox.ran(&[&diagnose[..], &["repaired", "--repair"]].concat());
    let told = gap(&sandbox.path("repaired"));
    let after = replayed(
        &sandbox.path("."),
        "repaired/corrected.toml",
        "repaired/repaired.csv",
    );
    assert_eq!(reproduced(&told["gap"]["channels"], &after), 5);
}

/// A recording from outside the project with its device, diagnosed; the folder of the answer, or a printed line.
fn of_shared(device: &str, log: &str) -> Option<(tempfile::TempDir, PathBuf)> {
    let shared = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let (device, log) = (shared.join(device), shared.join(log));
    if !device.exists() || !log.exists() {
        println!("skipped: no {}", log.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let output = haptical()
        .current_dir(folder.path())
        .args(["diagnose", "--out", "gap", "--device"])
        .arg(device)
        .arg("--log")
        .arg(&log)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    Some((folder, log))
}

#[test]
fn every_labelled_set_is_reproduced_by_its_corrected_device() {
    for set in [
        "02-capstan-compliance",
        "03-backlash",
        "04-cable-latency",
        "06-joint-compliance",
        "07-cable-guide",
        "08-unknown-dent",
    ] {
        let log = format!("gap-sets/{set}/log.csv.gz");
        let Some((folder, log)) = of_shared("devices/haptic7.toml", &log) else {
            return;
        };
        let told = gap(&folder.path().join("gap"));
        let after = replayed(folder.path(), "gap/corrected.toml", log.to_str().unwrap());
        assert_eq!(reproduced(&told["gap"]["channels"], &after), 5, "{set}");
    }
}

/// A lag of the cable of 2 ms bends the base model, and what the cause adds to it: the file is that of a fit without the bend.
#[test]
fn a_lag_that_bends_the_base_model_is_written() {
    let log = "cases/35-refit-stopped-half-way/log.csv.gz";
    let Some((folder, log)) = of_shared("devices/haptic7.toml", log) else {
        return;
    };
    let told = gap(&folder.path().join("gap"));
    let after = replayed(folder.path(), "gap/corrected.toml", log.to_str().unwrap());
    assert_eq!(reproduced(&told["gap"]["channels"], &after), 5);
    let delay = &told["causes"][0]["parameters"]["delay_s"]["ci95"];
    let [low, high] = [0, 1].map(|end| delay[end].as_f64().unwrap());
    assert!(low < 2e-3 && 2e-3 < high, "{delay}");
}

/// The drives of a moving arm are in its file beside the payload: with them the log has no gap, and nothing is left to identify.
#[test]
fn a_moving_arm_gets_the_numbers_of_its_drives() {
    let log = "moving-sets/02-payload/log.csv.gz";
    let Some((folder, log)) = of_shared("moving-sets/arm_a.urdf", log) else {
        return;
    };
    let told = gap(&folder.path().join("gap"));
    assert_eq!(told["causes"][0]["effect"], "payload");
    let left_out = told["not_in_file"].as_array().unwrap();
    assert_eq!(left_out.len(), 1, "{left_out:?}");
    assert!(left_out[0].as_str().unwrap().starts_with("the delay of"));
    let file = std::fs::read_to_string(folder.path().join("gap/corrected.toml")).unwrap();
    for key in [
        "armature_kgm2",
        "torque_offset_nm",
        "name = \"joint-friction\"",
    ] {
        assert_eq!(file.matches(key).count(), 6, "{key}: {file}");
    }
    let output = haptical()
        .current_dir(folder.path())
        .args(["diagnose", "--device", "gap/corrected.toml", "--json"])
        .args(["--out", "again", "--log", log.to_str().unwrap()])
        .output()
        .unwrap();
    let again: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(again["verdict"], "no-gap", "{again}");
}
