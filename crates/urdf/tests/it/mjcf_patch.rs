//! Corrected MJCFs: the calibrated kinematics, friction, and not a byte more.

use std::collections::BTreeMap;

use haptical_model::DeviceEffect;
use haptical_urdf::{BaseAndTip, CorrectedMjcf, NewJoints, UrdfError};
use proptest::prelude::*;

use crate::mjcf_read::{fixture, read};
use crate::support::{calibrated, gap, pose};

/// Two ways to a pose through the digits of a file: rounding of some forty transforms.
const WRITTEN: f64 = 1e-12;

fn corrected_mjcf(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
    device: &haptical_model::Device,
) -> Result<CorrectedMjcf, UrdfError> {
    haptical_urdf::corrected_mjcf(text, file, ends, device, NewJoints::Listed)
}

/// An arm with a body for each joint, written in several ways.
const ARM: &str = r#"<mujoco model="arm"> <!-- kept: pos="1 2 3" -->
  <default><default class="k"><joint axis="0 1 0" damping="3"/></default></default>
  <worldbody>
    <body name="one" pos="0.1 0 0.4" euler="10 20 30" childclass="k">
      <joint name="a" pos="0.02 0 0.1" ref="20" axis='0 0 1'/>
      <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/>
      <frame pos="0 0 0.1" euler="0 0 45"><body name="two" axisangle="1 0 0 30"><joint name="b"/>
        <body name="three" pos="0 0 0.3"><joint type="slide" name="c" damping="2" /><site name="tool" zaxis="1 1 0"/>
        </body></body>
      </frame>
    </body>
  </worldbody>
  <actuator><position joint="a" kp="10"/></actuator>
</mujoco>
"#;

