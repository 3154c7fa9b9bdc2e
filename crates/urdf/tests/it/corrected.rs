//! Corrected URDFs: the same forward kinematics as the calibrated device, and the rest of the text as it was.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::rigid::rotation_vector;
use haptical_model::{Device, JointType};
use haptical_urdf::{BaseAndTip, UrdfOrigins, corrected_urdf, device_from_urdf};
use proptest::prelude::*;

use crate::support::{calibrated, fixture, gap, pose};

/// What the issue asks for is 1e-9 m; shortest decimal forms give the doubles themselves, so rounding is left.
const RELOADED: f64 = 1e-13;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn reloaded_kinematics_are_the_calibrated_ones(
        deviations in prop::collection::vec(-0.05..0.05_f64, 41),
        readings in prop::array::uniform6(-2.0..2.0_f64),
    ) {
        for name in ["arm.urdf", "linkage.urdf"] {
            let Some(text) = fixture(name) else { return Ok(()); };
            let nominal = device_from_urdf(&text, name, BaseAndTip::default()).unwrap();
            let device = calibrated(&nominal.device, &deviations);
            let corrected = corrected_urdf(&text, name, BaseAndTip::default(), &device).unwrap();
            let again = device_from_urdf(&corrected.text, "again.urdf", BaseAndTip::to(&corrected.tip)).unwrap();
            let readings = &readings[..device.joints.len()];
            let gap = gap(&pose(&device, readings), &pose(&again.device, readings));
            prop_assert!(gap < RELOADED, "{name}: {gap:e}");
            prop_assert_eq!(&again.device.joints, &device.joints);
            // what is corrected once more with nothing to correct has the same kinematics
            let once_more = corrected_urdf(&corrected.text, name, BaseAndTip::to(&corrected.tip), &again.device).unwrap();
            let third = device_from_urdf(&once_more.text, "third.urdf", BaseAndTip::to(&once_more.tip)).unwrap();
            let gap = crate::support::gap(&pose(&third.device, readings), &pose(&device, readings));
            prop_assert!(gap < RELOADED, "{name} again: {gap:e}");
        }
    }
}

