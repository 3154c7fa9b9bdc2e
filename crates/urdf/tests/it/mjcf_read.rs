//! MJCF in: against MuJoCo's poses, closed forms, and texts that are refused.

use std::path::Path;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, JointType};
use haptical_urdf::{BaseAndTip, UrdfDevice, chain_ends, device_from_mjcf, device_from_urdf};
use serde_json::Value;

use crate::support::{ROUNDING, gap, pose};

/// A file of fixtures/mjcf; none where they were not shipped, said on standard output.
pub(crate) fn fixture(name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/mjcf")
        .join(name);
    if !path.exists() {
        println!("skipped: {name} is not here, as in a packaged crate");
        return None;
    }
    Some(std::fs::read_to_string(path).unwrap())
}

pub(crate) fn read(text: &str, ends: BaseAndTip<'_>) -> UrdfDevice {
    device_from_mjcf(text, "robot.xml", ends).unwrap()
}

fn refused(text: &str, ends: BaseAndTip<'_>) -> String {
    device_from_mjcf(text, "robot.xml", ends)
        .unwrap_err()
        .to_string()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Every way to write an orientation, degrees, classes, frames, references, anchors, two joints of one body, a follower.
#[test]
fn poses_are_mujoco_s() {
    let (Some(text), Some(poses)) = (fixture("arm.xml"), fixture("poses.json")) else {
        return;
    };
    let poses: Value = serde_json::from_str(&poses).unwrap();
    let cases = poses["cases"].as_array().unwrap();
    let tips = [
        ("tool", 5),
        ("hand", 5),
        ("camera", 4),
        ("wrist", 4),
        ("nail", 4),
        ("boom", 3),
        ("shoulder", 2),
    ];
    for (tip, joints) in tips {
        let device = read(&text, BaseAndTip::to(tip)).device;
        assert_eq!(device.joints.len(), joints, "{tip}");
        for case in cases {
            let values = numbers(&case["values"]);
            let place = &case["places"][tip];
            let expected = Pose {
                position_m: Vector3::from_column_slice(&numbers(&place[0])),
                rotation: Matrix3::from_row_slice(&numbers(&place[1])),
            };
            // MuJoCo's quaternions are normalised step by step
            let gap = gap(&pose(&device, &values[..joints]), &expected);
            assert!(gap < 1e-12, "{tip}: {gap:e}");
        }
    }
}

#[test]
fn limits_gravity_masses_and_what_a_drive_yields_are_read() {
    let Some(text) = fixture("arm.xml") else {
        return;
    };
    let read = read(&text, BaseAndTip::to("tool"));
    assert_eq!((read.base.as_str(), read.tip.as_str()), ("world", "tool"));
    let device = &read.device;
    let names: Vec<&str> = device
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["pan", "lift", "extend", "bend", "twist"]);
    assert_eq!(device.joints[2].joint_type, JointType::Prismatic);
    let degree = std::f64::consts::PI / 180.0;
    let limits = |joint: usize| {
        [
            device.joints[joint].lower_rad,
            device.joints[joint].upper_rad,
        ]
    };
    assert_eq!(limits(0), [-120.0 * degree, 90.0 * degree]);
    assert_eq!(limits(2), [-0.1, 0.3]);
    assert_eq!(limits(4), [f64::NEG_INFINITY, f64::INFINITY]);
    assert_eq!(device.gravity_mps2, Some([0.5, 0.0, -9.7]));
    assert_eq!(device.compliance_rad_per_nm(4), 1.0 / 50.0);
    assert_eq!(device.compliance_rad_per_nm(0), 0.0);
    let masses: f64 = device
        .bodies
        .iter()
        .flatten()
        .map(|body| body.mass_kg)
        .sum();
    // all but the stand, which only has a geom
    assert!((masses - 4.25).abs() < 1e-12, "{masses}");
    let said = read.warnings.join("\n");
    assert!(
        said.contains("the masses of `stand` from their geoms"),
        "{said}"
    );
    // what moves beside the chain counts as fixed to it
    assert!(said.contains("0.05 kg behind `finger`"), "{said}");
    // an inertia turns with its link: its trace does not
    let body = device.bodies[3].unwrap();
    let trace: f64 = body.inertia_kgm2.unwrap()[..3].iter().sum();
    assert!((trace - 0.025).abs() < 1e-15, "{body:?}");
}

