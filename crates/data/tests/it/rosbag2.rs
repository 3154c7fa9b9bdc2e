//! Bags of rosbag2 in SQLite: what the format's Python library wrote, and what is no bag.

use haptical_data::{
    BagOptions, DataError, JointShape, LoadedLog, LogShape, read_bag_from, read_log,
};
use proptest::prelude::*;

use crate::support::{fixture, revolute, shape};

fn read(content: &[u8]) -> Result<LoadedLog, DataError> {
    read_bag_from(content, "bag.db3", &BagOptions::default(), &shape())
}

/// A bag that was made from the fixture: `fixtures/generate.py`.
fn changed(name: &str) -> Vec<u8> {
    std::fs::read(fixture("rosbag2").join(format!("{name}.db3"))).unwrap()
}

#[test]
fn a_bag_of_the_python_library_is_read_as_its_csv_log() {
    let csv = read_log(&fixture("log.csv"), &shape()).unwrap().recording;
    let log = read_log(&fixture("rosbag2.db3"), &shape()).unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    // NaN is not equal to itself, its text is
    assert_eq!(format!("{:?}", log.recording), format!("{csv:?}"));
}

/// The order of recording counts, not the order in the table.
#[test]
fn messages_come_in_the_order_of_recording() {
    let log = read(&changed("turned")).unwrap();
    let csv = read_log(&fixture("log.csv"), &shape()).unwrap().recording;
    assert_eq!(log.recording.joint, csv.joint);
}

/// Messages that go on in other pages, freed pages, a topic of images, columns in another order and text of two bytes.
#[test]
fn a_bag_of_another_writer_is_read_as_well() {
    let log = read(&changed("other-writer")).unwrap();
    let csv = read_log(&fixture("log.csv"), &shape()).unwrap().recording;
    assert_eq!(format!("{:?}", log.recording), format!("{csv:?}"));
}

#[test]
fn what_is_no_bag_is_refused_with_the_way_out() {
    let refused = |content: &[u8], kind: &str, words: &[&str]| {
        let error = read(content).unwrap_err();
        let text = error.to_string();
        assert_eq!(error.kind(), kind, "{text}");
        for word in words {
            assert!(
                text.starts_with("bag.db3") && text.contains(word),
                "{word}: {text}"
            );
        }
    };
    refused(
        &changed("without-topics"),
        "not-a-log",
        &["`topics`", "ros2 bag record"],
    );
    refused(&changed("ros1"), "not-a-log", &["`ros1`", "CDR"]);
    refused(
        &changed("compressed"),
        "not-a-log",
        &["compressed", "rosbags-convert"],
    );
    refused(&changed("text"), "damaged", &["SQLite"]);
    refused(&changed("short"), "damaged", &["/joint_states"]);
    refused(
        &changed("empty"),
        "not-a-log",
        &["no joint state has the joints"],
    );
    let whole = std::fs::read(fixture("rosbag2.db3")).unwrap();
    for length in [17, 100, 4096, whole.len() / 2, whole.len() - 4096] {
        refused(&whole[..length], "damaged", &[]);
    }
    let other = JointShape {
        name: "wrist".into(),
        ..revolute("")
    };
    let other = LogShape {
        joints: vec![other],
        ..LogShape::default()
    };
    let error = read_bag_from(&whole[..], "bag.db3", &BagOptions::default(), &other).unwrap_err();
    assert!(error.to_string().contains("`elbow`, `shoulder`"), "{error}");
}

/// A bag that was not closed has its last messages elsewhere.
#[test]
fn an_open_bag_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag.db3");
    std::fs::write(&path, changed("written-ahead")).unwrap();
    let ahead = folder.path().join("bag.db3-wal");
    std::fs::write(&ahead, [0; 32]).unwrap();
    let error = read_log(&path, &shape()).unwrap_err().to_string();
    assert!(
        error.contains("bag.db3-wal") && error.contains("wal_checkpoint"),
        "{error}"
    );
    // closed it is whole again, and still says that it is written ahead
    std::fs::write(&ahead, []).unwrap();
    let log = read_log(&path, &shape()).unwrap();
    assert_eq!(log.recording.joint[0].len(), 40);
}

#[test]
fn a_folder_of_a_bag_is_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("metadata.yaml"),
        "rosbag2_bagfile_information:\n",
    )
    .unwrap();
    let error = read_log(folder.path(), &shape()).unwrap_err().to_string();
    assert!(error.contains(".mcap or .db3 file in it"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    /// Damaged bags are read or refused: no panic, no endless loop.
    #[test]
    fn damage_is_survived(
        name in prop::sample::select(vec!["turned", "other-writer"]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut content = changed(name);
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        let _ = read(&content);
    }
}
