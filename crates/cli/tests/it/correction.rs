//! A curve in the place of a cause that is unknown: written by `diagnose`, taken by `simulate`, `identify` and `diagnose --model`,
//! taken by an export for a control loop.

use std::path::Path;

use serde_json::Value;

use crate::{Sandbox, haptical, text};

/// Root mean squares of prediction minus measurement of two channels.
fn replayed(sandbox: &Sandbox, device: &str, log: &str) -> [f64; 2] {
    let flags = [
        "--replay",
        log,
        "--out",
        "predicted.csv",
        "--force",
        "--json",
    ];
    let said = sandbox.ran(&[&["simulate", "--device", device][..], &flags].concat());
    let told: Value = serde_json::from_str(&said).unwrap();
    let channels = told["channels"].as_array().unwrap();
    ["out2", "cable"].map(|name| {
        let own = channels.iter().find(|own| own["channel"] == name).unwrap();
        own["rms"].as_f64().unwrap() / own["noise_floor"].as_f64().unwrap()
    })
}

/// A dent of the drum of joint 2 at 0.25 rad, 2.5 mrad deep and 0.08 rad wide, as coefficients of 60 splines over 3 rad.
fn dented(device: &str) -> String {
    let knot = |index: i32| -1.5 + 3.0 / 57.0 * f64::from(index - 1);
    let dent = |at: f64| 2.5e-3 * (-0.5 * ((at - 0.25) / 0.08).powi(2)).exp();
    let coefficients: Vec<f64> = (0..60).map(|index| dent(knot(index))).collect();
    format!(
        "{device}\n[[effect]]\nname = \"correction\"\njoint = 2\nfrom_rad = -1.5\nto_rad = 1.5\ncoefficients_rad = {coefficients:?}\n"
    )
}

/// Nothing but noise on a fresh recording, to what a curve of 43 coefficients and the rest of the device are known.
const NOISE: f64 = 1.2;

#[test]
fn a_dent_is_corrected_on_a_fresh_recording_and_named_no_cause() {
    let sandbox = Sandbox::new();
    sandbox.write("dented.toml", dented(&sandbox.device_text()));
    for (log, seed) in [("log.csv", "3"), ("fresh.csv", "4")] {
        let flags = [
            "--seconds",
            "60",
            "--rate-hz",
            "100",
            "--seed",
            seed,
            "--out",
            log,
            "--force",
        ];
        sandbox.ran(&[&["simulate", "--device", "dented.toml"][..], &flags].concat());
    }
    let diagnose = ["diagnose", "--device", "device.toml", "--log"];
    let second = ["log.csv", "--validate", "fresh.csv", "--out", "gap"];
    let said = sandbox.ran(&[&diagnose[..], &second].concat());
    let gap = sandbox.json("gap/gap.json");
    assert_eq!(gap["verdict"], "unknown", "{said}");
    assert!(said.contains("which is no cause"), "{said}");
    let causes = gap["causes"].as_array().unwrap();
    assert!(causes.iter().all(|cause| cause["effect"] != "correction"));
    let own = &gap["correction"];
    assert_eq!(
        (&own["joint"], &own["over"]),
        (&2.into(), &"theta2_rad".into())
    );
    assert!(own["closed_unseen_share"].as_f64().unwrap() > 0.8, "{own}");
    // the second recording confirms it
    let closed = own["on_second"]["reduction_percent"].as_f64().unwrap();
    assert!(
        closed > 80.0 && gap["correction_refused"].is_null(),
        "{own}"
    );
    sandbox.ran(&[
        "identify",
        "--device",
        "device.toml",
        "--log",
        "log.csv",
        "--out",
        "rigid",
    ]);
    let before = replayed(&sandbox, "rigid/identified.toml", "fresh.csv");
    let after = replayed(&sandbox, "gap/corrected.toml", "fresh.csv");
    assert!(before.iter().all(|before| *before > 2.5), "{before:?}");
    assert!(after.iter().all(|after| *after < NOISE), "{after:?}");
    // an identification keeps it as it is
    sandbox.ran(&[
        "identify",
        "--device",
        "gap/corrected.toml",
        "--log",
        "fresh.csv",
        "--out",
        "again",
    ]);
    let [corrected, again] = ["gap/corrected.toml", "again/identified.toml"].map(|name| {
        let text = std::fs::read_to_string(sandbox.path(name)).unwrap();
        let lines = text
            .lines()
            .filter(|line| line.starts_with("coefficients_rad"));
        lines.map(str::to_owned).collect::<Vec<String>>()
    });
    assert!(corrected.len() == 1 && corrected == again);
    let model = [
        "fresh.csv",
        "--model",
        "gap/corrected.toml",
        "--out",
        "check",
    ];
    sandbox.ran(&[&diagnose[..], &model].concat());
    assert_eq!(sandbox.json("check/gap.json")["verdict"], "no-gap");
    // and a control loop has the curve
    let export = haptical()
        .current_dir(sandbox.folder.path())
        .args([
            "export",
            "--device",
            "gap/corrected.toml",
            "--format",
            "rust",
            "--out",
            "model.rs",
        ])
        .output()
        .unwrap();
    assert_eq!(export.status.code(), Some(0), "{}", text(&export.stderr));
    let module = std::fs::read_to_string(sandbox.path("model.rs")).unwrap();
    let curve = "Effect::Curve { joint: 1, over: haptical_runtime::Over::Angle";
    assert!(module.contains(curve), "{module}");
}

