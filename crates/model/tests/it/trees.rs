//! Devices that branch: their files, what moves each hand, and what their joints carry.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Convention, Link, Pose};
use haptical_model::{
    Body, Device, DeviceChain, Drive, Evaluation, Hand, Joint, JointType, ModelError, Origin,
    Recording, RigidBodies, Statics,
};
use proptest::prelude::*;

use crate::support::{CASES, all_parameters};

/// Step of differences; their error is its square times third derivatives.
const STEP: f64 = 1e-5;
/// The largest difference of a derivative that the step leaves.
const SLOPE: f64 = 1e-7;

/// A base, a trunk of one row and two arms of two rows each.
const FIGURE: &str = "\
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.5

[[link]]
a_m = 0.1
alpha_rad = 0.3
d_m = 0.0

[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.2

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0

[[link]]
parent = 1
origin_xyz_m = [0.0, -0.2, 0.0]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
hold = [\"twists\"]

[[joint]]
[[joint]]
[[joint]]
[[joint]]
[[joint]]

[[hand]]
name = \"left\"
row = 3

[[hand]]
name = \"right\"
row = 5
handle_xyz_m = [0.0, 0.0, 0.1]

[tracker]
base = \"unknown\"
tool = \"unknown\"

[[tool]]
id = \"right\"
xyz_m = [0.01, 0.0, 0.0]
";

fn figure() -> Device {
    let loaded = Device::from_toml(FIGURE, "figure.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

#[test]
fn a_file_is_read_and_written() {
    let device = figure();
    assert_eq!(device.parents, [0, 1, 2, 1, 4]);
    assert_eq!(
        [device.path_to(3), device.path_to(5)],
        [[0, 1, 2, 3], [0, 1, 4, 5]]
    );
    assert_eq!(device.hand_index("right"), Some(1));
    assert!(device.has_rows_behind(4) && !device.has_rows_behind(3));
    let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
    assert_eq!(
        again.device,
        Device {
            name: again.device.name.clone(),
            ..device.clone()
        }
    );
    // a calibrated one keeps its branches, and its tools are written
    let mut changed = device.clone();
    changed.links[4].a_m = 0.31;
    let placement = changed.surroundings.tools[0].placement.as_mut().unwrap();
    placement.start.position_m[1] = 0.02;
    let text = changed.to_toml(FIGURE, "figure.toml").unwrap();
    let again = Device::from_toml(&text, "figure.toml").unwrap().device;
    assert_eq!(
        (again.parents, again.hands),
        (changed.parents, changed.hands)
    );
    assert_eq!(again.links[4].a_m, 0.31);
    assert_eq!(again.surroundings.tools, changed.surroundings.tools);
}

/// Refuses a change of the file and gives what is said, with line and column of `place`.
#[track_caller]
fn refused(from: &str, to: &str, place: &str) -> String {
    assert_eq!(FIGURE.matches(from).count(), 1, "{from}");
    let text = FIGURE.replace(from, to);
    let error = Device::from_toml(&text, "figure.toml").unwrap_err();
    let at = error.position().unwrap();
    let offset = text.find(place).unwrap();
    let line = text[..offset].matches('\n').count() + 1;
    assert_eq!(
        (at.file.as_str(), at.line),
        ("figure.toml", line),
        "{error}"
    );
    let column = offset - text[..offset].rfind('\n').map_or(0, |end| end + 1) + 1;
    assert!(at.column >= column, "{error}");
    error.to_string()
}

#[test]
fn what_is_no_tree_is_refused_with_its_place() {
    for parent in ["4", "5", "7", "-1", "0.5"] {
        let said = refused("parent = 1\n", &format!("parent = {parent}\n"), "parent = ");
        let expected = format!(
            "[[link]] 4: `parent` is {parent}, but a row hangs on an earlier one, from 0 to 3"
        );
        assert!(said.contains(&expected), "{said}");
    }
    let said = refused("row = 5\n", "row = 6\n", "row = 6");
    assert!(
        said.contains("[[hand]] 2: `row` is 6, but a row from 1 to 5 is expected"),
        "{said}"
    );
    let said = refused(
        "name = \"right\"",
        "name = \"left\"",
        "name = \"left\"\nrow = 5",
    );
    assert!(
        said.contains("`name` is \"left\" again, but each hand has its own"),
        "{said}"
    );
    let said = refused("name = \"right\"", "name = \" \"", "name = \" \"");
    assert!(said.contains("a word without blanks"), "{said}");
    let said = refused(
        "[[link]]\na_m = 0.0\n",
        "[[link]]\nparent = 0\na_m = 0.0\n",
        "parent = 0",
    );
    assert!(
        said.contains("row 0 is the base, which hangs on nothing"),
        "{said}"
    );
    let head = "[device]\nhandle_xyz_m = [0.0, 0.0, 0.1]\n[[link]]\na_m = 0.0\n";
    let said = refused(
        "[[link]]\na_m = 0.0\n",
        head,
        "handle_xyz_m = [0.0, 0.0, 0.1]\n[[link]]",
    );
    assert!(
        said.contains("a device with [[hand]] has one for each"),
        "{said}"
    );
    // rows that branch and end nowhere
    let alone = FIGURE.replace("[[hand]]", "[[foot]]");
    let said = Device::from_toml(&alone, "figure.toml")
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("has no `hand`: rows branch here: say where each chain ends"),
        "{said}"
    );
    // a sensor file says nothing of hands
    let rig = Device::with_rig(
        FIGURE,
        "figure.toml",
        "[[hand]]\nname = \"left\"\nrow = 3\n",
        "rig.toml",
    );
    assert!(rig.unwrap_err().to_string().contains("rig.toml:1:1"));
}

#[test]
fn a_hand_must_be_chosen() {
    let device = figure();
    let mut evaluation = Evaluation::new(&device);
    assert!(matches!(
        evaluation.move_to(&[0.1; 5]),
        Err(ModelError::NoHand { .. })
    ));
    assert!(evaluation.pose().is_err());
    evaluation.choose_hand(Some(1));
    evaluation.move_pose_to(&[0.1; 5]).unwrap();
    let right = *evaluation.pose().unwrap();
    assert_eq!(
        right,
        DeviceChain::of_hand(&device, 1).pose(&[0.1; 5]).unwrap()
    );
    // a pose of another hand does not stay
    evaluation.choose_hand(Some(0));
    assert!(evaluation.pose().is_err());
    evaluation.choose_hand(None);
    assert!(evaluation.move_pose_to(&[0.1; 5]).is_err());
    let named = |hand: &str| Recording {
        joint: vec![vec![0.0]; 5],
        hand: Some(vec![hand.to_owned()]),
        ..Recording::default()
    };
    assert_eq!(device.hand_at(&named("right"), 0), Some(1));
    assert_eq!(device.hand_at(&named("foot"), 0), None);
    // a tool that a tracker sees goes by its hand's name
    assert_eq!(device.tool_at(&named("right"), 0), "");
    let seen = |hand: &str| Recording {
        position_m: Some([0.1, 0.2, 0.3].map(|part| vec![part])),
        ..named(hand)
    };
    assert_eq!(device.tool_at(&seen("right"), 0), "right");
    let mounts = device.mounts(&seen("right")).unwrap();
    assert_eq!(mounts[0].tool, Some(0));
    // what is seen does not touch
    assert_eq!(device.touching_m(mounts[0]).norm(), 0.0);
    assert_eq!(device.mounts(&seen("left")).unwrap_err().id, "left");
    let unseen = Recording {
        position_m: Some([f64::NAN; 3].map(|part| vec![part])),
        ..named("left")
    };
    assert!(device.mounts(&unseen).unwrap().is_empty());
}

/// A random tree: every row hangs on any row before it, and may follow any joint.
fn tree() -> impl Strategy<Value = (Device, Vec<f64>)> {
    let row = (
        [-0.4..0.4, -3.0..3.0, -0.4..0.4, -3.0..3.0, -0.3..0.3],
        0.0..1.0,
        (0_usize..4, -1.5..1.5, -0.5..0.5, any::<bool>()),
        [-0.2..0.2, -0.2..0.2, -0.2..0.2],
        prop_oneof![Just(0.0), 0.2..3.0],
    );
    let rows = prop::collection::vec(row, 4..9);
    (rows, any::<bool>(), prop::collection::vec(-1.2..1.2, 16)).prop_map(
        |(rows, modified, numbers)| {
            let count = rows.len();
            let convention = if modified {
                Convention::Modified
            } else {
                Convention::Standard
            };
            let mut links = vec![Link {
                d_m: 0.3,
                alpha_rad: 0.2,
                ..Link::default()
            }];
            let (mut parents, mut origins, mut bodies) = (Vec::new(), vec![None], vec![None]);
            let mut drives = Vec::new();
            for (
                index,
                ([a_m, alpha_rad, d_m, theta_rad, beta_rad], share, drive, place, mass_kg),
            ) in rows.into_iter().enumerate()
            {
                links.push(Link {
                    a_m,
                    alpha_rad,
                    d_m,
                    theta_rad,
                    beta_rad,
                    b_m: 0.5 * place[0],
                });
                parents.push(((index + 1) as f64 * share) as usize);
                origins.push((share > 0.4).then_some(Origin {
                    position_m: place,
                    ..Origin::IDENTITY
                }));
                bodies.push((mass_kg > 0.0).then_some(Body {
                    mass_kg,
                    centre_of_mass_m: place,
                    inertia_kgm2: None,
                }));
                let (follows, multiplier, offset, slides) = drive;
                // the first rows have joints of their own, the others follow them
                drives.push(Drive {
                    joint: if index < 4 { index } else { follows },
                    motion: if slides {
                        JointType::Prismatic
                    } else {
                        JointType::Revolute
                    },
                    multiplier,
                    offset,
                });
            }
            origins.push(None);
            // what a reader makes of nothing
            if origins.iter().all(Option::is_none) {
                origins.clear();
            }
            let joints = numbers[..4].iter().map(|home_rad| Joint {
                home_rad: *home_rad,
                ..Joint::default()
            });
            let mut device = Device::new(convention, links, joints.collect());
            let leaves: Vec<usize> = (1..=count).filter(|row| !parents.contains(row)).collect();
            device.hands = leaves
                .into_iter()
                .map(|row| Hand {
                    name: format!("hand{row}"),
                    row,
                    handle: Some(Origin {
                        position_m: [0.1, 0.0, 0.05],
                        ..Origin::IDENTITY
                    }),
                })
                .collect();
            (device.parents, device.origins, device.bodies, device.drives) =
                (parents, origins, bodies, drives);
            if device.parents.iter().copied().eq(0..count) {
                device.parents.clear();
            }
            device.gravity_mps2 = Some([1.0, -2.0, -9.0]);
            device.surroundings.compliance = (0..4)
                .map(|joint| haptical_model::JointCompliance {
                    rad_per_nm: 1e-3 * f64::from(joint),
                    fit: true,
                })
                .collect();
            (device, numbers[4..8].to_vec())
        },
    )
}

fn pose_at(device: &Device, hand: usize, readings: &[f64], torques: &[f64]) -> Pose {
    let mut evaluation = Evaluation::new(device);
    evaluation.choose_hand(Some(hand));
    evaluation.set_torques(torques);
    evaluation.move_to(readings).unwrap();
    *evaluation.pose().unwrap()
}

/// The rotation vector of a small turn between two poses.
fn turned(from: &Pose, to: &Pose) -> Vector3<f64> {
    let turn = to.rotation * from.rotation.transpose();
    let part = |a: usize, b: usize| (turn[(a, b)] - turn[(b, a)]) / 2.0;
    Vector3::new(part(2, 1), part(0, 2), part(1, 0))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    /// Every derivative of every hand, by every parameter, joint and reading; those of other branches are 0.
    #[test]
    fn derivatives_are_those_of_differences((device, readings) in tree()) {
        let torques = [0.4, -0.3, 0.2, 0.5];
        let mut parameters = all_parameters(&device);
        parameters.extend(device.further_parameters());
        for hand in 0..device.hands.len() {
            let path = device.path_to(device.hands[hand].row);
            let mut evaluation = Evaluation::new(&device);
            evaluation.choose_hand(Some(hand));
            evaluation.set_torques(&torques);
            evaluation.move_to(&readings).unwrap();
            for &parameter in &parameters {
                let own = evaluation.pose_derivative(parameter);
                let moved = |step: f64| {
                    let mut other = device.clone();
                    parameter.set(&mut other, parameter.value(&device) + step);
                    pose_at(&other, hand, &readings, &torques)
                };
                let (back, ahead) = (moved(-STEP), moved(STEP));
                let linear = (ahead.position_m - back.position_m) / (2.0 * STEP);
                let angular = turned(&back, &ahead) / (2.0 * STEP);
                prop_assert!((own.linear - linear).amax() < SLOPE, "{parameter:?}: {own:?} for {linear}");
                prop_assert!((own.angular - angular).amax() < SLOPE, "{parameter:?}: {own:?} for {angular}");
                if let haptical_model::ParameterId::Link { row, .. } = parameter && !path.contains(&row) {
                    prop_assert_eq!(own, Default::default());
                }
            }
            for joint in 0..readings.len() {
                let moved = |step: f64| {
                    let mut other = readings.clone();
                    other[joint] += step;
                    pose_at(&device, hand, &other, &torques)
                };
                let (back, ahead) = (moved(-STEP), moved(STEP));
                let linear = (ahead.position_m - back.position_m) / (2.0 * STEP);
                prop_assert!((evaluation.reading_twist(joint).linear - linear).amax() < SLOPE);
            }
        }
    }

    /// A tree's chain to a hand is the serial device of the rows on its path.
    #[test]
    fn a_hand_is_the_serial_device_of_its_path((device, readings) in tree()) {
        for (index, hand) in device.hands.iter().enumerate() {
            let path = device.path_to(hand.row);
            let mut serial = device.clone();
            serial.links = path.iter().map(|row| device.links[*row]).collect();
            serial.origins = path
                .iter()
                .map(|row| device.origins.get(*row).copied().flatten())
                .chain([hand.handle])
                .collect();
            serial.drives = path[1..].iter().map(|row| device.drives[*row - 1]).collect();
            serial.bodies = vec![None; path.len()];
            (serial.parents, serial.hands) = (Vec::new(), Vec::new());
            let mut evaluation = Evaluation::new(&serial);
            evaluation.move_to(&readings).unwrap();
            prop_assert_eq!(*evaluation.pose().unwrap(), pose_at(&device, index, &readings, &[]));
        }
    }

    /// Torques at rest are slopes of the potential energy of all branches, whichever hand is looked at.
    #[test]
    fn joints_carry_all_branches((device, readings) in tree()) {
        let gravity = Vector3::from(device.gravity_mps2.unwrap());
        let energy = |readings: &[f64]| -> f64 {
            let bodies = device.bodies.iter().enumerate().filter_map(|(row, body)| Some((row, (*body)?)));
            bodies.map(|(row, body)| {
                // a hand at the mass's centre: the row's own lengths come after its turn in the standard convention
                let mut other = device.clone();
                other.links[row].d_m -= device.links[row].d_m;
                if device.convention == Convention::Standard {
                    let link = &mut other.links[row];
                    (link.a_m, link.b_m, link.alpha_rad, link.beta_rad) = (0.0, 0.0, 0.0, 0.0);
                }
                other.hands = vec![Hand {
                    name: "centre".to_owned(),
                    row,
                    handle: Some(Origin { position_m: body.centre_of_mass_m, ..Origin::IDENTITY }),
                }];
                -body.mass_kg * gravity.dot(&pose_at(&other, 0, readings, &[]).position_m)
            }).sum()
        };
        let mut statics = Statics::new(&device);
        for hand in 0..device.hands.len() {
            statics.choose_hand(Some(hand));
            let load = statics.load(&readings, |_| None).unwrap();
            for (joint, torque) in load.torques_nm.iter().enumerate() {
                let at = |step: f64| {
                    let mut other = readings.clone();
                    other[joint] += step;
                    energy(&other)
                };
                let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                prop_assert!((torque - slope).abs() < 1e-5, "{torque} for {slope}");
            }
        }
    }

    /// Two forms of torques at rest: moments carried inwards along each chain, and the equations of motion of the rows.
    #[test]
    fn rigid_bodies_at_rest_are_held_as_statics_say((mut device, readings) in tree()) {
        for body in &mut device.bodies {
            let own = body.unwrap_or(Body { mass_kg: 0.0, centre_of_mass_m: [0.0; 3], inertia_kgm2: None });
            *body = Some(Body { inertia_kgm2: Some([0.03, 0.025, 0.04, 0.0, 0.01, 0.0]), ..own });
        }
        let bodies = RigidBodies::of_device(&device).unwrap();
        let (mut work, mut torques) = (bodies.work(), vec![0.0; device.joints.len()]);
        bodies.bias(&readings, &vec![0.0; readings.len()], &mut work, &mut torques).unwrap();
        let mut statics = Statics::new(&device);
        let load = statics.load(&readings, |_| None).unwrap();
        for (torque, expected) in torques.iter().zip(load.torques_nm) {
            prop_assert!((torque - expected).abs() < 1e-9, "{torque} {expected}");
        }
        for hand in 0..device.hands.len() {
            let flange = bodies.flange(hand).unwrap();
            let body = work.pose(flange.body.unwrap()).unwrap();
            let found = haptical_model::rigid::then(body, &flange.pose);
            let expected = DeviceChain::of_hand(&device, hand).pose(&readings).unwrap();
            prop_assert!((found.position_m - expected.position_m).amax() < 1e-12);
            prop_assert!((found.rotation - expected.rotation).amax() < 1e-12);
        }
    }

    #[test]
    fn files_hold_trees((device, _) in tree()) {
        let text = device.to_new_toml().unwrap();
        prop_assert_eq!(Device::from_toml(&text, "").unwrap().device, device);
    }
}
