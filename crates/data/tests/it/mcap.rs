//! MCAP logs: what the format's Python library wrote, what its Rust library writes, and what is no log.

use std::collections::BTreeMap;
use std::io::Cursor;

use byteorder::{BigEndian, LittleEndian};
use haptical_data::{
    BagOptions, DataError, JointShape, LoadedLog, LogShape, read_bag_from, read_log,
};
use mcap::records::MessageHeader;
use proptest::prelude::*;
use serde::Serialize;

use crate::support::{fixture, revolute, shape};

#[derive(Serialize, Clone)]
struct JointState {
    sec: i32,
    nanosec: u32,
    frame_id: String,
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}

#[derive(Serialize)]
struct Transform {
    sec: i32,
    nanosec: u32,
    frame_id: String,
    child_frame_id: String,
    position: [f64; 3],
    orientation_xyzw: [f64; 4],
}

/// A joint state at `time_ms` with these angles of shoulder and elbow.
fn state(time_ms: u32, position: [f64; 2]) -> JointState {
    JointState {
        sec: 5,
        nanosec: time_ms * 1_000_000,
        frame_id: "base".to_owned(),
        name: ["shoulder", "elbow"].map(str::to_owned).to_vec(),
        position: position.to_vec(),
        velocity: Vec::new(),
        effort: Vec::new(),
    }
}

fn little(message: &impl Serialize) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<_, LittleEndian>(message).unwrap());
    bytes
}

/// A message: topic, schema, content.
type Sent = (&'static str, &'static str, Vec<u8>);

const JOINTS: &str = "sensor_msgs/msg/JointState";

fn joints(message: &JointState) -> Sent {
    ("/joint_states", JOINTS, little(message))
}

/// A recording of these messages, a microsecond apart.
fn bag(messages: &[Sent]) -> Vec<u8> {
    encoded(messages, "cdr")
}

