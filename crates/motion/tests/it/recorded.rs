//! Whether anything was measured is asked of the torques as they were read, not of what is left without the device's effects.

use haptical_model::{AddedBy, AddedReadings, Recording};
use haptical_motion::{MotionError, examine, link_torques, torque_nm_without_effects};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::arm::{Truth, device, recording};

/// Dry and viscous friction of each joint, as a device's file has it.
const FRICTION: [[f64; 2]; 2] = [[1.5, 0.8], [0.6, 0.3]];
/// Speeds within which it turns over there: that of the arm, and far off it \[rad/s\].
const TURNOVERS: [f64; 2] = [0.006, 0.0015];

/// With what an effect of the device's file adds to the torque of a joint, by the joint's angle, speed and torque.
fn with(mut log: Recording, by: AddedBy, joint: usize, law: impl Fn([f64; 3]) -> f64) -> Recording {
    let angles = &log.joint[joint];
    let torque_nm = log.torque_nm[joint].as_ref().unwrap();
    let reading = |row: usize| {
        let (from, to) = (row.saturating_sub(1), (row + 1).min(angles.len() - 1));
        let speed = (angles[to] - angles[from]) / (0.005 * (to - from) as f64);
        law([angles[row], speed, torque_nm[row]])
    };
    let readings = (0..angles.len()).map(reading).collect();
    log.added.push(AddedReadings {
        effect: log.added.len(),
        channel: format!("torque{}_nm", joint + 1),
        axis: 0,
        by,
        readings,
        at: Vec::new(),
        slopes: Vec::new(),
    });
    log
}

/// With the friction of the device's file, which turns over within a speed there.
fn with_friction(log: Recording, turnover: f64) -> Recording {
    FRICTION.iter().zip(0..).fold(log, |log, (own, joint)| {
        let [coulomb, viscous] = *own;
        let law = |[_, speed, _]: [f64; 3]| coulomb * (speed / turnover).tanh() + viscous * speed;
        with(log, AddedBy::Friction, joint, law)
    })
}

