//! `cargo xtask blind-check` as a user runs it.
#![allow(
    clippy::unwrap_used,
    reason = "clippy.toml allows it in test functions; helpers of tests are meant too"
)]

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use xtask_blind::sha256_hex;

fn blind_check(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask"))
        .arg("blind-check")
        .args(words)
        .output()
        .unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn two_trials_leave_everything_that_is_promised() {
    let folder = tempfile::tempdir().unwrap();
    let (out, dump) = (folder.path().join("out"), folder.path().join("dump"));
    let (out_text, dump_text) = (out.to_str().unwrap(), dump.to_str().unwrap());
    let words = [
        "--suite", "s0,s1", "--count", "1", "--seed", "5", "--out", out_text,
    ];
    let output = blind_check(&[&words[..], &["--dump", dump_text]].concat());
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("Not a scored batch"), "{said}");
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        errors.lines().count(),
        1,
        "no progress bar in a pipe: {errors}"
    );

    for name in [
        "report.html",
        "summary.md",
        "summary.json",
        "confusion.svg",
        "answers.json",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let (commitments, scores) = (
        json(&out.join("commitments.json")),
        json(&out.join("scores.json")),
    );
    for (commitment, score) in commitments
        .as_array()
        .unwrap()
        .iter()
        .zip(scores.as_array().unwrap())
    {
        let text = |name: &str| score[name].as_str().unwrap();
        let digest = sha256_hex(&format!("{}\n{}", text("salt"), text("truth_json")));
        assert_eq!(commitment["commitment"], digest.as_str());
        assert_eq!(commitment["suite"], score["suite"]);
        assert_eq!(text("answer_sha256").len(), 64);
        assert!(score["score"]["right"].is_boolean() && score["answer"]["verdict"].is_string());
    }
    assert_eq!(
        json(&out.join("summary.json"))["is_scored"],
        Value::Bool(false)
    );
    let dumped: Vec<_> = std::fs::read_dir(&dump).unwrap().collect();
    assert_eq!(dumped.len(), 2);
    for entry in dumped {
        for name in ["device.toml", "log.csv.gz", "log2.csv.gz", "truth.json"] {
            assert!(
                entry.as_ref().unwrap().path().join(name).is_file(),
                "{name}"
            );
        }
    }

    // one of the two alone, as its row says: the same bytes
    let alone = folder.path().join("alone");
    let rerun = scores[1]["rerun"].as_str().unwrap();
    let mut words: Vec<&str> = rerun.split(' ').collect();
    words.extend(["--out", alone.to_str().unwrap()]);
    assert!(blind_check(&words).status.success());
    assert_eq!(json(&alone.join("scores.json"))[0], scores[1]);
}

/// The answer to one trial.
fn answer_of(suite: &str, index: &str, seed: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let words = [
        "--suite", suite, "--first", index, "--count", "1", "--seed", seed, "--out", out,
    ];
    let output = blind_check(&words);
    assert!(output.status.success(), "{output:?}");
    let scores = json(&folder.path().join("scores.json"));
    scores[0]["answer"].clone()
}

fn causes_of(suite: &str, index: &str, seed: &str) -> Vec<Value> {
    let answer = answer_of(suite, index, seed);
    answer["causes"].as_array().unwrap().clone()
}

fn names_of(suite: &str, index: &str, seed: &str) -> Vec<String> {
    let causes = causes_of(suite, index, seed);
    let names = causes.iter().map(|cause| cause["effect"].as_str().unwrap());
    names.map(str::to_owned).collect()
}

/// Draws that were answered wrongly once: joints that yield as a base, and a base as the first joint and its bearing.
#[test]
fn joints_that_yield_and_a_base_that_yields_are_told_apart() {
    let joints = names_of("sr", "4", "33");
    assert!(!joints.is_empty());
    assert!(
        joints.iter().all(|name| name == "joint-compliance"),
        "{joints:?}"
    );
    let base = names_of("s4", "13", "3588768297");
    assert_eq!(base, ["external-encoder-latency", "base-compliance"]);
}

/// A draw that was answered wrongly once: the first estimate of a noise with a long memory is too small, and what it leaves of
/// a drift is not something else.
#[test]
fn a_drift_in_noise_with_a_memory_keeps_its_class() {
    let causes = causes_of("sc", "62", "3588768297");
    assert_eq!(causes.len(), 1, "{causes:?}");
    let cause = &causes[0];
    let others = cause["confusable_with"].as_array().unwrap().iter();
    let class: Vec<&str> = others
        .chain([&cause["effect"]])
        .filter_map(Value::as_str)
        .collect();
    assert!(
        class.contains(&"thermal-drift") && !class.contains(&"unknown"),
        "{class:?}"
    );
}

/// A draw that was answered wrongly once: a play that a weight presses to one side looks like a spring, until the second
/// recording crosses it.
#[test]
fn a_spring_that_the_second_recording_does_not_show_is_not_named() {
    let answer = answer_of("moving", "725", "2718281");
    let left = &answer["causes"][0]["held_out"]["reduction_percent"];
    assert!(left.as_f64().unwrap() < 10.0, "{left}");
    assert_eq!(answer["verdict"], "unknown");
}

/// Draws whose interval missed once: a rest that is no gap was put into the masses of the wrist, and a push's point is not known.
#[test]
fn intervals_of_payloads_and_pushes_hold_what_was_drawn() {
    for (index, effect, number, drawn) in [
        ("1840", "payload", "mass_kg", 1.832),
        ("642", "contact", "force_n", 40.19),
    ] {
        let causes = causes_of("moving", index, "161803");
        assert_eq!(causes[0]["effect"], effect);
        let found = &causes[0]["parameters"][number];
        let [low, high] = [0, 1].map(|end| found["ci95"][end].as_f64().unwrap());
        assert!((low..=high).contains(&drawn), "{index}: {found}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_before_anything_is_drawn() {
    for (words, said) in [
        (
            &["--suite", "s77"][..],
            "there is no suite `s77`; known are s0, s1,",
        ),
        (&["--count", "0"], "nothing to try"),
        (&["--jobs", "0"], "--jobs is 0"),
        (&["--record"], "--record is for scored batches"),
        (&["--seed", "soon"], "neither a number nor `commit`"),
    ] {
        let output = blind_check(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(errors.contains(said), "{words:?}: {errors}");
    }
}
