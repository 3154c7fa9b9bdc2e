//! A payload that changes between runs is found with its size; what else changes is none.

use haptical_effects::{Context, drive_catalogue};
use haptical_model::Recording;
use nalgebra::Vector3;

use super::arm::{Scene, arm, other_arm};
use super::{examined, examined_held};
use crate::answer::{CauseAnswer, ParameterAnswer};
use crate::force::along::Along;
use crate::force::answer::ForceAnswer;
use crate::force::recorded::Recorded;

/// Rows of a run.
const RUN: usize = 2500;
const LAST: usize = 4;
const MASS_KG: f64 = 0.2;

/// Centre of a payload in the last link's frame: a few centimetres off the handle.
fn at_flange() -> Vector3<f64> {
    let link = arm().links[5];
    Vector3::new(link.a_m + 0.02, -0.01, link.d_m + 0.03)
}

/// A recording as runs of equal length; no hand.
fn recorded(scene: Scene, runs: usize) -> Recording {
    let mut recording = scene.record();
    let rows = recording.len() / runs;
    recording.run = Some(
        (0..recording.len())
            .map(|row| (row / rows) as i64)
            .collect(),
    );
    recording.force_n = None;
    recording
}

fn payloads(answer: &ForceAnswer) -> Vec<&CauseAnswer> {
    let found = answer.findings.iter();
    found.filter(|cause| cause.effect == "payload").collect()
}

fn assert_holds(found: &CauseAnswer, name: &str, truth: f64) {
    let ParameterAnswer {
        value,
        ci95: [low, high],
    } = found.parameters[name];
    // one in twenty is missed by chance
    let half = 0.5 * (high - low) * 1.7;
    assert!(
        (value - truth).abs() < half,
        "{name} {value} [{low}, {high}], truth {truth}"
    );
}

/// Friction, an offset and a spring that no law of the catalogue has, the same in all runs.
fn rub(scene: &mut Scene) {
    for joint in 0..scene.torque_nm.len() {
        for row in 0..scene.time_s.len() {
            let (rate, angle) = (scene.rate(joint, row), scene.angle_rad[joint][row]);
            let friction = 0.03 * (rate / 0.05).tanh() * (1.0 + 0.3 * (2.0 * angle).sin());
            scene.torque_nm[joint][row] += friction + 0.02 * rate + 0.02 + 0.03 * angle;
        }
    }
}

#[test]
fn a_payload_on_another_trajectory_is_found_with_its_size() {
    for seed in [71, 72, 73] {
        let mut scene = Scene::alone(seed, 2 * RUN);
        scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
        let answer = examined(&recorded(scene, 2));
        let found = payloads(&answer);
        assert_eq!(found.len(), 1, "{seed}: {answer:?}");
        assert_holds(found[0], "mass_kg", MASS_KG);
        assert_eq!(found[0].parameters["from_run"].value, 2.0);
        assert!(!found[0].parameters.contains_key("on_link"), "{seed}");
        assert!(
            found[0].probability > 0.8 && answer.unexplained_share < 0.1,
            "{answer:?}"
        );
        let [low, high] = found[0].parameters["mass_kg"].ci95;
        assert!(high - low < 0.1, "{seed}: [{low}, {high}]");
    }
}

#[test]
fn a_gauge_of_the_handle_takes_no_payload_away_unless_a_hand_moves_the_arm() {
    let mut scene = Scene::alone(71, 2 * RUN);
    scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
    let recording = recorded(scene, 2);
    let seen = examined_held(&recording);
    assert_eq!(payloads(&seen).len(), 1, "{seen:?}");
    assert_eq!(seen, examined(&recording));

    let mut guided = Scene::new(71, 2 * RUN);
    guided.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
    let seen = examined_held(&recorded(guided, 2));
    assert!(payloads(&seen).is_empty(), "{seen:?}");
    let why = seen.untestable.iter().find(|own| own.effect == "payload");
    assert!(why.is_some_and(|own| own.why.contains("no columns fx_n, fy_n, fz_n")));
}

#[test]
fn friction_that_both_runs_share_hides_no_payload() {
    for (seed, is_repeated) in [(74, true), (75, false), (76, true)] {
        let mut scene = match is_repeated {
            true => Scene::alone(seed, RUN).repeated(),
            false => Scene::alone(seed, 2 * RUN),
        };
        rub(&mut scene);
        scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
        let answer = examined(&recorded(scene, 2));
        let found = payloads(&answer);
        assert_eq!(found.len(), 1, "{seed}: {answer:?}");
        assert_holds(found[0], "mass_kg", MASS_KG);
        assert_eq!(answer.findings[0].effect, "payload");
        let held_out = found[0].held_out.as_ref().unwrap();
        assert!(held_out.rms_after < held_out.rms_before, "{held_out:?}");
    }
}

