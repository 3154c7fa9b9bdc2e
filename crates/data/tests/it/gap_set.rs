//! Recordings made by others, read when they are there.

use std::path::{Path, PathBuf};
use std::time::Instant;

use haptical_data::{JointShape, LogShape, read_log, write_log_to};

use crate::support::read;

/// Limits of the device that the gap sets were recorded with, from home.
const LIMITS_DEG: [f64; 7] = [90.0, 90.0, 75.0, 45.0, 90.0, 75.0, 120.0];

fn haptic7() -> LogShape {
    let joint = |limit: &f64| JointShape {
        name: "joint".into(),
        prismatic: false,
        lower: -limit.to_radians(),
        upper: limit.to_radians(),
    };
    LogShape {
        joints: LIMITS_DEG.iter().map(joint).collect(),
        cable_count: 1,
        hands: Vec::new(),
    }
}

fn shared(path: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared")
        .join(path);
    if !path.exists() {
        println!("skipped: {} is absent", path.display());
        return None;
    }
    Some(path)
}

#[test]
fn the_clean_gap_set_is_read() {
    let Some(path) = shared("gap-sets/01-clean/log.csv.gz") else {
        return;
    };
    let log = read_log(&path, &haptic7()).unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    let recording = log.recording;
    assert_eq!(recording.len(), 6000);
    assert_eq!((recording.line[0], recording.line[5999]), (2, 6001));
    assert_eq!(recording.time_s.as_deref().unwrap()[..2], [0.0, 0.01]);
    assert!(recording.joint.iter().all(|column| column[0] == 0.0));
    let first = |column: &Option<Vec<f64>>| column.as_ref().map(|column| column[0]);
    let outputs: Vec<Option<f64>> = recording.output.iter().map(first).collect();
    let expected = [
        Some(-0.0000491),
        Some(-0.0001258),
        Some(-0.0001300),
        Some(0.0000081),
    ];
    assert_eq!(outputs[..4], expected);
    assert_eq!(outputs[4..], [None; 3]);
    assert_eq!(
        recording.cable_m.iter().map(first).collect::<Vec<_>>(),
        [Some(0.1286049)]
    );
    let torques: Vec<f64> = recording.torque_nm.iter().filter_map(first).collect();
    assert_eq!(
        torques,
        [0.0601, -0.9270, 0.0829, -0.1741, -0.0102, -0.0127, 0.0031]
    );
    assert_eq!(
        recording.force_n.map(|axis| axis.map(|axis| axis[0])),
        Some([-0.0310, -0.3334, -0.5925])
    );
    assert_eq!(recording.temperature_degc.as_deref().unwrap()[0], 22.016);
    assert!(recording.covariates.is_empty() && recording.position_m.is_none());
}

#[test]
fn a_gap_set_in_degrees_is_refused() {
    let Some(path) = shared("gap-sets/01-clean/log.csv.gz") else {
        return;
    };
    for joint in 0..7 {
        let mut recording = read_log(&path, &haptic7()).unwrap().recording;
        for reading in &mut recording.joint[joint] {
            *reading = reading.to_degrees();
        }
        let mut bytes = Vec::new();
        write_log_to(&mut bytes, &recording, &haptic7()).unwrap();
        let error = read(&String::from_utf8(bytes).unwrap(), &haptic7()).unwrap_err();
        assert_eq!(error.kind(), "looks-like-degrees", "{error}");
        assert_eq!(error.column_number(), Some(joint + 2));
    }
}

#[test]
fn a_real_robot_with_a_tracker_is_read() {
    let Some(path) = shared("measured/franka_fr3_camera/log.csv") else {
        return;
    };
    let mut shape = haptic7();
    shape.cable_count = 0;
    for joint in &mut shape.joints {
        (joint.lower, joint.upper) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let log = read_log(&path, &shape).unwrap();
    assert_eq!((log.warnings.len(), log.recording.len()), (0, 114));
    let orientation = log.recording.orientation_wxyz.unwrap();
    // 12 printed digits.
    assert!((orientation[2][0] - 0.999892565578).abs() < 1e-11);
}

#[test]
fn the_time_to_read_is_proportional_to_the_rows() {
    // 7 joints, 4 outputs, 1 cable, 7 torques, 3 forces, time: 23 columns. Ten times the rows
    // take ten times as long, and a loop over all rows for each row would take a hundred times.
    const ALLOWED_RATIO: f64 = 40.0;
    let seconds = [4_000, 40_000].map(|n| {
        let text = long_log(n);
        // The best of three: other programs run on the same machine.
        let times = [(); 3].map(|()| {
            let start = Instant::now();
            let log = read(&text, &haptic7()).unwrap();
            assert_eq!(log.recording.len(), n);
            start.elapsed().as_secs_f64()
        });
        times.into_iter().fold(f64::INFINITY, f64::min)
    });
    assert!(seconds[1] < ALLOWED_RATIO * seconds[0], "{seconds:?}");
}

fn long_log(n: usize) -> String {
    let wave = |phase: usize| {
        (0..n)
            .map(move |row| 0.5 + 0.4 * ((row + 31 * phase) as f64 * 0.01).sin())
            .collect()
    };
    let some = |phase: usize| Some::<Vec<f64>>(wave(phase));
    let recording = haptical_model::Recording {
        time_s: Some((0..n).map(|row| row as f64 * 0.001).collect()),
        joint: (0..7).map(wave).collect(),
        output: (0..4).map(some).collect(),
        cable_m: vec![some(1)],
        torque_nm: (0..7).map(some).collect(),
        force_n: Some([wave(1), wave(2), wave(3)]),
        ..Default::default()
    };
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, &recording, &haptic7()).unwrap();
    String::from_utf8(bytes).unwrap()
}
