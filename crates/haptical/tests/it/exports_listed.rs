//! What an identification writes is held by every form of an export, or listed in it and said.

use std::collections::BTreeMap;

use haptical::{Device, Export, Form, export};
use haptical_model::{
    Device as Model, DeviceEffect, DriveNumber, FrictionNumber, GivenInertia, JOINT_FRICTION,
    JointType, Segments,
};
use haptical_urdf::{BaseAndTip, device_from_mjcf, device_from_urdf};

use crate::exports::{exported, same_torques};

/// The arm of the lists: a URDF of its own, so that every form can be written of it.
const ARM: &str = r#"<robot name="arm"> <link name="base"/>
  <link name="one"><inertial><origin xyz="0.1 0 0"/><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
  <link name="two"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="tool"/>
  <joint name="a" type="revolute"><origin xyz="0 0 0.3"/><parent link="base"/><child link="one"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="0" velocity="0"/></joint>
  <joint name="b" type="revolute"><origin xyz="0.3 0 0"/><parent link="one"/><child link="two"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="0" velocity="0"/></joint>
  <joint name="c" type="fixed"><origin xyz="0.2 0 0"/><parent link="two"/><child link="tool"/></joint>
</robot>"#;

/// Whether a form holds a number, and if not the words that name it in the file and on the terminal.
fn drive_number_in(form: Form, number: DriveNumber, model: &Model) -> Option<String> {
    let holds = match (form, number) {
        (Form::Toml, _) => true,
        (Form::Urdf | Form::Mjcf, DriveNumber::TorqueLimit) => true,
        (Form::Mjcf, DriveNumber::Armature) => true,
        (Form::Urdf | Form::Mjcf, _) => false,
        (Form::Rust | Form::CHeader | Form::Json, _) => false,
        (Form::Ros2Control | Form::KinematicsYaml, _) => false,
    };
    (!holds).then(|| number.words(&model.joints[1]).unwrap())
}

fn friction_number_in(form: Form, number: FrictionNumber) -> Option<&'static str> {
    let is_size = matches!(number, FrictionNumber::Coulomb | FrictionNumber::Viscous);
    match (form, number) {
        (Form::Toml | Form::Rust | Form::CHeader | Form::Json, _) => None,
        (Form::Urdf | Form::Mjcf, _) if is_size => None,
        (Form::Urdf | Form::Mjcf, FrictionNumber::Stribeck) => Some("Stribeck"),
        (Form::Urdf | Form::Mjcf, _) => Some("over 0.0625 rad"),
        (Form::Ros2Control | Form::KinematicsYaml, _) => Some("joint-friction@2"),
    }
}

#[test]
fn what_an_identification_writes_is_held_by_every_form_or_listed_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("arm.urdf");
    std::fs::write(&urdf, ARM).unwrap();
    let nominal = device_from_urdf(ARM, "arm.urdf", BaseAndTip::to("tool"))
        .unwrap()
        .device;
    let written = |model: &Model, form: Form| {
        let device = Device::from_toml(&model.to_new_toml().unwrap(), "identified.toml").unwrap();
        let mut request = Export::new(form);
        if form == Form::KinematicsYaml {
            request.urdf = Some(&urdf);
            request.ends = BaseAndTip::to("tool");
        }
        export(&device, &request).unwrap()
    };
    let forms = [
        Form::Rust,
        Form::CHeader,
        Form::Json,
        Form::Toml,
        Form::Urdf,
        Form::Mjcf,
        Form::Ros2Control,
        Form::KinematicsYaml,
    ];
    let assert_held = |model: &Model, form: Form, words: Option<&str>, value: &str| {
        let exported = written(model, form);
        let Some(words) = words else {
            assert!(
                exported.text.contains(value),
                "{form:?} lacks {value}:\n{}",
                exported.text
            );
            return;
        };
        assert!(
            exported.text.contains(words),
            "{form:?} does not list {words}:\n{}",
            exported.text
        );
        let mut said = exported.warnings.iter();
        assert!(
            said.any(|own| own.contains(words)),
            "{form:?}: {words}, {:?}",
            exported.warnings
        );
    };
    for form in forms {
        for number in DriveNumber::ALL {
            let mut model = nominal.clone();
            number.set(&mut model.joints[1], Some(0.3125));
            let words = drive_number_in(form, number, &model);
            assert_held(&model, form, words.as_deref(), "0.3125");
        }
        for number in FrictionNumber::ALL {
            let mut model = nominal.clone();
            let turnover = match number {
                FrictionNumber::TurnoverTravel => FrictionNumber::TurnoverTravel,
                _ => FrictionNumber::TurnoverSpeed,
            };
            let key = |own: FrictionNumber| own.key(JointType::Revolute).to_owned();
            let mut numbers = BTreeMap::from([
                (key(FrictionNumber::Coulomb), 0.5),
                (key(FrictionNumber::Viscous), 0.25),
                (key(FrictionNumber::Stribeck), 0.125),
                (key(turnover), 0.0625),
            ]);
            let value = if number == turnover { 0.0625 } else { 0.3125 };
            numbers.insert(key(number), value);
            model.effects.push(DeviceEffect {
                name: JOINT_FRICTION.to_owned(),
                joint: Some(1),
                numbers,
                ..DeviceEffect::default()
            });
            assert_held(
                &model,
                form,
                friction_number_in(form, number),
                &value.to_string(),
            );
        }
        if matches!(
            form,
            Form::Rust | Form::CHeader | Form::Json | Form::Ros2Control | Form::KinematicsYaml
        ) {
            assert_held(&nominal, form, Some("masses"), "");
        }
    }
}

