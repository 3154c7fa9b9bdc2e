//! A second recording is predicted by the model of the first, and fitted together with it.

use haptical_motion::{Examined, examine};

use super::arm::{Truth, device, recording, second_recording};

/// Largest root mean square over the noise of any torque: predicted, and by one fit of both in either recording.
fn left(found: &Examined) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for own in &found.unseen {
        let square = own.after.iter().sum::<f64>() / own.rows_in_all() as f64;
        most[0] = most[0].max(square.sqrt() / own.noise);
        let [first, second] = own.of_both.unwrap();
        most[1] = most[1].max(first).max(second);
    }
    most
}

#[test]
fn one_fit_of_both_leaves_noise_of_two_recordings_of_one_arm_and_more_of_two_arms() {
    for seed in 1..=4 {
        let first = recording(Truth::default(), seed);
        let with = |truth: Truth| {
            let second = second_recording(truth, seed);
            examine(&device(), &first, Some(&second), &[]).unwrap()
        };
        let [_, right] = left(&with(Truth::default()));
        assert!(right < 1.1, "{seed}: {right}");
        for truth in [
            Truth {
                payload_kg: 0.6,
                ..Truth::default()
            },
            Truth {
                offset_nm: 1.0,
                ..Truth::default()
            },
        ] {
            let found = with(truth);
            assert!(!found.has_gap() && found.findings.is_empty());
            let [predicted, of_both] = left(&found);
            assert!(
                predicted > 1.5 && of_both > 1.5,
                "{seed}: {predicted} {of_both}"
            );
        }
    }
}
