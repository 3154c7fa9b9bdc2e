//! Encoders on links by closed forms of their own: angles are sums of sines, a load is what a pendulum asks for at them, and the link's
//! reading is the motor's, late, less what yields, less the side of a play.

use haptical_model::Recording;
use haptical_motion::{Between, LoadSource, OwnEffect, examine_between, examine_own};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const JOINTS: usize = 2;
const STEP_S: f64 = 0.004;

/// What is between each motor and its link.
#[derive(Debug, Clone, Copy, Default)]
struct Truth {
    late_s: [f64; JOINTS],
    stiffness_nm_per_rad: [Option<f64>; JOINTS],
    /// What its stiffness grows by, over that at rest, with the square of what it yields \[1/rad^2\].
    hardening_per_rad2: f64,
    /// Widths of plays that follow the load, and of those that follow the motor.
    width_rad: [f64; JOINTS],
    dragged_rad: [f64; JOINTS],
    ratio_deviation: f64,
    /// Noise of the recorded torques \[N m\].
    torque_nm: f64,
    /// Noise of the encoders on the links \[rad\], where it is not small.
    encoder_rad: f64,
}

/// Angle, speed and acceleration of a motor.
fn motion(joint: usize, run: usize, t: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for k in 1..=4 {
        let rate = 0.9 * k as f64 + 0.35 * joint as f64 + 0.2 * run as f64;
        let size = 0.5 / k as f64;
        let phase = 1.3 * k as f64 + 2.1 * joint as f64 + 0.7 * run as f64;
        let (sine, cosine) = (rate * t + phase).sin_cos();
        sum[0] += size * sine;
        sum[1] += size * rate * cosine;
        sum[2] -= size * rate * rate * sine;
    }
    sum
}

/// What the link asks for \[N m\].
fn load(joint: usize, run: usize, t: f64) -> f64 {
    let [q, _, ddq] = motion(joint, run, t);
    120.0 * ddq + 250.0 * (q + 0.4 * joint as f64).sin()
}

/// The x of `x + c x^3 = straight`, by halves.
fn bisected(straight: f64, c: f64) -> f64 {
    let (mut low, mut high) = (0.0, straight.abs());
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        match x + c * x.powi(3) < straight.abs() {
            true => low = x,
            false => high = x,
        }
    }
    0.5 * (low + high) * straight.signum()
}

fn recording(truth: Truth, run: usize, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move |sd: f64| {
        let own: f64 = StandardNormal.sample(&mut random);
        sd * own
    };
    let count = 5000;
    let mut log = Recording {
        line: (2..).take(count).collect(),
        time_s: Some((0..count).map(|k| STEP_S * k as f64).collect()),
        ..Recording::default()
    };
    for joint in 0..JOINTS {
        let [mut motor, mut link, mut torque] = [const { Vec::new() }; 3];
        let mut dragged = 0.0_f64;
        for k in 0..count {
            let t = STEP_S * k as f64;
            let then = t - truth.late_s[joint];
            let q = motion(joint, run, then)[0];
            let own = load(joint, run, then);
            let half = 0.5 * truth.dragged_rad[joint];
            dragged = dragged.clamp(q - half, q + half);
            let mut out =
                q * (1.0 + truth.ratio_deviation) + 0.002 * joint as f64 + 0.001 * run as f64;
            out += dragged - q;
            out -= truth.stiffness_nm_per_rad[joint]
                .map_or(0.0, |k| bisected(own / k, truth.hardening_per_rad2));
            out -= 0.5 * truth.width_rad[joint] * own.signum();
            motor.push(motion(joint, run, t)[0] + normal(1e-6));
            link.push(out + normal(truth.encoder_rad.max(3e-6)));
            torque.push(load(joint, run, t) + normal(truth.torque_nm));
        }
        log.joint.push(motor);
        log.output.push(Some(link));
        log.torque_nm.push(Some(torque));
    }
    log
}

fn found(truth: Truth, without: &[&str]) -> Between {
    let source = match truth.torque_nm > 0.0 {
        true => LoadSource::Drives,
        false => LoadSource::Links,
    };
    let without: Vec<String> = without.iter().map(|own| (*own).to_owned()).collect();
    let [log, second] = [(0, 7), (1, 8)].map(|(run, seed)| recording(truth, run, seed));
    examine_between(&log, Some(&second), source, &without).unwrap()
}

fn names(found: &Between) -> Vec<(&'static str, Option<usize>)> {
    let mut names: Vec<_> = (found.examined.findings.iter())
        .map(|own| (own.effect, own.joint))
        .collect();
    names.sort_unstable();
    names
}

