//! Whether anything was measured is asked of the torques as they were read, not of what is left without the device's effects.

use haptical_model::{AddedReadings, Recording};
use haptical_motion::{MotionError, examine, torque_nm_without_effects};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::arm::{Truth, device, recording};

/// With what dry and viscous friction of the device's file add to the torques.
fn with_friction(log: Recording) -> Recording {
    let added = [(1.5, 0.8), (0.6, 0.3)].into_iter().enumerate();
    let added = added.map(|(joint, (coulomb, viscous))| {
        let angles = &log.joint[joint];
        let speed = |row: usize| {
            let (from, to) = (row.saturating_sub(1), (row + 1).min(angles.len() - 1));
            (angles[to] - angles[from]) / (0.005 * (to - from) as f64)
        };
        let friction = |own: f64| coulomb * (own / 0.006).tanh() + viscous * own;
        AddedReadings {
            effect: joint,
            channel: format!("torque{}_nm", joint + 1),
            axis: 0,
            readings: (0..angles.len()).map(|row| friction(speed(row))).collect(),
            at: Vec::new(),
            slopes: Vec::new(),
        }
    });
    Recording {
        added: added.collect(),
        ..log
    }
}

/// The sound arm's log with noise of this size in the place of its torques \[N m\].
fn of_noise(sd_nm: f64, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut log = recording(Truth::default(), seed);
    for reading in log.torque_nm.iter_mut().flatten().flatten() {
        let noise: f64 = StandardNormal.sample(&mut random);
        *reading = sd_nm * noise;
    }
    log
}

#[test]
fn noise_is_no_torque_of_an_arm_whose_file_has_friction() {
    for seed in 1..=4 {
        for sd_nm in [0.5, 2.0, 6.0] {
            match examine(&device(), &with_friction(of_noise(sd_nm, seed)), None, &[]) {
                Ok(found) => assert!(
                    found.has_gap() && !found.is_answer() && !found.doubts.is_empty(),
                    "{sd_nm} {seed}: {:?}",
                    found.findings
                ),
                Err(why) => assert_eq!(why, MotionError::Noise, "{sd_nm} {seed}"),
            }
        }
    }
}

#[test]
fn a_torque_of_one_value_was_not_measured_whatever_an_effect_adds() {
    let mut log = with_friction(recording(Truth::default(), 1));
    for reading in log.torque_nm.iter_mut().flatten().flatten() {
        *reading = 0.0;
    }
    assert_eq!(
        torque_nm_without_effects(&device(), &log, 0),
        log.torque_nm[0]
    );
    let refused = examine(&device(), &log, None, &[]).unwrap_err();
    assert_eq!(refused, MotionError::Constant);
}

#[test]
fn friction_of_the_file_is_taken_off_a_sound_arms_torques() {
    for seed in 1..=3 {
        let log = with_friction(recording(Truth::default(), seed));
        let without = torque_nm_without_effects(&device(), &log, 0).unwrap();
        let read = log.torque_nm[0].as_ref().unwrap();
        let (added, row) = (&log.added[0].readings, 1234);
        assert!((without[row] + added[row] - read[row]).abs() < 1e-12);
        let found = examine(&device(), &log, None, &[]).unwrap();
        assert!(found.doubts.is_empty(), "{:?}", found.doubts);
    }
}