/// Only origins of the chain's joints change: without all origins, both texts are the same.
#[test]
fn everything_else_stays() {
    let Some(text) = fixture("arm.urdf") else {
        return;
    };
    let nominal = device_from_urdf(&text, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    let device = calibrated(&nominal, &[0.001, -0.002, 0.003, 0.0005]);
    let corrected = corrected_urdf(&text, "arm.urdf", BaseAndTip::default(), &device).unwrap();
    assert_eq!(corrected.tip, "tool");
    let origins = |text: &str| {
        text.lines()
            .filter(|line| line.trim_start().starts_with("<origin"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let others = |text: &str| {
        let lines = text
            .lines()
            .filter(|line| !line.trim_start().starts_with("<origin"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(others(&corrected.text), others(&text));
    // the slide had no origin: it has one now
    assert_eq!(origins(&corrected.text).len(), origins(&text).len() + 1);
    let kept = |line: &&String| origins(&text).contains(line);
    let kept: Vec<String> = origins(&corrected.text)
        .iter()
        .filter(kept)
        .cloned()
        .collect();
    // cover, mount, wrist, palm screws and the two fingers
    assert_eq!(kept.len(), 6, "{kept:#?}");
    assert!(corrected.text.contains("<!-- the mount stands askew -->"));
}

/// Nothing is fixed behind the linkage's last joint: a link for the handle is added, under a free name.
#[test]
fn a_handle_is_added_where_there_is_none() {
    let Some(text) = fixture("linkage.urdf") else {
        return;
    };
    let text = text.replace("\"side\"", "\"e_handle\"");
    let device = device_from_urdf(&text, "linkage.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    let corrected = corrected_urdf(&text, "linkage.urdf", BaseAndTip::default(), &device).unwrap();
    assert_eq!(corrected.tip, "e_handle_");
    assert!(corrected.warnings[0].contains("`e_handle_` was added for the handle"));
}

#[test]
fn a_device_of_another_robot_is_refused() {
    let (Some(arm), Some(linkage)) = (fixture("arm.urdf"), fixture("linkage.urdf")) else {
        return;
    };
    let device = device_from_urdf(&arm, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    let refusal = |device: &Device, text: &str, ends| {
        corrected_urdf(text, "given.urdf", ends, device)
            .unwrap_err()
            .to_string()
    };
    let said = refusal(&device, &linkage, BaseAndTip::default());
    assert!(
        said.contains("it has 6 moving rows, the URDF's chain 5"),
        "{said}"
    );
    let said = refusal(&device, &arm, BaseAndTip::to("palm"));
    assert!(said.contains("the handle is elsewhere in it"), "{said}");
    let moved = arm.replace("0.4 0 0.01", "0.41 0 0.01");
    let said = refusal(&device, &moved, BaseAndTip::default());
    assert!(said.contains("joint `elbow` is elsewhere in it"), "{said}");
    let mut other = device.clone();
    other.joints[3].joint_type = JointType::Revolute;
    assert!(refusal(&other, &arm, BaseAndTip::default()).contains("is driven in another way"));
    let mut table = device;
    table.origins.clear();
    assert!(refusal(&table, &arm, BaseAndTip::default()).contains("has no origin in it"));
}

const BEND_BEFORE_A_SLIDE: &str = r#"<robot name="crane">
  <link name="base"/> <link name="column"/> <link name="boom"/> <link name="tool"/>
  <joint name="bend" type="revolute"> <origin xyz="0 0 0.5" rpy="0.1 0 0"/>
    <parent link="base"/> <child link="column"/> <axis xyz="0 1 0"/> <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="slide" type="prismatic"> <origin xyz="0.2 0.1 0"/>
    <parent link="column"/> <child link="boom"/> <axis xyz="1 0 0"/> <limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed"> <origin xyz="0.3 0 0.05"/> <parent link="boom"/> <child link="tool"/> </joint>
</robot>"#;

/// An encoder that reads too little turns (shifts) its own link: only its own joint's origin has the error.
#[test]
fn a_joints_zero_is_in_its_own_origin() {
    let ends = BaseAndTip::to("tool");
    let read = device_from_urdf(BEND_BEFORE_A_SLIDE, "crane.urdf", ends).unwrap();
    let chain = UrdfOrigins::read(BEND_BEFORE_A_SLIDE, "crane.urdf", ends).unwrap();
    let given = chain.of(&read.device).unwrap();
    let mut off = read.device.clone();
    off.links[1].theta_rad = 0.01;
    off.links[2].d_m = 0.002;
    let found = chain.of(&off).unwrap();
    let own = |joint: usize| {
        let (from, to) = (&given[joint].pose, &found[joint].pose);
        let turn = from.rotation.transpose() * to.rotation;
        (to.position_m - from.position_m, rotation_vector(&turn))
    };
    let (shift_m, turn_rad) = own(0);
    assert_eq!(found[0].joint, "bend");
    assert!(shift_m.amax() < 1e-12 && (turn_rad - Vector3::y() * 0.01).amax() < 1e-12);
    let (shift_m, turn_rad) = own(1);
    assert!(
        (shift_m - Vector3::x() * 0.002).amax() < 1e-12 && turn_rad.amax() < 1e-12,
        "{shift_m} {turn_rad}"
    );
    let (shift_m, turn_rad) = own(2);
    assert!(shift_m.amax() < 1e-12 && turn_rad.amax() < 1e-12);
}

/// A mass that is fixed behind a corrected origin, or that a slide with another zero carries, is elsewhere in the file: it is said.
#[test]
fn masses_that_move_with_an_origin_are_said() {
    let inertial = "<inertial> <mass value=\"2\"/> <inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/> </inertial>";
    let text = |kind: &str, arm: &str, tool: &str| {
        format!(
            "<robot name=\"lever\"> <link name=\"base\"/> <link name=\"arm\">{arm}</link> <link name=\"tool\">{tool}</link>\
             <joint name=\"j\" type=\"{kind}\"> <parent link=\"base\"/> <child link=\"arm\"/> <axis xyz=\"0 0 1\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/> </joint>\
             <joint name=\"f\" type=\"fixed\"> <origin xyz=\"0.1 0 0\"/> <parent link=\"arm\"/> <child link=\"tool\"/> </joint></robot>"
        )
    };
    let said = |text: &str, row: usize| {
        let ends = BaseAndTip::to("tool");
        let mut device = device_from_urdf(text, "lever.urdf", ends).unwrap().device;
        device.links[row].d_m = 0.002;
        let corrected = corrected_urdf(text, "lever.urdf", ends, &device).unwrap();
        corrected.warnings.join("\n")
    };
    let tool = said(&text("revolute", inertial, inertial), 1);
    assert!(
        tool.contains("the masses of `tool` move with their corrected origins"),
        "{tool}"
    );
    let arm = said(&text("prismatic", inertial, ""), 1);
    assert!(arm.contains("the masses of `arm` move"), "{arm}");
    for (text, row) in [
        (text("revolute", inertial, ""), 1),
        (text("revolute", inertial, inertial), 0),
    ] {
        let none = said(&text, row);
        assert!(!none.contains("move with"), "{none}");
    }
}
