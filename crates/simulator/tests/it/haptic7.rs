//! The device of the paper.

use haptical_simulator::model::Recording;
use haptical_simulator::{Settings, apply_deviations, simulate, true_poses};
use haptical_testkit::haptic7;

#[test]
fn two_hundred_poses_of_the_paper_s_device() {
    let nominal = haptic7();
    let assigned = [
        ("a3", 2e-3),
        ("ratio_deviation1", 0.025),
        ("length_deviation4[1]", -5e-4),
    ];
    let truth = apply_deviations(&nominal, &assigned).expect("a device");
    for settings in [Settings::paper(), Settings::real_encoders()] {
        let recording = simulate(&truth, &settings, 200, 71).expect("a recording");
        let present: Vec<bool> = recording.output.iter().map(Option::is_some).collect();
        assert_eq!(present, [true, true, true, true, false, false, false]);
        let cable_m = recording.cable_m[0].as_ref().expect("a cable");
        // design study with another program: 5 to 95 % of the cable lengths are 0.10 to 0.48 m; the
        // share of 200 poses has a standard deviation of 2 %, five of them are 10 %
        let inside = cable_m
            .iter()
            .filter(|length| (0.10..0.48).contains(*length))
            .count();
        assert!((160..200).contains(&inside), "{inside} of 200");
        // the limit of 30 mm, less 5 standard deviations of noise
        assert!(cable_m.iter().all(|length| *length > 0.029_95));
        let poses = true_poses(&truth, &recording).expect("poses");
        // a tenth of a millimetre: 10 micrometres of noise, readings rounded to at most 0.3 mrad
        // at a distance of 0.3 m from the axis
        for (pose, distance) in poses.iter().zip(cable_m) {
            assert!((pose.position_m.norm() - distance).abs() < 1e-4);
        }
        // the capstan turns by R / (R + R_e) of what its encoder says; noise is 0.1 mrad
        let outputs = recording.output[0].as_ref().expect("a capstan");
        for (reading, output) in recording.joint[0].iter().zip(outputs) {
            assert!((output - reading * 8.0 / 8.025).abs() < 1e-3);
        }
    }
}

/// The handle at home is known from another program to 0.5 mm.
const HOME_TOLERANCE_M: f64 = 5e-4;

#[test]
fn the_paper_s_device_at_home() {
    let nominal = haptic7();
    let recording = Recording {
        joint: vec![vec![0.0]; 7],
        ..Recording::default()
    };
    let poses = true_poses(&nominal, &recording).expect("a pose");
    for (axis, want) in [0.072, 0.053, 0.091].into_iter().enumerate() {
        let got = poses[0].position_m[axis];
        assert!(
            (got - want).abs() < HOME_TOLERANCE_M + 1e-12,
            "axis {axis}: {got}"
        );
    }
}
