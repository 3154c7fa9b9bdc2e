//! Torques of motions of arms that are described in files, against Pinocchio and MuJoCo (fixtures/dynamics/described.py).

use std::path::{Path, PathBuf};

use haptical_model::{Device, RigidBodies};
use haptical_urdf::{BaseAndTip, device_from_mjcf, device_from_urdf, new_mjcf, new_urdf};
use serde_json::Value;

fn described() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dynamics/described")
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn torques() -> Value {
    serde_json::from_str(&text(&described().join("torques.json"))).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|own| own.as_f64().unwrap()).collect()
}

/// Largest difference of the torques of all states from those of another program.
fn largest_gap(device: &Device, states: &Value, key: &str) -> f64 {
    let bodies = RigidBodies::of_device(device).unwrap();
    let (mut work, mut found) = (bodies.work(), vec![0.0; device.joints.len()]);
    let states = states.as_array().unwrap();
    assert!(!states.is_empty());
    let mut largest = 0.0_f64;
    for state in states {
        let [q, dq, ddq, tau] = ["q", "dq", "ddq", key].map(|key| numbers(&state[key]));
        bodies
            .torques(&q, &dq, &ddq, &mut work, &mut found)
            .unwrap();
        for (own, other) in found.iter().zip(&tau) {
            largest = largest.max((own - other).abs());
        }
    }
    largest
}

fn own_urdf() -> Device {
    let text = text(&described().join("arm.urdf"));
    device_from_urdf(&text, "arm.urdf", BaseAndTip::to("flange"))
        .unwrap()
        .device
}

fn own_mjcf() -> Device {
    let text = text(&described().join("arm.xml"));
    device_from_mjcf(&text, "arm.xml", BaseAndTip::to("tip"))
        .unwrap()
        .device
}

#[test]
fn the_torques_of_a_urdf_are_those_of_pinocchio() {
    let gap = largest_gap(&own_urdf(), &torques()["urdf"], "tau");
    assert!(gap < 1e-12, "{gap:e}");
}

#[test]
fn the_torques_of_an_mjcf_are_those_of_mujoco() {
    let gap = largest_gap(&own_mjcf(), &torques()["mjcf"], "tau");
    assert!(gap < 1e-12, "{gap:e}");
}

/// Both formats of one arm, whose rotations its files round.
#[test]
fn the_torques_of_an_arm_are_those_of_both_programs() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/moving-sets");
    if !shared.join("arm_a.urdf").is_file() {
        eprintln!("skipped: {} is not there", shared.display());
        return;
    }
    let states = &torques()["arm_a"];
    let urdf = text(&shared.join("arm_a.urdf"));
    let urdf = device_from_urdf(&urdf, "arm_a.urdf", BaseAndTip::to("flange")).unwrap();
    assert!(largest_gap(&urdf.device, states, "tau") < 1e-8);
    let mjcf = text(&shared.join("arm_a.xml"));
    let mjcf = device_from_mjcf(&mjcf, "arm_a.xml", BaseAndTip::to("flange")).unwrap();
    assert!(largest_gap(&mjcf.device, states, "with_armature") < 1e-8);
    let limits = urdf.device.joints.iter().map(|own| own.torque_limit_nm);
    assert!(limits.eq([150.0, 150.0, 150.0, 28.0, 28.0, 28.0].map(Some)));
}

#[test]
fn armatures_and_limits_are_read() {
    let limits = |device: &Device| -> Vec<Option<f64>> {
        let joints = device.joints.iter();
        joints.map(|own| own.torque_limit_nm).collect()
    };
    // an effort of 0 is none
    let urdf = own_urdf();
    assert_eq!(limits(&urdf), [Some(120.0), Some(80.0), None, Some(15.5)]);
    assert!(urdf.joints.iter().all(|own| own.armature_kgm2.is_none()));
    let mjcf = own_mjcf();
    // by class and gear; not limited; the joint's own range; by class and gear, of two ends the larger
    assert_eq!(limits(&mjcf), [Some(140.0), None, Some(40.0), Some(12.0)]);
    let armatures: Vec<_> = mjcf.joints.iter().map(|own| own.armature_kgm2).collect();
    assert_eq!(armatures, [0.3, 0.11, 0.02, 0.02].map(Some));
}

/// A written description, read again, moves with the same torques: inertials, armatures and limits come back.
#[test]
fn what_is_written_moves_as_the_device_does() {
    let device = own_mjcf();
    let states = &torques()["mjcf"];
    let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
    assert_eq!(again.device, device);
    let (mjcf, _) = new_mjcf(&device).unwrap();
    let mjcf = device_from_mjcf(&mjcf, "new.xml", BaseAndTip::to("handle")).unwrap();
    assert!(largest_gap(&mjcf.device, states, "tau") < 1e-9);
    let armatures = |device: &Device| -> Vec<Option<f64>> {
        device.joints.iter().map(|own| own.armature_kgm2).collect()
    };
    let limits = |device: &Device| -> Vec<Option<f64>> {
        let joints = device.joints.iter();
        joints.map(|own| own.torque_limit_nm).collect()
    };
    assert_eq!(armatures(&mjcf.device), armatures(&device));
    assert_eq!(limits(&mjcf.device), limits(&device));
    let (urdf, _) = new_urdf(&own_urdf()).unwrap();
    let urdf = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle")).unwrap();
    assert!(largest_gap(&urdf.device, &torques()["urdf"], "tau") < 1e-9);
    assert_eq!(limits(&urdf.device), limits(&own_urdf()));
}