#[test]
fn chains_are_listed_and_may_begin_anywhere() {
    let Some(text) = fixture("arm.xml") else {
        return;
    };
    let ends = chain_ends(&text, "robot.xml", None).unwrap();
    let has = |tip: &str, joints| {
        ends.iter()
            .any(|end| end.tip == tip && end.joints == joints)
    };
    assert!(has("tool", 5) && has("nail", 4), "{ends:?}");
    // from the camera back to the stand, and on to itself: the way there and back is none
    let there = read(&text, BaseAndTip::between("stand", "tool")).device;
    let back = read(&text, BaseAndTip::between("tool", "stand")).device;
    let values = [0.3, -0.4, 0.05, 0.7, -1.1];
    let mut reversed = values;
    reversed.reverse();
    let (there, back) = (pose(&there, &values), pose(&back, &reversed));
    let around = Pose {
        position_m: there.position_m + there.rotation * back.position_m,
        rotation: there.rotation * back.rotation,
    };
    assert!(gap(&around, &Pose::default()) < ROUNDING);
}

/// The device file of an MJCF is read back as the same device.
#[test]
fn the_device_file_comes_back() {
    let Some(text) = fixture("arm.xml") else {
        return;
    };
    for tip in ["tool", "nail"] {
        let device = read(&text, BaseAndTip::to(tip)).device;
        let file = device.to_new_toml().unwrap();
        assert_eq!(
            Device::from_toml(&file, "again.toml").unwrap().device,
            device
        );
    }
    let further = ["nail".to_owned()];
    let two = BaseAndTip {
        base: None,
        tip: Some("tool"),
        further_tips: &further,
    };
    let device = read(&text, two).device;
    let hands: Vec<&str> = device.hands.iter().map(|hand| hand.name.as_str()).collect();
    assert_eq!(hands, ["tool", "nail"]);
}

fn with_body(inside: &str) -> String {
    format!("<mujoco>\n<worldbody>\n<body name=\"b\">\n{inside}\n</body>\n</worldbody>\n</mujoco>")
}

#[test]
fn the_reason_and_the_place_are_said() {
    let hinge = "<joint name=\"j\"/>";
    let cases = [
        (
            with_body("<joint name=\"j\" axis=\"0 0 0\"/>"),
            "robot.xml:4:1: joint `j`: the axis is \"0 0 0\", but it must have a",
        ),
        (
            with_body("<joint name=\"j\" axis=\"0 0\"/>"),
            "robot.xml:4:1: joint `j`: axis is \"0 0\", but 3 finite numbers",
        ),
        (
            with_body("<joint name=\"j\" pos=\"0 nan 0\"/>"),
            "joint `j`: pos is \"0 nan 0\"",
        ),
        (
            with_body("<joint name=\"j\" range=\"1\"/>"),
            "joint `j`: range is \"1\", but two numbers",
        ),
        (
            with_body("<joint name=\"j\" type=\"screw\"/>"),
            "joint `j`: the type is \"screw\", but hinge, slide",
        ),
        (
            with_body("<joint name=\"j\" class=\"none\"/>"),
            "robot.xml:4:1: <joint>: there is no default class `none`",
        ),
        (
            with_body("<joint name=\"j\" type=\"ball\"/>"),
            "joint `j` is a ball joint: a chain has one variable",
        ),
        (
            with_body("<freejoint name=\"f\"/>"),
            "joint `f` is free (name a body behind it with --base)",
        ),
        (
            with_body(&format!("{hinge}\n{hinge}")),
            "there are two joints `j`: rename one",
        ),
        (
            with_body("<include file=\"arm.xml\"/>"),
            "robot.xml:4:1: <include>: the file is \"arm.xml\", but other files are read for a file and not for a text",
        ),
    ];
    all_are_said(&cases);
}

fn all_are_said(cases: &[(String, &str)]) {
    for (text, said) in cases {
        let error = refused(text, BaseAndTip::to("b"));
        assert!(error.contains(said), "{error}\n{text}");
    }
}

