//! Sizes of effects mean what they say.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::moving::arms::{Arm, SIX};
use crate::moving::kinds::{FOREIGN, Kind, NAMED, OWN_FRICTION};
use crate::moving::laws::{Draw, Drawn, Instant, Levels, Sliding};
use crate::moving::motion::log::Ticks;
use crate::moving::motion::plant::Plant;
use crate::moving::motion::rigid::At;
use crate::moving::motion::specimen::{Sense, Specimen};
use crate::random::Random;

const ARM: &Arm = &SIX;

fn kind(label: &str) -> &'static Kind {
    NAMED
        .iter()
        .chain(&FOREIGN)
        .chain(&OWN_FRICTION)
        .find(|kind| kind.label == label)
        .unwrap()
}

/// An effect of an arm that is drawn with these numbers; the joint is from 0.
fn drawn(label: &str, joint: usize, size: f64) -> Drawn {
    let angles: Vec<Vec<f64>> =
        vec![(0..200).map(|step| 0.01 * f64::from(step) - 1.0).collect(); ARM.count()];
    let loads: Vec<Vec<f64>> = ARM
        .axes
        .iter()
        .map(|axis| vec![0.1 * axis.range, -0.5 * axis.range])
        .collect();
    let flange_m: Vec<Vector3<f64>> = (0..200)
        .map(|step| Vector3::new(0.005 * f64::from(step), 0.3, 0.4))
        .collect();
    let mut random = Random::new(17, joint as u64);
    (kind(label).draw)(&mut Draw {
        arm: ARM,
        joint,
        size,
        duration_s: 20.0,
        loads: &loads,
        angles: &angles,
        flange_m: &flange_m,
        random: &mut random,
    })
}

fn nominal() -> Specimen {
    let mut specimen = Specimen::draw(ARM, &mut Random::new(1, 0));
    specimen.chain = ARM.chain();
    specimen
}

fn holding(specimen: &Specimen, angle: &[f64]) -> Vec<f64> {
    let mut at = At::default();
    specimen.chain.at(angle, &vec![0.0; angle.len()], &mut at);
    at.bias
}

const POSTURE: [f64; 6] = [0.3, -0.7, 0.9, 0.4, -0.6, 0.2];

/// What must be held more at rest is the weight at its place: the slope of its potential energy.
#[test]
fn masses_weigh_what_they_say() {
    let gravity = 9.81;
    for (label, joint) in [("payload", 0), ("link-inertia", 2)] {
        let effect = drawn(label, joint, 1.0);
        let mass_kg = effect.numbers["mass_kg"];
        let (plain, mut heavier) = (nominal(), nominal());
        (effect.build)(&mut heavier);
        let total = |specimen: &Specimen| -> f64 {
            specimen.chain.links.iter().map(|link| link.mass_kg).sum()
        };
        assert!((total(&heavier) - total(&plain) - mass_kg).abs() < 1e-12);
        let height_m = |angle: &[f64]| {
            let potential = |specimen: &Specimen| {
                let mut at = At::default();
                specimen.chain.at(angle, &[0.0; 6], &mut at);
                at.potential_j(&specimen.chain)
            };
            (potential(&heavier) - potential(&plain)) / (mass_kg * gravity)
        };
        let more: Vec<f64> = holding(&heavier, &POSTURE)
            .iter()
            .zip(holding(&plain, &POSTURE))
            .map(|(a, b)| a - b)
            .collect();
        for axis in 0..6 {
            let at = |step: f64| {
                let mut angle = POSTURE;
                angle[axis] += step;
                height_m(&angle)
            };
            let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
            assert!(
                (more[axis] - mass_kg * gravity * slope).abs() < 1e-5,
                "{label} {axis}"
            );
        }
        // behind the box nothing is heavier
        if label == "link-inertia" {
            assert!(
                more[3..].iter().all(|more| more.abs() < 1e-12) && more[2].abs() > 0.1,
                "{more:?}"
            );
        }
    }
    // two points make a dumbbell: the reduced mass at their distance, about axes across it
    let mut dumbbell = ARM.chain().links[1].clone();
    dumbbell.mass_kg = 2.0;
    dumbbell.centre_m = Vector3::new(0.5, 0.0, 0.0);
    dumbbell.inertia_kgm2 = Matrix3::zeros();
    crate::moving::laws::masses::bolt(&mut dumbbell, 3.0, Vector3::new(1.5, 0.0, 0.0), 0.0);
    assert!((dumbbell.centre_m - Vector3::new(1.1, 0.0, 0.0)).norm() < 1e-12);
    let expected = Matrix3::from_diagonal(&Vector3::new(0.0, 1.2, 1.2));
    assert!((dumbbell.inertia_kgm2 - expected).norm() < 1e-12);
}

