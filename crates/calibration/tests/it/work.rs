//! Bounds on the work of a fit, in steps of its searches and in rows, not in seconds.

use haptical_calibration::{CalibrationError, Options, fit_device};

use crate::chain::{Rig, cable_at, measure, pseudo_random};
use crate::rig_scene::{placement, plain, table, tracked, unknown_tracker};

/// Accepted steps of all rounds of a fit: six rounds at most, of five to ten steps each.
const MOST_STEPS: usize = 60;
/// Steps on all rows of a search that began where one on some of them ended.
const LAST_STEPS: usize = 4;

/// 300 postures on three straight lines of joint space tell little, and a fold of them less: each search ends all the same.
#[test]
fn folds_of_postures_on_lines_take_few_steps() {
    let mut device = table(6);
    unknown_tracker(&mut device);
    let mut truth = device.clone();
    for (row, link) in truth.links.iter_mut().enumerate() {
        let number = |index: u64| pseudo_random(5, 10 * row as u64 + index);
        link.a_m += 2e-3 * number(0);
        link.d_m += 2e-3 * number(1);
        link.theta_rad += 5e-3 * number(2);
        link.alpha_rad += 5e-3 * number(3);
    }
    truth.surroundings.tracker_base = Some(placement(1, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(2, 0.1, 0.0));
    let on_lines = |joint: u64| {
        let end = |line: u64, side: u64| pseudo_random(9, 100 * line + 10 * joint + side);
        let at = |row: u64| {
            let (line, share) = (row / 100, (row % 100) as f64 / 99.0);
            end(line, 0) + share * (end(line, 1) - end(line, 0))
        };
        (0..300).map(at).collect()
    };
    let mut recording = plain((0..6).map(on_lines).collect());
    tracked(&truth, &mut recording, 1.0, 21);
    let mut lost = 0;
    for fold in 0..10 {
        let seen: Vec<usize> = (0..300).filter(|row| row % 10 != fold).collect();
        match fit_device(&device, &recording.select(&seen), &Options::default()) {
            Ok(fitted) => {
                let steps = fitted.whole.unwrap().iterations;
                assert!(steps <= MOST_STEPS, "fold {fold}: {steps} steps");
            }
            Err(CalibrationError::NotConverged { .. }) => lost += 1,
            Err(error) => panic!("fold {fold}: {error}"),
        }
    }
    assert!(lost <= 1, "{lost} folds lost");
}

/// All rows of a long log are passed a few times, whatever the nominal device misses.
#[test]
fn a_long_log_takes_its_last_steps_alone() {
    let mut device = table(3);
    device.cables.push(cable_at([0.4, -0.3, 0.2]));
    let mut truth = device.clone();
    for link in &mut truth.links[1..] {
        link.a_m += 3e-3;
        link.theta_rad -= 8e-3;
    }
    let recording = measure(&truth, Rig::Cable, 100_000, 3);
    let fitted = fit_device(&device, &recording, &Options::default()).unwrap();
    let whole = fitted.whole.unwrap();
    assert!(whole.iterations <= LAST_STEPS, "{} steps", whole.iterations);
    assert!(whole.fitted.len() > 8);
}
