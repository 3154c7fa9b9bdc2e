//! Each effect is found with its size, clean torques are not, and what is in no list has no name.

use haptical_effects::Context;

use super::arm::{Noise, Scene, arm};
use super::{examined, examined_as};
use crate::answer::{CauseAnswer, ParameterAnswer};
use crate::force::answer::ForceAnswer;
use crate::force::examine;

const ROWS: usize = 3000;

/// The one finding of an answer, at a joint from 0.
pub(super) fn only<'a>(
    answer: &'a ForceAnswer,
    effect: &str,
    joint: Option<usize>,
) -> &'a CauseAnswer {
    assert!(answer.significant);
    assert_eq!(answer.findings.len(), 1, "{effect}: {answer:?}");
    let found = &answer.findings[0];
    let joint = joint.map(|joint| joint + 1);
    assert_eq!((found.effect.as_str(), found.joint), (effect, joint));
    assert!(
        found.share > 0.9 && answer.unexplained_share < 0.1,
        "{answer:?}"
    );
    found
}

/// Asserts that a parameter's interval holds the truth, and is no wider than `most`.
pub(super) fn holds(found: &CauseAnswer, name: &str, truth: f64, most: f64) {
    let ParameterAnswer {
        value,
        ci95: [low, high],
    } = found.parameters[name];
    // one in twenty intervals is missed by chance: widened to one in a thousand
    let half = 0.5 * (high - low) * 1.7;
    assert!(
        (value - truth).abs() < half,
        "{name} {value} [{low}, {high}], truth {truth}"
    );
    assert!(high - low < most, "{name} [{low}, {high}]");
}

#[test]
fn clean_torques_are_silent() {
    for seed in 1..=8 {
        let answer = examined(&Scene::new(seed, ROWS).record());
        assert!(
            !answer.significant && answer.findings.is_empty(),
            "{seed}: {answer:?}"
        );
        assert_eq!(answer.unexplained_share, 0.0);
        for gap in &answer.channels {
            assert!(gap.rms_before < 1.15 * gap.noise_floor, "{seed}: {gap:?}");
            assert_eq!(gap.rms_before, gap.rms_after);
        }
    }
}

/// A tilt of the base shows moments about a level axis that no torque showed before: what they are is assumed.
#[test]
fn a_tilted_base_is_no_gap() {
    let mut unweighed = arm();
    unweighed.bodies.fill(None);
    for seed in 1..=4 {
        let recording = Scene::tilted(seed, ROWS, 0.04).record();
        for device in [&arm(), &unweighed] {
            let answer = examined_as(device, &recording);
            assert!(
                !answer.significant && answer.findings.is_empty(),
                "{seed}: {answer:?}"
            );
        }
    }
}

#[test]
fn friction_is_found_with_its_size() {
    let mut scene = Scene::new(11, ROWS);
    let scale = scene.scales[2];
    for row in 0..ROWS {
        let rate = scene.rate(2, row);
        scene.torque_nm[2][row] += 0.03 * (rate / 0.01).tanh() + 0.02 * rate;
    }
    let answer = examined(&scene.record());
    let found = only(&answer, "joint-friction", Some(2));
    // what is rubbed off is read through the torque's scale too
    holds(found, "coulomb_nm", 0.03 / scale, 0.004);
    holds(found, "viscous_nm_s_per_rad", 0.02 / scale, 0.008);
    assert!(found.plausible);
    let gap = &answer.channels[2];
    assert!(gap.rms_before > 1.5 * gap.noise_floor, "{gap:?}");
    assert!(gap.rms_after < 1.15 * gap.noise_floor, "{gap:?}");
}

#[test]
fn other_sampling_changes_neither_silence_nor_size() {
    for (rows, step_s) in [(12_000, 2e-3), (1500, 0.03)] {
        let scene = Scene::sampled(9, rows, step_s);
        let answer = examined(&scene.clone().record());
        assert!(!answer.significant, "{step_s}: {answer:?}");

        let mut rubbing = scene;
        for row in 0..rows {
            let rate = rubbing.rate(3, row);
            rubbing.torque_nm[3][row] += 0.02 * (rate / 0.01).tanh();
        }
        let scale = rubbing.scales[3];
        let answer = examined(&rubbing.record());
        let found = only(&answer, "joint-friction", Some(3));
        holds(found, "coulomb_nm", 0.02 / scale, 0.005);
    }
}

#[test]
fn a_bias_of_the_force_is_found() {
    let mut scene = Scene::new(12, ROWS);
    scene.force_n[1].iter_mut().for_each(|force| *force += 0.12);
    let answer = examined(&scene.record());
    let found = only(&answer, "force-bias", None);
    holds(found, "x_n", 0.0, 0.02);
    holds(found, "y_n", 0.12, 0.02);
    holds(found, "z_n", 0.0, 0.02);
}