#[test]
fn what_is_put_down_is_negative_and_several_changes_are_told() {
    let mut scene = Scene::alone(77, 3 * RUN);
    scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
    let answer = examined(&recorded(scene, 3));
    let mut found = payloads(&answer);
    found.sort_by(|a, b| {
        a.parameters["from_run"]
            .value
            .total_cmp(&b.parameters["from_run"].value)
    });
    assert_eq!(found.len(), 2, "{answer:?}");
    assert_holds(found[0], "mass_kg", MASS_KG);
    assert_holds(found[1], "mass_kg", -MASS_KG);
    assert!(found[1].parameters["mass_kg"].ci95[1] < 0.0);
    assert_eq!(found[1].parameters["from_run"].value, 3.0);
}

#[test]
fn a_mass_on_a_link_is_told_with_its_link() {
    let mut scene = Scene::alone(78, RUN).repeated();
    rub(&mut scene);
    let place = Vector3::new(0.08, 0.1, -0.03);
    scene.carry(1, 0.5, &place, RUN..2 * RUN);
    let answer = examined(&recorded(scene, 2));
    let found = payloads(&answer);
    assert_eq!(found.len(), 1, "{answer:?}");
    assert_eq!(found[0].parameters["on_link"].value, 2.0);
    assert_holds(found[0], "moment_kg_m", 0.5 * place.norm());
    assert_holds(found[0], "mass_kg", 0.5);
}

/// A drive's offset or friction drifts while the arm is loaded: a payload is named beside it, by what the drive cannot take.
#[test]
fn a_drive_that_changed_with_it_hides_no_payload() {
    for (seed, link) in [(83, 1), (84, LAST), (85, 1)] {
        let mut scene = Scene::alone(seed, RUN).repeated();
        rub(&mut scene);
        let place = match link {
            LAST => at_flange(),
            _ => Vector3::new(0.08, 0.1, -0.03),
        };
        scene.carry(link, MASS_KG, &place, RUN..2 * RUN);
        for row in RUN..2 * RUN {
            scene.torque_nm[1][row] += 0.15 + 0.03 * (scene.rate(1, row) / 0.05).tanh();
        }
        let answer = examined(&recorded(scene, 2));
        let found = payloads(&answer);
        assert_eq!(found.len(), 1, "{seed}: {answer:?}");
        assert_holds(found[0], "mass_kg", MASS_KG);
        if link == 1 {
            assert_holds(found[0], "moment_kg_m", MASS_KG * place.norm());
            // its inertia tells the mass from the distance, less well than the moment
            let [low, high] = found[0].parameters["mass_kg"].ci95;
            assert!(
                (1.1..4.0).contains(&(high / low)),
                "{seed}: [{low}, {high}]"
            );
            let mass_kg = found[0].parameters["mass_kg"].value;
            assert!((mass_kg / MASS_KG - 1.0).abs() < 0.2, "{seed}: {mass_kg}");
        }
    }
}

/// Every torque is read with a scale of its own: the mass is known to no better than these scales, and its interval says so.
#[test]
fn the_torques_scales_are_in_the_interval_of_the_mass() {
    let scales = [1.04, 0.95, 1.03, 0.97, 1.05];
    for seed in [86, 87, 88] {
        let mut scene = Scene::alone(seed, RUN).repeated();
        scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
        for (torque, scale) in scene.torque_nm.iter_mut().zip(scales) {
            torque.iter_mut().for_each(|torque| *torque *= scale);
        }
        let answer = examined(&recorded(scene, 2));
        let found = payloads(&answer);
        assert_eq!(found.len(), 1, "{seed}: {answer:?}");
        assert_holds(found[0], "mass_kg", MASS_KG);
        assert!(!found[0].parameters.contains_key("on_link"), "{seed}");
        let [low, high] = found[0].parameters["mass_kg"].ci95;
        assert!(
            high - low > 0.05 * MASS_KG && high - low < 0.2 * MASS_KG,
            "{seed}: [{low}, {high}]"
        );
    }
}

/// What another run differs by that is no mass: joint and row in, torque out.
type Change = fn(&Scene, usize, usize) -> f64;

