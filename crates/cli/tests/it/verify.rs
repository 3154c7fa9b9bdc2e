//! `haptical verify`: the same bytes, the same numbers, and every kind of change.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::moving_log::moving_log;
use crate::resealed::{reseal, sha256_of};
use crate::{Sandbox, haptical, names_in, text};

fn verify(folder: &Path, words: &[&str]) -> Output {
    haptical()
        .current_dir(folder)
        .arg("verify")
        .args(words)
        .output()
        .unwrap()
}

fn identified() -> Sandbox {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    sandbox
}

/// With a second log, an earlier model, and effects left out.
fn diagnosed() -> Sandbox {
    let sandbox = Sandbox::new();
    let device = sandbox.device_text();
    for (part, name) in [(1, "log.csv"), (2, "log2.csv")] {
        sandbox.write(name, moving_log(&device, 1e-3, part));
    }
    let further = ["--validate", "log2.csv", "--without", "backlash,hysteresis"];
    let output = sandbox.diagnose(&further);
    assert!(output.status.success(), "{}", text(&output.stderr));
    sandbox
}

/// Runs verify in the sandbox: its status, and what it found.
fn found(sandbox: &Sandbox) -> (i32, Value) {
    let output = verify(&sandbox.path("."), &["result", "--json"]);
    let value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output.status.code().unwrap(), value)
}

fn file<'a>(found: &'a Value, name: &str) -> &'a Value {
    let files = found["results"][0]["files"].as_array().unwrap();
    files.iter().find(|file| file["file"] == name).unwrap()
}

#[test]
fn an_identification_gives_the_same_bytes_again() {
    let sandbox = Sandbox::new();
    let cases: [&[&str]; 5] = [
        &[],
        &["--method", "two-step", "--degree", "5"],
        &["--noise", "stated", "--held-out", "0.3"],
        &["--paper-preset", "--held-out", "0"],
        &["--input-drum-denominator-m", "0.0031"],
    ];
    for options in cases {
        assert!(sandbox.identify(options).status.success());
        let before = names_in(&sandbox.path("result"));
        let output = verify(&sandbox.path("."), &["result"]);
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{options:?}: {said}");
        assert_eq!(said.matches("the same bytes\n").count(), 4, "{said}");
        assert!(
            said.contains("Verified: these inputs give the same bytes."),
            "{said}"
        );
        assert!(output.stderr.is_empty());
        assert_eq!(
            names_in(&sandbox.path("result")),
            before,
            "nothing is written"
        );
    }
}

