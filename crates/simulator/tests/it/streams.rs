//! Random numbers do not depend on other noises, other channels or the number of rows.

use haptical_simulator::{Noise, Sampling, Settings, simulate, simulate_transmission};

use crate::device::{arm, transmissions_only};

const ROWS: usize = 100;

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    let truth = arm();
    for settings in [Settings::paper(), Settings::real_encoders()] {
        let recording = simulate(&truth, &settings, ROWS, 41).expect("a recording");
        assert_eq!(
            simulate(&truth, &settings, ROWS, 41).expect("again"),
            recording
        );
        let other = simulate(&truth, &settings, ROWS, 42).expect("a recording");
        for (a, b) in recording.joint.iter().zip(&other.joint) {
            assert!(a.iter().zip(b).filter(|(a, b)| a == b).count() < 3);
        }
        assert_ne!(recording.output, other.output);
        assert_ne!(recording.cable_m, other.cable_m);
    }
}

#[test]
fn a_row_does_not_depend_on_the_number_of_rows() {
    let truth = arm();
    for sampling in [Sampling::Normal, Sampling::Uniform] {
        let settings = Settings {
            sampling,
            minimum_distance_m: 0.5,
            ..Settings::paper()
        };
        let long = simulate(&truth, &settings, ROWS, 43).expect("a recording");
        for rows in [0, 1, 17, 99] {
            let short = simulate(&truth, &settings, rows, 43).expect("a recording");
            let first: Vec<usize> = (0..rows).collect();
            if rows > 0 {
                assert_eq!(short, long.select(&first), "{rows} rows");
            }
            assert_eq!(short.len(), rows);
        }
        let long = simulate_transmission(&truth, &settings, 0, ROWS, 43).expect("a recording");
        let short = simulate_transmission(&truth, &settings, 0, 17, 43).expect("a recording");
        assert_eq!(short, long.select(&(0..17).collect::<Vec<usize>>()));
    }
}

#[test]
fn switching_one_noise_changes_nothing_else() {
    let truth = arm();
    let paper = Settings::paper();
    let all = simulate(&truth, &paper, ROWS, 44).expect("a recording");
    for noise in [Noise::None, Noise::Counts, Noise::GaussianAndCounts] {
        let settings = Settings {
            output_noise: noise,
            ..paper
        };
        let changed = simulate(&truth, &settings, ROWS, 44).expect("a recording");
        assert_eq!(changed.joint, all.joint);
        assert_eq!(changed.cable_m, all.cable_m);
        assert_ne!(changed.output, all.output);
        let settings = Settings {
            cable_noise: noise,
            ..paper
        };
        let changed = simulate(&truth, &settings, ROWS, 44).expect("a recording");
        assert_eq!(changed.joint, all.joint);
        assert_eq!(changed.output, all.output);
        assert_ne!(changed.cable_m, all.cable_m);
    }
    let settings = Settings {
        motor_counts: true,
        ..paper
    };
    let changed = simulate(&truth, &settings, ROWS, 44).expect("a recording");
    assert_eq!((changed.output, changed.cable_m), (all.output, all.cable_m));
    assert_ne!(changed.joint, all.joint);
}

#[test]
fn channels_do_not_disturb_each_other() {
    let truth = arm();
    let settings = Settings {
        minimum_distance_m: 0.0,
        ..Settings::paper()
    };
    let all = simulate(&truth, &settings, ROWS, 45).expect("a recording");
    let mut one_cable = truth.clone();
    one_cable.cables.truncate(1);
    let recording = simulate(&one_cable, &settings, ROWS, 45).expect("a recording");
    assert_eq!(recording.cable_m[0], all.cable_m[0]);
    assert_eq!(
        (&recording.joint, &recording.output),
        (&all.joint, &all.output)
    );
    let mut no_encoder = truth.clone();
    no_encoder.joints[2].external_encoder_counts_per_rev = None;
    no_encoder.joints[2].external_encoder_sd_rad = None;
    let recording = simulate(&no_encoder, &settings, ROWS, 45).expect("a recording");
    assert_eq!(recording.output[2], None);
    assert_eq!(recording.output[..2], all.output[..2]);
    assert_eq!(recording.cable_m, all.cable_m);
    let recording = simulate(&transmissions_only(), &settings, ROWS, 45).expect("a recording");
    assert_eq!((recording.joint, recording.output), (all.joint, all.output));
    assert_eq!(recording.cable_m, [None, None], "no links, no handle");
}

#[test]
fn one_seed_serves_every_recording_of_a_device() {
    let truth = arm();
    let settings = Settings::paper();
    let device = simulate(&truth, &settings, ROWS, 46).expect("a recording");
    let alone: Vec<Vec<f64>> = (0..3)
        .map(|joint| {
            let recording = simulate_transmission(&truth, &settings, joint, ROWS, 46);
            let sd = truth.joints[joint].sampling_sd_rad.expect("given");
            let column = recording.expect("a recording").joint[joint].clone();
            column.iter().map(|reading| reading / sd).collect()
        })
        .collect();
    let together: Vec<f64> = device.joint[0]
        .iter()
        .map(|x| x / 0.523_598_775_598_298_8)
        .collect();
    for (a, b) in [
        (&alone[0], &alone[1]),
        (&alone[1], &alone[2]),
        (&alone[0], &together),
    ] {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() > 1e-9));
    }
}
