//! Faults of logs, files and laws: each kind is drawn, and its data have the fault.

use haptical_model::Recording;

use crate::moving::admission::{FAULTS, Fault, fault, largest_apart, with_zero};
use crate::moving::arms::{Arm, OTHER_SEVEN, OTHER_SIX, SEVEN, SIX, SLIDER, device_toml};
use crate::moving::kinds::{Kind, NAMED};
use crate::moving::motion::course::{Course, loads};
use crate::moving::motion::rigid::At;
use crate::moving::plan::{Plan, Stratum};
use crate::moving::scene::{ARMS, placed_on};
use crate::moving::trial::{Built, build};
use crate::random::Random;
use crate::suites::Suite;
use crate::trial::Trial;
use crate::truth::Said;

const SEED: u64 = 23;

fn trial(index: u64) -> Trial {
    Suite::MovingAdmission.draw(index, SEED).unwrap()
}

fn named(label: &str) -> &'static Kind {
    NAMED.iter().find(|kind| kind.label == label).unwrap()
}

/// The same arm as that of a trial before its fault, with its logs.
fn sound(index: u64, arms: &[&'static Arm], label: Option<&str>) -> (Built, [Recording; 2]) {
    let mut random = Suite::MovingAdmission.random(index, SEED);
    sound_of(arms, label, &mut random)
}

fn sound_of(
    arms: &[&'static Arm],
    label: Option<&str>,
    random: &mut Random,
) -> (Built, [Recording; 2]) {
    let plan = Plan {
        stratum: match label {
            Some(_) => Stratum::Strong,
            None => Stratum::Clean,
        },
        kinds: label.map(named).into_iter().collect(),
    };
    let placed = placed_on(arms, &plan, 0.0, random).unwrap();
    let built = build(&plan, placed, random).unwrap();
    let logs = logs_of(&built, random);
    (built, logs)
}

fn logs_of(built: &Built, random: &mut Random) -> [Recording; 2] {
    let scene = &built.scene;
    let read = |(ticks, rows): &(_, Vec<usize>)| scene.sensors.read(scene.arm, ticks, rows, random);
    built.recorded.each_ref().map(read)
}

fn torque(log: &Recording, joint: usize) -> &[f64] {
    log.torque_nm[joint].as_deref().unwrap()
}

fn without_torques(log: &Recording) -> Recording {
    Recording {
        torque_nm: Vec::new(),
        ..log.clone()
    }
}

fn apart_rms(one: &[f64], other: &[f64]) -> f64 {
    let apart: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    crate::laws::rms(&apart)
}

#[test]
fn a_batch_has_each_fault_twenty_times() {
    let [count, _] = Suite::MovingAdmission.trials();
    for kind in FAULTS {
        let own = (0..count).filter(|index| fault(*index).0 == kind).count();
        assert_eq!(own, 20, "{kind:?}");
    }
    assert_eq!(fault(0), (Fault::Partial, 0));
    assert_eq!(fault(12), (Fault::Short, 1));
}

/// The friction has no name, is not at the effect's joint, stands above the noise, and is in the log.
#[test]
fn friction_of_its_own_stands_beside_an_effect() {
    let laws = ["friction-waves", "slow-bristle", "shallow-dent"];
    for (number, label) in ["payload", "torque-gain", "link-inertia"]
        .into_iter()
        .enumerate()
    {
        let index = 7 * number as u64;
        let own = trial(index);
        let truth = &own.truth;
        assert_eq!(truth.name, format!("partial-{label}"));
        assert_eq!(truth.right, [[label]]);
        assert!(!truth.no_gap_is_right && truth.acceptable.iter().all(|name| name != "unknown"));
        let friction = &truth.effects[1..];
        assert!((2..=3).contains(&friction.len()));
        for one in friction {
            assert_eq!(one.effect, laws[number]);
            assert!(one.joint.is_some() && one.joint != truth.joint);
            assert!(one.law["friction_over_noise"] >= 3.0, "{:?}", one.law);
        }
        let (built, logs) = sound(index, &ARMS, Some(label));
        for one in friction {
            let joint = one.joint.unwrap() - 1;
            let noise = built.scene.sensors.noise[joint];
            let apart = apart_rms(torque(&own.log, joint), torque(&logs[0], joint));
            // both have noise of their own
            assert!(apart > 1.6 * noise, "{label}: {apart} of {noise}");
        }
    }
}

/// What is lost is a share of 3 to 10 % in bursts of one to four rows, in the stated columns, and reads what it must.
#[test]
fn readings_that_are_none_are_in_the_torques() {
    let ways = [
        (1, None, "dropouts-zero"),
        (22, Some("torque-gain"), "dropouts-spiked+torque-gain"),
        (36, Some("payload"), "dropouts-flipped+payload"),
        (43, None, "dropouts-held"),
    ];
    for (index, label, name) in ways {
        let own = trial(index);
        assert_eq!(own.truth.name, name);
        let groups = own.truth.right.len();
        assert_eq!(groups, 1 + usize::from(label.is_some()));
        assert_eq!(own.truth.right[groups - 1], ["dropouts", "outliers"]);
        let said = label.is_none().then_some(Said::Dropouts);
        assert_eq!(own.truth.besides.no_gap_with, said);
        assert!(!own.truth.no_gap_is_right);
        let (built, logs) = sound(index, &ARMS, label);
        let place = own.truth.effects.last().unwrap().joint;
        for (log, before) in [(&own.log, &logs[0]), (&own.log2, &logs[1])] {
            assert!(
                without_torques(log) == without_torques(before),
                "more than torques"
            );
            for joint in 0..built.scene.arm.count() {
                let (now, sound) = (torque(log, joint), torque(before, joint));
                if place.is_some_and(|place| place != joint + 1) {
                    assert!(now == sound, "another column");
                    continue;
                }
                are_none(name, now, sound, built.scene.arm.axes[joint].range);
            }
        }
    }
}

fn are_none(name: &str, now: &[f64], sound: &[f64], range: f64) {
    let is_lost: Vec<bool> = now.iter().zip(sound).map(|(a, b)| a != b).collect();
    let share = is_lost.iter().filter(|lost| **lost).count() as f64 / now.len() as f64;
    // a reading that is held may be the same one by chance
    assert!((0.028..0.102).contains(&share), "{name}: {share}");
    let bursts = is_lost.split(|lost| !lost).map(<[bool]>::len);
    let longest = bursts.max().unwrap();
    assert!((2..=4).contains(&longest), "{name}: {longest} in a row");
    for row in (0..now.len()).filter(|row| is_lost[*row]) {
        let is_so = match name.split(['-', '+']).nth(1).unwrap() {
            "zero" => now[row] == 0.0,
            "flipped" => now[row] == -sound[row],
            "spiked" => (now[row] - sound[row]).abs() > 0.299 * range,
            _ => (1..=4).any(|back| row >= back && now[row] == sound[row - back]),
        };
        assert!(is_so, "{name}, row {row}: {} for {}", now[row], sound[row]);
    }
}

/// All torques have the factor, nothing else has; a refusal is right where it is far from 1.
#[test]
fn all_torques_have_one_factor() {
    let mut sides = [0; 2];
    for index in (2..2 + 7 * 6).step_by(7) {
        let own = trial(index);
        let factor = own.truth.effects[0].law["factor"];
        assert!(
            (0.5..0.9).contains(&factor) || (1.1..=4.0).contains(&factor),
            "{factor}"
        );
        sides[usize::from(factor > 1.0)] += 1;
        let is_far = !(0.6..=2.0).contains(&factor);
        assert_eq!(!own.truth.besides.refusals.is_empty(), is_far);
        assert!(own.truth.besides.is_of_whole && own.truth.joint.is_none());
        let (built, logs) = sound(index, &ARMS, None);
        for (log, before) in [(&own.log, &logs[0]), (&own.log2, &logs[1])] {
            assert!(
                without_torques(log) == without_torques(before),
                "more than torques"
            );
            for joint in 0..built.scene.arm.count() {
                let wanted: Vec<f64> = torque(before, joint)
                    .iter()
                    .map(|reading| reading * factor)
                    .collect();
                assert!(apart_rms(torque(log, joint), &wanted) < 1e-3);
            }
        }
    }
    assert!(sides.iter().all(|count| *count > 0));
}

/// One joint's angle and command are off alike; torques are those of the true angle.
#[test]
fn one_zero_is_off() {
    let mut felt_ones = 0;
    for index in (3..3 + 7 * 8).step_by(7) {
        let own = trial(index);
        let truth = &own.truth;
        let joint = truth.joint.unwrap() - 1;
        let law = &truth.effects[0].law;
        let off_rad = law["off_rad"];
        assert!((0.03..=0.15).contains(&off_rad.abs()));
        let hardly = joint == 0 || law["felt"] < 0.03;
        assert_eq!(truth.no_gap_is_right, hardly);
        assert!(joint > 0 || law["felt"] < 1e-9, "the first axis is upright");
        let may_lean = truth.right[0].contains(&"gravity-direction".to_owned());
        assert_eq!(may_lean, joint == 0);
        felt_ones += usize::from(!hardly);
        let mut random = Suite::MovingAdmission.random(index, SEED);
        let zero = with_zero(fault(index).1, &mut random).unwrap();
        assert_eq!(
            (zero.joint, zero.off_rad, zero.felt),
            (joint, off_rad, law["felt"])
        );
        let logs = logs_of(&zero.built, &mut random);
        for (log, before) in [(&own.log, &logs[0]), (&own.log2, &logs[1])] {
            assert!(log.torque_nm == before.torque_nm, "torques");
            let columns = |log: &Recording| -> Vec<(String, Vec<f64>)> {
                let joints = log.joint.iter().enumerate();
                let joints =
                    joints.map(|(joint, column)| (format!("theta{}", joint + 1), column.clone()));
                joints.chain(log.covariates.clone()).collect()
            };
            for ((name, now), (_, sound)) in columns(log).iter().zip(columns(before)) {
                let own = [
                    format!("theta{}", joint + 1),
                    format!("command{}_rad", joint + 1),
                ];
                let wanted = if own.contains(name) { off_rad } else { 0.0 };
                let mut apart = now.iter().zip(&sound).map(|(a, b)| a - b - wanted);
                assert!(apart.all(|apart| apart.abs() < 1.1e-6), "{index}: {name}");
            }
        }
    }
    assert!(felt_ones >= 4, "every second one is felt");
}

/// One line of the file is wrong, as its label says; what is wrong is felt, but for an inertia below zero.
#[test]
fn one_body_is_described_wrongly() {
    let labels = ["centre", "mass-twice", "mass-half", "inertia"];
    for (number, label) in labels.into_iter().enumerate() {
        let own = trial(4 + 7 * number as u64);
        let truth = &own.truth;
        assert_eq!(truth.name, format!("description-{label}"));
        let arm = [&SIX, &SEVEN, &SLIDER]
            .into_iter()
            .find(|arm| arm.name == truth.device)
            .unwrap();
        let has_outputs = own.device.joints[0].output_sd_rad().is_some();
        let right = device_toml(arm, has_outputs);
        let pairs = right.lines().zip(own.device_toml.lines());
        let wrong: Vec<(&str, &str)> = pairs.filter(|(right, wrong)| right != wrong).collect();
        assert_eq!(wrong.len(), 1, "{wrong:?}");
        let numbers = |line: &str| -> Vec<f64> {
            let parts = line.split(['=', '[', ']', ',']);
            parts.filter_map(|part| part.trim().parse().ok()).collect()
        };
        let (before, after) = (numbers(wrong[0].0), numbers(wrong[0].1));
        let link = truth.joint.unwrap() - 1;
        match label {
            "mass-twice" => assert_eq!(after, [2.0 * arm.axes[link].mass_kg]),
            "mass-half" => assert_eq!(after, [0.5 * arm.axes[link].mass_kg]),
            "centre" => {
                let sums: Vec<f64> = before.iter().zip(&after).map(|(a, b)| a + b).collect();
                let size = |numbers: &[f64]| {
                    numbers
                        .iter()
                        .fold(0.0_f64, |most, one| most.max(one.abs()))
                };
                assert_eq!(before, arm.axes[link].centre_m);
                assert_eq!(sums.iter().filter(|sum| **sum == 0.0).count(), 1);
                assert!(
                    size(&sums) < 2.0 * size(&before),
                    "the largest one has the other sign"
                );
            }
            _ => assert_eq!(after.iter().filter(|moment| **moment < 0.0).count(), 1),
        }
        let is_negative = label == "inertia";
        assert!(is_negative || truth.effects[0].law["felt"] >= 0.03);
        assert_eq!(truth.besides.unknown, !is_negative);
        assert_eq!(
            truth.besides.refusals.contains(&"credible_base".to_owned()),
            is_negative
        );
        let is_last = link + 1 == arm.count();
        assert_eq!(truth.right[0].contains(&"payload".to_owned()), is_last);
    }
}

/// A log of 1 to 3 s, or one of 5 to 19 rows a second; no name is right, not even that of a load.
#[test]
fn logs_are_too_short() {
    for (number, label) in [
        "short-time",
        "short-rows",
        "short-time+payload",
        "short-rows+payload",
    ]
    .into_iter()
    .enumerate()
    {
        let own = trial(5 + 7 * number as u64);
        assert_eq!(own.truth.name, label);
        assert_eq!(
            (own.truth.is_unknown(), own.truth.acceptable.len()),
            (true, 0)
        );
        for log in [&own.log, &own.log2] {
            let times = log.time_s.as_ref().unwrap();
            let last_s = times.last().unwrap();
            let rate_hz = (times.len() - 1) as f64 / last_s;
            let is_short = label.starts_with("short-time");
            assert_eq!(times[0], 0.0);
            assert_eq!((0.9..3.01).contains(last_s), is_short, "{last_s} s");
            assert_eq!((4.9..19.1).contains(&rate_hz), !is_short, "{rate_hz} Hz");
            assert!(is_short || *last_s > 14.0);
            assert_eq!(log.line.len(), log.len());
            assert!(crate::laws::rms(torque(log, 1)) > 0.0);
        }
    }
}

/// Torques of other arms along the own arm's course are others by a tenth of a range and more.
#[test]
fn other_arms_are_others() {
    let with_others = [(&SIX, &OTHER_SIX), (&SEVEN, &OTHER_SEVEN)];
    for (own, others) in with_others {
        let course = Course::harmonics(own, 20.0, &mut Random::new(5, 1));
        let along = |arm: &Arm| {
            let (chain, mut at) = (arm.chain(), At::default());
            let mut columns = vec![Vec::new(); arm.count()];
            for step in 0..400 {
                let asked = course.at(0.05 * f64::from(step));
                chain.at(&asked.angle, &asked.rate, &mut at);
                for (column, load) in columns.iter_mut().zip(loads(arm, &asked, &at)) {
                    column.push(load);
                }
            }
            columns
        };
        for other in others {
            assert_eq!(other.count(), own.count());
            let apart = largest_apart(own, &along(own), &along(other));
            assert!(apart > 0.1, "{}: {apart}", other.name);
            let lengths = own.axes.iter().zip(other.axes);
            let longer = lengths.filter(|(own, other)| own.origin_m != other.origin_m);
            assert!(longer.count() >= 3, "{}: lengths", other.name);
        }
    }
}

/// Half of the trials are of another arm throughout, half in the second recording alone.
#[test]
fn logs_are_of_another_arm() {
    for (index, label) in [
        (6, "other-arm"),
        (13, "other-second"),
        (27, "other-second+payload"),
    ] {
        let own = trial(index);
        let truth = &own.truth;
        assert_eq!(truth.name, label);
        let mut random = Suite::MovingAdmission.random(index, SEED);
        let (file, others) = match random.unit() < 0.5 {
            true => (&SIX, &OTHER_SIX),
            false => (&SEVEN, &OTHER_SEVEN),
        };
        let other = &others[random.index(3)];
        assert_eq!(truth.device, file.name);
        let is_second = label != "other-arm";
        assert_eq!(truth.besides.second_is_foreign, is_second);
        assert_eq!(
            (truth.is_unknown(), truth.besides.unknown),
            (!is_second, is_second)
        );
        if !is_second {
            assert!(truth.effects[0].law["apart_of_range"] >= 0.1);
            assert_eq!(truth.effects[0].effect, other.name);
            let (_, logs) = sound_of(&[other], None, &mut random);
            assert!(own.log == logs[0] && own.log2 == logs[1]);
            continue;
        }
        let load = label.ends_with("payload").then_some("payload");
        let (_, logs) = sound_of(&[file], load, &mut random.clone());
        assert!(own.log == logs[0], "the first log is the arm's");
        assert!(own.log2 != logs[1], "the second one is not");
        let foreign = truth.effects.last().unwrap();
        assert!(foreign.effect == other.name && foreign.law["apart_of_range"] >= 0.1);
        let columns = |log: &Recording| (log.covariates.len(), log.output.iter().flatten().count());
        assert_eq!(columns(&own.log), columns(&own.log2));
        assert_eq!(truth.is_clean(), load.is_none());
    }
}