#[test]
fn a_diagnosis_gives_the_same_bytes_again_and_its_predictions_too() {
    let sandbox = diagnosed();
    let (status, said) = found(&sandbox);
    assert_eq!(
        (status, &said["verdict"]),
        (0, &"same-bytes".into()),
        "{said:#}"
    );
    let result = &said["results"][0];
    assert_eq!(result["command"], "diagnose");
    for name in ["gap.json", "gap.html", "predictions.csv"] {
        assert_eq!(file(&said, name)["agreement"], "same-bytes");
    }
    let flags: Vec<&str> = result["inputs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|input| input["flag"].as_str().unwrap())
        .collect();
    assert_eq!(flags, ["device", "log", "validate"]);
}

#[test]
fn a_result_says_what_it_was_made_from() {
    let sandbox = diagnosed();
    let gap: Value =
        serde_json::from_slice(&std::fs::read(sandbox.path("result/gap.json")).unwrap()).unwrap();
    let provenance = &gap["provenance"];
    assert_eq!(provenance["haptical_version"], env!("CARGO_PKG_VERSION"));
    let thresholds = provenance["thresholds"].as_str().unwrap();
    assert!(u64::from_str_radix(thresholds, 16).is_ok() && thresholds.len() == 16);
    assert_eq!(provenance["seeds"]["bootstrap"], 1);
    assert_eq!(provenance["arguments"][3], "--without=backlash,hysteresis");
    for (index, name) in ["device.toml", "log.csv", "log2.csv"].iter().enumerate() {
        let input = &provenance["inputs"][index];
        assert_eq!(input["file"], *name);
        assert_eq!(input["sha256"], sha256_of(&sandbox.path(name)));
    }
    let page = std::fs::read_to_string(sandbox.path("result/gap.html")).unwrap();
    for wanted in [sha256_of(&sandbox.path("log2.csv")).as_str(), "bootstrap 1"] {
        assert!(page.contains(wanted), "{wanted}");
    }
    for output in provenance["outputs"].as_array().unwrap() {
        let path = sandbox
            .path("result")
            .join(output["file"].as_str().unwrap());
        assert_eq!(output["sha256"], sha256_of(&path));
    }
    let sandbox = identified();
    let device = std::fs::read_to_string(sandbox.path("result/identified.toml")).unwrap();
    for wanted in [
        "# provenance: version: haptical ",
        "# provenance: command line: haptical identify --device device.toml --log log.csv --method joint",
        &sha256_of(&sandbox.path("log.csv")),
        "# provenance: seeds: none",
        "weak_share 0.5",
    ] {
        assert!(device.contains(wanted), "{wanted}");
    }
}

/// Changes the digit at a byte into another one that can begin a number.
fn other_digit(bytes: &mut [u8], at: usize) {
    bytes[at] = b'1' + (bytes[at] - b'0') % 9;
}

/// Changes one digit of a file at places from its start to its end, and looks whether it is found.
fn every_changed_digit_is_found(sandbox: &Sandbox, name: &str, places: usize) {
    let path = sandbox.path("result").join(name);
    let whole = std::fs::read(&path).unwrap();
    let digits: Vec<usize> = (0..whole.len())
        .filter(|&at| whole[at].is_ascii_digit())
        .collect();
    for place in 0..places {
        let at = digits[(2 * place + 1) * digits.len() / (2 * places)];
        let mut changed = whole.clone();
        other_digit(&mut changed, at);
        std::fs::write(&path, &changed).unwrap();
        let (status, said) = found(sandbox);
        let line = String::from_utf8_lossy(&whole[at.saturating_sub(60)..at + 1]);
        // A digit of an input's hash makes the input another file: status 2.
        assert!((1..=2).contains(&status), "{name}, after {line}: {said:#}");
        if status == 1 {
            assert_eq!(file(&said, name)["agreement"], "differs");
            assert_eq!(file(&said, name)["changed_since_written"], true);
        }
    }
    std::fs::write(&path, &whole).unwrap();
    assert_eq!(found(sandbox).0, 0);
}

#[test]
fn a_changed_digit_of_an_identification_is_found() {
    let sandbox = identified();
    for name in ["identified.json", "identified.toml", "identify.html"] {
        every_changed_digit_is_found(&sandbox, name, 6);
    }
}

#[test]
fn a_changed_digit_of_a_diagnosis_is_found() {
    let sandbox = diagnosed();
    for name in ["gap.json", "predictions.csv", "gap.html"] {
        every_changed_digit_is_found(&sandbox, name, 3);
    }
}

/// Replaces the number of the first line that begins so.
fn replace_number(text: &str, begins: &str, change: impl Fn(f64) -> f64) -> (String, [f64; 2]) {
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with(begins))
        .unwrap();
    let (_, number) = line.split_once(begins).unwrap();
    let was: f64 = number.trim_end_matches(',').parse().unwrap();
    let is = change(was);
    let new = line.replace(number.trim_end_matches(','), &format!("{is:?}"));
    (text.replacen(line, &new, 1), [was, is])
}

#[test]
fn a_changed_number_is_told_with_both_values() {
    let sandbox = identified();
    let cases = [
        ("identified.toml", "alpha_rad = ", "link[0].alpha_rad"),
        (
            "identified.json",
            "\"rms_after\": ",
            "channels[0].rms_after",
        ),
    ];
    for (name, begins, place) in cases {
        let path = sandbox.path("result").join(name);
        let whole = std::fs::read_to_string(&path).unwrap();
        let (changed, [was, is]) = replace_number(&whole, begins, |number| 1.5 * number);
        std::fs::write(&path, changed).unwrap();
        let (status, said) = found(&sandbox);
        assert_eq!(status, 1);
        let difference = &file(&said, name)["differences"][0];
        assert_eq!(difference["where"], place);
        assert_eq!(difference["recorded"], format!("{is:?}"));
        assert_eq!(difference["recomputed"], format!("{was:?}"));
        let plain = verify(&sandbox.path("."), &["result"]);
        let said = text(&plain.stdout);
        let line = format!("{place}: recorded {is:?}, recomputed {was:?}");
        assert!(
            said.contains(&line) && said.contains("Not verified"),
            "{said}"
        );
        std::fs::write(&path, whole).unwrap();
    }
}

