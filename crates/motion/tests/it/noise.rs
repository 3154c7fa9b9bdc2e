//! Noise of the torques: with a memory, and of slow logs with friction.

use haptical_model::Recording;
use haptical_motion::examine;

use crate::arm::{Truth, device, recording};

#[test]
fn a_noise_with_a_memory_is_no_gap_and_hides_no_cause() {
    for seed in 1..5 {
        let sound = Truth {
            lasting_nm: 0.1,
            ..Truth::default()
        };
        let found = examine(&device(), &recording(sound, seed), None, &[]).unwrap();
        let names = &found.findings;
        assert!(!found.has_gap() && names.is_empty(), "{seed}: {names:?}");
        assert!(found.has_memory(), "{seed}");
        for channel in &found.channels {
            let ratio = channel.rms_after / channel.noise;
            assert!((0.85..1.1).contains(&ratio), "{seed}: {ratio}");
        }
        let loaded = Truth {
            payload_kg: 0.4,
            ..sound
        };
        let found = examine(&device(), &recording(loaded, seed), None, &[]).unwrap();
        let names = &found.findings;
        assert!(found.is_adequate(), "{seed}: {names:?}");
        assert_eq!(names[0].effect, "payload", "{seed}");
    }
}

/// What comes at reversals alone has much of the spectrum of such a noise; of less than the noise's size it is not seen.
#[test]
fn friction_near_rest_is_no_noise_with_a_memory() {
    let truth = Truth {
        stribeck_nm: 2.0,
        lasting_nm: 0.1,
        ..Truth::default()
    };
    let without = ["stribeck-friction".to_owned(), "presliding".to_owned()];
    for seed in 1..4 {
        let found = examine(&device(), &recording(truth, seed), None, &without).unwrap();
        let is_gap = found.has_gap() && !found.is_adequate();
        assert!(is_gap, "{seed}: {:?}", found.findings);
    }
}

/// At 100 rows a second half a second holds a reversal nearly always.
#[test]
fn friction_is_no_noise_of_a_slow_log() {
    let truth = Truth {
        rough_nm: 8.0,
        ..Truth::default()
    };
    for seed in 1..4 {
        let fast: Recording = recording(truth, seed);
        let rows: Vec<usize> = (0..fast.len()).step_by(2).collect();
        let found = examine(&device(), &fast.select(&rows), None, &[]).unwrap();
        let [rough, plain] = [0, 1].map(|joint: usize| found.channels[joint].noise);
        assert!(rough < 5.0 * plain, "{seed}: {rough} {plain}");
    }
}
