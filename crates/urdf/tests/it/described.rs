//! New URDFs and MJCFs of devices, read back: URDF by the crate, MJCF by a reader of its own here.

use haptical_model::kinematics::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use haptical_model::kinematics::{Convention, Link, Pose};
use haptical_model::{Device, Joint, JointType};
use haptical_urdf::{BaseAndTip, device_from_urdf, new_mjcf, new_urdf};
use proptest::prelude::*;
use roxmltree::{Document, Node};

use crate::support::{ROUNDING, fixture, gap, pose};

/// A device file with one joint, whose parts are then replaced.
fn joint() -> Joint {
    let text = "[[joint]]\ntype = \"revolute\"\nlower_rad = -1.0\nupper_rad = 1.5\n";
    Device::from_toml(text, "joint.toml").unwrap().device.joints[0].clone()
}

fn device(convention: Convention, links: Vec<Link>, joints: Vec<Joint>) -> Device {
    let mut text = String::from("[device]\nname = \"a & <b>\"\n");
    for _ in &links {
        text.push_str("[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n");
    }
    for _ in &joints {
        text.push_str("[[joint]]\n");
    }
    let mut device = Device::from_toml(&text, "device.toml").unwrap().device;
    (device.convention, device.links, device.joints) = (convention, links, joints);
    device
}

