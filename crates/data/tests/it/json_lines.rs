//! Logs as JSON lines: keys as columns, joint states of ROS 2 as JSON, and what is refused with its line.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_data::{JointShape, LogShape, read_log_from};
use proptest::prelude::*;

use crate::support::{clean, read, refused, revolute, single};

fn two() -> LogShape {
    LogShape {
        joints: vec![revolute("shoulder"), revolute("elbow")],
        cable_count: 1,
        hands: Vec::new(),
    }
}

#[test]
fn keys_are_columns_in_any_order_and_missing_ones_are_no_reading() {
    let text = "{\"theta1_rad\": 0.5, \"contact\": \"a\"}\n\n{\"contact\": \"b\", \"cable_m\": 0.25, \"theta1_rad\": -1}\n";
    let log = clean(text, &single()).recording;
    assert_eq!(log.joint[0], [0.5, -1.0]);
    let cable = log.cable_m[0].as_ref().unwrap();
    assert!(cable[0].is_nan() && cable[1] == 0.25);
    assert_eq!(log.contact.unwrap(), ["a", "b"]);
    assert_eq!(log.line, [1, 3]);
}

#[test]
fn gzip_is_read_too() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder
        .write_all(b"{\"theta1_rad\":0.5}\n{\"theta1_rad\":0.25}\n")
        .unwrap();
    let content = encoder.finish().unwrap();
    let log = read_log_from(&content[..], "log.jsonl.gz", &single()).unwrap();
    assert_eq!(log.recording.joint[0], [0.5, 0.25]);
}

/// Drivers sort joints by name: the list's order is not the device's.
#[test]
fn a_joint_state_is_placed_by_its_names() {
    let row = |nanosec: u32, shoulder: f64, elbow: f64| {
        format!(
            "{{\"header\":{{\"stamp\":{{\"sec\":1700000000,\"nanosec\":{nanosec}}},\"frame_id\":\"\"}},\
             \"name\":[\"elbow\",\"finger\",\"shoulder\"],\"position\":[{elbow},9,{shoulder}],\"effort\":[1,2,3]}}\n"
        )
    };
    let text = row(500_000_000, 0.1, 0.2) + &row(510_000_000, 0.3, 0.4);
    let log = clean(&text, &two()).recording;
    assert_eq!(log.joint, [[0.1, 0.3], [0.2, 0.4]]);
    assert_eq!(log.torque_nm, [Some(vec![3.0, 3.0]), Some(vec![1.0, 1.0])]);
    let time = log.time_s.unwrap();
    assert!(time[0] == 0.0 && (time[1] - 0.01).abs() < 1e-12, "{time:?}");
}

#[test]
fn lists_without_names_are_in_the_device_s_order() {
    let text = "{\"t_s\":0,\"position\":[0.1,0.2],\"velocity\":[1,2]}\n{\"t_s\":1,\"position\":[0.3,0.4],\"velocity\":[3,4]}\n";
    let log = clean(text, &two()).recording;
    assert_eq!(log.joint, [[0.1, 0.3], [0.2, 0.4]]);
    let names: Vec<&str> = log
        .covariates
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    assert_eq!(names, ["velocity1_rad_per_s", "velocity2_rad_per_s"]);
}

#[test]
fn what_is_no_row_is_refused_with_its_line() {
    let good = "{\"theta1_rad\": 0.5}\n";
    let bad = |line: &str| format!("{good}{line}\n");
    for line in [
        "{\"theta1_rad\": 0.5",
        "[1]",
        "theta1_rad",
        "{\"a\": 1e999}",
        "{\"a.b\":1,\"a\":{\"b\":2}}",
    ] {
        refused(&bad(line), &single(), "not-a-log", Some(2), None);
    }
    refused(
        &bad("{\"other\": 1}"),
        &single(),
        "missing-reading",
        Some(2),
        Some((1, "theta1_rad")),
    );
    refused(
        &bad("{\"theta1_rad\": \"0,5\"}"),
        &single(),
        "decimal-comma",
        Some(2),
        Some((1, "theta1_rad")),
    );
    refused(
        "{\"position\":[1]}\n{\"position\":[1,2]}\n",
        &single(),
        "not-a-log",
        Some(2),
        None,
    );
    let named = "{\"name\":[\"x\"],\"position\":[1]}\n";
    let error = refused(named, &single(), "not-a-log", Some(1), None);
    assert!(
        error.to_string().contains("does not name the joint `base`"),
        "{error}"
    );
    let list = read("[{\"theta1_rad\": 0.5}]\n", &single()).unwrap_err();
    assert!(list.to_string().contains("jq -c"), "{list}");
}

/// Lines whose keys all differ would fill the memory with the square of their number.
#[test]
fn more_keys_than_columns_are_refused_at_the_line_of_the_first_too_many() {
    let line = |key: usize| format!("{{\"k{key}\":1}}\n");
    let text: String = (0..6000).map(line).collect();
    let error = refused(&text, &single(), "too-many-columns", Some(4097), None);
    assert!(error.to_string().contains("4096 different keys"), "{error}");
    let keys: Vec<String> = (0..4095).map(|key| format!("\"k{key}\":1")).collect();
    let most = format!("{{\"theta1_rad\":0.5,{}}}\n", keys.join(",")).repeat(2);
    assert_eq!(clean(&most, &single()).recording.covariates.len(), 4095);
}

#[test]
fn a_joint_that_slides_is_in_metres() {
    let slide = JointShape {
        prismatic: true,
        ..revolute("slide")
    };
    let shape = LogShape {
        joints: vec![slide],
        cable_count: 0,
        hands: Vec::new(),
    };
    let log = clean(
        "{\"position\":[0.1],\"effort\":[5]}\n{\"position\":[0.2],\"effort\":[6]}\n",
        &shape,
    )
    .recording;
    assert_eq!(
        (log.joint[0].len(), log.torque_nm[0].as_ref().unwrap()[1]),
        (2, 6.0)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn damage_is_survived(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let text = "{\"header\":{\"stamp\":{\"sec\":1,\"nanosec\":2}},\"name\":[\"base\"],\"position\":[0.5]}\n";
        let mut content = text.repeat(3).into_bytes();
        for (place, byte) in damage {
            let place = place.index(content.len() - 1) + 1;
            content[place] = byte;
        }
        let _ = read_log_from(&content[..], "log.jsonl", &single());
    }
}
