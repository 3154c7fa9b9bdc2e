//! Corrected descriptions hold what rows carry: read again, they have the device's masses, centres and inertias.

use haptical_model::{Body, Device, DeviceEffect, RigidBodies};
use haptical_urdf::{
    BaseAndTip, NewJoints, corrected_mjcf, corrected_urdf, device_from_mjcf, device_from_urdf,
    new_mjcf, new_urdf,
};

/// Oblique axes, a link that is fixed behind another, one without inertial, one without content.
const URDF: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="one"> <!-- kept -->
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
  </link>
  <link name="two">
    <inertial><origin xyz="0.1 0.02 0" rpy="0.3 0 0.2"/><mass value="1.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0.001" izz="0.02"/></inertial>
  </link>
  <link name="cover"><inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="three"/>
  <joint name="a" type="continuous"> <origin xyz="0 0 0.3" rpy="0.1 0 0"/> <parent link="base"/> <child link="one"/> <axis xyz="0.6 0 -0.8"/> </joint>
  <joint name="b" type="continuous"> <origin xyz="0.2 0 0"/> <parent link="one"/> <child link="two"/> <axis xyz="0 1 0"/> </joint>
  <joint name="screws" type="fixed"> <origin xyz="0 0.1 0" rpy="0 0 1"/> <parent link="two"/> <child link="cover"/> </joint>
  <joint name="c" type="prismatic"> <origin xyz="0.3 0 0"/> <parent link="two"/> <child link="three"/> <axis xyz="1 0 0"/> <limit lower="0" upper="1" effort="1" velocity="1"/> </joint>
</robot>
"#;

/// A joint beside its body's frame, an inertial with a quaternion, a body without one.
const MJCF: &str = r#"<mujoco model="arm">
  <compiler angle="radian"/>
  <worldbody>
    <body name="one" pos="0 0 0.3"> <!-- kept -->
      <joint name="a" axis="0.6 0 -0.8" pos="0.02 0 0.1"/>
      <body name="two" pos="0.2 0 0">
        <inertial pos="0.1 0.02 0" quat="0.9 0.1 0.2 0.3" mass="1.5" diaginertia="0.01 0.02 0.02"/>
        <joint name="b" axis="0 1 0"/>
        <body name="three" pos="0.3 0 0"><joint name="c" type="slide" axis="1 0 0"/><site name="tool"/></body>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

fn body(mass_kg: f64, centre_of_mass_m: [f64; 3], inertia_kgm2: [f64; 6]) -> Option<Body> {
    Some(Body {
        mass_kg,
        centre_of_mass_m,
        inertia_kgm2: Some(inertia_kgm2),
    })
}

/// The device with other masses on every row.
fn changed(device: &Device) -> Device {
    let mut device = device.clone();
    device.bodies[1] = body(
        2.0,
        [0.1, -0.2, 0.05],
        [0.1, 0.12, 0.09, 0.01, -0.02, 0.003],
    );
    device.bodies[2] = body(4.0, [0.15, 0.02, -0.1], [0.11, 0.2, 0.21, 0.0, 0.03, -0.01]);
    device.bodies[3] = body(0.7, [0.0, 0.0, 0.2], [0.01, 0.02, 0.015, 0.001, 0.0, 0.0]);
    device
}

fn assert_same(found: &Device, wanted: &Device) {
    for (row, (found, wanted)) in found.bodies.iter().zip(&wanted.bodies).enumerate().skip(1) {
        let (found, wanted) = (found.unwrap(), wanted.unwrap());
        let numbers = |own: &Body| {
            let mut all = vec![own.mass_kg];
            all.extend(own.centre_of_mass_m);
            all.extend(own.inertia_kgm2.unwrap());
            all
        };
        for (a, b) in numbers(&found).iter().zip(numbers(&wanted)) {
            assert!((a - b).abs() < 1e-12, "row {row}: {found:?}, {wanted:?}");
        }
    }
}