/// The course of one recording over its time, with a temperature that rises meanwhile: neither is written, and the answer says why.
#[test]
fn the_course_of_one_recording_is_no_property_of_the_device() {
    let sandbox = Sandbox::new();
    let dent = |at: f64, middle: f64| (-0.5 * ((at - middle) / 2.0).powi(2)).exp();
    let course = |at: f64| 2.5e-3 * (dent(at, 9.0) - 0.7 * dent(at, 22.0));
    let knot = |index: i32| 30.0 / 57.0 * f64::from(index - 1);
    let coefficients: Vec<f64> = (0..60).map(|index| course(knot(index))).collect();
    let table = format!(
        "\n[[effect]]\nname = \"correction\"\njoint = 2\nfrom_s = 0.0\nto_s = 30.0\ncoefficients_rad = {coefficients:?}\n"
    );
    sandbox.write("course.toml", sandbox.device_text() + &table);
    for (device, log, seed) in [
        ("course.toml", "log.csv", "3"),
        ("device.toml", "second.csv", "4"),
    ] {
        let motion = ["--seconds", "30", "--rate-hz", "50", "--seed", seed];
        let flags = ["simulate", "--device", device, "--out", log, "--force"];
        sandbox.ran(&[&flags[..], &motion].concat());
    }
    for (second, why) in [
        (&["--validate", "second.csv"][..], "second-recording"),
        (&[], "course-of-time"),
    ] {
        let flags = ["diagnose", "--device", "device.toml", "--log", "log.csv"];
        let said = sandbox.ran(&[&flags[..], second, &["--out", "gap", "--force"]].concat());
        let gap = sandbox.json("gap/gap.json");
        assert_eq!(gap["verdict"], "unknown", "{said}");
        assert!(gap["correction"].is_null(), "{said}");
        assert_eq!(gap["correction_refused"]["why"], why, "{said}");
        let depends_on = gap["where"]["depends_on"].as_array().unwrap();
        assert!(depends_on.contains(&"t_s".into()), "{said}");
        assert!(!sandbox.path("gap/corrected.toml").exists());
        let page = std::fs::read_to_string(sandbox.path("gap/gap.html")).unwrap();
        assert!(page.contains("Nothing is corrected: a curve over"));
    }
}

/// The dent of another simulator.
#[test]
fn the_dent_of_another_simulator_is_corrected() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let set = shared.join("gap-sets/08-unknown-dent");
    if !set.exists() {
        println!("skipped: no {}", set.display());
        return;
    }
    let sandbox = Sandbox::new();
    std::fs::copy(
        shared.join("devices/haptic7.toml"),
        sandbox.path("device.toml"),
    )
    .unwrap();
    for name in ["log.csv.gz", "log2.csv.gz"] {
        std::fs::copy(set.join(name), sandbox.path(name)).unwrap();
    }
    let log = ["--device", "device.toml", "--log", "log.csv.gz", "--out"];
    sandbox.ran(&[&["diagnose"][..], &log, &["gap"]].concat());
    assert_eq!(sandbox.json("gap/gap.json")["verdict"], "unknown");
    sandbox.ran(&[&["identify"][..], &log, &["rigid"]].concat());
    let before = replayed(&sandbox, "rigid/identified.toml", "log2.csv.gz");
    let after = replayed(&sandbox, "gap/corrected.toml", "log2.csv.gz");
    assert!(before.iter().all(|before| *before > 5.0), "{before:?}");
    assert!(after.iter().all(|after| *after < NOISE), "{after:?}");
}
