//! Effects on drives: where a log does not show the torque, they add nothing.

use haptical_effects::device::{add_effects, attached};
use haptical_model::{Device, Recording};

const FRICTION: &str = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
    [[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n\
    [[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 0.8\nviscous_nm_s_per_rad = 0.5\nstribeck_nm = 0.0\n\
    transition_rad_per_s = 0.02\n";

fn device() -> Device {
    Device::from_toml(FRICTION, "lever.toml").unwrap().device
}

/// Postures of a lever with places, and what is said beside.
fn recording(has_times: bool, has_torques: bool) -> Recording {
    let angle: Vec<f64> = (0..200).map(|row| (0.05 * f64::from(row)).sin()).collect();
    let place =
        [f64::cos, f64::sin].map(|part| angle.iter().map(|entry| 0.4 * part(*entry)).collect());
    let [x, y] = place;
    Recording {
        line: (2..202).collect(),
        time_s: has_times.then(|| (0..200).map(|row| 0.01 * f64::from(row)).collect()),
        torque_nm: vec![has_torques.then(|| angle.clone())],
        position_m: Some([x, y, vec![0.0; 200]]),
        output: vec![None],
        joint: vec![angle],
        ..Recording::default()
    }
}

#[test]
fn friction_adds_nothing_to_a_log_that_does_not_show_it() {
    for (has_times, has_torques, count) in [
        (false, false, 0),
        (true, false, 0),
        (false, true, 0),
        (true, true, 1),
    ] {
        let recording = recording(has_times, has_torques);
        let with = attached(&mut device(), &recording).unwrap();
        let shown =
            (with.added.iter()).filter(|entry| entry.readings.iter().any(|entry| *entry != 0.0));
        assert_eq!(shown.count(), count, "{has_times} {has_torques}");
        let mut simulated = recording.clone();
        add_effects(&device(), &mut simulated).unwrap();
        assert_eq!(
            simulated == recording,
            count == 0,
            "{has_times} {has_torques}"
        );
    }
}
