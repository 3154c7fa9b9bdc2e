//! New URDFs and MJCFs of devices, read back: URDF by the crate, MJCF by a reader of its own here.

use haptical_model::kinematics::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use haptical_model::kinematics::{Convention, Link, Pose};
use haptical_model::{Device, Joint, JointType};
use haptical_urdf::{BaseAndTip, device_from_mjcf, device_from_urdf, new_mjcf, new_urdf};
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
        let again = device_from_mjcf(&mjcf, "new.xml", BaseAndTip::to("handle")).unwrap().device;
        let mjcf_gap = gap(&pose(&again, readings), &expected);
        prop_assert!(mjcf_gap < ROUNDING, "{mjcf_gap:e}\n{mjcf}");
        for (own, was) in again.joints.iter().zip(&device.joints) {
            prop_assert_eq!(own.joint_type, was.joint_type);
            prop_assert_eq!((own.lower_rad, own.upper_rad), (was.lower_rad, was.upper_rad));
        }
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
    assert_eq!(warnings[0], said);
    assert_eq!(mjcf.matches("polycoef").count(), 2);
    let read_back = device_from_mjcf(&mjcf, "new.xml", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    for readings in [[0.0; 3], [0.4, -0.7, 1.1], [-0.9, 2.0, 0.3]] {
        let values = [readings[0], 0.01 * readings[1], readings[2]];
        let expected = pose(&device, &readings);
        assert!(gap(&pose(&again, &values), &expected) < ROUNDING);
        assert!(gap(&pose(&read_back, &values), &expected) < ROUNDING);
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
    // behind the joint's motion, its zero included
    for (found, expected) in body.centre_of_mass_m.into_iter().zip([0.1, 0.0, 0.02]) {
        assert!((found - expected).abs() < 1e-15, "{body:?}");
    }
}

/// Masses, centres, inertias, gravity and compliances come back from both descriptions.
#[test]
fn what_a_device_weighs_comes_back() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.2\nalpha_rad = 0.5\nd_m = 0.1\ntheta_offset_rad = 0.7\nmass_kg = 2.0\n\
        centre_of_mass_m = [0.1, 0.0, 0.02]\ninertia_kgm2 = [0.03, 0.02, 0.015, 0.001, -0.002, 0.0005]\n\
        [[joint]]\nhome_rad = 0.4\ncompliance_rad_per_nm = 0.002\n[gravity]\nvector_mps2 = [1.0, -9.0, 2.0]\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    // behind the joint's motion, its zero included
    let [xx, yy, zz, xy, xz, yz] = device.bodies[1].unwrap().inertia_kgm2.unwrap();
    let expected = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let (urdf, warnings) = new_urdf(&device).unwrap();
    let [springs, gravity] = warnings.as_slice() else {
        panic!("{warnings:?}");
    };
    assert!(springs.starts_with("joint 1 yields to torque"), "{springs}");
    assert!(
        gravity.starts_with("a URDF has no gravity") && gravity.contains("1 -9 2 m/s^2"),
        "{gravity}"
    );
    assert!(
        urdf.contains(springs.as_str()) && urdf.contains(gravity.as_str()),
        "{urdf}"
    );
    let (mjcf, _) = new_mjcf(&device).unwrap();
    let urdf = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    let mjcf = device_from_mjcf(&mjcf, "new.xml", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    assert_eq!(mjcf.gravity_mps2, device.gravity_mps2);
    assert!((mjcf.compliance_rad_per_nm(0) - 0.002).abs() < 1e-17);
    for again in [urdf, mjcf] {
        let body = again.bodies[1].unwrap();
        assert_eq!(body.mass_kg, 2.0);
        let [xx, yy, zz, xy, xz, yz] = body.inertia_kgm2.unwrap();
        let found = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        assert!((found - expected).amax() < 1e-15, "{body:?}");
    }
}

/// Without a mass a link is a rod of 2 kg/m from joint to joint, and its file says so beside it.
#[test]
fn what_is_made_up_is_marked() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.01\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 0.0\n[[joint]]\n[[joint]]\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    let (text, warnings) = new_mjcf(&device).unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let after = |what: &str| {
        let at = lines.iter().position(|line| *line == what).unwrap();
        lines[at + 1]
    };
    let rod = after("<!-- plausible: mass and inertia -->");
    assert!(
        rod.starts_with("<inertial pos=\"0.25 0 0\" mass=\"1\""),
        "{rod}"
    );
    let light = after("<!-- plausible: mass, which is given as 0, and inertia -->");
    assert!(light.contains("mass=\"0.001\""), "{light}");
    assert!(after("<!-- plausible: gravity, z being up -->").contains("gravity=\"0 0 -9.81\""));
    let said = warnings.join("\n");
    for part in [
        "plausible mass and inertia of link1,",
        "plausible gravity",
        "plausible armature, damping and gains",
    ] {
        assert!(said.contains(part), "{said}");
    }
}

