//! Friction that a description states: of `<dynamics>` in a URDF, of `damping` and `frictionloss` in an MJCF.

use haptical_model::{Device, FrictionNumber, JointType};
use haptical_urdf::{
    BaseAndTip, NewJoints, corrected_mjcf, corrected_urdf, device_from_urdf, new_mjcf, new_urdf,
};

use crate::mjcf_read::read;

const URDF: &str = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/><link name=\"e\"/>\
    <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><dynamics damping=\"0.5\" friction=\"0.8\"/></joint>\
    <joint name=\"s\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/><dynamics friction=\"3\"/></joint>\
    <joint name=\"f\" type=\"continuous\"><parent link=\"c\"/><child link=\"d\"/><mimic joint=\"j\" multiplier=\"-2\"/>\
    <dynamics damping=\"0.1\" friction=\"0.2\"/></joint>\
    <joint name=\"n\" type=\"continuous\"><parent link=\"d\"/><child link=\"e\"/><dynamics damping=\"0\" friction=\"-1\"/></joint></robot>";

const MJCF: &str = "<mujoco><default><joint damping=\"0.3\"/><default class=\"k\"><joint frictionloss=\"0.2\"/></default></default>\
    <worldbody><body name=\"a\"><joint name=\"j\" class=\"k\" damping=\"0.5\"/><body name=\"b\"><joint name=\"s\" type=\"slide\"/>\
    <body name=\"c\"><joint name=\"n\" axis=\"1 0 0\" damping=\"0\"/><site name=\"tip\"/></body></body></body></worldbody></mujoco>";

/// Coulomb's friction and that per speed, joint by joint.
fn frictions(device: &Device) -> Vec<Option<[f64; 2]>> {
    let of = |joint: usize| {
        let mut entry = device
            .effects
            .iter()
            .filter(|entry| entry.joint == Some(joint));
        let entry = entry.find(|entry| entry.is_friction())?;
        let size = |number: FrictionNumber| number.stated(entry);
        Some([
            size(FrictionNumber::Coulomb)?,
            size(FrictionNumber::Viscous)?,
        ])
    };
    (0..device.joints.len()).map(of).collect()
}

fn urdf(text: &str) -> Device {
    let read = device_from_urdf(text, "arm.urdf", BaseAndTip::to("e"));
    read.unwrap().device
}

fn mjcf(text: &str) -> Device {
    read(text, BaseAndTip::to("tip")).device
}

#[test]
fn friction_is_read_with_that_of_the_joints_that_follow() {
    let device = urdf(URDF);
    // what follows by -2 moves twice as far, and its torque counts twice
    assert_eq!(
        frictions(&device),
        [Some([0.8 + 0.4, 0.5 + 0.4]), Some([3.0, 0.0]), None]
    );
    assert_eq!(device.joints[1].joint_type, JointType::Prismatic);
    // of the classes, too
    assert_eq!(
        frictions(&mjcf(MJCF)),
        [Some([0.2, 0.5]), Some([0.0, 0.3]), None]
    );
    for device in [device, mjcf(MJCF)] {
        let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
        assert_eq!(frictions(&again.device), frictions(&device));
        assert!(again.warnings.is_empty(), "{:?}", again.warnings);
    }
}

#[test]
fn new_descriptions_have_it() {
    let device = mjcf(MJCF);
    let (text, said) = new_mjcf(&device).unwrap();
    let again = read(&text, BaseAndTip::to("handle")).device;
    assert_eq!(frictions(&again)[..2], frictions(&device)[..2]);
    let (text, said_of_urdf) = new_urdf(&device).unwrap();
    let again = device_from_urdf(&text, "new.urdf", BaseAndTip::to("handle")).unwrap();
    assert_eq!(frictions(&again.device), frictions(&device));
    // a description says nothing of how friction changes sides, so nothing of it is lost
    let said = [said, said_of_urdf].concat().join("\n");
    assert!(!said.contains("changes sides"), "{said}");
}

#[test]
fn a_file_keeps_the_friction_that_a_device_does_not_change() {
    let ends = BaseAndTip::to("e");
    let device = urdf(URDF);
    assert_eq!(
        corrected_urdf(URDF, "arm.urdf", ends, &device)
            .unwrap()
            .text
            .matches("<dynamics")
            .count(),
        4
    );
    let kept = corrected_urdf(URDF, "arm.urdf", ends, &device)
        .unwrap()
        .text;
    assert!(
        kept.contains("<dynamics damping=\"0.5\" friction=\"0.8\"/>"),
        "{kept}"
    );
    let ends = BaseAndTip::to("tip");
    let mut device = mjcf(MJCF);
    let write = |device: &Device| {
        let corrected = corrected_mjcf(MJCF, "arm.xml", ends, device, NewJoints::Listed);
        corrected.unwrap().text
    };
    assert!(write(&device).starts_with(MJCF.trim_end_matches("</mujoco>")));
    let key = FrictionNumber::Viscous.key(JointType::Revolute).to_owned();
    device.effects[0].numbers.insert(key, 0.75);
    let changed = MJCF.replace("damping=\"0.5\"", "damping=\"0.75\"");
    assert!(
        write(&device).starts_with(changed.trim_end_matches("</mujoco>")),
        "{}",
        write(&device)
    );
    // and what a device does not know stays
    device.effects.clear();
    assert_eq!(write(&device), MJCF);
}

/// What a joint and those that follow it have together comes back from a new MJCF: each row is written with its share.
#[test]
fn followers_get_no_made_up_friction_beside_the_known_one() {
    let finger = |name: &str| {
        format!(
            "<body name=\"{name}\"><joint name=\"{name}\" type=\"slide\" armature=\"0.1\" damping=\"10\" frictionloss=\"3\"/>\
             <inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"0.001 0.001 0.001\"/></body>"
        )
    };
    let text = format!(
        "<mujoco><worldbody>{}{}</worldbody><equality><joint joint1=\"b\" joint2=\"a\" polycoef=\"0 -2 0 0 0\"/></equality></mujoco>",
        finger("a"),
        finger("b")
    );
    let further = ["b".to_owned()];
    let ends = BaseAndTip {
        base: None,
        tip: Some("a"),
        further_tips: &further,
    };
    let device = read(&text, ends).device;
    let (new, _) = new_mjcf(&device).unwrap();
    let again = read(&new, ends).device;
    // 0.1 and 2^2 times 0.1
    for own in [&device, &again] {
        assert!(
            (own.joints[0].armature_kgm2.unwrap() - 0.5).abs() < 1e-12,
            "{new}"
        );
        let numbers = &own.effects[0].numbers;
        assert!((numbers["coulomb_n"] - 9.0).abs() < 1e-12, "{numbers:?}");
        assert!(
            (numbers["viscous_n_s_per_m"] - 50.0).abs() < 1e-12,
            "{numbers:?}"
        );
    }
}
