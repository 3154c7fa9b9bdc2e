//! `haptical` alone, and the examples of `haptical init`: every command that they print runs.

use std::path::Path;

use crate::{haptical, text};

/// Runs the command alone in a folder; what it prints for programs has the same commands.
fn alone(folder: &Path) -> String {
    let ran = |words: &[&str]| {
        let output = haptical().current_dir(folder).args(words).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let said = ran(&[]);
    let json: serde_json::Value = serde_json::from_str(&ran(&["--json"])).unwrap();
    for step in json["next"].as_array().unwrap() {
        let (what, command) = (&step["what"], &step["command"]);
        let line = format!(
            "  {}\n      {}\n",
            what.as_str().unwrap(),
            command.as_str().unwrap()
        );
        assert!(said.contains(&line), "{said}");
    }
    said
}

/// Commands of a text, one a line.
fn commands(text: &str) -> Vec<String> {
    let own = text.lines().filter(|line| line.starts_with(' '));
    own.filter_map(|line| line.trim().strip_prefix("haptical "))
        .map(str::to_owned)
        .collect()
}

/// Runs a command, whose words have no blanks.
fn run(folder: &Path, command: &str) -> String {
    let mut program = haptical();
    let output = program
        .current_dir(folder)
        .args(command.split(' '))
        .output()
        .unwrap();
    let said = text(&output.stderr);
    // the doctor's status says that it found something
    let is_done = output.status.success() || output.status.code() == Some(4);
    assert!(is_done, "haptical {command}\n{said}");
    text(&output.stdout)
}

#[test]
fn what_an_example_prints_runs() {
    for (example, count) in [
        ("paper", 1),
        ("urdf-arm", 2),
        ("sockets", 2),
        ("gap", 1),
        ("moving-arm", 2),
        ("data-set", 1),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let printed = run(folder.path(), &format!("init here --example {example}"));
        let next = commands(&printed);
        assert_eq!(next.len(), count, "{printed}");
        for command in next {
            run(folder.path(), &command);
        }
        if example == "gap" {
            let gap = std::fs::read_to_string(folder.path().join("here/gap/gap.json")).unwrap();
            let gap: serde_json::Value = serde_json::from_str(&gap).unwrap();
            let answer = std::fs::read_to_string(folder.path().join("here/answer.toml")).unwrap();
            let answer: toml::Table = answer.parse().unwrap();
            let (cause, answer) = (&gap["causes"][0], &answer["effect"][0]);
            assert_eq!(gap["verdict"], "named");
            let page = std::fs::read_to_string(folder.path().join("here/gap/gap.html")).unwrap();
            assert!(page.contains("<span>--with</span> <span>gap.json</span>"));
            assert_eq!(cause["effect"].as_str(), answer["name"].as_str());
            assert_eq!(cause["joint"].as_i64(), answer["joint"].as_integer());
        }
    }
}

#[test]
fn the_step_after_an_open_answer_runs() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "init . --example gap");
    // a gap that the effect explains alone, and the catalogue without it: nothing is open that a recording tells
    run(
        folder.path(),
        "diagnose --device device.toml --log log.csv --without capstan-compliance --out gap",
    );
    let next = commands(&alone(folder.path()));
    let settle = |next: &[String]| next.iter().find(|own| own.contains("--settle")).cloned();
    assert_eq!(settle(&next), None);
    // two that leave the same
    let path = folder.path().join("gap/gap.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut gap: serde_json::Value = serde_json::from_str(&text).unwrap();
    gap["verdict"] = "ambiguous".into();
    let candidate = |effect: &str, parameter: &str, value: f64| serde_json::json!({"effect": effect, "joint": 2, "parameters": {parameter: value}, "nats_behind": 0.1, "gain": 100.0});
    gap["candidates"] = serde_json::json!([
        candidate("backlash", "width_rad", 2e-3),
        candidate("joint-compliance", "stiffness_nm_per_rad", 500.0),
    ]);
    std::fs::write(&path, gap.to_string()).unwrap();
    let next = commands(&alone(folder.path()));
    run(folder.path(), &settle(&next).unwrap());
}