/// Pieces of a text outside the values of attributes that a correction may set.
fn skeleton(text: &str) -> String {
    let mut rest = text;
    let mut kept = String::new();
    while let Some(at) = rest.find('<') {
        let end = rest[at..].find('>').map_or(rest.len(), |end| at + end + 1);
        let (before, tag) = (&rest[..at], &rest[at..end]);
        kept.push_str(before);
        let is_placed = ["<body", "<site", "<joint"]
            .iter()
            .any(|own| tag.starts_with(own));
        let keys = [
            "pos",
            "quat",
            "euler",
            "axisangle",
            "zaxis",
            "xyaxes",
            "frictionloss",
            "damping",
        ];
        let mut tag = tag.to_owned();
        for key in keys.iter().filter(|_| is_placed) {
            while let Some(start) = tag.find(&format!(" {key}=\"")) {
                let value = start + key.len() + 3;
                let Some(length) = tag[value..].find('"') else {
                    break;
                };
                tag.replace_range(start..=value + length, "");
            }
        }
        kept.push_str(&tag);
        rest = &rest[end..];
    }
    kept + rest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_calibrated_kinematics_are_in_it_and_nothing_else_is(
        deviations in prop::collection::vec(-0.03..0.03_f64, 12..40),
        values in prop::array::uniform3(-0.8..0.8_f64),
    ) {
        let nominal = read(ARM, BaseAndTip::to("tool")).device;
        let device = calibrated(&nominal, &deviations);
        let corrected = corrected_mjcf(ARM, "arm.xml", BaseAndTip::to("tool"), &device).unwrap();
        let again = read(&corrected.text, BaseAndTip::to("tool")).device;
        let gap = gap(&pose(&again, &values), &pose(&device, &values));
        prop_assert!(gap < WRITTEN, "{gap:e}\n{}", corrected.text);
        prop_assert_eq!(skeleton(&corrected.text), skeleton(ARM));
        prop_assert_eq!(again.joints, device.joints);
    }

    /// The hand is a body that moves itself: the handle becomes a site on it.
    #[test]
    fn a_site_is_added_where_nothing_is_fixed(
        deviations in prop::collection::vec(-0.03..0.03_f64, 12..40),
        values in prop::array::uniform3(-0.8..0.8_f64),
    ) {
        let nominal = read(ARM, BaseAndTip::to("three")).device;
        let mut device = calibrated(&nominal, &deviations);
        // the last row's numbers, behind its motion, are what moves the handle
        device.links[3].a_m += 0.1;
        let corrected = corrected_mjcf(ARM, "arm.xml", BaseAndTip::to("three"), &device).unwrap();
        prop_assert_eq!(&corrected.tip, "three_handle");
        let said = corrected.warnings.join("
");
        prop_assert!(said.contains("the site `three_handle` was added"), "{said}");
        let again = read(&corrected.text, BaseAndTip::to("three_handle")).device;
        let gap = gap(&pose(&again, &values), &pose(&device, &values));
        prop_assert!(gap < WRITTEN, "{gap:e}\n{}", corrected.text);
    }
}

#[test]
fn the_same_device_changes_no_byte() {
    for tip in ["tool", "three"] {
        let device = read(ARM, BaseAndTip::to(tip)).device;
        let corrected = corrected_mjcf(ARM, "arm.xml", BaseAndTip::to(tip), &device).unwrap();
        assert_eq!(corrected.text, ARM);
        assert_eq!(corrected.tip, tip);
    }
    if let Some(text) = fixture("arm.xml") {
        let device = read(&text, BaseAndTip::to("tool")).device;
        let corrected = corrected_mjcf(&text, "arm.xml", BaseAndTip::to("tool"), &device).unwrap();
        assert_eq!(corrected.text, text);
    }
}

#[test]
fn friction_is_attributes_and_the_rest_is_listed() {
    let mut device = read(ARM, BaseAndTip::to("tool")).device;
    let effect = |name: &str, joint, numbers: &[(&str, f64)]| DeviceEffect {
        name: name.to_owned(),
        joint: Some(joint),
        numbers: numbers
            .iter()
            .map(|(key, value)| ((*key).to_owned(), *value))
            .collect::<BTreeMap<_, _>>(),
        ..DeviceEffect::default()
    };
    device.effects = vec![
        effect(
            "joint-friction",
            1,
            &[("coulomb_nm", 0.25), ("viscous_nm_s_per_rad", 0.5)],
        ),
        effect("joint-friction", 2, &[("viscous_n_s_per_m", 4.0)]),
        effect("backlash", 0, &[("width_rad", 0.002)]),
        effect(
            "drum-eccentricity",
            0,
            &[("amplitude_rad", 0.002), ("phase_rad", 0.1)],
        ),
    ];
    let corrected = corrected_mjcf(ARM, "arm.xml", BaseAndTip::to("tool"), &device).unwrap();
    let expected = ARM
        .replace(
            "<joint name=\"b\"/>",
            "<joint frictionloss=\"0.25\" damping=\"0.5\" name=\"b\"/>",
        )
        .replace("damping=\"2\"", "damping=\"4\"");
    let (kept, comment) = corrected.text.split_once("  <!-- Not in").unwrap();
    assert_eq!(kept.to_owned() + "</mujoco>\n", expected);
    assert!(
        comment.contains("a_play: a play of 0.002 rad or m"),
        "{comment}"
    );
    let added = "r[\"theta1_rad\"] -= 0.002 * np.cos(1 * r[\"theta1_rad\"] - 0.1)";
    assert!(comment.contains(added), "{comment}");
    assert!(
        comment.contains("\"theta1_rad\": data.joint(\"a\").qpos[0]"),
        "{comment}"
    );
    let said = corrected.warnings.join("\n");
    assert!(
        said.contains(
            "its `a_play` (a play of 0.002 rad or m) is a joint of its own, which is not put"
        ),
        "{said}"
    );
    assert!(
        said.contains("`drum-eccentricity@1` is not in the model"),
        "{said}"
    );
}

#[test]
fn a_device_that_is_not_of_it_is_refused() {
    let device = read(ARM, BaseAndTip::to("tool")).device;
    let error = corrected_mjcf(ARM, "arm.xml", BaseAndTip::to("two"), &device).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("it has 3 moving rows, the MJCF's chain 2"),
        "{error}"
    );
    let moved = ARM.replace("0.1 0 0.4", "0.1 0 0.5");
    let error = corrected_mjcf(&moved, "arm.xml", BaseAndTip::to("tool"), &device).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("joint `a` is elsewhere in it: give the MJCF"),
        "{error}"
    );
    // between two joints of one body there is no place for a correction
    let Some(text) = fixture("arm.xml") else {
        return;
    };
    let mut device = read(&text, BaseAndTip::to("tool")).device;
    device.links[1].a_m = 0.001;
    let error = corrected_mjcf(&text, "arm.xml", BaseAndTip::to("tool"), &device).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("before joint `lift` belongs between two joints"),
        "{error}"
    );
}