#[test]
fn what_is_wrong_with_a_body_or_a_file_is_said() {
    let hinge = "<joint name=\"j\"/>";
    let cases = [
        (
            with_body(hinge).replace("<body name=\"b\">", "<body name=\"b\" quat=\"0 0 0 0\">"),
            "robot.xml:3:1: body `b`: quat is \"0 0 0 0\", but it must have a direction",
        ),
        (
            with_body(hinge).replace(
                "<body name=\"b\">",
                "<body name=\"b\" quat=\"1 0 0 0\" euler=\"0 0 0\">",
            ),
            "body `b` has both quat and euler",
        ),
        (
            with_body(&format!("{hinge}<inertial pos=\"0 0 0\" mass=\"-1\"/>")),
            "body `b`: the mass is -1, but",
        ),
        (
            with_body(&format!("{hinge}<inertial pos=\"0 0 0\"/>")),
            "body `b` has no mass",
        ),
        (
            with_body(hinge).replace("<worldbody>", "<compiler angle=\"grad\"/><worldbody>"),
            "<compiler>: the angle is \"grad\", but radian or degree",
        ),
        (
            with_body(hinge).replace("<worldbody>", "<compiler eulerseq=\"xy\"/><worldbody>"),
            "<compiler>: the eulerseq is \"xy\"",
        ),
        (
            with_body(hinge).replace(
                "</mujoco>",
                "<equality><joint joint1=\"j\" joint2=\"k\"/></equality></mujoco>",
            ),
            "an <equality> of joints: there is no joint `k`",
        ),
        (
            with_body(hinge).replace(
                "</mujoco>",
                "<equality><joint joint1=\"j\" joint2=\"j\"/></equality></mujoco>",
            ),
            "joint `j` follows itself",
        ),
        (
            with_body(&format!("{hinge}<body name=\"b\"/>")),
            "there are two bodies `b`: rename one",
        ),
        (
            "<robot name=\"r\"/>".to_owned(),
            "robot.xml:1:1: the outermost element is <robot>, not <mujoco>: it looks like URDF",
        ),
        (
            "<mujoco><worldbody/></mujoco>".to_owned(),
            "there is no link `b`",
        ),
        ("<mujoco>".to_owned(), "not XML that is read"),
        ("<!DOCTYPE a><mujoco/>".to_owned(), "not XML that is read"),
    ];
    all_are_said(&cases);
}

/// What stands beside the chain is said with its line, and is no reason to refuse.
#[test]
fn what_is_left_out_is_said() {
    let text = with_body(
        "<joint name=\"j\"/>\n<replicate count=\"3\"><body/></replicate>\n<site name=\"b\"/>\n<joint name=\"slack\" range=\"-1 1\"/>",
    );
    let text = text.replace(
        "</mujoco>",
        "<worldbody><body><freejoint/></body></worldbody><equality><joint joint1=\"j\"/></equality></mujoco>",
    );
    let said = read(&text, BaseAndTip::to("b")).warnings.join("\n");
    for part in [
        "robot.xml:5:1: <replicate> is left out",
        "robot.xml: no ends of a chain, because a body or another site has their name, or fromto places them: the sites `b`",
        "robot.xml:7:1: joint `slack` moves along the axis of `j`",
        "joint `j` is bound by more than a multiple of another joint",
    ] {
        assert!(said.contains(part), "{part}\n{said}");
    }
}

/// Bodies without end, one in another, and defaults too: an answer in time, no overflow of the stack.
#[test]
fn deep_and_large_models_are_answered() {
    let deep =
        |open: &str, close: &str, times| format!("{}{}", open.repeat(times), close.repeat(times));
    let bodies = deep("<body><joint/>", "</body>", 300);
    let text = format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>");
    let error = refused(&text, BaseAndTip::default());
    assert!(error.contains("300 moving joints; at most 256"), "{error}");
    let frames = deep("<frame pos=\"0 0 1\">", "</frame>", 1000);
    let text = with_body(&format!("<joint name=\"j\"/>{frames}"));
    assert_eq!(read(&text, BaseAndTip::default()).device.joints.len(), 1);
    let many = "<body><joint/></body>".repeat(5000);
    let text = format!("<mujoco><worldbody>{many}</worldbody></mujoco>");
    let error = refused(&text, BaseAndTip::default());
    assert!(error.contains("more than 4096 bodies"), "{error}");
    let classes: String = (0..2000)
        .map(|index| format!("<default class=\"c{index}\"/>"))
        .collect();
    let text = format!("<mujoco><default>{classes}</default></mujoco>");
    let error = refused(&text, BaseAndTip::default());
    assert!(error.contains("more than 1024 default classes"), "{error}");
}

#[test]
fn a_urdf_is_told_from_an_mjcf() {
    let error = device_from_urdf("<mujoco/>", "a.urdf", BaseAndTip::default()).unwrap_err();
    assert!(error.to_string().contains("name it .xml"), "{error}");
}