#[test]
fn gravity_leans_by_its_angle() {
    let effect = drawn("gravity-direction", 0, 1.0);
    let mut specimen = nominal();
    let upright = specimen.chain.gravity_mps2;
    (effect.build)(&mut specimen);
    let lean_rad = specimen.chain.gravity_mps2.angle(&upright);
    assert!((lean_rad - effect.numbers["lean_rad"]).abs() < 1e-9);
    assert!((2.0..=6.0).contains(&lean_rad.to_degrees()));
    assert!((specimen.chain.gravity_mps2.norm() - upright.norm()).abs() < 1e-12);
}

/// Levels of a drive's friction at a speed, angle, time and load.
fn levels(effect: &Drawn, sliding: &Sliding) -> Levels {
    let mut levels = Levels {
        coulomb: 5.0,
        viscous: 2.0,
    };
    (effect.friction)(sliding, &mut levels);
    levels
}

/// The second joint turns at 1 rad/s.
const SLIDING: Sliding = Sliding {
    joint: 1,
    time_s: 0.0,
    angle: 0.0,
    speed: 1.0,
    drive: 0.0,
};

#[test]
fn friction_changes_by_its_numbers() {
    let sliding = SLIDING;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");

    let stribeck = drawn("stribeck-friction", 1, 1.0);
    let (extra, speed) = (stribeck.numbers["extra"], stribeck.numbers["speed"]);
    close(
        levels(
            &stribeck,
            &Sliding {
                speed: 0.0,
                ..sliding
            },
        )
        .coulomb,
        5.0 + extra,
    );
    close(
        levels(&stribeck, &Sliding { speed, ..sliding }).coulomb,
        5.0 + 0.5 * extra,
    );
    close(
        levels(
            &stribeck,
            &Sliding {
                joint: 2,
                ..sliding
            },
        )
        .coulomb,
        5.0,
    );

    let load = drawn("load-friction", 1, 1.0);
    let pressed = levels(
        &load,
        &Sliding {
            drive: -100.0,
            ..sliding
        },
    )
    .coulomb;
    close(
        (pressed - 5.0) / 100.0,
        (load.numbers["share"] * (1e4_f64 + 1.45 * 1.45).sqrt()) / 100.0,
    );

    let one_way = drawn("friction-asymmetry", 1, 1.0);
    let share = one_way.numbers["share"];
    let (there, back) = (
        levels(&one_way, &sliding),
        levels(
            &one_way,
            &Sliding {
                speed: -1.0,
                ..sliding
            },
        ),
    );
    close(
        (there.coulomb - back.coulomb) / (there.coulomb + back.coulomb),
        share,
    );
    close(
        (there.viscous - back.viscous) / (there.viscous + back.viscous),
        share,
    );
}

#[test]
fn friction_changes_with_time_and_angle() {
    let sliding = SLIDING;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    let drift = drawn("friction-drift", 1, 1.0);
    close(
        levels(&drift, &sliding).coulomb,
        5.0 * (1.0 + drift.numbers["share"]),
    );
    let later = Sliding {
        time_s: drift.numbers["time_s"],
        ..sliding
    };
    close(
        levels(&drift, &later).viscous,
        2.0 * (1.0 + drift.numbers["share"] / std::f64::consts::E),
    );

    let dent = drawn("dent", 1, 1.0);
    let (angle, width) = (dent.numbers["angle"], dent.numbers["width"]);
    close(
        levels(&dent, &Sliding { angle, ..sliding }).coulomb,
        5.0 + dent.numbers["extra"],
    );
    assert!(
        levels(
            &dent,
            &Sliding {
                angle: angle + 5.0 * width,
                ..sliding
            }
        )
        .coulomb
            < 5.001
    );
    // a quarter of the size is a quarter of the change
    close(
        drawn("dent", 1, 0.25).numbers["extra"],
        0.25 * dent.numbers["extra"],
    );
}

