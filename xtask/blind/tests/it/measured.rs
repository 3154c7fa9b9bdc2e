//! Suites like measured sets: what their members are, and that an effect is where the truth says.

use haptical_model::Recording;
use xtask_blind::{Suite, Trial, Truth};

fn trials(suite: Suite, count: u64) -> Vec<Trial> {
    (0..count)
        .map(|index| suite.draw(index, 11).expect("a trial"))
        .collect()
}

const SUITES: [Suite; 5] = [
    Suite::Elastic,
    Suite::Repeats,
    Suite::Moved,
    Suite::Coloured,
    Suite::Wrist,
];

/// Every suite has clean recordings, effects with names and withheld ones; what is withheld is not right.
#[test]
fn each_has_clean_named_and_withheld_members() {
    for suite in SUITES {
        let truths: Vec<_> = trials(suite, 10).into_iter().map(|t| t.truth).collect();
        assert!(truths.iter().any(Truth::is_clean), "{}", suite.name());
        assert!(
            truths
                .iter()
                .any(|t| t.is_unknown() && !t.without.is_empty()),
            "{}",
            suite.name()
        );
        assert!(
            truths.iter().any(|t| !t.is_clean() && !t.is_unknown()),
            "{}",
            suite.name()
        );
        for truth in &truths {
            let right = truth.right.iter().flatten().chain(&truth.acceptable);
            for name in right {
                assert!(!truth.without.contains(name), "{}: {name}", truth.name);
            }
        }
    }
}

/// Gaps of yielding arms are 3 to 30 of the stated standard deviations, and those of rigid arms nothing.
#[test]
fn arms_yield_as_far_as_they_should() {
    for trial in trials(Suite::Elastic, 20) {
        let gap = trial.truth.gap["position"].over_sd;
        if trial.truth.is_clean() {
            assert!(gap < 1e-9, "{gap}");
        } else {
            // the noise is up to 1.3 times what is stated either way
            assert!((2.3..40.0).contains(&gap), "{}: {gap}", trial.truth.name);
        }
        let rows = trial.log.len();
        assert!((36..=505).contains(&rows), "{rows}");
        assert!(trial.log.position_m.is_some());
        let sees_gravity = trial.device.gravity_mps2.is_some();
        assert!(sees_gravity && trial.device.bodies[1..].iter().all(Option::is_some));
    }
}

fn posture(log: &Recording, row: usize) -> Vec<u64> {
    log.joint
        .iter()
        .map(|column| column[row].to_bits())
        .collect()
}

/// Every posture is recorded as often as every other, two to five times.
#[test]
fn repeats_repeat() {
    for trial in trials(Suite::Repeats, 8) {
        let mut counts = std::collections::BTreeMap::new();
        for row in 0..trial.log.len() {
            *counts.entry(posture(&trial.log, row)).or_insert(0) += 1;
        }
        let times = trial.log.len() / counts.len();
        assert!((2..=5).contains(&times) && counts.values().all(|count| *count == times));
    }
}

/// A tracker that is moved is moved between all runs: distances between two markers of one run are those of the arm,
/// whatever the place, so that the first run's alone would not show it.
#[test]
fn moved_trackers_have_several_runs() {
    for trial in trials(Suite::Moved, 8) {
        let run = trial.log.run.as_ref().expect("runs");
        let last = run.last().copied().expect("a row");
        assert!((1..=3).contains(&last));
        assert!(run.is_sorted());
    }
}

/// Slip elements: where the motor has gone one way for long, the joint is behind it by half the play, and the two ways
/// differ by all of it.
#[test]
fn wrists_play() {
    let trial = Suite::Wrist.draw(5, 3).expect("a trial of plays alone");
    let joint = trial.truth.joint.expect("a joint") - 1;
    let width = trial.truth.effects[0].law[&format!("width{}_rad", joint + 1)];
    let motor = &trial.log.joint[joint];
    let output = trial.log.output[joint].as_ref().expect("an encoder");
    let starts = |row: usize| {
        let run = trial.log.run.as_ref();
        run.is_some_and(|run| run[row] != run[row - 1])
    };
    // travel since the last reversal
    let (mut travel, mut sums, mut counts) = (0.0_f64, [0.0; 2], [0.0; 2]);
    for row in 1..motor.len() {
        let step = motor[row] - motor[row - 1];
        if starts(row) || step * travel < 0.0 {
            travel = 0.0;
        } else {
            travel += step;
        }
        if travel.abs() > 4.0 * width {
            let way = usize::from(travel > 0.0);
            sums[way] += output[row] - motor[row];
            counts[way] += 1.0;
        }
    }
    assert!(counts.iter().all(|count| *count > 20.0), "{counts:?}");
    let apart = sums[0] / counts[0] - sums[1] / counts[1];
    // bends add up to a third
    assert!(
        (0.9 * width..1.4 * width).contains(&apart),
        "{apart} of {width}"
    );
}