/// What is found, first name and first number.
fn first(log: &Recording) -> (&'static str, Option<usize>, f64) {
    let found = examine(&device(), log, None, &[]).unwrap();
    assert!(found.is_adequate(), "{:?}", found.findings);
    let own = &found.findings[0];
    (own.effect, own.joint, own.numbers[0].1)
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
            match examine(
                &device(),
                &with_friction(of_noise(sd_nm, seed), TURNOVERS[0]),
                None,
                &[],
            ) {
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
    let mut log = with_friction(recording(Truth::default(), 1), TURNOVERS[0]);
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
fn a_sound_arm_has_no_gap_whatever_friction_its_file_has() {
    for (seed, turnover, times) in [
        (1, TURNOVERS[0], 1.0),
        (2, TURNOVERS[1], 1.0),
        (3, 0.1, 5.0),
    ] {
        let mut log = with_friction(recording(Truth::default(), seed), turnover);
        let added = log.added.iter_mut().flat_map(|own| &mut own.readings);
        added.for_each(|own| *own *= times);
        let without = torque_nm_without_effects(&device(), &log, 0).unwrap();
        let read = log.torque_nm[0].as_ref().unwrap();
        let (added, row) = (&log.added[0].readings, 1234);
        assert!((without[row] + added[row] - read[row]).abs() < 1e-12);
        let found = examine(&device(), &log, None, &[]).unwrap();
        assert!(!found.has_gap(), "{:?}", found.channels);
        // nor by another noise
        assert!(!found.has_memory() && found.findings.is_empty());
        assert!(found.doubts.is_empty(), "{:?}", found.doubts);
    }
}

/// Friction that is fitted is compared with that of the file: it is no gap, and is not passed over either.
#[test]
fn friction_that_is_not_that_of_the_file_is_listed() {
    let examined = |seed: u64, times: f64| {
        let mut log = with_friction(recording(Truth::default(), seed), TURNOVERS[0]);
        let of_joint = &mut log.added[0];
        assert_eq!(of_joint.channel, "torque1_nm");
        of_joint.readings.iter_mut().for_each(|own| *own /= times);
        examine(&device(), &log, None, &[]).unwrap()
    };
    let friction = |seed: u64, times: f64| examined(seed, times).other_friction;
    let coulomb = |seed: u64, times: f64| {
        let all = examined(seed, times).adjusted.into_iter();
        let mut own = all.filter(|own| own.joint == 0 && own.number == "coulomb_nm");
        own.next().unwrap()
    };
    for seed in 1..=4 {
        for as_good_as_that in [1.0, 1.1] {
            assert_eq!(friction(seed, as_good_as_that), [], "{seed}");
        }
        for times in [0.5, 2.0, 10.0] {
            let found = friction(seed, times);
            assert_eq!(found.len(), 1, "{seed} {times}: {found:?}");
            let (joint, of_file) = found[0];
            assert_eq!(joint, 0);
            assert!((of_file / times - 1.0).abs() < 0.1, "{times}: {of_file}");
            // what is fitted beside the file's friction and the share that is kept of it are one number
            let (friction, sd) = coulomb(seed, times).beside(FRICTION[0][0] / times);
            assert!(
                (friction - FRICTION[0][0]).abs() < 0.1,
                "{times}: {friction}"
            );
            assert!(sd < 0.05, "{times}: {sd}");
        }
    }
}

/// A device with the friction of its drives is told what one without is told.
#[test]
fn friction_of_the_file_hides_no_cause() {
    let truths = [
        Truth {
            late_s: 0.012,
            ..Truth::default()
        },
        Truth {
            late_s: 0.04,
            ..Truth::default()
        },
        Truth {
            end_nm: Some(3.0),
            ..Truth::default()
        },
        Truth {
            payload_kg: 0.8,
            ..Truth::default()
        },
    ];
    for truth in truths {
        for turnover in TURNOVERS {
            let log = recording(truth, 1);
            let (effect, joint, number) = first(&log);
            let with = first(&with_friction(log, turnover));
            assert_eq!((effect, joint), (with.0, with.1), "{truth:?}");
            assert!((with.2 / number - 1.0).abs() < 0.05, "{number} {}", with.2);
        }
    }
}

/// Friction of a law that the base model has not is a cause by as much as there is more of it than in the file.
#[test]
fn friction_that_grew_beyond_the_file_has_a_name() {
    let truth = |stribeck_nm: f64| Truth {
        stribeck_nm,
        ..Truth::default()
    };
    let stribeck = |log: Recording| {
        with(
            with_friction(log, TURNOVERS[0]),
            AddedBy::Friction,
            0,
            |own| {
                let [_, speed, _] = own;
                1.0 / (1.0 + (speed / 0.15).powi(2)) * (speed / 0.006).tanh()
            },
        )
    };
    let as_in_file = examine(&device(), &stribeck(recording(truth(1.0), 1)), None, &[]).unwrap();
    assert!(!as_in_file.has_gap() && as_in_file.findings.is_empty());
    let (effect, joint, more_nm) = first(&stribeck(recording(truth(2.5), 1)));
    assert_eq!((effect, joint), ("stribeck-friction", Some(0)));
    let (.., whole_nm) = first(&recording(truth(2.5), 1));
    assert!(
        (more_nm / whole_nm - 0.6).abs() < 0.06,
        "{more_nm} {whole_nm}"
    );
}

/// An effect that follows the motion is late with it, one that is a share of the reading is not; either is a cause where it changed.
#[test]
fn effects_of_the_file_are_part_of_the_model() {
    let cogging = |log: Recording| {
        with(log, AddedBy::Motion, 0, |[angle, ..]| {
            0.6 * (30.0 * angle + 0.4).sin()
        })
    };
    let gain = |log: Recording| {
        with(log, AddedBy::Reading, 1, |[_, _, torque_nm]| {
            0.3 / 1.3 * torque_nm
        })
    };
    let truth = |late_s: f64| Truth {
        late_s,
        cogging_nm: 0.6,
        gain: 0.3,
        ..Truth::default()
    };
    let sound = examine(
        &device(),
        &gain(cogging(recording(truth(0.0), 1))),
        None,
        &[],
    )
    .unwrap();
    assert!(!sound.has_gap() && sound.findings.is_empty());
    let (effect, joint, late_s) = first(&gain(cogging(recording(truth(0.04), 1))));
    assert_eq!((effect, joint), ("encoder-latency", None));
    assert!((late_s - 0.04).abs() < 0.003, "{late_s}");
    let grown = Truth {
        cogging_nm: 1.2,
        ..truth(0.0)
    };
    let (effect, joint, size_nm) = first(&gain(cogging(recording(grown, 1))));
    assert_eq!((effect, joint), ("motor-cogging", Some(0)));
    assert!((size_nm - 0.6).abs() < 0.03, "{size_nm}");
}

#[test]
fn a_drive_carries_the_force_of_a_hand_that_is_in_the_log() {
    let device = device();
    let of = |push_n: f64| {
        let truth = Truth {
            push_n,
            ..Truth::default()
        };
        recording(truth, 5)
    };
    let (mut pushed, free) = (of(60.0), of(0.0));
    // along the base's x, in the frame of the handle
    let times = pushed.time_s.as_ref().unwrap().iter();
    let angles = pushed.joint[0].iter().zip(&pushed.joint[1]);
    let axes = times.zip(angles).map(|(time, (q1, q2))| {
        let force_n = if (8.0..9.5).contains(time) { 60.0 } else { 0.0 };
        let (sine, cosine) = (q1 + q2).sin_cos();
        [force_n * cosine, -force_n * sine]
    });
    let (along, across): (Vec<f64>, Vec<f64>) = axes.map(|[x, y]| (x, y)).unzip();
    pushed.force_n = Some([along, across.clone(), vec![0.0; across.len()]]);
    let [with, without] = [&pushed, &free].map(|log| link_torques(&device, log).unwrap());
    for joint in 0..2 {
        let read = |log: &Recording, row: usize| log.torque_nm[joint].as_ref().unwrap()[row];
        let mut largest_nm = 0.0_f64;
        for row in 1700..1800 {
            let load_nm = with[joint][row] - without[joint][row];
            // both logs have the same noise
            let pushed_nm = read(&pushed, row) - read(&free, row);
            assert!((load_nm - pushed_nm).abs() < 1e-2, "{load_nm} {pushed_nm}");
            largest_nm = largest_nm.max(pushed_nm.abs());
        }
        assert!(largest_nm > 2.0, "{largest_nm}");
    }
}