#[test]
fn a_gain_and_a_crosstalk_are_told_apart() {
    let mut scene = Scene::new(13, ROWS);
    scene.force_n[0].iter_mut().for_each(|force| *force *= 1.4);
    let answer = examined(&scene.record());
    holds(only(&answer, "force-gain", None), "x", 0.4, 0.2);

    let mut scene = Scene::new(13, ROWS);
    let from = scene.force_n[2].clone();
    for (to, from) in scene.force_n[0].iter_mut().zip(from) {
        *to += 0.08 * from;
    }
    let answer = examined(&scene.record());
    holds(only(&answer, "force-crosstalk", None), "xz", 0.08, 0.06);
}

#[test]
fn a_loop_of_the_sensor_is_found() {
    let mut scene = Scene::new(14, ROWS);
    // a play of 0.1 N each way: another law than Dahl's
    let mut output = scene.force_n[2][0];
    for force in &mut scene.force_n[2] {
        output = output.clamp(*force - 0.1, *force + 0.1);
        *force = output;
    }
    let answer = examined(&scene.record());
    only(&answer, "force-hysteresis", None);
}

#[test]
fn cogging_is_found_with_its_order_fast_or_slow() {
    // order 12 at a ratio of 9 is far too fast for block means; order 2 at 6 is not
    for (joint, ratio, order) in [(1, 9.0, 12.0), (0, 6.0, 2.0)] {
        let mut scene = Scene::new(15, ROWS);
        for row in 0..ROWS {
            let angle = order * ratio * scene.angle_rad[joint][row];
            scene.torque_nm[joint][row] += 0.012 * (angle - 0.7).cos();
        }
        let answer = examined(&scene.record());
        let found = only(&answer, "motor-cogging", Some(joint));
        holds(found, "amplitude_nm", 0.012, 0.006);
        holds(found, "phase_rad", 0.7, 0.4);
        assert_eq!(found.parameters["order"].value, order);
    }
}

#[test]
fn a_scale_is_an_error_only_beyond_its_uncertainty() {
    let scene = Scene::new(16, ROWS);
    let scaled = |factor: f64| {
        let mut scene = scene.clone();
        let torques = scene.torque_nm[1].iter_mut();
        torques.for_each(|torque| *torque *= factor);
        examined(&scene.record())
    };
    assert!(!scaled(1.03).significant);
    let answer = scaled(1.4);
    let found = only(&answer, "torque-gain", Some(1));
    holds(found, "gain", 1.4 * scene.scales[1] - 1.0, 0.25);
}

#[test]
fn a_weight_beyond_the_assumed_is_found() {
    let recording = Scene::new(17, ROWS).record();
    let mut device = arm();
    // the file lacks 100 g of link 2, all towards its end
    let body = device.bodies[2].as_mut().unwrap();
    body.mass_kg -= 0.1;
    body.centre_of_mass_m[0] -= 0.04;
    let answer = examined_as(&device, &recording);
    let found = &answer.findings[0];
    assert_eq!(found.effect, "unbalanced-gravity", "{answer:?}");
    let near = |joint: Option<usize>| joint.is_some_and(|joint| (2..=4).contains(&joint));
    assert!(near(found.joint), "{answer:?}");
    assert!(found.parameters["deviations"].value > 4.0);
    // the missing 0.012 kg m of first moment weigh 0.12 N m
    assert!(
        (0.04..0.16).contains(&found.parameters["moment_nm"].value),
        "{found:?}"
    );
}

#[test]
fn a_force_that_the_sensor_misses_is_a_grip() {
    let mut scene = Scene::new(18, ROWS);
    for row in 0..ROWS {
        let time = scene.time_s[row];
        for (axis, force) in scene.force_n.iter_mut().enumerate() {
            let rate = 1.3 + 0.7 * axis as f64;
            force[row] -= 0.5 * (rate * time + axis as f64).sin() + 0.3 * (2.9 * time).cos();
        }
    }
    let answer = examined(&scene.record());
    let found = only(&answer, "grip-force", None);
    let truth = (3.0 * 0.5 * (0.5_f64.powi(2) + 0.3_f64.powi(2))).sqrt();
    assert!(
        (found.parameters["rms_n"].value / truth - 1.0).abs() < 0.25,
        "{found:?} {truth}"
    );
}

#[test]
fn what_no_list_has_gets_no_name() {
    // a bump on each of the joints, and a torque that walks
    for joint in 0..5 {
        let mut scene = Scene::new(19, ROWS);
        for row in 0..ROWS {
            let place: f64 = (scene.angle_rad[joint][row] - 0.1) / 0.12;
            scene.torque_nm[joint][row] += 0.05 * (-place * place).exp();
        }
        let answer = examined(&scene.record());
        assert!(answer.significant, "{joint}");
        assert!(answer.findings.is_empty(), "{joint}: {answer:?}");
        assert_eq!(answer.unexplained_share, 1.0);
    }
    let mut scene = Scene::new(20, ROWS);
    let (mut noise, mut state) = (Noise(3), 0.0);
    for torque in &mut scene.torque_nm[1] {
        state = 0.995 * state + 2e-3 * noise.normal();
        *torque += state;
    }
    let answer = examined(&scene.record());
    assert!(
        answer.significant && answer.findings.is_empty(),
        "{answer:?}"
    );
}