fn number(found: &Between, effect: &str, joint: usize, name: &str) -> (f64, f64) {
    let is_own = |own: &&haptical_motion::Finding| own.effect == effect && own.joint == Some(joint);
    let own = found.examined.findings.iter().find(is_own);
    let numbers = &own.unwrap().numbers;
    let own = numbers.iter().find(|own| own.0 == name).unwrap();
    (own.1, own.2)
}

#[test]
fn sound_gears_show_nothing() {
    for torque_nm in [0.0, 100.0] {
        let found = found(
            Truth {
                torque_nm,
                ratio_deviation: 0.0,
                ..Truth::default()
            },
            &[],
        );
        assert_eq!(names(&found), []);
        assert!(!found.is_adequate && !found.examined.has_gap());
    }
}

/// A ratio that is off is calibration, though it is in step with a load that hangs at the link.
#[test]
fn a_ratio_is_no_effect() {
    let found = found(
        Truth {
            ratio_deviation: 2e-3,
            ..Truth::default()
        },
        &[],
    );
    assert_eq!(names(&found), []);
    assert!(!found.examined.has_gap());
}

/// Noise of the drives' currents, 0.4 times the loads, makes no spring stiffer by more than a tenth, though its signal is a tenth of the
/// delay's.
#[test]
fn springs_are_found_beside_a_delay_that_all_share() {
    let truth = Truth {
        late_s: [0.0028; 2],
        stiffness_nm_per_rad: [Some(4e6), Some(7e6)],
        torque_nm: 120.0,
        encoder_rad: 1e-4,
        ..Truth::default()
    };
    let found = found(truth, &[]);
    let late = "external-encoder-latency";
    let wanted = [
        ("capstan-compliance", Some(0)),
        ("capstan-compliance", Some(1)),
        (late, Some(0)),
        (late, Some(1)),
    ];
    assert_eq!(names(&found), wanted);
    assert!(found.is_adequate);
    for joint in 0..JOINTS {
        let (delay_s, sd) = number(&found, late, joint, "delay_s");
        assert!(
            (delay_s - 0.0028).abs() < 4.0 * sd && sd < 2e-5,
            "{delay_s} {sd}"
        );
        let (stiffness, sd) = number(&found, "capstan-compliance", joint, "stiffness_nm_per_rad");
        let truth = truth.stiffness_nm_per_rad[joint].unwrap();
        assert!(
            (stiffness / truth - 1.0).abs() < 0.1,
            "{joint}: {stiffness} {sd}"
        );
        let own = found.own_delays_s[joint];
        assert!(
            own.0 == joint && (own.1 - 0.0028).abs() < 4.0 * own.2,
            "{own:?}"
        );
    }
}

/// One encoder alone is late: that is no delay of all.
#[test]
fn a_delay_of_one_encoder_is_its_own() {
    let found = found(
        Truth {
            late_s: [0.0, 0.0028],
            ..Truth::default()
        },
        &[],
    );
    assert_eq!(names(&found), [("external-encoder-latency", Some(1))]);
    assert!(found.own_delays_s.is_empty());
    let rivals: Vec<_> = found.examined.findings[0]
        .rivals
        .iter()
        .map(|own| own.effect)
        .collect();
    assert_eq!(rivals, ["viscous-lag"]);
}

/// Encoders on links that are early say that the motors' are late.
#[test]
fn a_delay_has_the_sign_of_what_is_late() {
    let found = found(
        Truth {
            late_s: [-0.003; 2],
            ..Truth::default()
        },
        &[],
    );
    assert_eq!(names(&found), [("encoder-latency", None)]);
    let own = &found.examined.findings[0].numbers[0];
    assert!(
        own.0 == "delay_s" && (own.1 - 0.003).abs() < 1e-5,
        "{own:?}"
    );
}

/// A play has its width, and what yields beyond it its stiffness.
#[test]
fn a_play_is_where_the_load_pushes_it() {
    let truth = Truth {
        width_rad: [0.0, 0.004],
        stiffness_nm_per_rad: [None, Some(3e5)],
        ..Truth::default()
    };
    let found = found(truth, &[]);
    assert_eq!(names(&found), [("backlash", Some(1))]);
    assert!(found.is_adequate);
    let (width_rad, _) = number(&found, "backlash", 1, "width_rad");
    assert!((width_rad / 0.004 - 1.0).abs() < 0.01, "{width_rad}");
    let (stiffness, _) = number(&found, "backlash", 1, "stiffness_nm_per_rad");
    assert!((stiffness / 3e5 - 1.0).abs() < 0.05, "{stiffness}");
}

