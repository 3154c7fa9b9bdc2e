//! Masses and friction of a device in the URDF and the MJCF that it came from.

use haptical_model::dynamics::Inertia;
use haptical_model::dynamics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, DeviceEffect, RigidBodies};
use haptical_urdf::{
    BaseAndTip, Loader, NewJoints, corrected_mjcf, corrected_urdf, device_from_mjcf,
    device_from_urdf, loader_notes,
};

const URDF: &str = r#"<robot name="two">
  <link name="base"/>
  <link name="one"><inertial><mass value="2"/><origin xyz="0 0.1 0" rpy="0.3 0 0"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.02"/></inertial></link>
  <link name="two"/>
  <link name="tool"><inertial><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
  <joint name="a" type="continuous"><origin xyz="0 0 0.3"/><parent link="base"/><child link="one"/><axis xyz="0 1 0"/><dynamics damping="9"/></joint>
  <joint name="b" type="continuous"><origin xyz="0.1 0 0.3" rpy="0.2 0 0"/><parent link="one"/><child link="two"/><axis xyz="1 0 0"/></joint>
  <joint name="c" type="fixed"><origin xyz="0 0 0.2"/><parent link="two"/><child link="tool"/></joint>
</robot>
"#;
const MJCF: &str = r#"<mujoco>
  <worldbody>
    <body name="one" pos="0 0 0.3">
      <joint name="a" axis="0 1 0" pos="0.01 0 0.02"/>
      <inertial pos="0 0.1 0" mass="2" diaginertia="0.02 0.01 0.02"/>
      <body name="two" pos="0.1 0 0.3" euler="10 0 0"><joint name="b" axis="1 0 0"/>
        <inertial pos="0 0 0.1" mass="0.7" fullinertia="0.01 0.01 0.005 0 0 0.001"/>
        <site name="tool" pos="0 0 0.2"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

/// Both rows heavier, with friction on the first joint.
fn changed(device: &Device) -> Device {
    let mut device = device.clone();
    let before = RigidBodies::plausible(&device).unwrap();
    for (row, mass_kg) in [(1, 0.6), (2, 0.9)] {
        let about = Matrix3::new(0.03, 0.002, 0.001, 0.002, 0.02, 0.0, 0.001, 0.0, 0.025);
        let centre_m = Vector3::new(0.02, 0.05, 0.12);
        let mut inertia = before.masses()[row - 1].inertia;
        inertia += Inertia::about_centre(mass_kg, &centre_m, &about);
        device.set_row_inertia(row, &inertia).unwrap();
    }
    device.joints[0].armature_kgm2 = Some(0.2);
    let numbers = [
        ("coulomb_nm", 1.5),
        ("viscous_nm_s_per_rad", 0.25),
        ("stribeck_nm", 0.0),
        ("transition_rad_per_s", 0.01),
    ];
    device.effects.push(DeviceEffect {
        name: "joint-friction".to_owned(),
        joint: Some(0),
        numbers: numbers.map(|(name, value)| (name.to_owned(), value)).into(),
        ..DeviceEffect::default()
    });
    device
}

fn assert_same(again: &Device, wanted: &Device) {
    for (again, wanted) in again.bodies.iter().zip(&wanted.bodies).skip(1) {
        let [again, wanted] = [again.unwrap(), wanted.unwrap()];
        assert!(
            (again.mass_kg - wanted.mass_kg).abs() < 1e-12,
            "{again:?}, {wanted:?}"
        );
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(
            near(&again.centre_of_mass_m, &wanted.centre_of_mass_m),
            "{again:?}, {wanted:?}"
        );
        let [a, b] = [again, wanted].map(|own| own.inertia_kgm2.unwrap());
        assert!(near(&a, &b), "{a:?}, {b:?}");
    }
}

