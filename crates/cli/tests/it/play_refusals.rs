//! `haptical play` with bad input: status 2, what is wrong and what to do next, and no file.

use serde_json::Value;

use crate::play_log::Played;
use crate::{names_in, text};

/// A lever on a base: another device, sound in itself.
const LEVER: &str = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.1\n\
                     [[link]]\na_m = 0.2\nalpha_rad = 0.0\nd_m = 0.0\n\
                     [[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";

/// Runs to a page in a new folder; the run must be refused, name `kind`, and leave nothing there.
fn refused(played: &Played, kind: &str, further: &[&str]) -> String {
    let mut all = vec!["--out", "pages/page.html", "--json"];
    all.extend(further);
    let output = played.play(&all);
    let error: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert_eq!(error["error"]["kind"], kind, "{error}");
    assert!(!error["error"]["next"].as_str().unwrap().is_empty());
    assert_eq!(names_in(&played.path("pages")), Vec::<String>::new());
    text(&output.stderr)
}

#[test]
fn a_model_of_another_device() {
    let played = Played::new();
    played.write("lever.toml", LEVER);
    let said = refused(&played, "other-device", &["--model", "lever.toml"]);
    assert!(
        said.contains("the model has 1 joints, the device has 7"),
        "{said}"
    );
    assert!(said.contains("lever.toml"), "{said}");

    let device = std::fs::read_to_string(played.path("device.toml")).unwrap();
    let modified = device.replacen("[device]", "[device]\nconvention = \"modified\"", 1);
    played.write("modified.toml", modified);
    let said = refused(&played, "other-device", &["--model", "modified.toml"]);
    assert!(said.contains("convention"), "{said}");
}

#[test]
fn a_log_without_rows() {
    let played = Played::new();
    let log = std::fs::read_to_string(played.path("log.csv")).unwrap();
    played.write("log.csv", log.lines().next().unwrap());
    let said = refused(&played, "no-rows", &[]);
    assert!(said.contains("no rows below the header"), "{said}");
}

#[test]
fn a_device_without_links() {
    let played = Played::new();
    let joint = "[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";
    played.write("device.toml", joint);
    played.write("log.csv", "theta1_rad,out1_rad\n0.1,0.1\n0.2,0.2\n");
    let said = refused(&played, "no-links", &[]);
    assert!(
        said.contains("no arm to draw") && said.contains("[[link]]"),
        "{said}"
    );
}

#[test]
fn a_place_that_cannot_be_written_to() {
    let played = Played::new();
    for out in ["device.toml/page.html", ".", "/proc/page.html"] {
        let output = played.play(&["--out", out]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{out}: {said}");
        assert!(said.contains("cannot write"), "{out}: {said}");
    }
    let names = names_in(&played.path("."));
    assert_eq!(names, ["device.toml", "log.csv", "truth.toml"]);
}

#[test]
fn every_zeroth_row() {
    let said = refused(&Played::new(), "arguments", &["--every", "0"]);
    assert!(said.contains("--every"), "{said}");
}

#[test]
fn an_arm_too_long_to_be_drawn() {
    let played = Played::new();
    let device = std::fs::read_to_string(played.path("device.toml")).unwrap();
    played.write(
        "device.toml",
        device.replacen("a_m = 0.25", "a_m = 2.5e7", 1),
    );
    let said = refused(&played, "too-far", &[]);
    assert!(
        said.contains("log.csv:2") && said.contains("metres"),
        "{said}"
    );
}

#[test]
fn a_wild_reading() {
    let mut played = Played::new();
    played.recording.cable_m[0].as_mut().unwrap()[3] = 1e200;
    played.write_log();
    let output = played.play(&["--out", "page.html"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    assert!(
        text(&output.stderr).contains("cable"),
        "{}",
        text(&output.stderr)
    );
    assert!(!played.path("page.html").exists());
}

#[test]
fn a_log_of_readings_alone_plays_the_arm_and_says_so() {
    let mut played = Played::new();
    played.recording.output.fill(None);
    played.recording.cable_m = vec![None];
    played.recording.position_m = None;
    played.write_log();
    let output = played.play(&["--out", "page.html"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("without errors"),
        "{}",
        text(&output.stderr)
    );
    let page = std::fs::read_to_string(played.path("page.html")).unwrap();
    assert!(page.contains("so there are no errors"));
}

#[test]
fn a_tracker_in_its_own_frame_is_played_where_it_fits_best() {
    let played = Played::new();
    let device = std::fs::read_to_string(played.path("device.toml")).unwrap();
    let tracker = "[tracker]\nbase = \"unknown\"\ntool = \"known\"\nposition_sd_m = 1e-4\n\
                   rotation_sd_rad = 1e-3\n";
    played.write("device.toml", format!("{device}\n{tracker}"));
    let output = played.play(&["--out", "page.html"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let data = crate::play_log::data(&std::fs::read_to_string(played.path("page.html")).unwrap());
    // the log's tracker is in frame (-1), so the frame found is that one
    let tracked = &data["tracked_um"][0];
    let handle = data["origins_um"][0].as_array().unwrap();
    for (axis, origin) in handle[handle.len() - 3..].iter().enumerate() {
        let apart_um = tracked[axis].as_i64().unwrap() - origin.as_i64().unwrap();
        assert!(apart_um.abs() < 20_000, "{axis}: {apart_um}");
    }
    assert_eq!(data["channels"].as_array().unwrap().len(), 6);
}

#[test]
fn a_model_with_another_name_is_played_with_a_warning() {
    let played = Played::new();
    let truth = std::fs::read_to_string(played.path("truth.toml")).unwrap();
    let renamed = truth.replacen(
        "name = \"7-DOF capstan-driven haptic device\"",
        "name = \"the one next to it\"",
        1,
    );
    played.write("truth.toml", renamed);
    let output = played.play(&["--out", "page.html", "--model", "truth.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("the model is called \"the one next to it\""));
}