/// Friction of an arm's own laws is 2 to 5 % of the range; it rises and falls along the way, yields over a long way, or has dents.
#[test]
fn own_friction_has_its_level() {
    let share = |level: f64| level / ARM.axes[1].range;
    let waves = drawn("friction-waves", 1, 1.0);
    let level = waves.numbers["level"];
    assert!((0.02..=0.05).contains(&share(level)));
    let along = (0..2000).map(|step| {
        let angle = 0.001 * f64::from(step) - 1.0;
        levels(&waves, &Sliding { angle, ..SLIDING }).coulomb - 5.0
    });
    let along: Vec<f64> = along.collect();
    let [least, most] = [
        along.iter().copied().fold(f64::INFINITY, f64::min),
        along.iter().copied().fold(0.0, f64::max),
    ];
    assert!(least.abs() < 1e-3 * level && (most - level).abs() < 1e-3 * level);
    let middle = |pair: &&[f64]| (pair[0] > 0.5 * level) != (pair[1] > 0.5 * level);
    let crossings = along.windows(2).filter(middle).count();
    assert!((4..=10).contains(&crossings), "{crossings} in all the way");

    let slow = drawn("slow-bristle", 1, 1.0);
    let (mut plain, mut built) = (nominal(), nominal());
    (slow.prepare)(&mut plain);
    (slow.prepare)(&mut built);
    (slow.build)(&mut built);
    let length = slow.numbers["length"];
    assert_eq!(built.friction[1].sense, Sense::Bristle { length });
    assert_eq!(built.friction[1].coulomb, plain.friction[1].coulomb);
    assert!((0.02..=0.05).contains(&share(built.friction[1].coulomb)));
    assert!(length > 2.0 * drawn("presliding", 1, 1.0).numbers["length"]);
    assert_eq!(built.friction[0], plain.friction[0]);

    let dent = drawn("shallow-dent", 1, 1.0);
    assert!((0.03..=0.05).contains(&share(dent.numbers["extra"])));
}

/// Bristles yield over their length: after one of them 1 - 1/e of the level is there.
#[test]
fn a_long_bristle_yields_over_its_length() {
    let effect = drawn("presliding", 2, 1.0);
    let mut specimen = nominal();
    (effect.build)(&mut specimen);
    let mut plant = Plant::new(&specimen, &[], &[0.0; 6]);
    let length = effect.numbers["length"];
    plant.follow(2, length);
    let sliding = Sliding {
        joint: 2,
        time_s: 0.0,
        angle: length,
        speed: 0.0,
        drive: 0.0,
    };
    let level = specimen.friction[2].coulomb;
    let expected = level * (1.0 - 1.0 / std::f64::consts::E);
    assert!((plant.friction(&sliding) - expected).abs() < 1e-9);
    // half a length back it has turned over by as much of what is between it and the other side
    let back = Sliding {
        angle: 0.5 * length,
        ..sliding
    };
    let expected = level * (-1.0 + (2.0 - 1.0 / std::f64::consts::E) * (-0.5_f64).exp());
    assert!((plant.friction(&back) - expected).abs() < 1e-9);
}

/// Torques on the joints at a posture and a time.
fn torques(effect: &Drawn, angle: &[f64], time_s: f64) -> Vec<f64> {
    let mut at = At::default();
    ARM.chain().at(angle, &vec![0.0; angle.len()], &mut at);
    let mut torque = vec![0.0; angle.len()];
    (effect.torque)(
        &Instant {
            time_s,
            angle,
            motor: angle,
            at: &at,
        },
        &mut torque,
    );
    torque
}

