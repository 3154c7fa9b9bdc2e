//! `haptical export`: its three forms, their provenance, its refusals.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use haptical_model::Device;
use serde_json::Value;

use crate::{Sandbox, haptical, names_in, text};

/// A file of the runtime's fixtures; a packaged crate has none, and says that it skips.
pub(crate) fn fixture(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../runtime/tests/fixtures")
        .join(name);
    if !path.exists() {
        println!("skipped: {name} of the runtime is not here");
        return None;
    }
    Some(path)
}

pub(crate) fn export(device: &Path, format: &str, out: &Path, further: &[&str]) -> Output {
    haptical()
        .args(["export", "--format", format, "--device"])
        .arg(device)
        .arg("--out")
        .arg(out)
        .args(further)
        .output()
        .unwrap()
}

/// The text that an export writes.
fn exported(device: &Path, format: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/model");
    let output = export(device, format, &out, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(names_in(out.parent().unwrap()), ["model"]);
    std::fs::read_to_string(out).unwrap()
}

#[test]
fn the_committed_modules_are_what_the_command_writes() {
    // they are compiled and compared with the model in the runtime's tests
    for name in [
        "identified",
        "parallelogram",
        "general",
        "coupled",
        "effects",
        "every_effect",
        "parallel_axes",
    ] {
        let (Some(device), Some(module)) = (
            fixture(&format!("{name}.toml")),
            fixture(&format!("{name}.rs")),
        ) else {
            return;
        };
        let committed = std::fs::read_to_string(module).unwrap();
        assert!(
            exported(&device, "rust") == committed,
            "export {name}.rs again"
        );
    }
}

#[test]
fn the_committed_headers_are_what_the_command_writes() {
    // they are compiled and compared with the modules in the runtime's tests
    for name in ["every_effect", "parallel_axes"] {
        let (Some(device), Some(header)) = (
            fixture(&format!("{name}.toml")),
            fixture(&format!("{name}.h")),
        ) else {
            return;
        };
        let committed = std::fs::read_to_string(header).unwrap();
        assert!(
            exported(&device, "c-header") == committed,
            "export {name}.h again"
        );
    }
}

#[test]
fn effects_that_a_loop_cannot_use_are_left_out_and_named() {
    let Some(path) = fixture("every_effect.toml") else {
        return;
    };
    let sandbox = Sandbox::new();
    for format in ["rust", "c-header", "json"] {
        let output = export(&path, format, &sandbox.path("out"), &[]);
        let said = text(&output.stderr);
        assert!(output.status.success(), "{said}");
        let expected = "effect `cable-scale` is left out: it shows on a sensor that a control loop does not read";
        assert!(said.contains(expected), "{said}");
        assert_eq!(said.matches("left out").count(), 1, "{said}");
        assert!(
            std::fs::read_to_string(sandbox.path("out"))
                .unwrap()
                .contains("cable-scale")
        );
    }
    let json: Value = serde_json::from_str(&exported(&path, "json")).unwrap();
    assert_eq!(json["effects_left_out"][0]["effect"], "cable-scale");
    let effects = json["effects"].as_array().unwrap();
    let of = |label: &str| {
        let found = effects.iter().find(|effect| effect["effect"] == label);
        found.unwrap_or_else(|| panic!("no {label}"))
    };
    let play = of("backlash@2");
    assert_eq!(
        (&play["law"], &play["joint"]),
        (&Value::from("Backlash"), &Value::from(2))
    );
    assert_eq!(
        (&play["width_rad"], &play["driven_by"]),
        (&Value::from(5e-4), &Value::from("hand"))
    );
    assert_eq!(
        of("tool-changed")["shift_m"],
        serde_json::json!([0.001, 0.002, -0.003])
    );
    assert_eq!(of("joint-friction@1")["side"]["travel"], 0.02);
    assert_eq!(of("joint-compliance@1")["rad_per_nm"], 1e-3);
    let curve = of("correction@1");
    assert_eq!(
        (&curve["law"], &curve["over"]),
        (&"Curve".into(), &"angle".into())
    );
    assert_eq!(
        (&curve["lower"], &curve["upper"]),
        (&(-0.3).into(), &0.35.into())
    );
    assert_eq!(curve["coefficients"][2], -2e-3);
    // a form without effects says so
    let output = export(&path, "urdf", &sandbox.path("out"), &[]);
    let said = text(&output.stderr);
    assert!(
        said.contains(
            "a URDF has no effects but friction of a joint's own row: `capstan-compliance@1`"
        ),
        "{said}"
    );
    // and so does the file
    let written = std::fs::read_to_string(sandbox.path("out")).unwrap();
    assert!(
        written.contains("joint 1 (Dahl's state over 0.02 rad)"),
        "{written}"
    );
    assert!(
        written.contains("are left out; the forms rust, c-header"),
        "{written}"
    );
}

#[test]
fn every_form_says_where_it_comes_from() {
    let sandbox = Sandbox::new();
    let device = sandbox.path("device.toml");
    let sums = Command::new("sha256sum").arg(&device).output();
    for format in ["rust", "c-header", "json"] {
        let written = exported(&device, format);
        assert!(
            written.contains("7-DOF capstan-driven haptic device"),
            "{format}"
        );
        assert!(written.contains("device.toml"), "{format}");
        assert!(written.contains(env!("CARGO_PKG_VERSION")), "{format}");
        assert!(
            !written.contains(sandbox.folder.path().to_str().unwrap()),
            "{format}"
        );
        if let Ok(sums) = &sums {
            let sum = text(&sums.stdout);
            let sum = sum.split_whitespace().next().unwrap();
            assert!(written.contains(sum), "{format}");
        }
    }
}

/// A control loop that shifted good encoders by a tracker's delay would be wrong by it: the delay is in no form, and each says why.
#[test]
fn encoders_that_are_ahead_are_left_out() {
    let sandbox = Sandbox::new();
    let ahead = "\n[[effect]]\nname = \"encoder-latency\"\ndelay_s = -0.014\n";
    let behind = "\n[[effect]]\nname = \"encoder-latency\"\ndelay_s = 0.004\n";
    sandbox.write("ahead.toml", sandbox.device_text() + ahead);
    sandbox.write("behind.toml", sandbox.device_text() + behind);
    for (form, law) in [
        ("c-header", "LATENCY"),
        ("rust", "Effect::EncoderLatency"),
        ("json", "\"EncoderLatency\""),
    ] {
        let written = exported(&sandbox.path("ahead.toml"), form);
        assert!(
            !written.contains("-0.014") && written.contains("(the tracker) is late"),
            "{form}"
        );
        let written = exported(&sandbox.path("behind.toml"), form);
        assert!(written.contains(law) && written.contains("0.004"), "{form}");
    }
}

#[test]
fn the_flat_arrays_hold_the_file_s_numbers() {
    let Some(path) = fixture("identified.toml") else {
        return;
    };
    let json: Value = serde_json::from_str(&exported(&path, "json")).unwrap();
    let device = Device::load(&path).unwrap().device;
    // serde_json reads a number to one unit in its last place
    let same = |key: &str, row: usize, there: f64| {
        let here = json["rows"][key][row].as_f64().unwrap();
        assert!(
            (here - there).abs() <= f64::EPSILON * there.abs(),
            "{key} of row {row}"
        );
    };
    for (row, link) in device.links.iter().enumerate() {
        same("a_m", row, link.a_m);
        same("alpha_rad", row, link.alpha_rad);
        same("d_m", row, link.d_m);
        same("theta_offset_rad", row, link.theta_rad);
        same("beta_rad", row, link.beta_rad);
    }
    let joints = &json["joints"];
    assert_eq!(joints["home"].as_array().unwrap().len(), 7);
    assert_eq!(joints["home"][1], device.joints[1].home_rad);
    assert_eq!(joints["lower_limit"][2], device.joints[2].lower_rad);
    assert_eq!(joints["upper_limit"][3], device.joints[3].upper_rad);
    assert_eq!(joints["transmission_error"][0], "capstan");
    assert_eq!(joints["transmission_ratio"][0], 8.0);
    assert_eq!(joints["transmission_error"][3], "chebyshev");
    assert_eq!(joints["chebyshev"][3].as_array().unwrap().len(), 25);
    assert_eq!(joints["transmission_error"][6], "none");
    assert_eq!(joints["offset"][6], Value::Null);
}

#[test]
fn json_says_what_was_written() {
    let sandbox = Sandbox::new();
    let out = sandbox.path("model.h");
    let output = export(&sandbox.path("device.toml"), "c-header", &out, &["--json"]);
    assert!(output.status.success());
    let said: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    assert_eq!(said["written"], out.to_str().unwrap());
    assert_eq!(said["format"], "c-header");
    assert_eq!(said["joints"], 7);
    assert_eq!(said["device_sha256"].as_str().unwrap().len(), 64);
}

/// Exports a changed template, and what is said of it.
fn refused(change: impl Fn(&str) -> String) -> String {
    let sandbox = Sandbox::new();
    sandbox.write("changed.toml", change(&sandbox.device_text()));
    let out = sandbox.path("model.h");
    let output = export(&sandbox.path("changed.toml"), "c-header", &out, &[]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    assert!(!out.exists());
    text(&output.stderr)
}

#[test]
fn a_device_that_the_runtime_cannot_hold_is_refused_with_joint_and_next_step() {
    let with_error = |error: &str| {
        let error = format!("[joint.transmission_error]\n{error}\n[[joint]]\nname = \"2\"");
        move |device: &str| device.replace("[[joint]]\nname = \"2\"", &error)
    };
    let said = refused(with_error("output_drum_xy_m = [0.03, 0.0]"));
    assert!(said.contains("joint 1: output_drum_xy_m"), "{said}");
    let long = format!("range_rad = [-1, 1]\nchebyshev = {:?}", [0.001; 26]);
    let said = refused(with_error(&long));
    assert!(
        said.contains("joint 1: its polynomial has 26 terms"),
        "{said}"
    );
    assert!(said.contains("--degree 24"), "{said}");
    let without_links = |device: &str| {
        let (head, rest) = device.split_once("[[link]]").unwrap();
        let joints = rest.find("[[joint]]").unwrap();
        head.to_owned() + &rest[joints..]
    };
    assert!(refused(without_links).contains("no [[link]] rows"));
}

#[test]
fn an_output_that_is_a_folder_is_refused() {
    let sandbox = Sandbox::new();
    for out in [
        sandbox.folder.path().to_owned(),
        PathBuf::from("/"),
        PathBuf::from(".."),
    ] {
        let output = export(&sandbox.path("device.toml"), "json", &out, &[]);
        assert_eq!(output.status.code(), Some(2), "{}", out.display());
        assert!(text(&output.stderr).contains("next: "));
    }
}

#[test]
fn a_name_cannot_end_the_comment_that_it_stands_in() {
    let sandbox = Sandbox::new();
    let name = r#"name = "a */ int x; /*@DATA@*/ \n \" \\ \u202e""#;
    let device =
        sandbox
            .device_text()
            .replacen("name = \"7-DOF capstan-driven haptic device\"", name, 1);
    sandbox.write("device.toml", device);
    let header = exported(&sandbox.path("device.toml"), "c-header");
    let comment = header.split("*/").next().unwrap();
    assert!(
        comment.contains("int x") && comment.contains("SHA-256"),
        "{comment}"
    );
    let module = exported(&sandbox.path("device.toml"), "rust");
    assert!(
        !module.contains('\u{202e}'),
        "rustc refuses a comment with it"
    );
    assert!(
        module.lines().take(3).all(|line| line.starts_with("// ")),
        "{module}"
    );
}

#[test]
fn joints_that_yield_are_told_where_the_form_has_rigid_ones() {
    let sandbox = Sandbox::new();
    let soft = "[[joint]]\ncompliance_rad_per_nm = 2.5e-3\nname = \"2\"";
    let device = sandbox.device_text();
    let device = device.replace("[[joint]]\nname = \"2\"", soft);
    sandbox.write("soft.toml", device);
    let said = |name: &str, format: &str| {
        let output = export(&sandbox.path(name), format, &sandbox.path("out"), &[]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    // an MJCF has a spring there
    let soft = said("soft.toml", "mjcf");
    assert!(!soft.contains("yield"), "{soft}");
    let written = std::fs::read_to_string(sandbox.path("out")).unwrap();
    assert!(
        written
            .contains("<joint name=\"2_spring\" type=\"hinge\" axis=\"0 0 1\" stiffness=\"400\"")
    );
    assert!(said("soft.toml", "urdf").contains("joint 2 yields to torque"));
    assert!(!said("device.toml", "urdf").contains("yield"));
    // these have joints that yield
    for (format, effect) in [
        (
            "rust",
            "Effect::JointCompliance { joint: 1, rad_per_nm: 0.0025 }",
        ),
        ("c-header", ".kind = HAPTICAL_JOINT_COMPLIANCE, .joint = 1"),
        ("json", "\"joint-compliance@2\""),
    ] {
        let is_of_masses = |told: &str| {
            let mut lines = told.lines();
            lines.all(|line| line.contains("masses and inertias of the links are not held"))
        };
        assert!(is_of_masses(&said("soft.toml", format)), "{format}");
        let written = std::fs::read_to_string(sandbox.path("out")).unwrap();
        assert!(written.contains(effect), "{written}");
        assert!(is_of_masses(&said("device.toml", format)), "{format}");
        let written = std::fs::read_to_string(sandbox.path("out")).unwrap();
        let none = [
            "haptical_runtime::Effect",
            ".kind = HAPTICAL_JOINT_COMPLIANCE",
            "\"effects\"",
        ];
        assert!(!none.iter().any(|own| written.contains(own)), "{written}");
    }
    assert_eq!(said("soft.toml", "toml"), "");
}
