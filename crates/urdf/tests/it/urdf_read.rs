//! What a URDF says beside links and joints: rotations by quaternions, prefixes that nobody declares.

use haptical_urdf::{BaseAndTip, UrdfDevice, corrected_urdf, device_from_urdf};

use crate::support::{gap, pose};

/// A lever with an origin, its inertial's too.
fn lever(version: &str, origin: &str) -> String {
    format!(
        "<robot name=\"r\"{version}>\n<link name=\"a\"/>\n<link name=\"b\"><inertial>\n<origin xyz=\"0.1 0 0\" {origin}/>\
         <mass value=\"1\"/><inertia ixx=\"1\" iyy=\"2\" izz=\"2.5\"/></inertial></link>\n\
         <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/>\n<origin xyz=\"0 0 0.3\" {origin}/>\
         <axis xyz=\"1 0 0\"/></joint>\n<link name=\"tip\"/><joint name=\"f\" type=\"fixed\"><parent link=\"b\"/>\
         <child link=\"tip\"/><origin xyz=\"0.2 0.1 0\"/></joint></robot>"
    )
}

fn read(text: &str) -> UrdfDevice {
    device_from_urdf(text, "lever.urdf", BaseAndTip::to("tip")).unwrap()
}

fn refused(text: &str) -> String {
    let error = device_from_urdf(text, "lever.urdf", BaseAndTip::to("tip"));
    error.unwrap_err().to_string()
}

const V: &str = " version=\"1.1\"";

#[test]
fn a_quaternion_turns_as_its_angles_do() {
    // a turn by 0.8 about x, y, z of 0.48, 0.6, 0.64, whatever its length and sign
    let (sine, cosine) = 0.4_f64.sin_cos();
    let [x, y, z, w] = [0.48 * sine, 0.6 * sine, 0.64 * sine, cosine];
    let turn = haptical_model::kinematics::nalgebra::UnitQuaternion::from_quaternion(
        haptical_model::kinematics::nalgebra::Quaternion::new(w, x, y, z),
    );
    let (roll, pitch, yaw) = turn.euler_angles();
    let expected = read(&lever("", &format!("rpy=\"{roll:?} {pitch:?} {yaw:?}\"")));
    assert!(expected.warnings.is_empty(), "{:?}", expected.warnings);
    for (version, factor) in [("1.1", 1.0), ("1.2", 7.0), ("2.0", -0.3)] {
        let [x, y, z, w] = [x, y, z, w].map(|entry| entry * factor);
        let text = lever(
            &format!(" version=\"{version}\""),
            &format!("quat_xyzw=\"{x:?} {y:?} {z:?} {w:?}\""),
        );
        let found = read(&text);
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        let off = gap(
            &pose(&found.device, &[0.7]),
            &pose(&expected.device, &[0.7]),
        );
        assert!(off < 1e-14, "{version}: {off:e}");
        let inertia = |entry: &UrdfDevice| entry.device.bodies[1].unwrap().inertia_kgm2.unwrap();
        let off = inertia(&found).into_iter().zip(inertia(&expected));
        assert!(off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-14);
    }
}

#[test]
fn before_version_1_1_a_quaternion_is_ignored_with_a_warning() {
    let bare = read(&lever("", ""));
    for version in ["", " version=\"1.0\""] {
        let found = read(&lever(version, "quat_xyzw=\"0 0 0.7 0.7\""));
        assert_eq!(found.device.origins, bare.device.origins);
        let [said] = &found.warnings[..] else {
            panic!("{:?}", found.warnings);
        };
        assert!(
            said.starts_with("lever.urdf:4:1: quat_xyzw is ignored"),
            "{said}"
        );
        assert!(said.contains("and in 1 more"), "{said}");
    }
    // nothing is refused of what is not read
    read(&lever("", "rpy=\"0 0 1\" quat_xyzw=\"what\""));
    read(&lever(" version=\"one\"", "rpy=\"0 0 1\""));
}

#[test]
fn a_quaternion_that_is_none_is_refused_with_its_place() {
    let both = refused(&lever(V, "rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\""));
    assert!(
        both.starts_with("lever.urdf:4:1: link `b` has both rpy and quat_xyzw"),
        "{both}"
    );
    for wrong in [
        "0 0 0 0",
        "0 0 1",
        "0 0 0 1 0",
        "0 0 nan 1",
        "0 0 inf 1",
        "a b c d",
        "",
    ] {
        let said = refused(&lever(V, &format!("quat_xyzw=\"{wrong}\"")));
        assert!(
            said.starts_with("lever.urdf:4:1: link `b`: quat_xyzw is"),
            "{said}"
        );
    }
    let said = refused(&lever(" version=\"one\"", "quat_xyzw=\"0 0 0 1\""));
    assert!(said.contains("the version is \"one\""), "{said}");
}

#[test]
fn a_corrected_urdf_has_one_rotation_in_each_origin() {
    let text = lever(V, "quat_xyzw=\"0 0 0.6 0.8\"");
    let mut device = read(&text).device;
    device.links[1].beta_rad = 0.01;
    let corrected = corrected_urdf(&text, "lever.urdf", BaseAndTip::to("tip"), &device).unwrap();
    let again = read(&corrected.text).device;
    let off = gap(&pose(&again, &[0.3]), &pose(&device, &[0.3]));
    assert!(off < 1e-14, "{off:e}");
}

#[test]
fn prefixes_that_nobody_declares_are_names_as_they_are() {
    let text = lever(V, "rpy=\"0 0 0\"");
    let known = read(&text).device;
    // none of these is a joint or a link of the robot, declared or not
    let strange = text
        .replacen("<link name=\"a\"/>", "<gazebo><sensor:camera sensor:é=\"&gt;:\" name='x:\"y'/></gazebo>\n<link name=\"a\" drake:a=\"1\"/>", 1)
        .replacen("</robot>", "<drake:joint name=\"j\" xmlns:drake=\"x\"/><a:b:link name=\"a\"/><!-- <q:r> --></robot>", 1);
    let found = read(&strange);
    assert_eq!(found.device, known);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // places are those of the user's text
    let wrong = strange.replacen("0.2 0.1 0", "0.2 0.1", 1);
    let said = refused(&wrong);
    assert!(said.starts_with("lever.urdf:8:"), "{said}");
    assert!(said.contains("joint `f`: xyz is \"0.2 0.1\""), "{said}");
    // and what is written is the user's text but for the numbers
    let mut device = known;
    device.links[1].d_m = 0.002;
    let written = |text: &str| {
        let ends = BaseAndTip::to("tip");
        corrected_urdf(text, "lever.urdf", ends, &device)
            .unwrap()
            .text
    };
    let (before, after) = (written(&text), written(&strange));
    assert_ne!(before, text);
    let added = |text: &str, other: &str| text.len() - other.len();
    assert_eq!(added(&after, &before), added(&strange, &text));
    for part in [
        "<sensor:camera sensor:é=\"&gt;:\" name='x:\"y'/>",
        "drake:a=\"1\"",
        "<a:b:link name=\"a\"/><!-- <q:r> --></robot>",
    ] {
        assert!(after.contains(part), "{after}");
    }
}