/// Torques that come of an energy do no work around a loop; a magnet repeats once per turn of the motor.
#[test]
fn springs_cables_and_magnets_keep_energy() {
    for (label, joint) in [
        ("gravity-spring", 1),
        ("motor-cogging", 1),
        ("cable-bundle", 2),
    ] {
        let effect = drawn(label, joint, 1.0);
        let steps = 20_000;
        let angle = |step: i32| {
            let turn = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
            let mut angle = POSTURE;
            angle[joint] += 0.5 * turn.cos();
            angle[joint + 1] += 0.5 * turn.sin();
            angle
        };
        let (mut work, mut moved) = (0.0, 0.0);
        for step in 0..steps {
            let (from, to) = (angle(step), angle(step + 1));
            let middle: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
            let torque = torques(&effect, &middle, 0.0);
            let done: f64 = (0..6)
                .map(|axis| torque[axis] * (to[axis] - from[axis]))
                .sum();
            work += done;
            moved += done.abs();
        }
        assert!(
            moved > 0.5 && work.abs() < 1e-4 * moved,
            "{label} {work} {moved}"
        );
    }
    let magnets = drawn("motor-cogging", 1, 1.0);
    let mut turned = POSTURE;
    turned[1] += std::f64::consts::TAU / ARM.axes[1].ratio;
    let (here, there) = (
        torques(&magnets, &POSTURE, 0.0)[1],
        torques(&magnets, &turned, 0.0)[1],
    );
    assert!((here - there).abs() < 1e-9);
}

/// The wall pushes back along its normal by the stated force where the flange would be deepest, in its time alone.
#[test]
fn a_wall_pushes_back() {
    let effect = drawn("contact", 0, 1.0);
    let normal =
        Vector3::from(["normal_x", "normal_y", "normal_z"].map(|name| effect.numbers[name]));
    let inside = 0.5 * (effect.numbers["from_s"] + effect.numbers["until_s"]);
    let mut at = At::default();
    let mut random = Random::new(2, 0);
    let mut touched = 0;
    for _ in 0..200 {
        let angle: Vec<f64> = ARM
            .axes
            .iter()
            .map(|axis| random.uniform(axis.reach[0], axis.reach[1]))
            .collect();
        ARM.chain().at(&angle, &[0.0; 6], &mut at);
        let depth = normal.dot(&at.flange().0) - effect.numbers["place_m"];
        let torque = torques(&effect, &angle, inside);
        let mut unit = vec![0.0; 6];
        at.add_at_flange(&-normal, &mut unit);
        let size = unit.iter().map(|entry| entry * entry).sum::<f64>();
        let force: f64 = torque
            .iter()
            .zip(&unit)
            .map(|(torque, unit)| torque * unit)
            .sum::<f64>()
            / size;
        assert_eq!(force > 0.0, depth > 0.0);
        touched += usize::from(depth > 0.0);
        assert!(
            torques(&effect, &angle, 0.0)
                .iter()
                .all(|torque| *torque == 0.0)
        );
    }
    assert!(touched > 10, "{touched}");
}

/// A soft drive twists by torque over stiffness, a play leaves the link free within its width.
#[test]
fn drives_yield_as_they_say() {
    let mut specimen = nominal();
    (drawn("elastic", 1, 1.0).build)(&mut specimen);
    let soft = specimen.soft.unwrap();
    assert!((soft.torque(1e-5, 0.0) / 1e-5 - soft.stiffness).abs() < 1e-3 * soft.stiffness);
    let twice = soft.torque(soft.hardens_rad, 0.0);
    assert!((twice - 2.0 * soft.stiffness * soft.hardens_rad).abs() < 1e-9);
    let effect = drawn("backlash-second-encoder", 1, 1.0);
    (effect.build)(&mut specimen);
    let play = specimen.soft.unwrap();
    let half = 0.5 * effect.numbers["play_rad"];
    assert_eq!(
        (
            play.torque(0.99 * half, 1.0),
            play.torque(-0.99 * half, 1.0)
        ),
        (0.0, 0.0)
    );
    assert!(play.torque(1.1 * half, 0.0) > 0.0 && play.torque(-1.1 * half, 0.0) < 0.0);
}

