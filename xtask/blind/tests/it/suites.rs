//! Suites: the same for the same numbers, each with what it is for.

use haptical_model::Joint;
use xtask_blind::{KINDS, Suite, Truth, kind};

fn truths(suite: Suite, count: u64) -> Vec<Truth> {
    (0..count)
        .map(|index| suite.draw(index, 11).expect("a trial").truth)
        .collect()
}

#[test]
fn a_trial_is_a_function_of_suite_index_and_seed() {
    for suite in Suite::ALL {
        let (first, again) = (
            suite.draw(4, 9).expect("a trial"),
            suite.draw(4, 9).expect("a trial"),
        );
        assert_eq!(first.log, again.log);
        assert_eq!(first.clean2, again.clean2);
        assert_eq!(first.truth, again.truth);
        assert_ne!(first.log, suite.draw(4, 10).expect("a trial").log);
        assert_ne!(first.log.joint, first.log2.joint, "two motions");
        assert_eq!(Suite::named(suite.name()).expect("a suite"), suite);
    }
    assert!(Suite::named("s99").is_err());
}

/// Logs have the columns, rows and digits that a reader expects of them.
#[test]
fn logs_are_complete() {
    for index in 0..8 {
        let trial = Suite::Singles.draw(index, 2).expect("a trial");
        let joints = trial.device.joints.len();
        for log in [&trial.log, &trial.log2] {
            assert!(log.len() >= 3000);
            assert_eq!((log.joint.len(), log.torque_nm.len()), (joints, joints));
            let with_encoder = trial.device.joints.iter().map(Joint::output_sd_rad);
            for (column, sd) in log.output.iter().zip(with_encoder) {
                assert_eq!(column.is_some(), sd.is_some());
            }
            assert!(log.cable_m[0].is_some() && log.force_n.is_some());
            assert!(log.temperature_degc.is_some() && log.time_s.is_some());
            let numbers = log
                .joint
                .iter()
                .chain(log.output.iter().flatten())
                .flatten();
            assert!(
                numbers
                    .chain(log.cable_m.iter().flatten().flatten())
                    .all(|x| x.is_finite())
            );
        }
        assert_eq!(trial.clean2.output_rad.len(), joints);
    }
}

#[test]
fn singles_go_through_the_catalogue_and_know_their_names() {
    let singles = truths(Suite::Singles, 64);
    let mut names: Vec<&str> = singles.iter().map(|truth| truth.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 32);
    for truth in &singles {
        assert_eq!(
            (truth.effects.len(), truth.right.len()),
            (1, 1),
            "{}",
            truth.name
        );
        assert!(truth.right[0].contains(&truth.name), "{}", truth.name);
        assert_eq!(truth.joint, truth.effects[0].joint);
        assert!(
            truth
                .right
                .iter()
                .flatten()
                // no trial draws a bent joint yet
                .all(|name| kind(name).is_some() || *name == "lateral-compliance")
        );
    }
}

/// A strong effect can be seen: the true gap is above the noise on a channel, or it hits a kind that
/// the base model or the noise hides.
#[test]
fn strong_effects_open_a_gap() {
    for truth in truths(Suite::Singles, 64) {
        let largest = truth
            .gap
            .values()
            .map(|gap| gap.over_sd)
            .fold(0.0, f64::max);
        assert!(
            largest > 1.0,
            "{} at {:?}: {:?}",
            truth.name,
            truth.joint,
            truth.gap
        );
    }
}

#[test]
fn clean_trials_have_no_gap_but_rounding() {
    for truth in truths(Suite::Clean, 12) {
        assert!(truth.is_clean() && truth.effects.is_empty());
        // the coarse motor encoders of the direct wrists reach the size of the noise
        assert!(
            truth.gap.values().all(|gap| gap.over_sd < 1.3),
            "{:?}",
            truth.gap
        );
    }
}

#[test]
fn withheld_trials_withhold_every_right_name() {
    for truth in truths(Suite::Withheld, 32) {
        assert!(truth.is_unknown());
        assert!(
            truth.without.contains(&truth.effects[0].effect),
            "{}",
            truth.name
        );
    }
}

#[test]
fn unknown_effects_are_in_no_catalogue() {
    let all = truths(Suite::Unknown, 15);
    for truth in &all {
        assert_eq!(truth.right, [["unknown"]]);
        assert!(truth.without.is_empty());
        assert!(
            truth.gap.values().any(|gap| gap.over_sd > 1.5),
            "{}: {:?}",
            truth.name,
            truth.gap
        );
    }
    assert!(all.iter().any(|truth| truth.name == "drum-dent"));
}