/// A load cell is often a mass without extent: it does not make the inertia of the link that it is screwed to unknown.
#[test]
fn a_small_part_without_extent_is_a_point() {
    let inertia = r#"<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/>"#;
    let zero = r#"<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>"#;
    let link =
        format!(r#"<link name="two"><inertial><mass value="1.5"/>{inertia}</inertial></link>"#);
    let text = URDF
        .replace(inertia, zero)
        .replace(r#"<link name="two"/>"#, &link);
    let read = |text: &str| device_from_urdf(text, "two.urdf", BaseAndTip::to("tool")).unwrap();
    let body = read(&text).device.bodies[2].unwrap();
    // 1.5 kg and a point of 0.5 kg that is 0.2 m off: their reduced mass is 0.375 kg
    let own = body.inertia_kgm2.unwrap();
    let across: Vec<f64> = own[..3].iter().map(|own| own - 0.001).collect();
    assert!(
        (across.iter().sum::<f64>() - 2.0 * 0.375 * 0.04).abs() < 1e-12,
        "{own:?}"
    );
    // where it is most of the mass, nothing is known
    let heavy = text.replace(r#"<mass value="0.5"/>"#, r#"<mass value="1.6"/>"#);
    assert_eq!(read(&heavy).device.bodies[2].unwrap().inertia_kgm2, None);
}

#[test]
fn masses_and_friction_come_back_from_a_urdf() {
    let ends = || BaseAndTip::to("tool");
    let device = changed(&device_from_urdf(URDF, "two.urdf", ends()).unwrap().device);
    let corrected = corrected_urdf(URDF, "two.urdf", ends(), &device).unwrap();
    let again = device_from_urdf(&corrected.text, "again.urdf", ends())
        .unwrap()
        .device;
    assert_same(&again, &device);
    // what is fixed to a link stays
    assert!(corrected.text.contains("<mass value=\"0.5\"/>"));
    assert!(
        corrected
            .text
            .contains("<dynamics damping=\"0.25\" friction=\"1.5\"/>"),
        "{}",
        corrected.text
    );
    assert!(
        corrected
            .warnings
            .iter()
            .any(|own| own.contains("armatures"))
    );
}

#[test]
fn masses_friction_and_armature_come_back_from_an_mjcf() {
    let ends = || BaseAndTip::to("tool");
    let device = changed(&device_from_mjcf(MJCF, "two.xml", ends()).unwrap().device);
    let corrected = corrected_mjcf(MJCF, "two.xml", ends(), &device, NewJoints::Listed).unwrap();
    let again = device_from_mjcf(&corrected.text, "again.xml", ends())
        .unwrap()
        .device;
    assert_same(&again, &device);
    assert_eq!(again.joints[0].armature_kgm2, Some(0.2));
    assert!(
        corrected.text.contains("frictionloss=\"1.5\"")
            && corrected.text.contains("damping=\"0.25\"")
    );
}

#[test]
fn a_mass_that_no_link_can_have_is_said() {
    let ends = || BaseAndTip::to("tool");
    let mut device = device_from_urdf(URDF, "two.urdf", ends()).unwrap().device;
    // less than what is fixed to the second link
    let light = Inertia::about_centre(
        0.1,
        &Vector3::zeros(),
        &Matrix3::from_diagonal_element(1e-3),
    );
    device.set_row_inertia(2, &light).unwrap();
    let corrected = corrected_urdf(URDF, "two.urdf", ends(), &device).unwrap();
    assert!(
        corrected
            .warnings
            .iter()
            .any(|own| own.contains("row 2 was not put into `two`")),
        "{:?}",
        corrected.warnings
    );
}

/// Pinocchio's reader leaves out an `<inertial>` with a number that a blank follows; the number is read here.
#[test]
fn a_blank_beside_a_number_is_said_to_be_none_to_pinocchio() {
    let padded = URDF.replacen("iyy=\"0.01\"", "iyy=\"0.01 \"", 1);
    let ends = BaseAndTip::to("tool");
    let [plain, blank] = [URDF, padded.as_str()].map(|text| {
        let device = device_from_urdf(text, "two.urdf", ends).unwrap().device;
        let notes = loader_notes(text, "two.urdf", Loader::Pinocchio).unwrap();
        let of_blanks = notes
            .into_iter()
            .filter(|own| own.contains("a blank before or behind it"));
        (device, of_blanks.collect::<Vec<_>>())
    });
    assert_eq!(plain.0, blank.0);
    assert_eq!(plain.1, Vec::<String>::new());
    assert!(
        blank.1.len() == 1 && blank.1[0].contains("`one`"),
        "{blank:?}"
    );
}
