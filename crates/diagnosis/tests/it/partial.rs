//! A heavy arm whose errors no catalogue has, beside one that it has: the cause that unseen postures support is named, with what
//! it leaves.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::Recording;
use haptical_model::kinematics::nalgebra::Vector3;

use crate::postures::{POSITION_SD_M, Posture, device, recorded_with};

/// Joints that yield, with their stiffness \[N m/rad\].
const SPRINGS: [(usize, f64); 3] = [(1, 2e4), (2, 1.5e4), (4, 8e3)];

/// An error of every joint that two angles decide together \[rad\]: in no catalogue.
fn of_two_angles(posture: &Posture<'_>, link: &mut [f64]) {
    for joint in 0..link.len() {
        let next = (joint + 1) % link.len();
        link[joint] += 4e-4 * (3.0 * posture.reading[joint] + 4.0 * posture.reading[next]).sin();
    }
}

fn elastic(seed: u64) -> Recording {
    recorded_with(seed, POSITION_SD_M, |posture, link| {
        of_two_angles(posture, link);
        for (joint, stiffness) in SPRINGS {
            link[joint] -= posture.torque[joint] / stiffness;
        }
        Vector3::zeros()
    })
}

fn without(recording: &Recording, names: &[&str]) -> Diagnosis {
    let options = Options {
        without: names.iter().map(|name| (*name).to_owned()).collect(),
        ..Options::default()
    };
    diagnose(&device(), recording, &options).unwrap()
}

#[test]
fn joints_that_yield_are_named_beside_what_no_effect_explains() {
    let mut within = 0;
    for seed in [1, 2, 3, 4] {
        let diagnosis = without(&elastic(seed), &[]);
        let causes = &diagnosis.causes;
        assert_eq!(diagnosis.verdict, Verdict::Named, "seed {seed}: {causes:?}");
        let closed = diagnosis.closed_unseen_share.unwrap();
        assert!((0.3..0.8).contains(&closed), "seed {seed}: {closed}");
        let left = diagnosis.unexplained_share;
        assert!((0.2..0.7).contains(&left), "seed {seed}: {left}");
        for (joint, stiffness) in SPRINGS {
            let is_own = |cause: &&haptical_diagnosis::CauseAnswer| cause.joint == Some(joint + 1);
            let cause = causes.iter().find(is_own).unwrap();
            assert_eq!(cause.effect, "joint-compliance", "seed {seed}");
            let [low, high] = cause.parameters["stiffness_nm_per_rad"].ci95;
            within += usize::from((low..high).contains(&stiffness));
        }
        assert_eq!(causes.len(), SPRINGS.len(), "seed {seed}: {causes:?}");
    }
    // of 12 intervals of 95 %: one draw in 500 has fewer
    assert!(within >= 9, "{within}");
}

#[test]
fn without_the_true_law_no_other_is_named() {
    let springs = [
        "joint-compliance",
        "capstan-compliance",
        "lateral-compliance",
        "base-compliance",
    ];
    for seed in [1, 2, 3, 4] {
        let diagnosis = without(&elastic(seed), &springs);
        let causes = &diagnosis.causes;
        assert_eq!(
            diagnosis.verdict,
            Verdict::Unknown,
            "seed {seed}: {causes:?}"
        );
        assert_eq!(diagnosis.closed_unseen_share, None);
    }
}

/// It yields by the square of its torque: a spring's column closes a part of that, and its law is broken.
#[test]
fn a_law_that_is_not_the_springs_is_not_named_as_one() {
    for seed in [1, 2, 3] {
        let recording = recorded_with(seed, POSITION_SD_M, |posture, link| {
            for joint in [1, 2, 4] {
                let torque = posture.torque[joint];
                link[joint] -= 3e-5 * torque + 1.2e-5 * torque * torque;
            }
            Vector3::zeros()
        });
        let diagnosis = without(&recording, &[]);
        let causes = &diagnosis.causes;
        assert_eq!(
            diagnosis.verdict,
            Verdict::Unknown,
            "seed {seed}: {causes:?}"
        );
    }
}

#[test]
fn errors_of_no_catalogue_alone_are_not_named() {
    for seed in [1, 2, 3, 4] {
        let recording = recorded_with(seed, POSITION_SD_M, |posture, link| {
            of_two_angles(posture, link);
            Vector3::zeros()
        });
        let diagnosis = without(&recording, &[]);
        let causes = &diagnosis.causes;
        assert_eq!(
            diagnosis.verdict,
            Verdict::Unknown,
            "seed {seed}: {causes:?}"
        );
    }
}