/// Springs, plays and couplings become joints behind their own; keyframes get their numbers, and nothing else changes.
#[test]
fn new_joints_are_put_in_behind_their_own_and_into_keyframes() {
    let key = "  <keyframe><key name=\"home\" qpos=\"0.3 -0.2 0.1\" qvel=\"1 2 3\"/></keyframe>\n</mujoco>";
    let text = ARM.replace("</mujoco>", key);
    let mut device = read(&text, BaseAndTip::to("tool")).device;
    let effect = |name: &str, joint, numbers: &[(&str, f64)]| DeviceEffect {
        name: name.to_owned(),
        joint: Some(joint),
        numbers: numbers
            .iter()
            .map(|(key, value)| ((*key).to_owned(), *value))
            .collect::<BTreeMap<_, _>>(),
        ..DeviceEffect::default()
    };
    device.effects = vec![
        effect("capstan-compliance", 1, &[("stiffness_nm_per_rad", 400.0)]),
        effect("backlash", 1, &[("width_rad", 0.002)]),
        effect("cross-coupling", 0, &[("gain", 0.05), ("from_joint", 2.0)]),
    ];
    let put = |text: &str, device: &haptical_model::Device| {
        let ends = BaseAndTip::to("tool");
        haptical_urdf::corrected_mjcf(text, "arm.xml", ends, device, NewJoints::PutIn).unwrap()
    };
    // without the request they are listed, with Python for what they do to the readings at rest
    let listed = corrected_mjcf(&text, "arm.xml", BaseAndTip::to("tool"), &device).unwrap();
    let (kept, comment) = listed
        .text
        .split_once("  <!-- Not in this model, because the file has no joints")
        .unwrap();
    assert!(text.starts_with(kept.trim_end()));
    for line in [
        "r[\"out2_rad\"] = r.get(\"out2_rad\", r[\"theta2_rad\"]) - data.joint(\"b\").qfrc_actuator[0] / 400",
        "r[\"out1_rad\"] = r.get(\"out1_rad\", r[\"theta1_rad\"]) + 0.05 * r[\"theta2_rad\"]",
    ] {
        assert!(comment.contains(line), "{comment}");
    }
    let corrected = put(&text, &device);
    let document = roxmltree::Document::parse(&corrected.text).unwrap();
    let joint = |name: &str| {
        let mut all = document.descendants();
        all.find(|own| own.has_tag_name("joint") && own.attribute("name") == Some(name))
            .unwrap_or_else(|| panic!("no {name}\n{}", corrected.text))
    };
    let attributes =
        |name: &str, keys: [&str; 3]| keys.map(|key| joint(name).attribute(key).unwrap_or(""));
    assert_eq!(
        attributes("b_cable", ["stiffness", "limited", "frictionloss"]),
        ["400", "false", "0"]
    );
    // degrees, as the file has them
    let range = joint("b_play").attribute("range").unwrap();
    let ends: Vec<f64> = range.split(' ').map(|end| end.parse().unwrap()).collect();
    assert!((ends[1].to_radians() - 0.001).abs() < 1e-15 && ends[0] == -ends[1]);
    // a_coupling is behind `a`, along its axis at its place
    assert_eq!(
        attributes("a_coupling", ["pos", "axis", "ref"]),
        ["0.02 0 0.1", "0 0 1", "0"]
    );
    assert!(joint("b").next_sibling_element().unwrap().attribute("name") == Some("b_cable"));
    let bond = document
        .descendants()
        .find(|own| own.has_attribute("joint1"))
        .unwrap();
    assert_eq!(
        ["joint1", "joint2", "polycoef"].map(|key| bond.attribute(key).unwrap()),
        ["a_coupling", "b", "0 0.05 0 0 0"]
    );
    let home = document
        .descendants()
        .find(|own| own.has_tag_name("key"))
        .unwrap();
    // a, a_coupling, b, b_cable, b_play, c
    let numbers = |key: &str| -> Vec<f64> {
        let words = home.attribute(key).unwrap().split(' ');
        words.map(|word| word.parse().unwrap()).collect()
    };
    let expected = [0.3, 0.05 * -0.2, -0.2, 0.0, 0.0, 0.1];
    assert!(
        numbers("qpos")
            .iter()
            .zip(expected)
            .all(|(own, other)| (own - other).abs() < 1e-15)
    );
    assert_eq!(numbers("qvel"), [1.0, 0.05 * 2.0, 2.0, 0.0, 0.0, 3.0]);
    // read again the spring is the joint's; with another stiffness the same element has it
    let again = read(&corrected.text, BaseAndTip::to("tool")).device;
    assert!((again.compliance_rad_per_nm(1) - 1.0 / 400.0).abs() < 1e-15);
    let mut stiffer = again;
    stiffer.surroundings.compliance[1].rad_per_nm = 1.0 / 500.0;
    let once_more = put(&corrected.text, &stiffer);
    assert_eq!(
        once_more.text,
        corrected
            .text
            .replace("stiffness=\"400\"", "stiffness=\"500\"")
    );
    // a keyframe that does not fit is left and named
    let odd = put(&text.replace("0.3 -0.2 0.1", "0.3 -0.2"), &device);
    assert!(
        odd.warnings
            .join("\n")
            .contains("the keyframe `home` is as it was")
    );
    assert!(odd.text.contains("qpos=\"0.3 -0.2\""));
}

/// An armature that a device has learnt goes into the file; one that is the file's is not touched.
#[test]
fn another_armature_is_put_in() {
    let ends = BaseAndTip::to("tool");
    let text = ARM.replace("name=\"b\"", "name=\"b\" armature=\"0.25\"");
    let mut device = haptical_urdf::device_from_mjcf(&text, "arm.xml", ends)
        .unwrap()
        .device;
    let same = corrected_mjcf(&text, "arm.xml", ends, &device).unwrap();
    assert_eq!(same.text, text);
    device.joints[0].armature_kgm2 = Some(0.125);
    device.joints[1].armature_kgm2 = Some(0.375);
    let corrected = corrected_mjcf(&text, "arm.xml", ends, &device).unwrap();
    let expected = text
        .replace("<joint name=\"a\"", "<joint armature=\"0.125\" name=\"a\"")
        .replace("armature=\"0.25\"", "armature=\"0.375\"");
    assert_eq!(corrected.text, expected);
}
