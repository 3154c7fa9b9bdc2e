//! `haptical import mukca` and `mcap`: the log that it writes, the rig next to it, its refusals.

use std::path::Path;
use std::process::Output;

use haptical_data::{JointShape, LogShape, read_log};
use haptical_model::Device;
use serde_json::Value;

use crate::{haptical, names_in, text};

/// A robot of two joints: two positions of the tool, the second with one socket.
fn robot() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    };
    write("high/hole_0.csv", "0.1,2e-1,0.9\n-0.3,0.4,0.9\n");
    write("high/hole_1.csv", "0.5,0.6,0.9\n");
    write("low/hole_1.csv", "0.7,0.8,0.9\n0.9,1.0,0.9\n");
    write("low/hole_1_pose.csv", "1,2,3\n");
    folder
}

fn mukca(robot: &Path, out: &Path, further: &[&str]) -> Output {
    haptical()
        .args(["import", "mukca"])
        .arg(robot)
        .arg("--out")
        .arg(out)
        .args(further)
        .output()
        .unwrap()
}

fn joints(count: usize) -> LogShape {
    let joints = (0..count).map(|index| JointShape {
        name: index.to_string(),
        prismatic: false,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    });
    LogShape {
        joints: joints.collect(),
        cable_count: 0,
        hands: Vec::new(),
    }
}