/// A log says of encoders that are ahead that another sensor is late: no simulator is to have it, and each form says so.
#[test]
fn encoders_that_are_ahead_are_in_no_description() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n\
        [[effect]]\nname = \"encoder-latency\"\ndelay_s = -0.014\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    let (mjcf, of_mjcf) = new_mjcf(&device).unwrap();
    let (_, of_urdf) = new_urdf(&device).unwrap();
    assert!(!mjcf.contains("delay="), "{mjcf}");
    for warnings in [of_mjcf, of_urdf] {
        let own = warnings
            .iter()
            .filter(|own| own.contains("encoder-latency"));
        let own: Vec<&String> = own.collect();
        assert!(
            own.len() == 1 && own[0].contains("(the tracker) is late"),
            "{warnings:?}"
        );
    }
}

#[test]
fn effects_are_joints_or_listed() {
    let effects = "[[effect]]\nname = \"capstan-compliance\"\njoint = 1\nstiffness_nm_per_rad = 260.0\n\
        [[effect]]\nname = \"backlash\"\njoint = 2\nwidth_rad = 0.002\n\
        [[effect]]\nname = \"cross-coupling\"\njoint = 2\ngain = 0.02\nfrom_joint = 1\n\
        [[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 0.05\nviscous_nm_s_per_rad = 0.3\n\
        [[effect]]\nname = \"encoder-latency\"\ndelay_s = 0.004\n\
        [[effect]]\nname = \"input-drum-harmonic\"\njoint = 2\namplitude_rad = 0.0004\nphase_rad = 0.3\norder = 2\n\
        [[effect]]\nname = \"a--b\"\nsize_m = 1.0\n";
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n[[joint]]\ntransmission_ratio = 8.0\n";
    let device = Device::from_toml(&format!("{text}{effects}"), "device.toml")
        .unwrap()
        .device;
    let (text, warnings) = new_mjcf(&device).unwrap();
    Document::parse(&text).unwrap();
    for part in [
        "name=\"joint1_cable\" type=\"hinge\" axis=\"0 0 1\" stiffness=\"260\"",
        "name=\"joint2_play\" type=\"hinge\" axis=\"0 0 1\" range=\"-0.001 0.001\"",
        "joint1=\"joint2_coupling\" joint2=\"joint1\" polycoef=\"0 0.02 0 0 0\"",
        "damping=\"0.3\" frictionloss=\"0.05\"",
        "<jointpos name=\"theta2_rad\" joint=\"joint2\" delay=\"0.004\" nsample=\"",
        "<joint joint=\"joint2_play\" coef=\"1\"/>",
        "r[\"theta2_rad\"] -= 0.0004 * np.cos(16 * r[\"theta2_rad\"] - 0.3)",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let said = warnings.join("\n");
    assert!(said.contains("`input-drum-harmonic@2 ("), "{said}");
    assert!(!said.contains("backlash"), "{said}");
    // the spring comes back as the joint's compliance, the play is said, the coupling follows
    let again = device_from_mjcf(&text, "new.xml", BaseAndTip::to("handle")).unwrap();
    assert_eq!(again.device.joints.len(), 2);
    assert_eq!(again.device.compliance_rad_per_nm(0), 1.0 / 260.0);
    assert!(
        again
            .warnings
            .iter()
            .any(|said| said.contains("`joint2_play` moves along"))
    );
}

/// Numbers from a hostile file end in a refusal, not in a file with inf or NaN in it.
#[test]
fn what_leaves_the_number_range_is_refused() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\n\
        mass_kg = 1.0\n[[joint]]\n";
    let mut device = Device::from_toml(text, "device.toml").unwrap().device;
    device.links[1].a_m = 1e140;
    device.bodies[1].as_mut().unwrap().mass_kg = 1e200;
    let error = new_mjcf(&device).unwrap_err().to_string();
    assert!(error.contains("too large to be simulated"), "{error}");
}

