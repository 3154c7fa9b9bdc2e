//! The scale of torques that are read in counts.

use haptical_servo::{Finding, JointLog, torque_gain};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const COUNT_NM: f64 = 0.022814;

/// Torques of a joint that moves to and fro under a weight, in counts, with the six digits of a log.
fn torques(seed: u64, size_nm: f64, scale: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..3000)
        .map(|row| {
            let torque =
                size_nm * (0.01 * row as f64).sin() + random.random_range(-1.5..1.5) * COUNT_NM;
            let read = (torque.abs() / COUNT_NM).round() * COUNT_NM * scale(row);
            (read * 1e6).round() / 1e6
        })
        .collect()
}

fn found(torque: &[f64]) -> Option<Finding> {
    let time_s: Vec<f64> = (0..torque.len()).map(|row| 0.02 * row as f64).collect();
    torque_gain(&JointLog {
        time_s: Some(&time_s),
        torque: Some(torque),
        response: torque,
        ..JointLog::default()
    })
}

#[test]
fn a_factor_of_four_is_placed_both_ways() {
    for seed in 0..10 {
        // from a joint that carries nothing to one of 40 counts
        let size_nm = 0.1 * seed as f64;
        let at = 700 + 150 * seed as usize;
        for (factor, scales) in [(4.0, [1.0, 4.0]), (0.25, [4.0, 1.0])] {
            let torque = torques(seed, size_nm, |row| scales[usize::from(row >= at)]);
            let finding = found(&torque).unwrap();
            assert_eq!(finding.effect, "torque-gain");
            assert_eq!(finding.numbers[0].value, factor, "{seed}");
            let [first, likeliest, last] = finding.since.unwrap().rows;
            assert!(likeliest.abs_diff(at) < 10, "{seed} {factor}: {finding:?}");
            assert!(
                first <= at + 1 && at <= last + 1,
                "{seed} {factor}: {finding:?}"
            );
        }
    }
}

#[test]
fn sound_torques_and_readings_without_counts_show_none() {
    for seed in 0..20 {
        assert_eq!(
            found(&torques(seed, 0.1 * seed as f64, |_| 1.0)),
            None,
            "{seed}"
        );
    }
    // it rests at four counts for the second half: one value is no scale
    let rests = torques(3, 0.8, |_| 1.0);
    let rests = rests
        .iter()
        .enumerate()
        .map(|(row, own)| if row < 1500 { *own } else { 4.0 * COUNT_NM });
    assert_eq!(found(&rests.collect::<Vec<_>>()), None);
    let smooth: Vec<f64> = (0..3000).map(|row| (0.01 * f64::from(row)).sin()).collect();
    assert_eq!(found(&smooth), None);
    assert_eq!(found(&[0.0; 3000]), None);
}