fn encoded(messages: &[Sent], encoding: &str) -> Vec<u8> {
    let mut content = Vec::new();
    let options = mcap::WriteOptions::new()
        .compression(None)
        .chunk_size(Some(256));
    let mut writer = options.create(Cursor::new(&mut content)).unwrap();
    for (sequence, (topic, schema, data)) in messages.iter().enumerate() {
        let schema = writer.add_schema(schema, "ros2msg", b"").unwrap();
        let channel = writer
            .add_channel(schema, topic, encoding, &BTreeMap::new())
            .unwrap();
        let header = MessageHeader {
            channel_id: channel,
            sequence: sequence as u32,
            log_time: 1_000 * sequence as u64,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    content
}

fn read(content: &[u8], options: &BagOptions) -> Result<LoadedLog, DataError> {
    read_bag_from(content, "bag.mcap", options, &shape())
}

fn clean(messages: &[Sent]) -> LoadedLog {
    let log = read(&bag(messages), &BagOptions::default()).unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    log
}

#[test]
fn files_of_the_python_library_are_read_as_their_csv_log() {
    let csv = read_log(&fixture("log.csv"), &shape()).unwrap().recording;
    for name in ["none.mcap", "lz4.mcap", "zstd.mcap"] {
        let log = read_log(&fixture(name), &shape()).unwrap();
        assert_eq!(log.warnings, Vec::<String>::new(), "{name}");
        // NaN is not equal to itself, its text is
        assert_eq!(format!("{:?}", log.recording), format!("{csv:?}"), "{name}");
    }
}

#[test]
fn time_counts_from_the_first_stamp_and_other_topics_do_not_matter() {
    let log = clean(&[
        ("/rosout", "rcl_interfaces/msg/Log", vec![1, 2, 3]),
        joints(&state(20, [0.1, 0.2])),
        joints(&state(30, [0.3, 0.4])),
    ]);
    let recording = log.recording;
    assert_eq!(recording.time_s.unwrap(), [0.0, 0.01]);
    assert_eq!(recording.joint, [[0.1, 0.3], [0.2, 0.4]]);
    assert_eq!(recording.torque_nm, [None, None]);
}

#[test]
fn messages_of_the_other_byte_order_are_read() {
    let message = |state: &JointState| {
        let mut bytes = vec![0, 0, 0, 0];
        bytes.extend(cdr_encoding::to_vec::<_, BigEndian>(state).unwrap());
        ("/joint_states", JOINTS, bytes)
    };
    let sent = [
        message(&state(1, [0.5, -0.5])),
        message(&state(2, [0.25, 0.75])),
    ];
    assert_eq!(clean(&sent).recording.joint, [[0.5, 0.25], [-0.5, 0.75]]);
}

#[test]
fn without_stamps_the_time_of_recording_is_taken() {
    let unstamped = |angles| JointState {
        sec: 0,
        ..state(0, angles)
    };
    let sent = [
        joints(&unstamped([0.1, 0.2])),
        joints(&unstamped([0.3, 0.4])),
    ];
    let log = read(&bag(&sent), &BagOptions::default()).unwrap();
    assert!(log.warnings[0].contains("no stamps"), "{:?}", log.warnings);
    assert_eq!(log.recording.time_s.unwrap(), [0.0, 1e-6]);
}

#[test]
fn a_message_that_is_not_later_and_one_of_a_gripper_are_left_out_with_a_warning() {
    let gripper = JointState {
        name: vec!["finger".to_owned()],
        position: vec![0.01],
        ..state(2, [0.0; 2])
    };
    let sent = [
        joints(&state(1, [0.1, 0.2])),
        joints(&gripper),
        joints(&state(1, [0.5, 0.5])),
        joints(&state(3, [0.3, 0.4])),
    ];
    let log = read(&bag(&sent), &BagOptions::default()).unwrap();
    assert_eq!(log.recording.joint[0], [0.1, 0.3]);
    assert_eq!(log.warnings.len(), 2, "{:?}", log.warnings);
    assert!(
        log.warnings
            .iter()
            .all(|warning| warning.starts_with("bag.mcap: 1 messages"))
    );
}

#[test]
fn efforts_become_torques_of_joints_that_turn() {
    let pushed = |time| JointState {
        effort: vec![1.5, f64::NAN],
        ..state(time, [0.1, 0.2])
    };
    let content = bag(&[joints(&pushed(1)), joints(&pushed(2))]);
    let log = read(&content, &BagOptions::default()).unwrap();
    // a driver without a sensor at one joint says NaN there
    assert_eq!(log.recording.torque_nm, [Some(vec![1.5, 1.5]), None]);
    let mut sliding = shape();
    sliding.joints[0] = JointShape {
        prismatic: true,
        ..revolute("shoulder")
    };
    let log = read_bag_from(&content[..], "bag.mcap", &BagOptions::default(), &sliding).unwrap();
    assert_eq!(log.recording.torque_nm, [None, None]);
    assert!(
        log.warnings[0].contains("`shoulder`, which slides"),
        "{:?}",
        log.warnings
    );
}

/// What is written so far is read, wherever the file ends; without the word it is damaged.
#[test]
fn a_file_that_grows_is_read_to_its_last_whole_message() {
    let sent: Vec<_> = (1..=40)
        .map(|time| joints(&state(time, [0.01 * f64::from(time), 0.2])))
        .collect();
    let content = bag(&sent);
    let whole = read(&content, &BagOptions::default()).unwrap().recording;
    let growing = BagOptions {
        is_growing: true,
        ..BagOptions::default()
    };
    let (mut most, mut steps) = (0, 0);
    for bytes in (100..content.len()).step_by(61) {
        let cut = &content[..bytes];
        let Ok(log) = read(cut, &growing) else {
            assert_eq!(most, 0, "{bytes}");
            continue;
        };
        let rows = log.recording.len();
        assert!(rows >= most, "{bytes}: {rows} after {most}");
        assert_eq!(log.recording.joint[0], whole.joint[0][..rows], "{bytes}");
        assert!(read(cut, &BagOptions::default()).is_err(), "{bytes}");
        steps += usize::from(rows > most);
        most = rows;
    }
    assert_eq!((most, steps > 0), (40, true));
}

#[test]
fn poses_and_transforms_go_to_the_nearest_row() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let transform = |time_ms: u32, x: f64| {
        let message = Transform {
            sec: 5,
            nanosec: time_ms * 1_000_000,
            frame_id: "world".to_owned(),
            child_frame_id: "handle".to_owned(),
            position: [x, 2.0, 3.0],
            orientation_xyzw: [half, 0.0, 0.0, half],
        };
        (
            "/vicon/handle",
            "geometry_msgs/msg/TransformStamped",
            little(&message),
        )
    };
    let sent = [
        joints(&state(0, [0.1, 0.2])),
        transform(1, 0.25),
        joints(&state(10, [0.3, 0.4])),
        transform(16, 0.5),
        joints(&state(20, [0.5, 0.6])),
        transform(90, 0.75),
    ];
    let log = read(&bag(&sent), &BagOptions::default()).unwrap();
    let [x, _, z] = log.recording.position_m.unwrap();
    assert_eq!((x[0], x[2], z[0]), (0.25, 0.5, 3.0));
    assert!(x[1].is_nan());
    let [w, i, j, _] = log.recording.orientation_wxyz.unwrap();
    assert_eq!((w[0], i[0], j[0]), (half, half, 0.0));
    assert!(
        log.warnings[0].contains("1 of 3 poses"),
        "{:?}",
        log.warnings
    );
    assert!(
        log.warnings[1].contains("up to 0.004 s away"),
        "{:?}",
        log.warnings
    );
}

#[test]
fn names_and_topics_are_chosen() {
    let other = |time, angle| {
        let message = JointState {
            name: vec!["a".into(), "b".into()],
            ..state(time, [angle, 0.0])
        };
        ("/other", JOINTS, little(&message))
    };
    let sent = [
        joints(&state(1, [0.1, 0.2])),
        other(1, 0.7),
        joints(&state(2, [0.3, 0.4])),
        other(2, 0.8),
    ];
    let named = BagOptions {
        joint_names: vec!["b".into(), "a".into()],
        ..BagOptions::default()
    };
    let log = read(&bag(&sent), &named).unwrap();
    assert_eq!(log.recording.joint[1], [0.7, 0.8]);
    let twice = [
        &sent[..],
        &sent
            .clone()
            .map(|(_, schema, data)| ("/copy", schema, data)),
    ]
    .concat();
    let error = read(&bag(&twice), &BagOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("2 topics have these joints: `/copy`, `/joint_states`"),
        "{error}"
    );
    let chosen = BagOptions {
        joint_topic: Some("/joint_states".into()),
        ..BagOptions::default()
    };
    assert_eq!(
        read(&bag(&twice), &chosen).unwrap().recording.joint[0],
        [0.1, 0.3]
    );
}

#[test]
fn what_is_no_log_is_refused_with_the_way_out() {
    let refused = |content: &[u8], options: &BagOptions, kind: &str, words: &[&str]| {
        let error = read(content, options).unwrap_err();
        let text = error.to_string();
        assert_eq!(error.kind(), kind, "{text}");
        assert!(text.starts_with("bag.mcap"), "{text}");
        for word in words {
            assert!(text.contains(word), "{word}: {text}");
        }
    };
    let default = BagOptions::default();
    let good = [joints(&state(1, [0.1, 0.2])), joints(&state(2, [0.3, 0.4]))];
    let names = |names: &[&str]| BagOptions {
        joint_names: names.iter().map(|&name| name.to_owned()).collect(),
        ..BagOptions::default()
    };
    let content = bag(&good);
    refused(
        &content,
        &names(&["a", "b"]),
        "not-a-log",
        &["`a`, `b`", "`elbow`, `shoulder`"],
    );
    refused(
        &content,
        &names(&["a"]),
        "not-a-log",
        &["1 names", "2 joints"],
    );
    refused(
        &content,
        &names(&["elbow", "elbow"]),
        "not-a-log",
        &["two joints are called `elbow`"],
    );
    refused(
        &content,
        &names(&["elbow", "wrist"]),
        "not-a-log",
        &["message 1 of `/joint_states` has no `wrist`"],
    );
    let topic = BagOptions {
        joint_topic: Some("/x".into()),
        ..BagOptions::default()
    };
    refused(&content, &topic, "not-a-log", &["`/x`", "`/joint_states`"]);
    let pose = BagOptions {
        pose_topic: Some("/p".into()),
        ..BagOptions::default()
    };
    refused(&content, &pose, "not-a-log", &["`/p`", "none"]);
    refused(
        &bag(&[]),
        &default,
        "not-a-log",
        &["no joint state has the joints"],
    );
    refused(
        &encoded(&good, "ros1"),
        &default,
        "not-a-log",
        &["`ros1`", "ROS 2"],
    );
    let lopsided = JointState {
        position: vec![0.1],
        ..state(1, [0.0; 2])
    };
    refused(
        &bag(&[joints(&lopsided)]),
        &default,
        "damaged",
        &["1 positions for 2 joints"],
    );
    let mut cut = joints(&state(1, [0.1, 0.2]));
    cut.2.truncate(40);
    refused(&bag(&[cut]), &default, "damaged", &["/joint_states"]);
    let mut parameters = joints(&state(1, [0.1, 0.2]));
    parameters.2[1] = 3;
    refused(&bag(&[parameters]), &default, "damaged", &["encoding 3"]);
    let empty = read_bag_from(&content[..], "bag.mcap", &default, &LogShape::default());
    assert_eq!(empty.unwrap_err().kind(), "invalid-shape");
}

#[test]
fn a_cut_file_is_refused_at_every_length() {
    for name in ["none.mcap", "lz4.mcap", "zstd.mcap"] {
        let whole = std::fs::read(fixture(name)).unwrap();
        for length in (8..whole.len()).step_by(7) {
            let error = read(&whole[..length], &BagOptions::default()).unwrap_err();
            assert_eq!(error.kind(), "damaged", "{name} {length}: {error}");
        }
    }
}

/// A record that says it is longer than its chunk: the library that reads it counted below zero.
#[test]
fn a_record_longer_than_its_chunk_is_survived() {
    let sound = std::fs::read(fixture("none.mcap")).unwrap();
    for place in [111, 1410, 1648] {
        let mut content = sound.clone();
        content[place] = 3;
        let refused = read(&content, &BagOptions::default()).unwrap_err();
        assert_eq!(refused.kind(), "damaged", "{place}: {refused}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    /// Damaged files are read or refused: no panic, no endless loop.
    #[test]
    fn damage_is_survived(
        name in prop::sample::select(vec!["none.mcap", "lz4.mcap", "zstd.mcap"]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut content = std::fs::read(fixture(name)).unwrap();
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        let _ = read(&content, &BagOptions::default());
    }

    /// So are messages whose lengths and names are anything.
    #[test]
    fn damaged_messages_are_survived(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut sent = joints(&state(1, [0.1, 0.2]));
        for (place, byte) in damage {
            let place = place.index(sent.2.len());
            sent.2[place] = byte;
        }
        let _ = read(&bag(&[sent]), &BagOptions::default());
    }
}
