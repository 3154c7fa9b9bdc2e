//! Bags of rosbag2 in SQLite: what the format's Python library wrote, and what is no bag.

use haptical_data::{
    BagOptions, DataError, JointShape, LoadedLog, LogShape, read_bag_from, read_log,
};
use proptest::prelude::*;
use rusqlite::Connection;

use crate::support::{fixture, revolute, shape};

fn read(content: &[u8]) -> Result<LoadedLog, DataError> {
    read_bag_from(content, "bag.db3", &BagOptions::default(), &shape())
}

/// The fixture after statements.
fn changed(statements: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag.db3");
    std::fs::copy(fixture("rosbag2.db3"), &path).unwrap();
    let bag = Connection::open(&path).unwrap();
    bag.execute_batch(statements).unwrap();
    drop(bag);
    std::fs::read(path).unwrap()
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
    let turned = changed(
        "CREATE TABLE t AS SELECT * FROM messages ORDER BY timestamp DESC; DELETE FROM messages; \
         INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp, data FROM t;",
    );
    let log = read(&turned).unwrap();
    let csv = read_log(&fixture("log.csv"), &shape()).unwrap().recording;
    assert_eq!(log.recording.joint, csv.joint);
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
        &changed("DROP TABLE topics"),
        "not-a-log",
        &["`topics`", "ros2 bag record"],
    );
    refused(
        &changed("UPDATE topics SET serialization_format = 'ros1'"),
        "not-a-log",
        &["`ros1`", "CDR"],
    );
    refused(
        &changed("UPDATE messages SET data = x'28b52ffd00'"),
        "not-a-log",
        &["compressed", "rosbags-convert"],
    );
    refused(
        &changed("UPDATE messages SET data = 'text'"),
        "damaged",
        &["SQLite"],
    );
    refused(
        &changed("UPDATE messages SET data = x'0001'"),
        "damaged",
        &["/joint_states"],
    );
    refused(
        &changed("DELETE FROM messages"),
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
    std::fs::copy(fixture("rosbag2.db3"), &path).unwrap();
    let bag = Connection::open(&path).unwrap();
    bag.execute_batch("PRAGMA journal_mode = WAL; DELETE FROM messages WHERE id = 1;")
        .unwrap();
    let error = read_log(&path, &shape()).unwrap_err().to_string();
    assert!(
        error.contains("bag.db3-wal") && error.contains("wal_checkpoint"),
        "{error}"
    );
    drop(bag);
    // closed it is whole again, and still says that it is written ahead
    assert_eq!(
        read_log(&path, &shape()).unwrap().recording.joint[0].len(),
        39
    );
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
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut content = std::fs::read(fixture("rosbag2.db3")).unwrap();
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        let _ = read(&content);
    }
}
