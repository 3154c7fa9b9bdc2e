//! The content of a URDF that a device keeps (joints, limits, masses, the tip), and the warnings about the rest.

use haptical_model::{JointType, Parameter, ParameterId};
use haptical_urdf::{BaseAndTip, device_from_urdf};

use crate::support::{fixture, pose};

#[test]
fn the_arm_s_joints_limits_and_warnings() {
    let Some(text) = fixture("arm.urdf") else {
        return;
    };
    let read = device_from_urdf(&text, "arm.urdf", BaseAndTip::default()).unwrap();
    let device = read.device;
    // the fingers follow each other, so they are a hand and not the end of the chain
    assert_eq!(read.tip, "tool");
    // the cover ends a shorter chain
    assert_eq!(read.warnings.len(), 1, "{:?}", read.warnings);
    assert!(read.warnings[0].contains("`left`") && read.warnings[0].contains("`right`"));
    let names: Vec<&str> = device
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    let expected = [
        "shoulder_pan",
        "shoulder_lift",
        "elbow",
        "extension",
        "wrist_roll",
        "wrist_bend",
    ];
    assert_eq!(names, expected);
    assert_eq!(device.joints[3].joint_type, JointType::Prismatic);
    let limits = |joint: usize| {
        (
            device.joints[joint].lower_rad,
            device.joints[joint].upper_rad,
        )
    };
    assert_eq!(limits(0), (-2.9, 2.8));
    assert_eq!(limits(2), (f64::NEG_INFINITY, f64::INFINITY));
    assert_eq!(limits(3), (0.0, 0.25));
    assert!(device.joints.iter().all(|joint| joint.home_rad == 0.0));
    assert!(device.drives_are_plain() && !device.is_plain_table());
    assert_eq!(device.gravity_mps2, Some([0.0, 0.0, -9.81]));
    let tracker = device.tracker.unwrap();
    assert!(!tracker.base_known && !tracker.tool_known);
    // six numbers for the base and for each joint
    assert_eq!(device.link_parameters(false).len(), 6 * 7);
    let slide = ParameterId::Link {
        row: 2,
        parameter: Parameter::B,
    };
    assert_eq!(
        (slide.key(&device).as_str(), slide.unit(&device)),
        ("link[2].b_m", "m")
    );
}

#[test]
fn masses_of_what_is_fixed_to_a_link_are_its_own() {
    let Some(text) = fixture("arm.urdf") else {
        return;
    };
    let device = device_from_urdf(&text, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    // the upper arm's 1.5 kg at its origin, and the cover's 0.5 kg at (0, 0.2, 0): turned by a quarter
    // about z, 0.1 m along its x is along y; the axis is -z, so z_to has turned by a half about x
    let body = device.bodies[2].unwrap();
    assert!((body.mass_kg - 2.0).abs() < 1e-15);
    let expected = [0.0, -0.05, 0.0];
    for axis in 0..3 {
        assert!(
            (body.centre_of_mass_m[axis] - expected[axis]).abs() < 1e-8,
            "{body:?}"
        );
    }
    assert_eq!(device.bodies[0], None);
    assert_eq!(device.bodies[3], None, "the forearm has no mass");
    // the base's 5 kg do not move
    let total: f64 = device
        .bodies
        .iter()
        .flatten()
        .map(|body| body.mass_kg)
        .sum();
    assert!((total - (2.5 + 2.0 + 0.7)).abs() < 1e-12);
}

/// A centre of mass is where its link carries it: the tip of a chain that ends in a massive link whose
/// frame is the centre.
#[test]
fn a_centre_of_mass_moves_with_its_link() {
    let body = |origin: &str| {
        format!(
            r#"<robot name="r"><link name="a"/>
            <link name="b"><inertial><origin xyz="{origin}"/><mass value="1"/></inertial></link>
            <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
              <origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/><axis xyz="0.6 -0.8 0"/></joint>
            <link name="c"/><joint name="f" type="fixed"><parent link="b"/><child link="c"/>
              <origin xyz="{origin}"/></joint></robot>"#
        )
    };
    let device = device_from_urdf(&body("0.07 -0.03 0.11"), "r", BaseAndTip::default())
        .unwrap()
        .device;
    let centre = device.bodies[1].unwrap().centre_of_mass_m;
    // the centre as the handle of a device whose last origin is the centre
    let mut at_centre = device.clone();
    at_centre.origins[2] = Some(haptical_model::Origin {
        position_m: centre,
        ..haptical_model::Origin::IDENTITY
    });
    for reading in [0.0, 0.7, -2.0] {
        let gap = pose(&device, &[reading]).position_m - pose(&at_centre, &[reading]).position_m;
        assert!(gap.amax() < 1e-15);
    }
}

#[test]
fn rows_that_follow_are_no_joints() {
    let Some(text) = fixture("linkage.urdf") else {
        return;
    };
    let read = device_from_urdf(&text, "linkage.urdf", BaseAndTip::default()).unwrap();
    // the spindle drives a row, so nothing of it is left out
    let said = "linkage.urdf: row 1 `leans` follows `lift` (column theta1_rad), row 3 `levels` follows `lift` \
        (column theta1_rad), row 4 `feeds` follows `spindle` (column theta2_rad); names of parameters, such \
        as theta5, count rows, columns of the log count joints: row 2 `lift` is column theta1_rad, row 5 \
        `turn` is column theta3_rad";
    assert_eq!(read.warnings, [said]);
    let device = read.device;
    let names: Vec<&str> = device
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["lift", "spindle", "turn"]);
    let drives: Vec<_> = (1..device.links.len())
        .map(|row| device.drive(row).unwrap())
        .collect();
    let told: Vec<_> = drives
        .iter()
        .map(|d| (d.joint, d.multiplier, d.offset))
        .collect();
    // levels follows leans, which follows lift
    let (first, second, third) = ((0, -0.5, 0.2), (0, 1.0, 0.0), (0, -1.5, 0.2 * 3.0));
    assert_eq!(told[..3], [first, second, third]);
    assert_eq!(told[3..], [(1, 0.01, -0.005), (2, 1.0, 0.0)]);
    assert_eq!(drives[3].motion, JointType::Prismatic);
    // what drives a slide turns
    assert_eq!(device.joints[1].joint_type, JointType::Revolute);
    assert_eq!(
        (device.first_row(0), device.first_row(1)),
        (Some(1), Some(4))
    );
}

