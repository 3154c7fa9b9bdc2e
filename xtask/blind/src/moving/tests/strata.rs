//! Which trials there are, and that a strong effect changes what an arm without it would log.

use std::collections::BTreeSet;

use crate::moving::kinds::{FOREIGN, NAMED};
use crate::moving::plan::{Stratum, plan};
use crate::moving::trial::make;
use crate::random::Random;
use crate::suites::Suite;
use crate::trial::Trial;

fn trial(index: u64) -> Trial {
    Suite::Moving.draw(index, 23).unwrap()
}

/// Sixty trials have every strong effect, every foreign one, all ways of wrong torques, and a fifth of them is clean.
#[test]
fn sixty_trials_have_all_kinds() {
    let plans: Vec<_> = (0..60)
        .map(|index| plan(index, &mut Random::new(1, index)))
        .collect();
    let labels = |stratum: Stratum| -> BTreeSet<&str> {
        let of = plans.iter().filter(|plan| plan.stratum == stratum);
        of.flat_map(|plan| plan.kinds.iter().map(|kind| kind.label))
            .collect()
    };
    assert_eq!(labels(Stratum::Strong).len(), NAMED.len());
    assert_eq!(labels(Stratum::Foreign).len(), FOREIGN.len());
    let count = |stratum: Stratum| plans.iter().filter(|plan| plan.stratum == stratum).count();
    assert_eq!(count(Stratum::Clean), 12);
    assert_eq!((count(Stratum::Weak), count(Stratum::Withheld)), (6, 6));
    assert_eq!((count(Stratum::Pair), count(Stratum::Sloppy)), (3, 3));
    for plan in plans.iter().filter(|plan| plan.stratum == Stratum::Pair) {
        assert_eq!(plan.kinds.len(), 2);
        assert_ne!(plan.kinds[0].label, plan.kinds[1].label);
    }
}

#[test]
fn truths_say_what_is_right() {
    let unknown = vec![vec!["unknown".to_owned()]];
    let payload = trial(0).truth;
    assert_eq!(
        (payload.right, payload.name.as_str()),
        (vec![vec!["payload".to_owned()]], "payload")
    );
    let clean = trial(1).truth;
    assert!(clean.is_clean() && clean.effects.is_empty() && clean.name == "clean");
    let dent = trial(3).truth;
    assert_eq!((dent.name.as_str(), &dent.right), ("dent", &unknown));
    assert_eq!(dent.depends_on, [format!("theta{}", dent.joint.unwrap())]);
    let weak = trial(6).truth;
    assert!(weak.name.ends_with("-weak") && weak.effects[0].size == 0.25 && !weak.is_unknown());
    let withheld = trial(8).truth;
    assert_eq!(withheld.right, unknown);
    assert_eq!(withheld.without, ["capstan-compliance", "joint-compliance"]);
    let pair = trial(11).truth;
    assert_eq!((pair.right.len(), pair.effects.len()), (2, 2));
    let sloppy = trial(19).truth;
    assert!(sloppy.name.starts_with("torques-of-") && sloppy.right == unknown);
    let mode = trial(33).truth;
    assert!(mode.name == "controller-mode" && mode.no_gap_is_right && mode.right == unknown);
}

/// Strong effects change the torque by what is stated, or show on what the trial then has; a weak one changes it less.
#[test]
fn strong_effects_are_strong() {
    for index in [0, 2, 5, 7, 10, 12, 15] {
        let truth = trial(index).truth;
        let law = &truth.effects[0].law;
        let largest = |end: &str| {
            let own = law
                .iter()
                .filter(|(name, _)| name.starts_with("change_") && name.ends_with(end));
            own.fold(0.0_f64, |most, (_, value)| most.max(*value))
        };
        assert!(
            largest("of_range") > 0.03 || largest("over_noise") > 8.0,
            "{index} {}: {law:?}",
            truth.name
        );
    }
    let elastic = trial(17);
    assert_eq!(elastic.truth.name, "elastic-second-encoder");
    let joint = elastic.truth.joint.unwrap() - 1;
    let output = elastic.log.output[joint].as_ref().unwrap();
    let apart: Vec<f64> = output
        .iter()
        .zip(&elastic.log.joint[joint])
        .map(|(a, b)| a - b)
        .collect();
    let sd = elastic.device.joints[joint].output_sd_rad().unwrap();
    assert!(crate::laws::rms(&apart) > 30.0 * sd);
    let other = usize::from(joint == 0);
    let rigid: Vec<f64> = elastic.log.output[other]
        .as_ref()
        .unwrap()
        .iter()
        .zip(&elastic.log.joint[other])
        .map(|(a, b)| a - b)
        .collect();
    assert!(crate::laws::rms(&rigid) < 1.5e-5, "other joints are stiff");
}

/// The measure of a change is nothing where nothing was changed: the arm explains its own torques.
#[test]
fn an_arm_without_effect_is_not_changed() {
    for index in [1, 4, 9, 14] {
        let mut random = Suite::Moving.random(index, 23);
        let plan = plan(index, &mut random);
        let moving = make(&plan, 0.0, Suite::Moving.id(index, 23), &mut random).unwrap();
        assert!(
            moving.change.arm.over_noise < 0.15,
            "{index}: {:?}",
            moving.change
        );
        assert!(
            moving.change.controller.over_noise < 1.0,
            "{index}: {:?}",
            moving.change
        );
    }
}

/// Noise with a memory has the stated size and remembers; that of the suite itself does not.
#[test]
fn noise_has_its_size_and_memory() {
    let sensors = |memory: f64| crate::moving::sensors::Sensors {
        rate_hz: 200.0,
        duration_s: 1.0,
        noise: vec![2.0],
        memory,
        has_command: false,
        has_outputs: false,
    };
    let rows: Vec<usize> = (0..40_000).collect();
    for memory in [0.0, 0.6] {
        let noise = sensors(memory).noise_of(0, &rows, &mut Random::new(8, 0));
        assert!((crate::laws::rms(&noise) - 2.0).abs() < 0.05);
        let next: f64 =
            noise.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / (4.0 * 40_000.0);
        assert!((next - memory).abs() < 0.02, "{next}");
    }
}

#[test]
fn torques_of_something_else_are_not_the_arm_s() {
    let mut names = BTreeSet::new();
    for index in [19, 39, 59] {
        let own = trial(index);
        let torque = own.log.torque_nm[1].as_ref().unwrap();
        assert!(torque.iter().all(|value| value.is_finite()));
        assert!(own.truth.name.starts_with("torques-of-"));
        names.insert(own.truth.name);
    }
    assert_eq!(names.len(), 3);
}
