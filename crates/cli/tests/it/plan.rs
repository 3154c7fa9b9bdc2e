//! `haptical plan`: tables, files, what is refused, and the way back through `check`.

use std::process::Output;

use serde_json::Value;

use crate::{Sandbox, haptical, names_in, text};

fn plan(sandbox: &Sandbox, further: &[&str]) -> Output {
    haptical()
        .current_dir(sandbox.folder.path())
        .args(["plan", "--device", "device.toml", "--candidates", "150"])
        .args(further)
        .output()
        .unwrap()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn without_out_a_table_is_printed_and_nothing_written() {
    let sandbox = Sandbox::new();
    let before = names_in(sandbox.folder.path());
    let output = plan(&sandbox, &["--measure", "cable", "--measure", "cable,pose"]);
    let said = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        said.contains("parameter") && said.contains("cable,pose"),
        "{said}"
    );
    assert!(said.contains("out1 would tell offset1 (sd "), "{said}");
    assert_eq!(names_in(sandbox.folder.path()), before);
}

#[test]
fn a_robot_description_s_rows_are_named_and_redundancy_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = haptical()
            .current_dir(folder.path())
            .args(arguments)
            .output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    run(&["init", "arm", "--example", "urdf-arm"]);
    let said = run(&["plan", "--device", "arm/arm6.urdf", "--rig", "arm/rig.toml"]);
    assert!(
        said.contains("0 is the base, 1 is `shoulder_pan`,"),
        "{said}"
    );
    let rigs = said.matches("readings a pose").count();
    let redundant = said.matches("nothing that was tried tells d0,").count();
    assert_eq!((rigs, redundant), (2, 2), "{said}");
}

#[test]
fn rigs_stand_side_by_side_and_more_measurements_tell_more() {
    let sandbox = Sandbox::new();
    let rigs = [
        "--measure",
        "cable",
        "--measure",
        "cable,cable2:0.4,-0.1,0.3",
        "--json",
    ];
    let found = json(&plan(&sandbox, &rigs));
    let rank = |rig: usize| found["rigs"][rig]["rank"].as_u64().unwrap();
    assert!(rank(1) > rank(0), "{} {}", rank(0), rank(1));
    for rig in found["rigs"].as_array().unwrap() {
        for parameter in rig["parameters"].as_array().unwrap() {
            let is_told = parameter["status"] == "identifiable" || parameter["status"] == "weak";
            assert_eq!(
                parameter["standard_deviation"].is_number(),
                is_told,
                "{parameter}"
            );
            assert_eq!(
                parameter["reason"].is_null(),
                parameter["status"] == "identifiable"
            );
        }
    }
}

#[test]
fn chosen_poses_are_a_log_within_the_limits_and_the_same_again() {
    let sandbox = Sandbox::new();
    let flags = [
        "--measure",
        "out,cable",
        "--poses",
        "80",
        "--seed",
        "3",
        "--out",
    ];
    let run = |folder: &str, threads: &str| {
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .env("RAYON_NUM_THREADS", threads)
            .args(["plan", "--device", "device.toml", "--candidates", "150"])
            .args(flags)
            .args([folder, "--json"])
            .output()
            .unwrap();
        json(&output)
    };
    let (found, again) = (run("one", "1"), run("two", "4"));
    assert_eq!(found, again);
    let files = [
        "plan.html",
        "plan.json",
        "poses.csv",
        "report.html",
        "rigs.svg",
    ];
    assert_eq!(names_in(&sandbox.path("one")), files);
    for file in files {
        let read = |folder: &str| std::fs::read(sandbox.path(folder).join(file)).unwrap();
        assert!(read("one") == read("two"), "{file}");
    }
    let device = haptical_model::Device::load(&sandbox.path("device.toml"))
        .unwrap()
        .device;
    let poses = std::fs::read_to_string(sandbox.path("one").join("poses.csv")).unwrap();
    assert_eq!(poses.lines().count(), 81);
    for line in poses.lines().skip(1) {
        let readings = line.split(',').map(|cell| cell.parse::<f64>().unwrap());
        for (reading, joint) in readings.zip(&device.joints) {
            assert!((joint.lower_rad..=joint.upper_rad).contains(&reading));
        }
    }
    let next = &found["next_poses"];
    let value = |of: &str| next[of]["geometric_mean_sd"].as_f64().unwrap();
    assert!(value("figures") < value("random"));
    // poses that were measured count: the next ones make every standard deviation smaller
    let more = json(&plan(
        &sandbox,
        &[
            "--measure",
            "out,cable",
            "--poses",
            "20",
            "--log",
            "one/poses.csv",
            "--out",
            "three",
            "--json",
        ],
    ));
    assert_eq!(more["measured_poses"], 80);
    let own = more["next_poses"]["figures"]["geometric_mean_sd"]
        .as_f64()
        .unwrap();
    assert!(own < value("figures"));
}

