//! When positions show a gap that falsifies the geometry of the torques.

use haptical_calibration::Channel;
use haptical_effects::{Context, streams};
use haptical_model::{Device, Recording};

use crate::force::recorded::positions_show_a_gap;

/// A count of the external encoder.
const COUNT_RAD: f64 = 3e-4;

/// A slow sweep, 1000 rows a second, of a joint whose link is `error` of its angle ahead.
fn is_seen(error: impl Fn(f64) -> f64) -> bool {
    let device = Device::from_toml("[[joint]]\n", "one.toml").unwrap().device;
    let time_s: Vec<f64> = (0..8000).map(|row| 1e-3 * f64::from(row)).collect();
    let angles: Vec<f64> = time_s.iter().map(|time| (0.4 * time).sin()).collect();
    let counted = |angle: &f64| ((angle + error(*angle)) / COUNT_RAD).round() * COUNT_RAD;
    let recording = Recording {
        line: (2..8002).collect(),
        output: vec![Some(angles.iter().map(counted).collect())],
        torque_nm: vec![None],
        time_s: Some(time_s),
        joint: vec![angles],
        ..Recording::default()
    };
    let streams = streams(&device, &[Channel::Output { joint: 0 }]);
    let context = Context::new(&device, &recording, &streams).unwrap();
    positions_show_a_gap(&context)
}

/// Most rows of a slow motion repeat the reading before: what they differ by is no measure of what they are off by.
#[test]
fn whole_counts_of_a_slow_motion_are_no_gap() {
    assert!(!is_seen(|_| 0.0));
    assert!(is_seen(|angle| COUNT_RAD * (3.0 * angle).sin()));
}