#[test]
fn what_cannot_be_written_is_said() {
    let device = Device::from_toml("[[joint]]\n", "bare.toml")
        .unwrap()
        .device;
    let error = new_urdf(&device).unwrap_err().to_string();
    assert!(error.contains("has no [[link]] rows"), "{error}");
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.1\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[joint]]\n[joint.transmission_error]\noffset_rad = 0.1\n";
    let device = Device::from_toml(text, "device.toml").unwrap().device;
    let (_, warnings) = new_mjcf(&device).unwrap();
    assert!(warnings[0].starts_with("a robot description has no transmission errors"));
}

/// What is between two joints of one body, and a rotor whose mass is counted elsewhere, load no joint by a made-up mass.
#[test]
fn rows_that_weigh_nothing_weigh_nothing_in_a_new_mjcf() {
    let text = "<mujoco><worldbody>\
        <body name=\"rotor\"><joint name=\"m\"/><inertial pos=\"0.1 0 0\" mass=\"0\" diaginertia=\"0.05 0.06 0.07\"/>\
        <body name=\"a\" pos=\"0.2 0 0\"><joint name=\"j\" axis=\"1 0 0\" pos=\"0 0.1 0\"/><joint name=\"k\" axis=\"0 0 1\"/>\
        <inertial pos=\"0.1 0 0\" mass=\"1\" diaginertia=\"0.01 0.02 0.025\"/>\
        <body name=\"end\" pos=\"0.3 0 0\"><joint name=\"l\"/><inertial pos=\"0 0 0\" mass=\"0\" diaginertia=\"0 0 0\"/>\
        <site name=\"tip\"/></body></body></body></worldbody></mujoco>";
    let device = device_from_mjcf(text, "two.xml", BaseAndTip::to("tip"))
        .unwrap()
        .device;
    let (text, warnings) = new_mjcf(&device).unwrap();
    let ends = BaseAndTip::to("handle");
    let again = device_from_mjcf(&text, "new.xml", ends).unwrap().device;
    let body = |row: usize| again.bodies[row].unwrap();
    assert!((1e-15..1e-11).contains(&body(1).mass_kg), "{text}");
    assert!((1e-15..1e-11).contains(&body(2).mass_kg), "{text}");
    assert!(
        body(2).inertia_kgm2.unwrap()[..3]
            .iter()
            .all(|own| (1e-15..1e-11).contains(own))
    );
    assert_eq!(body(3).mass_kg, 1.0);
    let mut rotor = body(1).inertia_kgm2.unwrap()[..3].to_vec();
    rotor.sort_by(f64::total_cmp);
    assert!(
        (rotor[0] - 0.05).abs() + (rotor[2] - 0.07).abs() < 1e-12,
        "{rotor:?}"
    );
    // a simulator asks for a mass at the end, which nothing else gives
    assert_eq!(body(4).mass_kg, 1e-3);
    assert_eq!(text.matches("plausible: mass").count(), 1, "{text}");
    let said = warnings.join("\n");
    assert!(
        said.contains("plausible mass, which is given as 0, and inertia of link4"),
        "{said}"
    );
    assert!(!said.contains("link1") && !said.contains("link2"), "{said}");
}
