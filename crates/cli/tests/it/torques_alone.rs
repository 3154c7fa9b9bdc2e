//! Logs of joints and torques alone: diagnosed, checked, verified; nothing to identify.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{haptical, text};

fn fixtures() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/payload")
}

/// Kilograms that the generator of the fixture puts on for the second run.
const MASS_KG: f64 = 0.4;

fn run(words: &[&str], device: &Path, log: &Path, out: &Path) -> std::process::Output {
    haptical()
        .args(words)
        .arg("--device")
        .arg(device)
        .arg("--log")
        .arg(log)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap()
}

/// The answer as JSON; the command must succeed.
fn gap(device: &Path, log: &Path, out: &Path, further: &[&str]) -> Value {
    let words = [&["diagnose", "--json"], further].concat();
    let output = run(&words, device, log, out);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn of_fixture(further: &[&str]) -> (Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("result");
    let answer = gap(
        &fixtures().join("device.toml"),
        &fixtures().join("log.csv.gz"),
        &out,
        further,
    );
    (answer, folder)
}

#[test]
fn a_payload_is_named_with_a_mass_that_holds_and_the_result_is_verified() {
    let (answer, folder) = of_fixture(&[]);
    assert_eq!(answer["verdict"], "named", "{answer}");
    let first = &answer["causes"][0];
    assert_eq!(first["effect"], "payload", "{answer}");
    let mass = &first["parameters"]["mass_kg"];
    let ends = [0, 1].map(|end| mass["ci95"][end].as_f64().unwrap());
    assert!((ends[0]..=ends[1]).contains(&MASS_KG), "{mass}");
    assert!(ends[1] - ends[0] < 0.2, "{mass}");
    assert_eq!(first["parameters"]["from_run"]["value"], 2.0);
    assert!(
        first["held_out"]["reduction_percent"].as_f64().unwrap() > 50.0,
        "{first}"
    );
    let channels = answer["gap"]["channels"].as_array().unwrap();
    let units: Vec<&str> = channels
        .iter()
        .map(|gap| gap["unit"].as_str().unwrap())
        .collect();
    assert_eq!(units, ["N m", "N m", "N", "N m"]);
    let out = folder.path().join("result");
    for name in ["gap.html", "gap.json", "report.html"] {
        assert!(out.join(name).exists(), "{name}");
    }
    let page = std::fs::read_to_string(out.join("gap.html")).unwrap();
    assert!(page.contains("payload") && page.contains("torque1"));
    let verified = haptical()
        .arg("verify")
        .arg(out.join("gap.json"))
        .arg("--device")
        .arg(fixtures().join("device.toml"))
        .arg("--log")
        .arg(fixtures().join("log.csv.gz"))
        .output()
        .unwrap();
    assert_eq!(
        verified.status.code(),
        Some(0),
        "{}",
        text(&verified.stderr)
    );
}

#[test]
fn left_out_of_the_catalogue_it_is_not_named() {
    let (answer, _folder) = of_fixture(&["--without=payload"]);
    let causes = answer["causes"].as_array().unwrap();
    assert!(
        causes.iter().all(|cause| cause["effect"] != "payload"),
        "{answer}"
    );
    assert_ne!(answer["verdict"], "no-gap");
}

/// The log of the fixture as text.
fn lines() -> String {
    let whole = std::fs::read(fixtures().join("log.csv.gz")).unwrap();
    let mut lines = String::new();
    std::io::Read::read_to_string(
        &mut flate2::read::GzDecoder::new(whole.as_slice()),
        &mut lines,
    )
    .unwrap();
    lines
}

/// The fixture's runs as logs of their own.
fn runs(folder: &Path) -> [PathBuf; 2] {
    let lines = lines();
    ["1,", "2,"].map(|run| {
        let kept = lines
            .lines()
            .filter(|line| line.starts_with("run") || line.starts_with(run));
        let text: String = kept.map(|line| format!("{line}\n")).collect();
        let path = folder.join(format!("log{}.csv", &run[..1]));
        std::fs::write(&path, text).unwrap();
        path
    })
}

/// All joints of the fixture rub. What a first log shows of it is in corrected.toml, and with that model little of it is left
/// in a second log.
#[test]
fn a_model_with_friction_takes_it_off_another_log() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = runs(folder.path());
    let (device, out) = (fixtures().join("device.toml"), folder.path().join("result"));
    let found = gap(&device, &first, &out, &[]);
    let causes = found["causes"].as_array().unwrap();
    assert!(
        causes.len() == 4
            && causes
                .iter()
                .all(|cause| cause["effect"] == "joint-friction"),
        "{found}"
    );
    let model = format!("--model={}", out.join("corrected.toml").display());
    let without = gap(&device, &second, &folder.path().join("without"), &[]);
    let with = gap(&device, &second, &folder.path().join("with"), &[&model]);
    let before = |answer: &Value, index: usize| {
        let channels = &answer["gap"]["channels"];
        let own = &channels[index];
        let name = own["channel"].as_str().unwrap().to_owned();
        (name, own["rms_before"].as_f64().unwrap())
    };
    for index in 0..4 {
        let (name, with_nm) = before(&with, index);
        let others = (0..4).map(|index| before(&without, index));
        let (_, without_nm) = others.into_iter().find(|own| own.0 == name).unwrap();
        assert!(
            with_nm < 0.35 * without_nm,
            "{name}: {with_nm} {without_nm}"
        );
    }
}

#[test]
fn a_second_log_is_predicted_and_another_payload_on_it_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = runs(folder.path());
    let out = folder.path().join("result");
    let validate = format!("--validate={}", second.display());
    let answer = gap(
        &fixtures().join("device.toml"),
        &first,
        &out,
        &[validate.as_str()],
    );
    let causes = answer["causes"].as_array().unwrap();
    assert!(
        causes.iter().all(|cause| cause["effect"] != "payload"),
        "{answer}"
    );
    let warnings = answer["warnings"].to_string();
    assert!(warnings.contains("in the second recording"), "{warnings}");
    let predictions = std::fs::read_to_string(out.join("predictions.csv")).unwrap();
    assert!(predictions.contains("torque3"), "{}", predictions.len());
}

#[test]
fn nothing_is_identified_and_the_next_step_is_a_diagnosis() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(
        &["identify"],
        &fixtures().join("device.toml"),
        &fixtures().join("log.csv.gz"),
        &folder.path().join("result"),
    );
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("no measurement") && said.contains("haptical diagnose"),
        "{said}"
    );
}

#[test]
fn a_check_says_what_such_a_log_is_good_for() {
    let check = |further: &[&str]| {
        haptical()
            .arg("check")
            .arg(fixtures().join("device.toml"))
            .arg(fixtures().join("log.csv.gz"))
            .args(further)
            .output()
            .unwrap()
    };
    let output = check(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    for wanted in ["torque3", "payload", "2 runs", "joint-friction", "geometry"] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
    let json: Value = serde_json::from_slice(&check(&["--json"]).stdout).unwrap();
    assert_eq!(json["log"]["channels"][2]["unit"], "N");
    assert!(json["log"]["good_for"].as_array().unwrap().len() > 2);
}