#[test]
fn a_urdf_has_the_masses_of_the_device() {
    let device = device_from_urdf(URDF, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    let wanted = changed(&device);
    let written = corrected_urdf(URDF, "arm.urdf", BaseAndTip::default(), &wanted).unwrap();
    assert!(written.text.contains("<!-- kept -->"));
    let ends = BaseAndTip::to(&written.tip);
    let again = device_from_urdf(&written.text, "again.urdf", ends)
        .unwrap()
        .device;
    assert_same(&again, &wanted);
    // what is fixed to a link stays as it is
    assert!(
        written
            .text
            .contains("<link name=\"cover\"><inertial><mass value=\"0.5\"/>")
    );
    let same = corrected_urdf(URDF, "arm.urdf", BaseAndTip::default(), &device).unwrap();
    assert_eq!(same.text.matches("<inertial>").count(), 2);
}

#[test]
fn an_mjcf_has_the_masses_of_the_device() {
    let ends = BaseAndTip::to("tool");
    let device = device_from_mjcf(MJCF, "arm.xml", ends).unwrap().device;
    let wanted = changed(&device);
    let written = corrected_mjcf(MJCF, "arm.xml", ends, &wanted, NewJoints::Listed).unwrap();
    assert!(written.text.contains("<!-- kept -->"));
    let again = device_from_mjcf(&written.text, "again.xml", ends)
        .unwrap()
        .device;
    assert_same(&again, &wanted);
    let same = corrected_mjcf(MJCF, "arm.xml", ends, &device, NewJoints::Listed).unwrap();
    assert_eq!(same.text, MJCF);
}

#[test]
fn what_cannot_be_put_in_is_said() {
    let ends = BaseAndTip::to("tool");
    let mut device = device_from_mjcf(MJCF, "arm.xml", ends).unwrap().device;
    device.gravity_mps2 = Some([1.0, 0.0, -9.7]);
    let written = corrected_mjcf(MJCF, "arm.xml", ends, &device, NewJoints::Listed).unwrap();
    let says = |words: &str| written.warnings.iter().any(|own| own.contains(words));
    assert!(
        says("the direction of gravity is not put in"),
        "{:?}",
        written.warnings
    );
    // two joints of one body: what the first one carries has no element
    let both = MJCF.replace(
        "<joint name=\"b\" axis=\"0 1 0\"/>",
        "<joint name=\"b\" axis=\"0 1 0\"/><joint name=\"b2\" axis=\"0 0 1\"/>",
    );
    let mut device = device_from_mjcf(&both, "arm.xml", ends).unwrap().device;
    device.bodies[2] = body(1.0, [0.0; 3], [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]);
    let written = corrected_mjcf(&both, "arm.xml", ends, &device, NewJoints::Listed).unwrap();
    let says = |words: &str| written.warnings.iter().any(|own| own.contains(words));
    assert!(
        says("between two joints of one body"),
        "{:?}",
        written.warnings
    );
    // a URDF has no armatures
    let mut device = device_from_urdf(URDF, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    device.joints[0].armature_kgm2 = Some(0.1);
    let written = corrected_urdf(URDF, "arm.urdf", BaseAndTip::default(), &device).unwrap();
    let says = |words: &str| written.warnings.iter().any(|own| own.contains(words));
    assert!(says("no place for armatures"), "{:?}", written.warnings);
}

/// What an identification finds and a form has no place for is said by the command and by the file, for each form.
#[test]
fn what_a_form_does_not_carry_is_said_and_written() {
    let friction = |joint, transition: &str, size| DeviceEffect {
        name: "joint-friction".to_owned(),
        joint: Some(joint),
        numbers: [
            ("coulomb_nm", 0.4),
            ("viscous_nm_s_per_rad", 0.1),
            (transition, size),
        ]
        .map(|(key, value)| (key.to_owned(), value))
        .into(),
        ..DeviceEffect::default()
    };
    let with = |mut device: Device| {
        device.effects = vec![
            friction(0, "transition_rad_per_s", 0.017),
            friction(1, "transition_rad", 0.003),
        ];
        device.joints[0].armature_kgm2 = Some(0.25);
        device.joints[0].torque_offset_nm = Some(-0.3);
        device.joints[1].torque_delay_s = Some(0.0021);
        device
    };
    let urdf = with(
        device_from_urdf(URDF, "arm.urdf", BaseAndTip::default())
            .unwrap()
            .device,
    );
    let ends = BaseAndTip::to("tool");
    let mjcf = with(device_from_mjcf(MJCF, "arm.xml", ends).unwrap().device);
    let corrected = corrected_urdf(URDF, "arm.urdf", BaseAndTip::default(), &urdf).unwrap();
    let patched = corrected_mjcf(MJCF, "arm.xml", ends, &mjcf, NewJoints::Listed).unwrap();
    let sides = "joint 1 (tanh over 0.017 rad/s), joint 2 (Dahl's state over 0.003 rad)";
    let [in_urdf, in_mjcf] = [
        "joint 1 (armature 0.25 kg m^2, torque offset -0.3 N m), joint 2 (torque delay 2.1 ms)",
        "joint 1 (torque offset -0.3 N m), joint 2 (torque delay 2.1 ms)",
    ];
    let softly = "`frictionloss` is a soft constraint";
    for ((text, warnings), parts) in [
        (
            new_urdf(&urdf).unwrap(),
            [sides, in_urdf, "a URDF's `friction`"],
        ),
        (
            (corrected.text, corrected.warnings),
            [sides, in_urdf, "a URDF's `friction`"],
        ),
        (new_mjcf(&mjcf).unwrap(), [sides, in_mjcf, softly]),
        ((patched.text, patched.warnings), [sides, in_mjcf, softly]),
    ] {
        let (_, comment) = text
            .split_once("<!-- What this file does not carry of the device:")
            .unwrap();
        for part in parts {
            assert!(comment.contains(part), "{part}\n{text}");
            assert!(
                warnings.iter().any(|own| own.contains(part)),
                "{part}\n{warnings:?}"
            );
        }
        roxmltree::Document::parse(&text).unwrap();
    }
}

/// A device without any of it is written without a word.
#[test]
fn what_is_carried_in_full_has_no_comment() {
    let mut device = device_from_urdf(URDF, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    device.effects = vec![DeviceEffect {
        name: "joint-friction".to_owned(),
        joint: Some(0),
        numbers: [("viscous_nm_s_per_rad".to_owned(), 0.1)].into(),
        ..DeviceEffect::default()
    }];
    let written = corrected_urdf(URDF, "arm.urdf", BaseAndTip::default(), &device).unwrap();
    assert!(
        written.text.contains("<dynamics damping=\"0.1\""),
        "{}",
        written.text
    );
    assert!(!written.text.contains("does not carry"), "{}", written.text);
    assert!(
        !written.warnings.iter().any(|own| own.contains("left out")),
        "{:?}",
        written.warnings
    );
}

/// What is between two joints of one body weighs nothing; no row of it gets a made-up mass.
#[test]
fn between_two_joints_of_one_body_nothing_weighs() {
    let text = r#"<mujoco><worldbody><body name="b1">
        <joint name="j1" axis="1 0 0" pos="0 .1 0"/><joint name="j2" axis="0 0 1" pos=".2 0 0"/>
        <inertial pos=".1 0 0" mass="1" diaginertia=".01 .02 .025"/><site name="tip" pos=".2 0 .1"/>
        </body></worldbody></mujoco>"#;
    let ends = BaseAndTip::to("tip");
    let device = device_from_mjcf(text, "arm.xml", ends).unwrap().device;
    let masses: Vec<f64> = device.bodies[1..]
        .iter()
        .map(|own| own.unwrap().mass_kg)
        .collect();
    assert_eq!(masses, [0.0, 1.0]);
    let (urdf, _) = new_urdf(&device).unwrap();
    let again = device_from_urdf(&urdf, "again.urdf", BaseAndTip::to("handle")).unwrap();
    let torques = |device: &Device| {
        let bodies = RigidBodies::of_device(device).unwrap();
        let mut torques = [0.0; 2];
        let (q, dq, ddq) = ([0.3, -0.7], [1.0, 2.0], [3.0, -1.0]);
        bodies
            .torques(&q, &dq, &ddq, &mut bodies.work(), &mut torques)
            .unwrap();
        torques
    };
    let (wanted, found) = (torques(&device), torques(&again.device));
    for (wanted, found) in wanted.iter().zip(found) {
        assert!((wanted - found).abs() < 1e-12, "{wanted} {found}");
    }
}