/// An inertia that no body has is in no description; one without a mass is, as Pinocchio and MuJoCo take it.
#[test]
fn inertias_that_no_body_has_are_not_exported_and_rotors_are() {
    let broken = ARM.replace(
        "izz=\"0.02\"/></inertial></link>\n  <link name=\"tool\"",
        "izz=\"0.9\"/></inertial></link>\n  <link name=\"tool\"",
    );
    assert_ne!(broken, ARM);
    let read = device_from_urdf(&broken, "arm.urdf", BaseAndTip::to("tool")).unwrap();
    let said = read.warnings.join("\n");
    assert!(
        said.contains("no body has the inertia of link `two` (izz is more than ixx + iyy)"),
        "{said}"
    );
    let device = Device::from_toml(&read.device.to_new_toml().unwrap(), "arm.toml").unwrap();
    let of = |model: &Model| {
        let body = Segments::of_device(model).unwrap().rows[1].body.unwrap();
        (body.mass_kg, body.given_inertia())
    };
    let ends = BaseAndTip::to("handle");
    for form in [Form::Urdf, Form::Mjcf] {
        let exported = export(&device, &Export::new(form)).unwrap();
        let wanted = "plausible inertia of link2, because no body has the one that is given";
        let mut said = exported.warnings.iter();
        assert!(said.any(|own| own == wanted), "{:?}", exported.warnings);
        let again = match form {
            Form::Urdf => device_from_urdf(&exported.text, "again.urdf", ends),
            _ => device_from_mjcf(&exported.text, "again.xml", ends),
        };
        let GivenInertia::Body(inertia) = of(&again.unwrap().device).1 else {
            panic!("{form:?} has no inertia");
        };
        assert!(inertia.trace() < 0.1, "{inertia}");
    }
    let rotor = ARM.replace("<mass value=\"1\"/>", "<mass value=\"0\"/>");
    let read = device_from_urdf(&rotor, "arm.urdf", BaseAndTip::to("tool")).unwrap();
    assert!(
        read.warnings.iter().all(|own| !own.contains("no body")),
        "{:?}",
        read.warnings
    );
    let device = Device::from_toml(&read.device.to_new_toml().unwrap(), "arm.toml").unwrap();
    let again = device_from_urdf(
        &exported(&device, Form::Urdf),
        "again.urdf",
        BaseAndTip::to("handle"),
    )
    .unwrap();
    same_torques(&device.model, &again.device, "a rotor");
    let (mass_kg, inertia) = of(&again.device);
    let GivenInertia::Body(inertia) = inertia else {
        panic!("{inertia:?}")
    };
    assert!(
        mass_kg == 0.0 && (inertia.trace() - 0.05).abs() < 1e-12,
        "{inertia}"
    );
    let mjcf = device_from_mjcf(
        &exported(&device, Form::Mjcf),
        "again.xml",
        BaseAndTip::to("handle"),
    )
    .unwrap();
    let GivenInertia::Body(inertia) = of(&mjcf.device).1 else {
        panic!("no inertia")
    };
    assert!((inertia.trace() - 0.05).abs() < 1e-12, "{inertia}");
}