#[test]
fn drives_that_changed_between_runs_are_no_payload() {
    let changes: [(&str, Change); 5] = [
        ("all of it", |scene, joint, row| {
            let friction = 0.04 * (scene.rate(joint, row) / 0.03).tanh();
            0.02 * (joint as f64 - 2.0) + friction + 0.1 * scene.torque_nm[joint][row]
        }),
        ("offsets", |_, joint, _| 0.03 * (joint as f64 - 2.0)),
        ("friction", |scene, joint, row| match joint {
            1 => 0.06 * (scene.rate(1, row) / 0.02).tanh(),
            _ => 0.0,
        }),
        ("a gain", |scene, joint, row| match joint {
            2 => 0.15 * scene.torque_nm[2][row],
            _ => 0.0,
        }),
        ("nothing", |_, _, _| 0.0),
    ];
    for (what, change) in changes {
        for (seed, is_repeated) in [(81, true), (82, false)] {
            let mut scene = match is_repeated {
                true => Scene::alone(seed, RUN).repeated(),
                false => Scene::alone(seed, 2 * RUN),
            };
            rub(&mut scene);
            let before = scene.clone();
            for joint in 0..before.torque_nm.len() {
                for row in RUN..2 * RUN {
                    scene.torque_nm[joint][row] += change(&before, joint, row);
                }
            }
            let answer = examined(&recorded(scene, 2));
            assert!(
                payloads(&answer).is_empty(),
                "{what} {is_repeated}: {answer:?}"
            );
        }
    }
}

#[test]
fn a_mass_in_every_row_is_none_of_a_run_and_a_twin_of_the_last_link() {
    let mut scene = Scene::alone(79, 2 * RUN);
    scene.carry(LAST, MASS_KG, &at_flange(), 0..2 * RUN);
    let answer = examined(&recorded(scene, 1));
    assert!(payloads(&answer).is_empty(), "{answer:?}");
    let mut untestable = answer.untestable.iter();
    let why = &untestable.find(|own| own.effect == "payload").unwrap().why;
    assert!(why.contains("one run"), "{why}");
    let found = &answer.findings[0];
    assert_eq!(found.effect, "unbalanced-gravity", "{answer:?}");
    assert!(
        found.confusable_with.contains(&"payload".to_owned()),
        "{found:?}"
    );
    assert!(found.probability < 0.6);
}

#[test]
fn left_out_of_the_catalogue_it_is_not_named() {
    let mut scene = Scene::alone(80, 2 * RUN);
    scene.carry(LAST, MASS_KG, &at_flange(), RUN..2 * RUN);
    let recording = recorded(scene, 2);
    let device = arm();
    let context = Context::new(&device, &recording, &[]).unwrap();
    let answer = crate::force::examine(&context, None, &["payload".to_owned()]).unwrap();
    assert!(
        answer.significant && payloads(&answer).is_empty(),
        "{answer:?}"
    );
}

/// The law of the catalogue, row by row, against the inertial columns that runs are compared with.
#[test]
fn the_law_is_that_of_the_links_columns() {
    for device in [arm(), other_arm()] {
        let recording = recorded(Scene::alone(90, 2 * RUN), 2);
        let context = Context::new(&device, &recording, &[]).unwrap();
        let recorded = Recorded::new(&context, false).unwrap();
        let along = Along::new(recorded).unwrap();
        let catalogue = drive_catalogue(&device);
        let law = catalogue
            .iter()
            .find(|effect| effect.name() == "payload")
            .unwrap();
        let signal = law.signal(&context, &[1.0], 1.0);
        let recorded = &along.recorded;
        let means = recorded.signal_means(&signal);
        // one kilogram at the flange in all blocks
        let unit = std::array::from_fn(|number| f64::from(u8::from(number == 0)));
        let columns = along.link_torques(&along.carrying(None, unit));
        let blocks = recorded.blocks.len();
        let largest = columns.amax();
        for (cell, (law, column)) in means.iter().zip(&columns).enumerate() {
            let block = &recorded.blocks[cell % blocks];
            if block.rows.start < RUN {
                assert_eq!(*law, 0.0);
            } else {
                // postures are averaged over half blocks, accelerations over 70 ms
                assert!(
                    (law - column).abs() < 0.02 * largest,
                    "cell {cell}: {law} {column}"
                );
            }
        }
    }
}

#[test]
fn the_torque_of_a_slide_is_in_newtons() {
    let device = other_arm();
    let recording = recorded(Scene::alone(91, 2 * RUN), 2);
    let context = Context::new(&device, &recording, &[]).unwrap();
    let answer = crate::force::examine(&context, None, &[]).unwrap();
    let units: Vec<&str> = answer
        .channels
        .iter()
        .map(|gap| gap.unit.as_str())
        .collect();
    assert_eq!(units, ["N m", "N m", "N", "N m", "N m"]);
}