#[test]
fn pairs_are_two_different_effects() {
    for truth in truths(Suite::Pairs, 40) {
        assert_eq!(
            (truth.effects.len(), truth.right.len(), truth.joints.len()),
            (2, 2, 2)
        );
        assert_ne!(truth.effects[0].effect, truth.effects[1].effect);
        let shared = truth.right[0]
            .iter()
            .any(|name| truth.right[1].contains(name));
        assert!(!shared, "{}: one answer would do for both", truth.name);
    }
}

#[test]
fn ladders_climb_from_a_hundredth() {
    let sizes: Vec<f64> = truths(Suite::Ladder, 14)
        .iter()
        .map(|t| t.effects[0].size)
        .collect();
    assert!((sizes[0] - 0.01).abs() < 1e-12 && (sizes[6] - 1.0).abs() < 1e-12);
    assert!(sizes[..7].windows(2).all(|pair| pair[1] > 2.0 * pair[0]));
    assert_eq!(sizes[..7], sizes[7..]);
    let near = truths(Suite::NearSingles, 5);
    assert!(near.iter().all(|truth| truth.effects[0].size == 0.1));
}

#[test]
fn ablation_gives_a_model_without_transmissions() {
    for index in 0..2 {
        let trial = Suite::Ablation.draw(index, 4).expect("a trial");
        let model = trial.model_toml.expect("a model");
        let model = haptical_model::Device::from_toml(&model, "model")
            .expect("a device")
            .device;
        assert_ne!(
            model.links, trial.device.links,
            "the links are the true ones"
        );
        for joint in &model.joints {
            assert_eq!(joint.error_rad(0.7).expect("an error"), 0.0);
        }
        assert_eq!(trial.truth.right.len(), 3);
        assert!(
            trial
                .truth
                .effects
                .iter()
                .any(|effect| effect.effect == "parallelogram-error")
        );
        // against that model the transmissions' errors are the gap
        assert!(
            trial.truth.gap.values().all(|gap| gap.over_sd > 1.0),
            "{:?}",
            trial.truth.gap
        );
    }
}

#[test]
fn every_kind_has_a_place_and_a_name_of_its_own() {
    let mut names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
    names.sort_unstable();
    let count = names.len();
    names.dedup();
    assert_eq!(names.len(), count);
    for kind in KINDS {
        let has_place = xtask_blind::NOMINALS
            .iter()
            .any(|nominal| !kind.joints(&nominal.device().expect("a device")).is_empty());
        assert!(has_place, "{}", kind.name);
    }
}

/// What a seed means: readings of three trials, to the digits of the log. They change only when the
/// generator does, and then scores of earlier batches cannot be repeated.
#[test]
fn a_seed_means_the_same_on_every_machine() {
    let golden = [
        (Suite::Clean, 2, [-0.6418431, 0.3960006, 0.5772715, -2.223]),
        (
            Suite::Singles,
            3,
            [-0.1875611, -0.9425405, 0.4946517, -1.7791],
        ),
        (
            Suite::Unknown,
            6,
            [0.1684822, 0.4238676, 0.3762652, -1.7773],
        ),
    ];
    for (suite, index, expected) in golden {
        let trial = suite.draw(index, 20).expect("a trial");
        let column = |column: &Option<Vec<f64>>| column.as_ref().expect("a column")[1500];
        let got = [
            trial.log.joint[1][1500],
            column(&trial.log.output[0]),
            column(&trial.log.cable_m[0]),
            column(&trial.log2.torque_nm[1]),
        ];
        assert_eq!(got, expected, "{} {index}", suite.name());
    }
}

/// An effect that is asked for has a name of the catalogue and a place that the device has; the recording has none.
#[test]
fn an_absent_effect_is_asked_for_where_it_could_be() {
    let mut names = Vec::new();
    for index in 0..24 {
        let trial = Suite::Absent.draw(index, 5).expect("a trial");
        let asked = trial.asked.expect("an effect");
        let of_name = kind(asked.effect).expect("a kind");
        assert!(trial.truth.is_clean());
        match asked.joint {
            Some(joint) => assert!(of_name.joints(&trial.device).contains(&(joint - 1))),
            None => assert!(of_name.is_whole()),
        }
        names.push(asked.effect);
    }
    names.sort_unstable();
    names.dedup();
    assert!(names.len() > 8, "{names:?}");
    let others = Suite::ALL
        .into_iter()
        .filter(|suite| *suite != Suite::Absent);
    for suite in others {
        assert_eq!(suite.draw(0, 5).expect("a trial").asked, None);
    }
}
