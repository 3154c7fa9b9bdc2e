//! Corrected descriptions hold what rows carry: read again, they have the device's masses, centres and inertias.

use haptical_model::{Body, Device};
use haptical_urdf::{
    BaseAndTip, NewJoints, corrected_mjcf, corrected_urdf, device_from_mjcf, device_from_urdf,
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