/// A gear that hardens has the stiffness that it has at rest, and the cause says that it hardens; a straight one does not.
#[test]
fn a_spring_that_hardens_is_told_by_its_stiffness_at_rest() {
    for hardening_per_rad2 in [1e3, 1e4, 1e5] {
        let truth = Truth {
            stiffness_nm_per_rad: [Some(2e4), None],
            hardening_per_rad2,
            ..Truth::default()
        };
        let found = found(truth, &[]);
        assert_eq!(names(&found), [("capstan-compliance", Some(0))]);
        assert!(found.is_adequate);
        let (stiffness, sd) = number(&found, "capstan-compliance", 0, "stiffness_nm_per_rad");
        assert!(
            (stiffness - 2e4).abs() < 4.0 * sd && sd < 1e3,
            "{hardening_per_rad2}: {stiffness} {sd}"
        );
        let (hardening, _) = number(&found, "capstan-compliance", 0, "hardening_per_rad2");
        assert!(
            (hardening / hardening_per_rad2 - 1.0).abs() < 0.1,
            "{hardening}"
        );
        let (secant, _) = number(
            &found,
            "capstan-compliance",
            0,
            "secant_stiffness_nm_per_rad",
        );
        assert!(secant > 1.02 * stiffness, "{secant} {stiffness}");
        // no spring is its own rival
        let rivals = &found.examined.findings[0].rivals;
        assert!(
            rivals.iter().all(|own| own.effect != "capstan-compliance"),
            "{rivals:?}"
        );
    }
    let straight = Truth {
        stiffness_nm_per_rad: [Some(2e4), Some(5e4)],
        ..Truth::default()
    };
    for own in &found(straight, &[]).examined.findings {
        assert!(
            own.numbers.iter().all(|own| own.0 != "hardening_per_rad2"),
            "{own:?}"
        );
    }
}

/// A spring alone is no play, and a play is no spring; what is left out has no stand-in.
#[test]
fn what_is_left_out_has_no_stand_in() {
    let spring = Truth {
        stiffness_nm_per_rad: [Some(5e4), None],
        ..Truth::default()
    };
    assert_eq!(
        names(&found(spring, &[])),
        [("capstan-compliance", Some(0))]
    );
    assert!(!found(spring, &["capstan-compliance"]).is_adequate);
    let play = Truth {
        width_rad: [0.004, 0.0],
        ..Truth::default()
    };
    assert_eq!(names(&found(play, &[])), [("backlash", Some(0))]);
    assert!(!found(play, &["backlash"]).is_adequate);
}

/// A play that the motor drags its link through is another law's, and not explained by the load.
#[test]
fn a_play_that_follows_the_motor_is_not_explained() {
    let found = found(
        Truth {
            dragged_rad: [0.004, 0.0],
            ..Truth::default()
        },
        &[],
    );
    assert!(!found.is_adequate, "{:?}", found.examined.findings);
    assert!(found.examined.has_gap());
}

/// What a device's own effects say is taken off another run, whose zeros are its own; a play of another width is not.
#[test]
fn own_effects_leave_nothing_of_another_run() {
    let truth = Truth {
        width_rad: [0.0, 0.004],
        stiffness_nm_per_rad: [Some(5e4), Some(3e5)],
        late_s: [0.003, 0.0],
        ..Truth::default()
    };
    let log = recording(truth, 1, 5);
    let of = |half_rad: f64| {
        let own = [
            (0, OwnEffect::Delay(0.003)),
            (0, OwnEffect::Spring(1.0 / 5e4)),
            (1, OwnEffect::Play(half_rad)),
            (1, OwnEffect::Spring(1.0 / 3e5)),
        ];
        examine_own(&log, LoadSource::Links, &own).unwrap()
    };
    assert!(of(0.002).is_adequate && of(0.002).examined.findings.is_empty());
    assert!(!of(0.003).is_adequate);
}

/// In noise that hides most of it, a spring is nearly as well a drum that runs out, which explains a part of what it does.
#[test]
fn a_rival_explains_a_part_of_what_is_found() {
    let truth = Truth {
        stiffness_nm_per_rad: [None, Some(1e5)],
        encoder_rad: 0.017,
        ..Truth::default()
    };
    let found = found(truth, &[]);
    assert_eq!(names(&found), [("capstan-compliance", Some(1))]);
    let spring = &found.examined.findings[0];
    let drum = &spring.rivals[0];
    assert_eq!(drum.effect, "drum-eccentricity");
    assert!((0.0..spring.nats).contains(&drum.behind_nats), "{drum:?}");
    let share = 1.0 - drum.behind_nats / spring.nats;
    assert!((drum.share - share).abs() < 1e-9 && share > 0.2, "{drum:?}");
}