/// A result that another machine wrote has its own digits and hashes that fit them.
#[test]
fn another_machine_may_differ_by_a_billionth_and_no_more() {
    for (share, status, verdict) in [(4e-10, 0, "same-numbers"), (4e-9, 1, "differs")] {
        let sandbox = identified();
        let path = sandbox.path("result/identified.json");
        let whole = std::fs::read_to_string(&path).unwrap();
        let change = |number: f64| number * (1.0 + share);
        let (changed, _) = replace_number(&whole, "\"rms_after\": ", change);
        std::fs::write(&path, changed).unwrap();
        reseal(&sandbox.path("result"), "identified.json");
        let (got, said) = found(&sandbox);
        assert_eq!(
            (got, &said["verdict"]),
            (status, &verdict.into()),
            "{said:#}"
        );
        let json = file(&said, "identified.json");
        assert_eq!(json["changed_since_written"], false);
        if status == 0 {
            let largest = json["largest_relative_difference"].as_f64().unwrap();
            assert!((largest / share - 1.0).abs() < 1e-3, "{largest}");
        }
    }
}

#[test]
fn another_version_is_said_and_recomputed() {
    let sandbox = identified();
    let version = env!("CARGO_PKG_VERSION");
    // its hash is its own
    std::fs::remove_file(sandbox.path("result/report.html")).unwrap();
    for name in names_in(&sandbox.path("result")) {
        let path = sandbox.path("result").join(name);
        let whole = std::fs::read_to_string(&path).unwrap();
        let other = whole
            .replace(&format!("haptical {version}"), "haptical 0.0.9")
            .replace(&format!("version\": \"{version}"), "version\": \"0.0.9");
        assert_ne!(other, whole);
        std::fs::write(path, other).unwrap();
    }
    reseal(&sandbox.path("result"), "identified.json");
    let output = verify(&sandbox.path("."), &["result"]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("written by version 0.0.9"), "{said}");
    assert!(
        said.contains(&format!("another version: {version}")),
        "{said}"
    );
    assert!(said.contains("the same bytes."), "{said}");
}

#[test]
fn a_moved_folder_is_verified_from_anywhere() {
    let sandbox = identified();
    let moved = tempfile::tempdir().unwrap();
    let folder = moved.path().join("elsewhere");
    std::fs::create_dir(&folder).unwrap();
    for name in names_in(&sandbox.path(".")) {
        std::fs::rename(sandbox.path(&name), folder.join(&name)).unwrap();
    }
    for (from, result) in [
        (".", "elsewhere/result"),
        ("elsewhere", "result/identified.json"),
        ("elsewhere/result", "."),
    ] {
        let output = verify(&moved.path().join(from), &[result]);
        let said = text(&output.stderr) + &text(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{from} {result}: {said}");
        assert!(said.contains("these inputs give the same bytes"), "{said}");
    }
    // The result alone, its inputs where the flags say, under other names.
    let alone = tempfile::tempdir().unwrap();
    std::fs::rename(folder.join("result"), alone.path().join("result")).unwrap();
    std::fs::rename(folder.join("log.csv"), folder.join("another name.csv")).unwrap();
    let output = haptical()
        .current_dir(alone.path())
        .args(["verify", "result", "--device"])
        .arg(folder.join("device.toml"))
        .arg("--log")
        .arg(folder.join("another name.csv"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("the same bytes."));
}

#[test]
fn two_results_in_one_folder_are_both_verified() {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&[]).status.success());
    assert!(sandbox.diagnose(&[]).status.success());
    let (status, said) = found(&sandbox);
    assert_eq!(status, 0, "{said:#}");
    assert_eq!(said["results"].as_array().unwrap().len(), 2);
    assert_eq!(file(&said, "identify.html")["agreement"], "same-bytes");
    assert_eq!(said["indexes"][0]["agreement"], "same-bytes");
}

#[test]
fn a_changed_digit_of_the_index_is_found() {
    let sandbox = identified();
    let path = sandbox.path("result/report.html");
    let page = std::fs::read_to_string(&path).unwrap();
    let digit = page.find(" parameters identified").unwrap() - 1;
    let mut changed = page.into_bytes();
    other_digit(&mut changed, digit);
    std::fs::write(&path, changed).unwrap();
    let (status, said) = found(&sandbox);
    assert_eq!((status, &said["verdict"]), (1, &"differs".into()));
    assert_eq!(said["indexes"][0]["changed_since_written"], true);
}

