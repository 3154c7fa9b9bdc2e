//! init, check, completions, help and version.

use std::process::{Command, Stdio};

use crate::{Sandbox, haptical, names_in, text};

const MANIFEST: &str = env!("CARGO_MANIFEST_DIR");

/// A file of the project's fixtures; a packaged crate has none, and says that it skips.
fn fixture(path: &str) -> Option<String> {
    let read = std::fs::read_to_string(format!("{MANIFEST}/../../fixtures/{path}"));
    if read.is_err() {
        println!("skipped: fixtures/{path} is not here");
    }
    read.ok()
}

#[test]
fn the_template_is_the_device_of_the_fixtures() {
    let Some(fixture) = fixture("devices/haptic7.toml") else {
        return;
    };
    let asset = std::fs::read_to_string(format!("{MANIFEST}/assets/haptic7.toml")).unwrap();
    assert_eq!(asset, fixture);
    assert_eq!(Sandbox::new().device_text(), fixture);
}

#[test]
fn the_sample_log_is_the_one_of_the_fixtures() {
    let Some(fixture) = fixture("logs/haptic7-sample.csv") else {
        return;
    };
    assert!(Sandbox::new().log_text() == fixture);
}

#[test]
fn init_does_not_overwrite() {
    let sandbox = Sandbox::new();
    sandbox.write("device.toml", "mine");
    let folder = sandbox.folder.path();
    haptical()
        .arg("init")
        .arg(folder)
        .assert()
        .code(2)
        .stderr(predicates::str::contains("--force"));
    assert_eq!(sandbox.device_text(), "mine");
    haptical()
        .arg("init")
        .arg(folder)
        .arg("--force")
        .assert()
        .success();
    assert_ne!(sandbox.device_text(), "mine");
    assert_eq!(names_in(folder), ["device.toml", "log.csv"]);
}

#[test]
fn the_command_that_init_prints_runs() {
    let folder = tempfile::tempdir().unwrap();
    let output = haptical().arg("init").arg(folder.path()).output().unwrap();
    let said = text(&output.stdout);
    let line = said.lines().last().unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[0], "haptical");
    haptical().args(&words[1..]).assert().success();
    assert_eq!(names_in(&folder.path().join("result")).len(), 4);
}