/// A ramp of every column.
fn ramp() -> Ticks {
    let mut ticks = Ticks::new(ARM.count());
    for tick in 0..2000 {
        let value = 0.001 * f64::from(tick);
        ticks.time_s.push(value);
        let all = [
            &mut ticks.angle,
            &mut ticks.rate,
            &mut ticks.acceleration,
            &mut ticks.output,
        ];
        for columns in all {
            columns.iter_mut().for_each(|column| column.push(value));
        }
        for (joint, axis) in ARM.axes.iter().enumerate() {
            ticks.torque[joint].push(axis.range * (value - 1.0));
        }
    }
    ticks
}

#[test]
fn sensors_read_as_they_say() {
    let range = ARM.axes[1].range;
    let read = |label: &str| {
        let effect = drawn(label, 1, 1.0);
        let mut ticks = ramp();
        (effect.readings)(&mut ticks);
        assert_eq!(ticks.torque[2], ramp().torque[2], "one joint alone");
        (effect, ticks)
    };
    let plain = ramp();
    let (effect, ticks) = read("torque-gain");
    assert!((ticks.torque[1][100] / plain.torque[1][100] - effect.numbers["factor"]).abs() < 1e-12);
    let factor = drawn("torque-gain-of-four", 1, 1.0).numbers["factor"];
    assert!(factor == 4.0 || factor == 0.25);
    let (effect, ticks) = read("torque-offset");
    assert!((ticks.torque[1][700] - plain.torque[1][700] - effect.numbers["offset"]).abs() < 1e-12);
    let (effect, ticks) = read("torque-saturation");
    let largest = ticks.torque[1]
        .iter()
        .fold(0.0_f64, |most, own| most.max(own.abs()));
    assert!((largest - effect.numbers["limit"]).abs() < 1e-12 && largest < 0.5 * range);
    let (effect, ticks) = read("torque-dead-band");
    let width = effect.numbers["width"];
    assert_eq!(
        ticks.torque[1][1000 + (900.0 * width / range) as usize],
        0.0
    );
    assert!((ticks.torque[1][1900] - (plain.torque[1][1900] - width)).abs() < 1e-12);
    let (effect, ticks) = read("encoder-latency");
    let late = plain.angle[1][1500] - ticks.angle[1][1500];
    assert!(
        (late - effect.numbers["delay_s"]).abs() < 1e-12,
        "a slope of one per second"
    );
    assert_eq!(ticks.torque, plain.torque);
    let effect = drawn("command-latency", 0, 1.0);
    assert_eq!(effect.command_delay_s, effect.numbers["delay_s"]);
    let effect = drawn("controller-mode", 0, 1.0);
    let soft = 0.5 * (effect.numbers["from_s"] + effect.numbers["until_s"]);
    assert_eq!(
        ((effect.gains)(0.0), (effect.gains)(soft)[0]),
        ([1.0; 2], effect.numbers["factor"])
    );
}

#[test]
fn recorders_lose_and_repeat_as_they_say() {
    let all: Vec<usize> = (0..20_000).map(|row| 5 * row).collect();
    let changed = |label: &str| {
        let effect = drawn(label, 0, 1.0);
        let mut rows = all.clone();
        (effect.rows)(&mut rows, &mut Random::new(4, 4));
        (effect.numbers["share"], rows)
    };
    let (share, rows) = changed("sampling-repeated");
    let repeats = rows.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert_eq!(rows.len(), all.len());
    assert!(
        (repeats as f64 / 20_000.0 - share).abs() < 0.015,
        "{repeats}"
    );
    let (share, rows) = changed("sampling-dropped");
    let gaps = rows.windows(2).filter(|pair| pair[1] - pair[0] > 5).count();
    assert!(
        rows.windows(2)
            .all(|pair| (5..=25).contains(&(pair[1] - pair[0])))
    );
    assert!(
        (gaps as f64 / rows.len() as f64 - share).abs() < 0.005,
        "{gaps}"
    );
}