/// Blocks of the log are held out; what they hold beyond the angles of the others is not predicted: a polynomial of degree 10 was off
/// by half a radian there.
#[test]
fn held_out_rows_beyond_the_angles_of_the_fit_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "init . --example gap");
    run(
        folder.path(),
        "diagnose --device device.toml --log log.csv --out gap",
    );
    let text = std::fs::read_to_string(folder.path().join("gap/gap.json")).unwrap();
    let gap: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(gap["verdict"], "named", "{gap}");
    let channels = gap["gap"]["channels"].as_array().unwrap();
    let of_joint_4 = channels.iter().find(|own| own["channel"] == "out4");
    let before = of_joint_4.unwrap()["rms_before"].as_f64().unwrap();
    // what a model without the cause leaves of other rows is a millirad or two, as of those of its fit
    assert!(before < 5e-3, "out4: {before} rad before");
    let cable = channels.iter().find(|own| own["channel"] == "cable");
    let before = cable.unwrap()["rms_before"].as_f64().unwrap();
    assert!(before < 5e-3, "cable: {before} m before");
    let warnings = gap["warnings"].as_array().unwrap();
    let is_said = |own: &serde_json::Value| {
        let own = own.as_str().unwrap();
        own.starts_with("out4: ") && own.contains("are not predicted and left out")
    };
    assert!(warnings.iter().any(is_said), "{warnings:?}");
}

/// The error of the fit is small against a strong cause's gap, and not against the noise: the readings where the cause acts most count.
#[test]
fn readings_of_a_strong_cause_in_a_second_recording_are_all_predicted() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "init . --example gap");
    run(
        folder.path(),
        "diagnose --device device.toml --log log.csv --validate second.csv --out gap",
    );
    let text = std::fs::read_to_string(folder.path().join("gap/gap.json")).unwrap();
    let gap: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(gap["verdict"], "named", "{gap}");
    assert_eq!(
        gap["warnings"].as_array().map(Vec::len),
        Some(0),
        "{}",
        gap["warnings"]
    );
}

#[test]
fn a_folder_is_followed_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "init . --example gap");
    let mut done: Vec<String> = Vec::new();
    loop {
        let next = commands(&alone(folder.path()));
        let fresh: Vec<String> = next
            .into_iter()
            .filter(|command| !done.contains(command) && command != "--help")
            .collect();
        if fresh.is_empty() {
            break;
        }
        for command in fresh {
            run(folder.path(), &command);
            done.push(command);
        }
    }
    let verbs: Vec<&str> = done
        .iter()
        .filter_map(|command| command.split(' ').next())
        .collect();
    assert_eq!(verbs, ["check", "identify", "diagnose", "export", "verify"]);
    assert!(done[2].contains("--validate second.csv"), "{done:?}");
    // the cause is in the model that is exported, where one is named
    assert!(done[3].contains("gap/corrected.toml"), "{done:?}");
}

#[test]
fn a_folder_without_data_says_how_to_begin() {
    let folder = tempfile::tempdir().unwrap();
    let said = alone(folder.path());
    let begin = commands(&said);
    assert!(begin[0].starts_with("init demo --example gap"), "{said}");
    // a table alone: its columns are asked for
    std::fs::write(folder.path().join("table.csv"), "time,j1\n0,1\n").unwrap();
    let next = commands(&alone(folder.path()));
    assert_eq!(next[0], "import --guess table.csv");
    std::fs::remove_file(folder.path().join("table.csv")).unwrap();
    // a device alone: poses are chosen
    run(folder.path(), "init .");
    std::fs::remove_file(folder.path().join("log.csv")).unwrap();
    let next = commands(&alone(folder.path()));
    assert!(next[0].starts_with("plan "), "{next:?}");
    run(folder.path(), &next[0]);
}

#[test]
fn names_with_blanks_are_quoted_and_rubbish_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "init .");
    let place = |name: &str| folder.path().join(name);
    std::fs::rename(place("log.csv"), place("my log.csv")).unwrap();
    std::fs::write(place("broken.toml"), [0xff, 0xfe, 0]).unwrap();
    std::fs::write(place("broken.csv.gz"), b"no gzip").unwrap();
    std::fs::write(place("empty.csv"), b"").unwrap();
    std::fs::write(place("gap.json"), b"{").unwrap();
    let said = alone(folder.path());
    assert!(said.contains("--log 'my log.csv'"), "{said}");
    assert!(
        !said.contains("broken") && !said.contains("empty.csv"),
        "{said}"
    );
}
