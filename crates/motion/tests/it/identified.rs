//! Dynamics of an arm whose equations are another hand's: numbers, intervals, the noise of positions, refusals.

use haptical_model::{Device, DriveNumber, FrictionNumber, JOINT_FRICTION, JointType, Recording};
use haptical_motion::{
    Dynamics, Estimated, Instruments, MotionError, examine, identify_dynamics, with_dynamics,
};

use crate::arm::{Truth, device, recording, with_factors};

fn identified(truth: Truth, seed: u64) -> (Dynamics, [f64; 4]) {
    let (log, factor) = with_factors(truth, seed);
    (
        identify_dynamics(&device(), &log, None, Some(20.0)).unwrap(),
        factor,
    )
}

fn base(found: &Dynamics, name: &str) -> Estimated {
    let own = found.base.iter().find(|own| own.terms[0].0 == name);
    own.unwrap().estimated
}

/// How many standard deviations an estimate is off.
fn off(found: Estimated, truth: f64) -> f64 {
    (found.value - truth) / found.sd
}

/// By the closed form: what two links in a plane have of base parameters.
fn truths([first, second, rotor1, rotor2]: [f64; 4]) -> [(&'static str, f64); 5] {
    let (m1, m2) = (3.0 * first, 2.0 * second);
    [
        ("izz1", m1 * 0.04 + 0.05 * first + 0.3 * rotor1 + m2 * 0.16),
        ("mx1", m1 * 0.2 + m2 * 0.4),
        ("izz2", m2 * 0.0225 + 0.02 * second),
        ("mx2", m2 * 0.15),
        ("armature2", 0.1 * rotor2),
    ]
}

#[test]
fn numbers_of_a_known_arm_are_in_their_intervals_and_those_are_narrow() {
    for seed in 1..=4 {
        let (found, factor) = identified(
            Truth {
                offset_nm: 0.7,
                late_s: 0.003,
                ..Truth::default()
            },
            seed,
        );
        for (name, truth) in truths(factor) {
            let own = base(&found, name);
            assert!(
                off(own, truth).abs() < 4.0,
                "{seed} {name}: {own:?}, {truth}"
            );
            assert!(own.sd < 0.03 * truth, "{seed} {name}: {own:?}, {truth}");
        }
        let [one, two] = [found.joints[0], found.joints[1]];
        for (own, truth) in [
            (one.coulomb, 1.5),
            (two.coulomb, 0.6),
            (one.viscous, 0.8),
            (two.viscous, 0.3),
        ] {
            assert!(
                (own.value - truth).abs() < 0.05 * truth,
                "{seed}: {own:?}, {truth}"
            );
        }
        assert!(off(one.offset, 0.7).abs() < 4.0, "{:?}", one.offset);
        // positions are logged 3 ms late: torques 3 ms before them
        assert!(
            (found.delay_s.value + 0.003).abs() < 0.0003,
            "{:?}",
            found.delay_s
        );
        let left = haptical_motion::stacked_percent(&found.residuals);
        assert!(left[1] < 1.5 && left[0] > 10.0, "{left:?}");
    }
}

/// Friction that falls with the speed is of no law that is tried: two of them take turns, each chosen with the other's numbers.
#[test]
fn laws_of_friction_that_take_turns_come_to_an_end() {
    for seed in [1, 2, 3] {
        let truth = Truth {
            stribeck_nm: 1.5,
            ..Truth::default()
        };
        let (found, _) = identified(truth, seed);
        let coulomb = found.joints[0].coulomb;
        assert!(coulomb.is_told() && coulomb.sd > 0.0, "{coulomb:?}");
    }
}

#[test]
fn what_the_plane_hides_is_said_to_be_unseen_or_in_a_sum() {
    let (found, _) = identified(Truth::default(), 5);
    for name in ["mz1", "ixx1", "iyz2", "m1"] {
        assert!(
            found.unseen.iter().any(|own| own == name),
            "{name}: {:?}",
            found.unseen
        );
    }
    let sum = |name: &str| {
        let own = found
            .base
            .iter()
            .find(|own| own.terms[0].0 == name)
            .unwrap();
        own.terms.clone()
    };
    // Steiner: the second mass at the end of the first link
    let of_mass =
        |terms: Vec<(String, f64)>| terms.into_iter().find(|own| own.0 == "m2").unwrap().1;
    assert!((of_mass(sum("izz1")) - 0.16).abs() < 1e-6);
    assert!((of_mass(sum("mx1")) - 0.4).abs() < 1e-6);
    assert!(
        sum("izz1")
            .iter()
            .any(|own| own.0 == "armature1" && (own.1 - 1.0).abs() < 1e-6)
    );
}

/// The regressor's noise bends least squares; with the same motion a period later it does not.
#[test]
fn least_squares_are_bent_by_noisy_positions_and_a_repetition_is_not() {
    let (mut plain, mut repeated, mut said) = (0.0, 0.0, 0.0);
    for seed in 1..=4 {
        let truth = Truth {
            position_sd: 6e-4,
            ..Truth::default()
        };
        let (once, factor) = identified(truth, seed);
        let wanted = truths(factor)[0].1;
        assert_eq!(once.instruments, None);
        assert!(
            once.warnings
                .iter()
                .any(|own| own.contains("the bias of noisy positions is not excluded"))
        );
        plain += base(&once, "izz1").value / wanted - 1.0;
        let once_sd = base(&once, "izz1").sd;
        let bias = once
            .base
            .iter()
            .find(|own| own.terms[0].0 == "izz1")
            .unwrap()
            .bias
            .unwrap();
        assert!(bias < -2.0 * once_sd, "{bias}");
        said += bias / wanted;
        let (twice, _) = identified(
            Truth {
                further_rows: 4000,
                ..truth
            },
            seed,
        );
        assert!(
            matches!(twice.instruments, Some(Instruments::Repetition { period_s }) if (period_s - 20.0).abs() < 0.02),
            "{:?}",
            twice.warnings
        );
        repeated += base(&twice, "izz1").value / wanted - 1.0;
    }
    let [plain, repeated, said] = [plain, repeated, said].map(|own| 100.0 * own / 4.0);
    assert!(plain < -15.0, "{plain} %");
    // noise upon noise bends a little less than the first
    assert!(
        (0.4..1.1).contains(&(said / plain)),
        "{said} % is said of {plain} %"
    );
    assert!(
        repeated.abs() < 0.2 * plain.abs(),
        "{repeated} % against {plain} %"
    );
}

#[test]
fn the_device_that_is_written_has_no_gap_on_another_motion() {
    let truth = Truth {
        offset_nm: 0.7,
        ..Truth::default()
    };
    let (found, _) = identified(truth, 6);
    let device = with_dynamics(&device(), &found).unwrap();
    let text = device.to_new_toml().unwrap();
    let again = Device::from_toml(&text, "again.toml").unwrap();
    assert!(again.warnings.is_empty(), "{:?}", again.warnings);
    assert_eq!(again.device.bodies, device.bodies);
    assert_eq!(again.device.joints, device.joints);
    assert_eq!(again.device.effects.len(), 2);
    for own in &found.bodies {
        assert!(own.inertia.is_physical() && own.inertia.mass_kg > 0.0);
    }
    // the same arm, since the same seed; its offset is in the file now
    let log = recording(truth, 6);
    let bare = Device {
        effects: Vec::new(),
        ..again.device
    };
    let shown = examine(&bare, &log, None, &[]).unwrap();
    assert!(!shown.has_gap(), "{:?}", shown.findings);
}

/// What is written is on the list that a forward prediction, a replay and the exports are tested with: a number of a drive, of its
/// friction, or of a link's body.
#[test]
fn every_number_that_is_written_is_on_the_list() {
    let truth = Truth {
        offset_nm: 0.7,
        late_s: 0.003,
        ..Truth::default()
    };
    let (found, _) = identified(truth, 3);
    let nominal = device();
    let written = with_dynamics(&nominal, &found).unwrap();
    assert!(
        written.joints[0].torque_offset_nm.is_some() && written.joints[0].torque_delay_s.is_some()
    );
    for effect in &written.effects {
        let joint_type = nominal.joints[effect.joint.unwrap()].joint_type;
        assert_eq!(
            (effect.name.as_str(), joint_type),
            (JOINT_FRICTION, JointType::Revolute)
        );
        let known = FrictionNumber::ALL.map(|own| own.key(joint_type));
        for key in effect.numbers.keys() {
            assert!(known.contains(&key.as_str()), "{key}");
        }
    }
    let mut again = Device {
        bodies: nominal.bodies.clone(),
        effects: Vec::new(),
        ..written
    };
    for (joint, own) in again.joints.iter_mut().zip(&nominal.joints) {
        for number in DriveNumber::ALL {
            number.set(joint, number.stated(own));
        }
    }
    assert_eq!(again, nominal);
}

/// Friction that grows with the load is asked for where it shows, and nowhere else; the other motion is predicted the better for it.
#[test]
fn friction_that_grows_with_the_load_is_found_where_it_is() {
    for seed in 1..=3 {
        let truth = Truth {
            load_share: 0.12,
            ..Truth::default()
        };
        let (found, _) = identified(truth, seed);
        let load = found.joints[0].load.unwrap();
        // this drive loses a share of its whole torque, with friction and armature in it: a larger one of what the bodies ask for
        assert!(
            (0.12..0.18).contains(&load.value) && load.is_told(),
            "{load:?}"
        );
        assert_eq!(found.joints[1].load, None);
        let left = haptical_motion::stacked_percent(&found.residuals);
        assert!(left[1] < 2.0, "{left:?}");
        // the file gets the friction of the mean load
        let device = with_dynamics(&device(), &found).unwrap();
        let own = device
            .effects
            .iter()
            .find(|own| own.joint == Some(0))
            .unwrap();
        let dry = own.numbers["coulomb_nm"];
        let wanted = found.joints[0].coulomb.value + load.value * found.joints[0].carried;
        assert!((dry - wanted).abs() < 1e-12 && dry > 1.5, "{dry}");
        let (without, _) = identified(Truth::default(), seed);
        assert!(
            without.joints.iter().all(|own| own.load.is_none()),
            "{:?}",
            without.joints
        );
    }
}

#[test]
fn logs_that_say_nothing_are_refused_in_clear_words() {
    let log = recording(Truth::default(), 7);
    let told = |log: &Recording| match identify_dynamics(&device(), log, None, None) {
        Err(error) => error,
        Ok(_) => panic!("it was taken"),
    };
    let without = Recording {
        torque_nm: vec![None, None],
        ..log.clone()
    };
    assert!(told(&without).to_string().contains("torque1_nm is missing"));
    let without = Recording {
        time_s: None,
        ..log.clone()
    };
    assert!(told(&without).to_string().contains("t_s is missing"));
    let still = Recording {
        joint: vec![vec![0.3; 4000]; 2],
        ..log.clone()
    };
    assert_eq!(told(&still), MotionError::Standstill);
    let short = log.select(&(0..40).collect::<Vec<_>>());
    assert!(matches!(told(&short), MotionError::Sampling(_)));
    let one = Recording {
        joint: vec![log.joint[0].clone()],
        ..log
    };
    assert!(told(&one).to_string().contains("the log has 1"));
}