/// An identification and a diagnosis in a folder, a plan in a folder of it, an identification of another log.
fn four_results() -> Sandbox {
    let sandbox = identified();
    assert!(sandbox.diagnose(&[]).status.success());
    let device = sandbox.device_text();
    sandbox.write("moving.csv", moving_log(&device, 1e-3, 1));
    for words in [
        "plan --device device.toml --measure out,cable --out result/inner/plan",
        "identify --device device.toml --log moving.csv --out second --held-out 0",
    ] {
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .args(words.split(' '))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    sandbox
}

#[test]
fn every_result_in_a_folder_and_in_its_folders_is_checked() {
    let sandbox = four_results();
    let run = || {
        let output = verify(&sandbox.path("."), &[".", "--json"]);
        let value: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code().unwrap(), value)
    };
    let (status, said) = run();
    assert_eq!(
        (status, &said["verdict"]),
        (0, &"same-bytes".into()),
        "{said:#}"
    );
    let results: Vec<&str> = said["results"]
        .as_array()
        .unwrap()
        .iter()
        .map(|result| result["result"].as_str().unwrap())
        .collect();
    assert_eq!(
        results,
        [
            "./result/identified.json",
            "./result/gap.json",
            "./result/inner/plan/plan.json",
            "./second/identified.json"
        ]
    );
    assert_eq!(said["indexes"].as_array().unwrap().len(), 3);
    // one cannot be checked: the others are
    std::fs::remove_file(sandbox.path("moving.csv")).unwrap();
    let (status, said) = run();
    assert_eq!((status, &said["verdict"]), (2, &"undecided".into()));
    assert_eq!(said["results"][3]["error"]["kind"], "missing-input");
    assert_eq!(said["results"][2]["files"][0]["agreement"], "same-bytes");
    let plain = text(&verify(&sandbox.path("."), &["."]).stdout);
    for wanted in [
        "./second/identified.json: not checked\nerror: ",
        "Not verified: a result could not be checked.",
    ] {
        assert!(plain.contains(wanted), "{wanted}: {plain}");
    }
    // and what differs is said whatever else cannot be checked
    let path = sandbox.path("result/inner/plan/plan.json");
    let plan = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, plan.replacen("\"rank\": ", "\"rank\": 1", 1)).unwrap();
    let (status, said) = run();
    assert_eq!((status, &said["verdict"]), (1, &"differs".into()));
}

#[test]
fn a_file_that_is_gone_is_missing_in_a_folder_only() {
    let sandbox = identified();
    std::fs::remove_file(sandbox.path("result/identified.toml")).unwrap();
    let (status, said) = found(&sandbox);
    assert_eq!(status, 1);
    assert_eq!(file(&said, "identified.toml")["agreement"], "missing");
    let output = verify(&sandbox.path("."), &["result/identified.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));
    assert!(text(&output.stdout).contains("not kept with this result"));
}

#[test]
fn a_model_identified_earlier_is_an_input_too() {
    let sandbox = identified();
    std::fs::rename(sandbox.path("result"), sandbox.path("model")).unwrap();
    let output = sandbox.diagnose(&["--model", "model/identified.toml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(found(&sandbox).0, 0);
    let model = std::fs::read_to_string(sandbox.path("model/identified.toml")).unwrap();
    sandbox.write("model/identified.toml", model + "# a note\n");
    let output = verify(&sandbox.path("."), &["result"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("as --model") && said.contains("model/identified.toml"),
        "{said}"
    );
}

#[test]
fn an_identified_device_that_is_identified_again_says_so_once() {
    let sandbox = identified();
    let first = std::fs::read_to_string(sandbox.path("result/identified.toml")).unwrap();
    sandbox.write("device.toml", &first);
    assert!(sandbox.identify(&[]).status.success());
    assert_eq!(found(&sandbox).0, 0);
    let second = std::fs::read_to_string(sandbox.path("result/identified.toml")).unwrap();
    let count = |text: &str| text.matches("# provenance: ").count();
    assert_eq!(count(&first), count(&second));
    assert!(second.contains(&sha256_of(&sandbox.path("device.toml"))));
}