#[test]
fn every_criterion_has_figures() {
    let sandbox = Sandbox::new();
    for criterion in ["d", "a", "o1", "task-position"] {
        let found = json(&plan(
            &sandbox,
            &[
                "--measure",
                "cable",
                "--known-transmissions",
                "--poses",
                "60",
                "--criterion",
                criterion,
                "--out",
                "plan",
                "--json",
            ],
        ));
        let next = &found["next_poses"];
        assert_eq!(next["criterion"], criterion);
        let has_task = !matches!(criterion, "d" | "o1");
        assert_eq!(next["figures"]["root_mean_square"].is_number(), has_task);
    }
}

#[test]
fn what_is_refused_leaves_no_file_and_says_what_to_do() {
    let sandbox = Sandbox::new();
    let before = names_in(sandbox.folder.path());
    for (flags, said) in [
        (vec!["--measure", "cabel"], "there is no such kind"),
        (vec!["--measure", "cable2"], "give its place"),
        (vec!["--poses", "50"], "--out"),
        (vec!["--poses", "2", "--out", "plan"], "at least"),
        (vec!["--poses", "500", "--out", "plan"], "candidates"),
        (vec!["--poses", "0", "--out", "plan"], "whole number from 1"),
        (vec!["--cable-length", "3,4"], "cables' lengths"),
        (vec!["--cable-length", "nan,4"], "two lengths"),
        (vec!["--workspace", "0,0,0,1,1"], "six numbers"),
        (
            vec![
                "--poses",
                "90",
                "--out",
                "plan",
                "--criterion",
                "task-position",
                "--region",
                "9,9,9,0.1",
            ],
            "does not reach",
        ),
        (
            vec![
                "--poses",
                "90",
                "--out",
                "plan",
                "--criterion",
                "task-position",
                "--region",
                "0:1",
            ],
            "region gives 1",
        ),
        (vec!["--region", "a,b"], "four numbers"),
        (vec!["--out", "device.toml"], "not a folder"),
    ] {
        let output = plan(&sandbox, &flags);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{flags:?}: {}",
            text(&output.stderr)
        );
        let error = text(&output.stderr);
        assert!(error.contains(said), "{flags:?}: {error}");
        assert_eq!(names_in(sandbox.folder.path()), before, "{flags:?}");
    }
}

#[test]
fn a_plan_is_verified_and_a_changed_digit_is_found() {
    let sandbox = Sandbox::new();
    let words = ["--measure", "out,cable", "--poses", "60", "--out", "plan"];
    let output = plan(&sandbox, &words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let verify = || {
        let mut command = haptical();
        let command = command.current_dir(sandbox.folder.path());
        command.args(["verify", "plan"]).output().unwrap()
    };
    let output = verify();
    let said = text(&output.stdout);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{said}{}",
        text(&output.stderr)
    );
    assert_eq!(said.matches("the same bytes\n").count(), 5, "{said}");
    let poses = sandbox.path("plan").join("poses.csv");
    let written = std::fs::read_to_string(&poses).unwrap();
    let changed = match written.replacen("0.1", "0.2", 1) {
        same if same == written => written.replacen("0.2", "0.3", 1),
        other => other,
    };
    std::fs::write(&poses, changed).unwrap();
    let output = verify();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    assert!(text(&output.stdout).contains("poses.csv"));
}
