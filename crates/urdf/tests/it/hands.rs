//! Several tips of one URDF: a device that branches, against a program of its own in Python (fixtures/urdf/humanoid.py).

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Parameter, Pose};
use haptical_model::{Device, DeviceChain, Evaluation, ParameterId, Statics};
use haptical_urdf::{
    BaseAndTip, UrdfDevice, corrected_urdf, device_from_mjcf, device_from_urdf, new_mjcf, new_urdf,
};
use serde_json::Value;

use crate::support::{ROUNDING, fixture, gap};

const FILE: &str = "humanoid.urdf";

/// The tips behind the first one.
fn further(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn ends(further_tips: &[String]) -> BaseAndTip<'_> {
    BaseAndTip {
        further_tips,
        ..BaseAndTip::to("left_hand")
    }
}

fn read(text: &str) -> UrdfDevice {
    device_from_urdf(text, FILE, ends(&further(&["right_hand"]))).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let numbers = value.as_array().unwrap().iter();
    numbers.map(|number| number.as_f64().unwrap()).collect()
}

/// A homogeneous matrix.
fn pose_of(value: &Value) -> Pose {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    Pose {
        position_m: Vector3::from_fn(|row, _| rows[row][3]),
        rotation: Matrix3::from_fn(|row, column| rows[row][column]),
    }
}