#[test]
fn postures_become_rows_with_a_run_for_each_position_and_a_contact_for_each_socket() {
    let robot = robot();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/two.csv");
    let output = mukca(robot.path(), &out, &["--joints", "2", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let log = read_log(&out, &joints(2)).unwrap().recording;
    assert_eq!(log.joint[0], [0.1, -0.3, 0.5, 0.7, 0.9]);
    assert_eq!(log.joint[1], [0.2, 0.4, 0.6, 0.8, 1.0]);
    assert_eq!(log.run.unwrap(), [1, 1, 1, 2, 2]);
    let contacts = [
        "high_hole_0",
        "high_hole_0",
        "high_hole_1",
        "low_hole_1",
        "low_hole_1",
    ];
    assert_eq!(log.contact.unwrap(), contacts);
    assert_eq!(names_in(out.parent().unwrap()), ["two.csv", "two.rig.toml"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&report["rows"], &report["joints"]),
        (&Value::from(5), &Value::from(2))
    );
    let warnings = report["warnings"].as_array().unwrap();
    let has = |words: &str| {
        warnings
            .iter()
            .any(|warning| warning.as_str().unwrap().contains(words))
    };
    assert!(
        has("hole_1_pose.csv: not read") && has("column 3 is left out"),
        "{warnings:?}"
    );
    assert!(has("low: 1 of its two sockets"), "{warnings:?}");
}

#[test]
fn the_rig_file_is_read_as_one_and_has_the_distance() {
    let robot = robot();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("log.csv");
    let output = mukca(
        robot.path(),
        &out,
        &["--distance-m", "0.08", "--distance-sd-m", "2e-4"],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rig = std::fs::read_to_string(folder.path().join("log.rig.toml")).unwrap();
    let device = "[device]\ndof = 1\n[[joint]]\n";
    let (merged, odd) = Device::with_rig(device, "d.toml", &rig, "log.rig.toml").unwrap();
    assert_eq!(odd, Vec::<String>::new());
    let pairs = Device::from_toml(&merged, "d.toml")
        .unwrap()
        .device
        .contact_pairs;
    // the position with one socket has no distance
    assert_eq!(pairs.len(), 1);
    assert_eq!(
        (pairs[0].a.as_str(), pairs[0].b.as_str()),
        ("high_hole_0", "high_hole_1")
    );
    assert_eq!((pairs[0].distance_m, pairs[0].sd_m), (0.08, 2e-4));
}

#[test]
fn what_is_no_such_recording_is_refused_and_nothing_is_written() {
    let refused = |change: &dyn Fn(&Path), further: &[&str], words: &[&str]| {
        let robot = robot();
        change(robot.path());
        let folder = tempfile::tempdir().unwrap();
        let output = mukca(robot.path(), &folder.path().join("log.csv"), further);
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
        assert_eq!(names_in(folder.path()), Vec::<String>::new());
    };
    let write = |name: &'static str, content: &'static str| {
        move |robot: &Path| std::fs::write(robot.join(name), content).unwrap()
    };
    let nothing = |_: &Path| {};
    refused(
        &write("high/hole_0.csv", "q1,q2,q3\n0,0,0\n"),
        &[],
        &["hole_0.csv:1:1", "`q1`", "without a header"],
    );
    refused(
        &write("high/hole_1.csv", "10,20,170\n"),
        &[],
        &["hole_1.csv:1:3", "degrees"],
    );
    refused(
        &write("high/hole_1.csv", "0,nan,0\n"),
        &[],
        &["hole_1.csv:1:2", "`nan`"],
    );
    refused(
        &write("high/hole_0.csv", "0,0,0\n1,1\n"),
        &[],
        &["hole_0.csv:2", "2 numbers where the first row has 3"],
    );
    refused(
        &write("low/hole_1.csv", "0,0\n"),
        &[],
        &["`low_hole_1` has 2 columns, `high_hole_0` 3"],
    );
    refused(&write("low/hole_1.csv", ""), &[], &["no postures"]);
    refused(
        &nothing,
        &["--joints", "4"],
        &["--joints is 4", "3 columns"],
    );
    refused(&nothing, &["--distance-m", "0"], &["a number above 0"]);
    refused(
        &|robot| {
            std::fs::remove_dir_all(robot.join("high"))
                .and_then(|()| std::fs::remove_file(robot.join("low/hole_1.csv")))
                .unwrap();
        },
        &[],
        &["no folder in it has hole_0.csv"],
    );
    refused(
        &|robot| std::fs::remove_dir_all(robot).unwrap(),
        &[],
        &["cannot be read"],
    );
}

#[test]
fn a_log_is_written_as_csv_alone() {
    let robot = robot();
    let folder = tempfile::tempdir().unwrap();
    for name in ["log.csv.gz", "log.parquet", "device.toml"] {
        let output = mukca(robot.path(), &folder.path().join(name), &[]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr).contains("ends in .csv"),
            "{}",
            text(&output.stderr)
        );
    }
}

#[cfg(all(feature = "mcap", feature = "rosbag2"))]
#[test]
fn joints_of_a_bag_are_chosen_by_name() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/tests/fixtures");
    if !fixtures.exists() {
        println!("skipped: the fixtures of haptical-data are not here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let device = folder.path().join("device.toml");
    std::fs::write(&device, "[device]\ndof = 2\n[[joint]]\n[[joint]]\n").unwrap();
    let out = folder.path().join("log.csv");
    // the older word for MCAP files still works
    for (word, bag) in [("mcap", "zstd.mcap"), ("bag", "rosbag2.db3")] {
        joints_of_a_bag(word, &fixtures.join(bag), &device, &out);
        std::fs::remove_file(&out).unwrap();
    }
}

#[cfg(all(feature = "mcap", feature = "rosbag2"))]
fn joints_of_a_bag(word: &str, bag: &Path, device: &Path, out: &Path) {
    let import = |joints: &str| {
        let mut command = haptical();
        command.args(["import", word]).arg(bag);
        command.arg("--device").arg(device).arg("--out").arg(out);
        command.args(["--joints", joints]).output().unwrap()
    };
    let output = import("shoulder,elbow");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let ours = read_log(out, &joints(2)).unwrap().recording;
    let theirs = read_log(&bag.with_file_name("log.csv"), &joints(2))
        .unwrap()
        .recording;
    // NaN is not equal to itself, its text is
    assert_eq!(format!("{ours:?}"), format!("{theirs:?}"));
    let output = import("shoulder,wrist");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("has no `wrist`"),
        "{}",
        text(&output.stderr)
    );
}
