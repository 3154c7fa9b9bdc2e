//! What cannot be tested is said, with its reason; what can be, still is.

use super::arm::{Scene, arm};
use super::{examined, examined_as, examined_held};
use crate::force::names;

const ROWS: usize = 2500;

fn reason(answer: &crate::force::answer::ForceAnswer, effect: &str) -> Option<String> {
    let found = answer.untestable.iter().find(|own| own.effect == effect);
    found.map(|own| own.why.clone())
}

#[test]
fn without_what_all_need_nothing_is_tested() {
    let whole = Scene::new(41, ROWS).record();
    let no_torque = {
        let mut recording = whole.clone();
        recording.torque_nm = vec![None; 5];
        (arm(), recording, "no column torque1_nm")
    };
    let no_time = {
        let mut recording = whole.clone();
        recording.time_s = None;
        (arm(), recording, "no column t_s")
    };
    let no_gravity = {
        let mut device = arm();
        device.gravity_mps2 = None;
        (device, whole.clone(), "no [gravity]")
    };
    let no_links = {
        let mut device = arm();
        device.links.clear();
        device.bodies.clear();
        (device, whole.clone(), "no [[link]]")
    };
    let short = (
        arm(),
        whole.select(&(0..400).collect::<Vec<_>>()),
        "too little motion",
    );
    for (device, recording, why) in [no_torque, no_time, no_gravity, no_links, short] {
        let answer = examined_as(&device, &recording);
        assert!(!answer.significant && answer.findings.is_empty());
        for name in names() {
            let given = reason(&answer, name).unwrap();
            assert!(given.contains(why), "{name}: {given}, not {why}");
        }
    }
}

#[test]
fn without_the_hands_force_friction_is_found_all_the_same() {
    let scene = Scene::new(42, ROWS);
    let mut clean = scene.clone().record();
    clean.force_n = None;
    let answer = examined_held(&clean);
    // that is the hand's, and nobody knows
    assert!(
        answer.significant && answer.findings.is_empty(),
        "{answer:?}"
    );
    assert!(answer.warnings[0].contains("a force at the hand that is not in the log"));
    for name in [
        "force-bias",
        "force-gain",
        "force-crosstalk",
        "force-hysteresis",
        "grip-force",
    ] {
        assert!(
            reason(&answer, name)
                .unwrap()
                .contains("no columns fx_n, fy_n, fz_n")
        );
    }
    assert_eq!(reason(&answer, "joint-friction"), None);

    let mut rubbing = scene;
    for row in 0..ROWS {
        let rate = rubbing.rate(1, row);
        rubbing.torque_nm[1][row] += 0.05 * (rate / 0.01).tanh();
    }
    let mut recording = rubbing.record();
    recording.force_n = None;
    let answer = examined_held(&recording);
    assert_eq!(answer.findings.len(), 1, "{answer:?}");
    assert_eq!(
        (answer.findings[0].effect.as_str(), answer.findings[0].joint),
        ("joint-friction", Some(2))
    );
}

#[test]
fn a_missing_torque_is_named_and_the_others_are_tested() {
    let mut scene = Scene::new(43, ROWS);
    for row in 0..ROWS {
        let rate = scene.rate(0, row);
        scene.torque_nm[0][row] += 0.04 * (rate / 0.01).tanh();
    }
    let mut recording = scene.record();
    recording.torque_nm[3] = None;
    let answer = examined(&recording);
    assert_eq!(
        reason(&answer, "joint-friction").unwrap(),
        "no column torque4_nm"
    );
    assert_eq!(
        reason(&answer, "grip-force").unwrap(),
        "fewer than five torques"
    );
    assert_eq!(answer.channels.len(), 4);
    assert_eq!(answer.findings[0].effect, "joint-friction");
}

#[test]
fn cells_without_a_reading_are_left_out() {
    let mut recording = Scene::new(44, ROWS).record();
    for row in (0..ROWS).step_by(7) {
        recording.torque_nm[row % 5].as_mut().unwrap()[row] = f64::NAN;
        recording.force_n.as_mut().unwrap()[row % 3][row] = f64::NAN;
    }
    let answer = examined(&recording);
    assert!(!answer.significant, "{answer:?}");
    assert!(answer.channels.iter().all(|gap| gap.rms_after.is_finite()));
}

#[test]
fn a_constant_force_tells_no_gain() {
    let mut recording = Scene::new(45, ROWS).record();
    for (axis, values) in recording.force_n.as_mut().unwrap().iter_mut().enumerate() {
        values.fill(0.3 * axis as f64);
    }
    let answer = examined(&recording);
    assert_eq!(
        reason(&answer, "force-gain").unwrap(),
        "the hand's force is constant"
    );
    assert_eq!(reason(&answer, "force-bias"), None);
}
