//! Logs, plain and compressed.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_data::{JointShape, LogShape, read_log_from, write_log_to};
use haptical_fuzz::{Edit, bounded, mutated, seeds};

fn shape() -> LogShape {
    let joint = |name: &str| JointShape {
        name: name.to_owned(),
        prismatic: false,
        lower: -1.5,
        upper: 1.5,
    };
    LogShape {
        joints: vec![joint("1"), joint("2")],
        cable_count: 1,
        hands: Vec::new(),
    }
}

/// Reads it; a log that is accepted is written and read again.
fn read(bytes: &[u8]) {
    let Ok(log) = read_log_from(bytes, "log.csv", &shape()) else {
        return;
    };
    let recording = log.recording;
    assert!(recording.len() >= 2);
    assert!(
        recording
            .joint
            .iter()
            .flatten()
            .all(|reading| reading.is_finite())
    );
    let mut written = Vec::new();
    // Names that a header of ours would not have are refused, nothing else.
    if write_log_to(&mut written, &recording, &shape()).is_ok() {
        let again = read_log_from(written.as_slice(), "again.csv", &shape()).unwrap();
        assert_eq!(again.recording.joint, recording.joint);
        assert_eq!(again.recording.len(), recording.len());
    }
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn plain_logs() {
    let seeds = seeds(&["log-", "sound-log"], &[]).unwrap();
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 4000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}

#[test]
fn compressed_logs() {
    let seeds = seeds(&["log-", "sound-log"], &[]).unwrap();
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>, Vec<Edit>)>()
        .for_each(|(pick, edits, damage)| {
            let whole = compressed(&mutated(&seeds, *pick, edits));
            read(&whole);
            read(&mutated(&[whole], 0, damage));
        });
}