fn any_device() -> impl Strategy<Value = Device> {
    let number = || -0.5..0.5_f64;
    let angle = || -3.0..3.0_f64;
    let link = (number(), angle(), number(), angle(), number(), number());
    let link = link.prop_map(|(a_m, alpha_rad, d_m, theta_rad, beta_rad, b_m)| Link {
        a_m,
        alpha_rad,
        d_m,
        theta_rad,
        beta_rad,
        b_m,
    });
    let joint = (any::<bool>(), number(), any::<bool>()).prop_map(|(slides, home_rad, limited)| {
        let mut own = joint();
        if slides {
            own.joint_type = JointType::Prismatic;
        }
        if !limited {
            (own.lower_rad, own.upper_rad) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        Joint { home_rad, ..own }
    });
    (1..6_usize).prop_flat_map(move |joints| {
        let links = prop::collection::vec(link.clone(), joints + 1);
        let joints = prop::collection::vec(joint.clone(), joints);
        (any::<bool>(), links, joints).prop_map(|(modified, links, mut joints)| {
            for (index, joint) in joints.iter_mut().enumerate() {
                joint.name = (index + 1).to_string();
            }
            let convention = if modified {
                Convention::Modified
            } else {
                Convention::Standard
            };
            device(convention, links, joints)
        })
    })
}

fn numbers<const N: usize>(node: Node<'_, '_>, key: &str) -> [f64; N] {
    let text = node.attribute(key).unwrap();
    let numbers: Vec<f64> = text.split(' ').map(|word| word.parse().unwrap()).collect();
    numbers.try_into().unwrap()
}

fn step(at: &Pose, node: Node<'_, '_>) -> Pose {
    let [w, x, y, z] = numbers(node, "quat");
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Pose {
        position_m: at.position_m + at.rotation * Vector3::from(numbers::<3>(node, "pos")),
        rotation: at.rotation * turn.to_rotation_matrix().into_inner(),
    }
}

/// MuJoCo's rule for a tree of bodies: body frame in its parent, then the joint's motion.
fn handle_of_mjcf(text: &str, value: impl Fn(&str) -> f64) -> Pose {
    let document = Document::parse(text).unwrap();
    let find = |node: Node<'_, '_>, tag: &str| {
        node.children()
            .find(|child| child.has_tag_name(tag))
            .map(|child| child.id())
    };
    let mut at = Pose::default();
    let mut node = document
        .descendants()
        .find(|node| node.has_tag_name("worldbody"))
        .unwrap();
    while let Some(body) = find(node, "body") {
        node = document.get_node(body).unwrap();
        at = step(&at, node);
        let joint = document.get_node(find(node, "joint").unwrap()).unwrap();
        let own = value(joint.attribute("name").unwrap());
        let axis = Vector3::from(numbers::<3>(joint, "axis"));
        if joint.attribute("type") == Some("slide") {
            at.position_m += at.rotation * axis * own;
        } else {
            let turn = UnitQuaternion::from_scaled_axis(axis * own);
            at.rotation *= turn.to_rotation_matrix().into_inner();
        }
    }
    step(&at, document.get_node(find(node, "site").unwrap()).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn devices_come_back(device in any_device(), readings in prop::array::uniform5(-1.0..1.0_f64)) {
        let readings = &readings[..device.joints.len()];
        let expected = pose(&device, readings);

        let (urdf, warnings) = new_urdf(&device).unwrap();
        prop_assert!(warnings.is_empty());
        let again = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle")).unwrap().device;
        prop_assert_eq!(&again.name, &device.name);
        let urdf_gap = gap(&pose(&again, readings), &expected);
        prop_assert!(urdf_gap < ROUNDING, "{urdf_gap:e}\n{urdf}");
        for (own, was) in again.joints.iter().zip(&device.joints) {
            prop_assert_eq!(own.joint_type, was.joint_type);
            if was.lower_rad.is_finite() {
                prop_assert_eq!((own.lower_rad, own.upper_rad), (was.lower_rad, was.upper_rad));
            }
        }

        let (mjcf, _) = new_mjcf(&device).unwrap();
        let value = |name: &str| readings[name.trim_start_matches("joint").parse::<usize>().unwrap() - 1];
        let mjcf_gap = gap(&handle_of_mjcf(&mjcf, value), &expected);
        prop_assert!(mjcf_gap < ROUNDING, "{mjcf_gap:e}\n{mjcf}");
    }
}

/// Rows that follow stay tied: the new URDF of the linkage moves as the linkage.
#[test]
fn rows_that_follow_are_written_as_such() {
    let Some(text) = fixture("linkage.urdf") else {
        return;
    };
    let device = device_from_urdf(&text, "linkage.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    let (urdf, warnings) = new_urdf(&device).unwrap();
    let again = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    // it drives a slide alone, so its value is the slide's
    let said = "joint `spindle` drives other rows and has none of its own: its value in m is 0.01 times the \
         reading in rad";
    assert_eq!(warnings, [said]);
    let (mjcf, warnings) = new_mjcf(&device).unwrap();
    assert_eq!(warnings, [said]);
    assert_eq!(mjcf.matches("polycoef").count(), 2);
    for readings in [[0.0; 3], [0.4, -0.7, 1.1], [-0.9, 2.0, 0.3]] {
        let values = [readings[0], 0.01 * readings[1], readings[2]];
        let expected = pose(&device, &readings);
        assert!(gap(&pose(&again, &values), &expected) < ROUNDING);
        let value = |name: &str| {
            // the second row is the lift itself
            let row = match name {
                "lift" => 2,
                "spindle" => 4,
                "turn" => 5,
                other => other.trim_start_matches("row").parse().unwrap(),
            };
            let drive = device.drive(row).unwrap();
            drive.multiplier * readings[drive.joint]
        };
        assert!(gap(&handle_of_mjcf(&mjcf, value), &expected) < ROUNDING);
    }
}

/// Home and the drive's offset are in the origins: a description is fed with a log's columns as they are.
#[test]
fn a_reading_is_the_joint_s_value() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.1\nd_m = 0.0\n\
        [[link]]\na_m = 0.2\nalpha_rad = 0.5\nd_m = 0.1\n\
        [[link]]\na_m = 0.1\nalpha_rad = -1.2\nd_m = 0.0\ntheta_offset_rad = 0.3\n\
        [[joint]]\nname = \"turn\"\nhome_rad = 0.4\nlower_rad = -1.0\nupper_rad = 2.0\n\
        [[joint]]\nname = \"slide\"\ntype = \"prismatic\"\nhome_m = 0.15\nlower_m = -0.12\nupper_m = 0.12\n";
    let mut device = Device::from_toml(text, "device.toml").unwrap().device;
    let drive = |joint, motion, multiplier, offset| haptical_model::Drive {
        joint,
        motion,
        multiplier,
        offset,
    };
    for driven in [false, true] {
        if driven {
            let turn = drive(0, JointType::Revolute, 1.0, -0.7);
            device.drives = vec![turn, drive(1, JointType::Prismatic, 1.0, 0.02)];
        }
        let (urdf, warnings) = new_urdf(&device).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        assert!(
            urdf.contains("<limit lower=\"-0.12\" upper=\"0.12\""),
            "{urdf}"
        );
        let again = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle"))
            .unwrap()
            .device;
        let (mjcf, _) = new_mjcf(&device).unwrap();
        assert!(mjcf.contains("name=\"turn\" type=\"hinge\" axis=\"0 0 1\" range=\"-1 2\""));
        for readings in [[0.0, 0.0], [0.9, -0.1], [-0.3, 0.07]] {
            let expected = pose(&device, &readings);
            assert!(gap(&pose(&again, &readings), &expected) < ROUNDING);
            let value = |name: &str| readings[usize::from(name == "slide")];
            assert!(gap(&handle_of_mjcf(&mjcf, value), &expected) < ROUNDING);
        }
    }
}

#[test]
fn masses_stand_where_the_device_has_them() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.2\nalpha_rad = 0.5\nd_m = 0.1\ntheta_offset_rad = 1.5707963267948966\n\
        mass_kg = 2.0\ncentre_of_mass_m = [0.1, 0.0, 0.02]\n[[joint]]\nhome_rad = 0.4\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    let (urdf, _) = new_urdf(&device).unwrap();
    let again = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    let body = again.bodies[1].unwrap();
    assert_eq!(body.mass_kg, 2.0);
    // behind the joint's motion, before the offset of a quarter turn
    for (found, expected) in body.centre_of_mass_m.into_iter().zip([0.0, 0.1, 0.02]) {
        assert!((found - expected).abs() < 1e-15, "{body:?}");
    }
}

#[test]
fn what_cannot_be_written_is_said() {
    let device = Device::from_toml("[[joint]]\n", "bare.toml")
        .unwrap()
        .device;
    let error = new_urdf(&device).unwrap_err().to_string();
    assert!(error.contains("it has no [[link]] rows"), "{error}");
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.1\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[joint]]\n[joint.transmission_error]\noffset_rad = 0.1\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    let (_, warnings) = new_mjcf(&device).unwrap();
    assert!(warnings[0].starts_with("a robot description has no transmission errors"));
}