#[test]
fn a_tip_can_be_chosen() {
    let Some(text) = fixture("arm.urdf") else {
        return;
    };
    let finger = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("left_finger")).unwrap();
    assert_eq!(finger.device.joints.len(), 7);
    let elbow = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("cover")).unwrap();
    assert_eq!(elbow.device.joints.len(), 2);
    let error = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("hand"))
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("arm.urdf: there is no link `hand`; the links are `world`, `base`"));
    let error = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("base"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "arm.urdf: no joint between the root and `base` moves: name another --tip"
    );
}

/// Two arms of one length: the first, and the other is named.
#[test]
fn equal_chains_are_said() {
    let arm = |side: &str| {
        format!(
            r#"<link name="{side}"/><joint name="{side}_joint" type="continuous">
            <parent link="trunk"/><child link="{side}"/></joint>"#
        )
    };
    let text = format!(
        r#"<robot name="two"><link name="trunk"/>{}{}</robot>"#,
        arm("left"),
        arm("right")
    );
    let read = device_from_urdf(&text, "two.urdf", BaseAndTip::default()).unwrap();
    assert_eq!(read.tip, "left");
    assert_eq!(
        read.warnings[0],
        "two.urdf: the chain ends at `left`; chains of the same length end at `right`: choose with --tip"
    );
}

/// The device file of a URDF's device is that device, bit by bit.
#[test]
fn the_device_files_come_back() {
    for name in ["arm.urdf", "linkage.urdf"] {
        let Some(text) = fixture(name) else {
            return;
        };
        let device = device_from_urdf(&text, name, BaseAndTip::default())
            .unwrap()
            .device;
        let written = device.to_new_toml().unwrap();
        let again = haptical_model::Device::from_toml(&written, "again.toml").unwrap();
        assert_eq!(again.warnings, Vec::<String>::new());
        assert_eq!(again.device, device);
        // and with identified values the same way as any other device file
        let mut calibrated = device.clone();
        calibrated.links[2].b_m = 1.5e-3;
        calibrated.links[0].beta_rad = -2e-3;
        let identified = calibrated.to_toml(&written, "device.toml").unwrap();
        let again = haptical_model::Device::from_toml(&identified, "identified.toml")
            .unwrap()
            .device;
        assert_eq!(again.links, calibrated.links);
        assert_eq!(again.nominal_links, Some(device.links));
        assert_eq!(
            (again.origins, again.drives),
            (device.origins, device.drives)
        );
    }
}