#[test]
fn an_error_of_the_motor_side_angle_is_no_cogging() {
    // its second derivative times the inertia looks like a torque at the same order
    for size_rad in [1e-3, 3e-3] {
        let mut scene = Scene::new(23, ROWS);
        for angle in &mut scene.angle_rad[0] {
            *angle += size_rad * (3.0 * 6.0 * *angle).cos();
        }
        let answer = examined(&scene.record());
        assert!(!answer.significant, "{size_rad}: {answer:?}");
    }
}

#[test]
fn less_than_two_periods_are_not_called_cogging() {
    let mut scene = Scene::new(22, ROWS);
    for row in 0..ROWS {
        scene.torque_nm[4][row] += 0.03 * (2.0 * scene.angle_rad[4][row]).cos();
    }
    let answer = examined(&scene.record());
    assert!(
        answer.significant && answer.findings.is_empty(),
        "{answer:?}"
    );
}

#[test]
fn an_effect_left_out_of_the_catalogue_is_unknown() {
    let mut scene = Scene::new(24, ROWS);
    scene.force_n[1].iter_mut().for_each(|force| *force += 0.2);
    let recording = scene.record();
    let device = arm();
    let context = Context::new(&device, &recording, &[]).unwrap();
    let without = ["force-bias".to_owned(), "grip-force".to_owned()];
    let answer = examine(&context, None, &without).unwrap();
    assert!(answer.significant, "{answer:?}");
    assert!(answer.findings.is_empty(), "{answer:?}");
    // the bias is a force that the hand does not exert
    let answer = examine(&context, None, &without[..1]).unwrap();
    assert_eq!(answer.findings[0].effect, "grip-force", "{answer:?}");
    // and as well any other error of the readings
    assert_eq!(answer.findings[0].confusable_with, ["unknown"]);
}

/// The answer with some names left out of the catalogue.
fn examined_without(scene: Scene, names: &[&str]) -> ForceAnswer {
    let (device, recording) = (arm(), scene.record());
    let context = Context::new(&device, &recording, &[]).unwrap();
    let without: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    examine(&context, None, &without).unwrap()
}

#[test]
fn a_withheld_torque_gain_leaves_a_gap_without_a_name() {
    let mut scene = Scene::new(16, ROWS);
    scene.torque_nm[2]
        .iter_mut()
        .for_each(|torque| *torque *= 1.3);
    let answer = examined_without(scene, &["torque-gain"]);
    assert!(answer.significant, "{answer:?}");
    assert!(answer.findings.is_empty(), "{answer:?}");
    assert_eq!(answer.unexplained_share, 1.0);
    assert_eq!(answer.unexplained().unwrap().joint, Some(3), "{answer:?}");
}

/// A state that hardly saturates is a gain, whatever the catalogue has.
#[test]
fn a_withheld_gain_of_the_force_is_no_hysteresis() {
    for (seed, axis) in [(13, 0), (14, 1), (15, 2), (16, 0), (17, 1), (18, 2)] {
        let mut scene = Scene::new(seed, ROWS);
        let force = scene.force_n[axis].iter_mut();
        force.for_each(|force| *force *= 1.2);
        let answer = examined_without(scene, &["force-gain"]);
        let names: Vec<_> = answer
            .findings
            .iter()
            .map(|found| found.effect.as_str())
            .collect();
        assert!(!names.contains(&"force-hysteresis"), "{seed}: {answer:?}");
    }
}

#[test]
fn two_effects_are_both_found() {
    let mut scene = Scene::new(21, ROWS);
    for row in 0..ROWS {
        let rate = scene.rate(0, row);
        scene.torque_nm[0][row] += 0.04 * (rate / 0.01).tanh();
    }
    scene.force_n[2].iter_mut().for_each(|force| *force += 0.15);
    let answer = examined(&scene.record());
    let mut names: Vec<_> = answer
        .findings
        .iter()
        .map(|found| found.effect.as_str())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["force-bias", "joint-friction"], "{answer:?}");
    let shares: f64 = answer.findings.iter().map(|found| found.share).sum();
    assert!((0.9..=1.0 + 1e-9).contains(&shares));
}

/// Rotors behind gears, as large as the links: what they add is no link's, and no gap.
#[test]
fn the_inertia_of_rotors_is_no_gap() {
    for seed in [61, 62] {
        let mut scene = Scene::alone(seed, ROWS);
        for (joint, rotor) in [0.02, 0.015, 0.02, 0.01, 0.006].into_iter().enumerate() {
            for row in 1..scene.time_s.len() - 1 {
                let step_s = scene.time_s[row + 1] - scene.time_s[row];
                let angle = &scene.angle_rad[joint];
                let bend = angle[row + 1] - 2.0 * angle[row] + angle[row - 1];
                scene.torque_nm[joint][row] += rotor * bend / (step_s * step_s);
            }
        }
        let mut recording = scene.record();
        recording.force_n = None;
        let answer = examined(&recording);
        assert!(!answer.significant, "{seed}: {answer:?}");
    }
}