#[test]
fn check_says_what_the_log_could_identify() {
    let sandbox = Sandbox::new();
    let check = |further: &[&str]| {
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .args(["check", "device.toml"])
            .args(further)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    assert!(check(&[]).contains("The device file is valid."));
    let said = check(&["log.csv"]);
    for wanted in [
        "400 rows",
        "cable (400)",
        "ratio_deviation3",
        "alpha7 has no effect",
    ] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
    let found: serde_json::Value = serde_json::from_str(&check(&["log.csv", "--json"])).unwrap();
    assert_eq!(found["log"]["rows"], 400);
    assert_eq!(
        found["device"]["joints"][3]["transmission"],
        "parallelogram"
    );
    let judged = &found["log"]["identifiability"];
    let identifiable = found["log"]["identifiable"].as_array().unwrap().len();
    let refused = found["log"]["not_identified"].as_array().unwrap();
    assert_eq!(judged["candidates"], identifiable + refused.len());
    let names: Vec<&str> = refused
        .iter()
        .map(|entry| entry["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["alpha0", "d0", "theta0", "alpha7"]);
    // Row 0 is 0.25 m long and theta1 turns about an axis across it: 1 / 0.25 rad for each metre.
    assert_eq!(refused[1]["reason"], "d0 acts like +4.000000 theta1");
}

/// Names that `check` says could be identified, those that it says not, and what `identify` says of both.
fn judged_by_both(
    device: &str,
    log: &str,
    flags: &[&str],
    root: &std::path::Path,
) -> [Vec<String>; 4] {
    let run = |words: &[&str]| {
        let output = haptical()
            .current_dir(root)
            .args(words)
            .args(flags)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let names = |list: &serde_json::Value,
                 of: &dyn Fn(&serde_json::Value) -> Option<String>|
     -> Vec<String> {
        let mut names: Vec<String> = list.as_array().unwrap().iter().filter_map(of).collect();
        names.sort();
        names
    };
    let checked = run(&["check", device, log, "--json"]);
    let out = root.join("both");
    let found = run(&[
        "identify",
        "--device",
        device,
        "--log",
        log,
        "--out",
        out.to_str().unwrap(),
        "--force",
        "--json",
    ]);
    let plain = |name: &serde_json::Value| name.as_str().map(str::to_owned);
    let named = |entry: &serde_json::Value| plain(&entry["name"]);
    let valued =
        |entry: &serde_json::Value| entry["value"].as_f64().and_then(|_| plain(&entry["name"]));
    [
        names(&checked["log"]["identifiable"], &plain),
        names(&found["parameters"], &valued),
        names(&checked["log"]["not_identified"], &named),
        names(&found["not_identified"], &named),
    ]
}

/// The drives' forms are those that the samples support: a polynomial has not eleven numbers in one command and five in the
/// other.
#[test]
fn check_and_identify_count_alike() {
    let sandbox = Sandbox::new();
    let root = sandbox.folder.path();
    let [could, did, could_not, did_not] = judged_by_both("device.toml", "log.csv", &[], root);
    assert_eq!(could, did);
    assert_eq!(could_not, did_not);
    assert!(
        could.iter().any(|name| name == "chebyshev4[4]")
            && !could.iter().any(|name| name == "chebyshev4[9]")
    );
    // few samples support few terms of equation (1): the others are held, and both say so
    let few: String = sandbox
        .log_text()
        .lines()
        .take(41)
        .map(|line| line.to_owned() + "\n")
        .collect();
    sandbox.write("few.csv", few);
    let device = sandbox.device_text();
    let rows = device.find("[[link]]").unwrap()..device.find("[[joint]]").unwrap();
    let drives = device.replacen(&device[rows], "", 1);
    sandbox.write(
        "drives.toml",
        drives.split("[cable_encoder]").next().unwrap(),
    );
    let [could, did, could_not, did_not] = judged_by_both("drives.toml", "few.csv", &[], root);
    assert_eq!((could.len(), could_not.len()), (did.len(), did_not.len()));
    assert_eq!(could, did);
    assert!(
        could_not.iter().any(|name| name.starts_with("input_drum")),
        "{could_not:?}"
    );
}

#[test]
fn check_without_external_encoders_says_which_offsets_merge() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    for joint in 1..=4 {
        let gone = crate::column(&cells, &format!("out{joint}_rad"));
        cells.iter_mut().for_each(|row| drop(row.remove(gone)));
    }
    sandbox.write_log(&cells);
    let output = haptical()
        .current_dir(sandbox.folder.path())
        .args(["check", "device.toml", "log.csv"])
        .output()
        .unwrap();
    let said = text(&output.stdout);
    for joint in 1..=3 {
        let wanted = format!("offset{joint} acts like +1.000000 theta{joint}");
        assert!(said.contains(&wanted), "{wanted}: {said}");
    }
}

#[test]
fn check_refuses_what_identify_refuses() {
    let sandbox = Sandbox::new();
    sandbox.write("log.csv", "theta1_rad\n0\n1\n");
    haptical()
        .current_dir(sandbox.folder.path())
        .args(["check", "device.toml", "log.csv"])
        .assert()
        .code(2)
        .stderr(predicates::str::contains("missing `theta2_rad`"));
}

#[test]
fn every_help_has_an_example() {
    for words in [
        &[][..],
        &["identify"],
        &["diagnose"],
        &["check"],
        &["init"],
        &["completions"],
    ] {
        let output = haptical().args(words).arg("--help").output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert!(
            text(&output.stdout).contains("Example:\n  haptical"),
            "{words:?}"
        );
        assert!(output.stderr.is_empty());
    }
}

#[test]
fn the_version_is_the_package_version() {
    let said = text(&haptical().arg("--version").output().unwrap().stdout);
    assert_eq!(said, format!("haptical {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn completions_know_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let output = haptical().args(["completions", shell]).output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        let script = text(&output.stdout);
        // A name of an effect is a completion of --without.
        for word in [
            "identify",
            "held-out",
            "diagnose",
            "without",
            "capstan-compliance",
        ] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_haptical"))
        .args(["completions", "zsh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stderr), "");
}

/// A device file is somebody else's: its name must not reach the terminal as a command to it.
#[test]
fn a_name_does_not_steer_the_terminal() {
    let sandbox = Sandbox::new();
    let name = r#"name = "arm \u001b[2J\u001b]0;owned\u0007""#;
    let device = sandbox.device_text();
    let named = device.replacen("name = \"7-DOF capstan-driven haptic device\"", name, 1);
    assert_ne!(named, device);
    sandbox.write("device.toml", named);
    let output = haptical()
        .arg("check")
        .arg(sandbox.path("device.toml"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("arm  [2J ]0;owned"), "{said}");
    assert!(
        !said.contains('\u{1b}') && !said.contains('\u{7}'),
        "{said}"
    );
}

#[test]
fn the_catalogue_is_listed_without_a_device_and_a_log() {
    let list = |further: &[&str]| {
        let arguments = ["diagnose", "--list"].iter().chain(further);
        let output = haptical().args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let table = list(&[]);
    assert!(table.contains("stiffness_nm_per_rad [N m/rad]"), "{table}");
    let json: serde_json::Value = serde_json::from_str(&list(&["--json"])).unwrap();
    let effects = json.as_array().unwrap();
    let backlash = effects.iter().find(|effect| effect["name"] == "backlash");
    let width = &backlash.unwrap()["parameters"][0];
    assert_eq!(
        (&width["name"], &width["unit"]),
        (&"width_rad".into(), &"rad".into())
    );
    for missing in [&["--device", "device.toml"][..], &[]] {
        let refused = haptical().arg("diagnose").args(missing).output().unwrap();
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains("--log"));
    }
}