#[test]
fn both_hands_are_where_another_program_has_them() {
    let (Some(text), Some(expected)) = (fixture(FILE), fixture("humanoid.json")) else {
        return;
    };
    let read = read(&text);
    let device = &read.device;
    let expected: Value = serde_json::from_str(&expected).unwrap();
    // the joints in the order of its columns, the shared ones first
    let joints: Vec<&str> = device
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    let wanted: Vec<&str> = expected["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own.as_str().unwrap())
        .collect();
    assert_eq!(joints, wanted);
    let hands: Vec<(&str, usize)> = device
        .hands
        .iter()
        .map(|hand| (hand.name.as_str(), hand.row))
        .collect();
    assert_eq!(hands, [("left_hand", 9), ("right_hand", 15)]);
    assert_eq!(device.parent(10), Some(3));
    assert_eq!(read.warnings.len(), 1, "{:?}", read.warnings);
    assert!(
        read.warnings[0].contains("row 3 `chest_level` follows `torso_pitch`"),
        "{}",
        read.warnings[0]
    );
    let mut statics = Statics::new(device);
    let mut evaluation = Evaluation::new(device);
    let checks = expected["checks"].as_array().unwrap();
    assert_eq!(checks.len(), 6);
    for check in checks {
        let readings = numbers(&check["joints"]);
        for (hand, side) in ["left", "right"].into_iter().enumerate() {
            evaluation.choose_hand(Some(hand));
            evaluation.move_to(&readings).unwrap();
            let gap = gap(evaluation.pose().unwrap(), &pose_of(&check["hands"][side]));
            assert!(gap < ROUNDING, "{side}: {gap:e}");
        }
        // the torso carries both arms; the slopes of the energy are differences
        let load = statics.load(&readings, |_| None).unwrap();
        for (own, wanted) in load.torques_nm.iter().zip(numbers(&check["torques_nm"])) {
            assert!((own - wanted).abs() < 1e-7, "{own} for {wanted}");
        }
    }
}

/// Poses of both hands at some readings.
fn poses(device: &Device) -> Vec<Pose> {
    let readings: Vec<f64> = (0..device.joints.len())
        .map(|joint| 0.3 * (joint as f64 + 1.0).sin())
        .collect();
    let hands = 0..device.hands.len();
    hands
        .map(|hand| DeviceChain::of_hand(device, hand).pose(&readings).unwrap())
        .collect()
}

fn assert_alike(device: &Device, again: &Device) {
    let (own, other) = (poses(device), poses(again));
    assert_eq!((own.len(), other.len()), (2, 2));
    for (own, other) in own.iter().zip(&other) {
        let gap = gap(own, other);
        assert!(gap < 1e-12, "{gap:e}");
    }
}

#[test]
fn a_corrected_file_moves_both_hands_as_the_device() {
    let Some(text) = fixture(FILE) else {
        return;
    };
    let mut device = read(&text).device;
    let numbers = device.link_parameters(true).into_iter().enumerate();
    for (index, parameter) in numbers.collect::<Vec<_>>() {
        parameter.set(&mut device, 0.01 * (index as f64 + 0.5).sin());
    }
    // the base's frame is that of the file
    for parameter in Parameter::ALL {
        ParameterId::Link { row: 0, parameter }.set(&mut device, 0.0);
    }
    let tips = further(&["right_hand"]);
    let corrected = corrected_urdf(&text, FILE, ends(&tips), &device).unwrap();
    assert_eq!(
        (corrected.tip.as_str(), corrected.further_tips),
        ("left_hand", tips)
    );
    assert_eq!(corrected.warnings, Vec::<String>::new());
    assert_alike(&device, &read(&corrected.text).device);
    // every joint's origin and no other was written
    assert_eq!(
        corrected.text.matches("rpy=").count(),
        text.matches("<joint name=").count()
    );
    // a device of one of its chains is another one
    let alone = corrected_urdf(&text, FILE, BaseAndTip::to("left_hand"), &device).unwrap_err();
    assert!(
        alone
            .to_string()
            .contains("it has 15 moving rows, the URDF's chain 9"),
        "{alone}"
    );
    let turned = BaseAndTip {
        further_tips: &further(&["left_hand"]),
        ..BaseAndTip::to("right_hand")
    };
    let turned = corrected_urdf(&text, FILE, turned, &device).unwrap_err();
    assert!(
        turned
            .to_string()
            .contains("its rows branch in another way, or it has other hands"),
        "{turned}"
    );
}

/// A hand on the way to another one keeps its place when what follows is corrected.
#[test]
fn a_hand_on_the_way_to_another_is_corrected_too() {
    let text = r#"<robot name="arm"><link name="base"/><link name="arm"/><link name="elbow"/><link name="hand"/>
        <joint name="lift" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
        <joint name="marker" type="fixed"><origin xyz="0.3 0 0"/><parent link="arm"/><child link="elbow"/></joint>
        <joint name="bend" type="continuous"><origin xyz="0.1 0 0"/><parent link="elbow"/><child link="hand"/>
        <axis xyz="0 0 1"/></joint></robot>"#;
    let tips = further(&["hand"]);
    let ends = BaseAndTip {
        further_tips: &tips,
        ..BaseAndTip::to("elbow")
    };
    let mut device = device_from_urdf(text, FILE, ends).unwrap().device;
    assert_eq!((device.hands[0].row, device.hands[1].row), (1, 2));
    device.links[1].a_m = 0.01;
    device.links[2].a_m = 0.02;
    let corrected = corrected_urdf(text, FILE, ends, &device).unwrap();
    let again = BaseAndTip {
        further_tips: &corrected.further_tips,
        ..BaseAndTip::to(&corrected.tip)
    };
    assert_alike(
        &device,
        &device_from_urdf(&corrected.text, FILE, again)
            .unwrap()
            .device,
    );
}

#[test]
fn a_new_file_has_both_hands() {
    let Some(text) = fixture(FILE) else {
        return;
    };
    let device = read(&text).device;
    let (written, left_out) = new_urdf(&device).unwrap();
    // the file of the humanoid has masses without inertias
    assert_eq!(left_out.len(), 1, "{left_out:?}");
    assert!(left_out[0].starts_with("plausible inertia of link1, link2,"));
    assert_alike(&device, &read(&written).device);
    let (written, _) = new_mjcf(&device).unwrap();
    let hands: Vec<String> = device.hands.iter().map(|hand| hand.name.clone()).collect();
    let ends = BaseAndTip {
        base: None,
        tip: Some(&hands[0]),
        further_tips: &hands[1..],
    };
    assert_alike(
        &device,
        &device_from_mjcf(&written, "new.xml", ends).unwrap().device,
    );
}

#[test]
fn tips_that_make_no_device_are_refused() {
    let Some(text) = fixture(FILE) else {
        return;
    };
    for (tips, said) in [
        (&["left_hand"][..], "the tip `left_hand` is named twice"),
        (
            &["right_hand", "right_hand"],
            "the tip `right_hand` is named twice",
        ),
        (&["foot"], "there is no link `foot`"),
        (&["pelvis"], "no joint between the root and `pelvis` moves"),
    ] {
        let refused = device_from_urdf(&text, FILE, ends(&further(tips))).unwrap_err();
        assert!(refused.to_string().contains(said), "{refused}");
    }
}
