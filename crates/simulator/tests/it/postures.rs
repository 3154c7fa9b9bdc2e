//! Single postures: touches are met, held angles held, noise has its size, drawn places hold for all rows.

use haptical_simulator::model::kinematics::nalgebra::{
    Quaternion, Rotation3, UnitQuaternion, Vector3,
};
use haptical_simulator::model::{AddedBy, AddedReadings, Device, Recording};
use haptical_simulator::{
    PostureSensors, PostureSimulation, SimulatorError, apply_deviations, true_poses, with_places_of,
};

/// Rounding of a touch \[m\].
const ROUNDING_M: f64 = 1e-10;

fn nominal() -> Device {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/devices/haptic7.toml"
    );
    Device::load(path.as_ref()).expect("a device").device
}

fn truth(nominal: &Device) -> Device {
    let off = [
        ("a3", 2e-3),
        ("theta2", -4e-3),
        ("ratio_deviation1", 0.02),
        ("alpha5", 3e-3),
    ];
    apply_deviations(nominal, &off).expect("a device")
}

/// Postures near home; a name for every second row.
fn asked(device: &Device, rows: usize) -> Recording {
    let reading = |joint: usize, row: usize| {
        0.4 * libm::sin(1.0 + (row * (joint + 2)) as f64 * 0.7 + joint as f64)
    };
    Recording {
        line: (2..2 + rows as u64).collect(),
        joint: (0..device.joints.len())
            .map(|joint| (0..rows).map(|row| reading(joint, row)).collect())
            .collect(),
        ..Recording::default()
    }
}

fn sensors(device: &Device) -> PostureSensors {
    PostureSensors {
        outputs: vec![false; device.joints.len()],
        cables: vec![false; device.cables.len()],
        ..PostureSensors::default()
    }
}

fn names(rows: usize, of: impl Fn(usize) -> &'static str) -> Option<Vec<String>> {
    Some((0..rows).map(|row| of(row).to_owned()).collect())
}

#[test]
fn touches_lie_in_points_and_planes_as_exactly_as_stated() {
    let nominal = nominal();
    let mut truth = truth(&nominal);
    let rows = 60;
    let sd_m = 3e-5;
    truth.surroundings.contact_sd_m = Some(sd_m);
    truth.surroundings.plane_sd_m = Some(sd_m);
    let mut asked = asked(&nominal, rows);
    asked.contact = names(rows, |row| ["left", "right", ""][row % 3]);
    asked.plane = names(rows, |row| ["", "", "table"][row % 3]);
    truth.contact_pairs = Device::from_toml(
        "[[joint]]\n[[contact_pair]]\na = \"left\"\nb = \"right\"\ndistance_m = 0.05\nsd_m = 1e-12\n",
        "pair.toml",
    )
    .unwrap()
    .device
    .contact_pairs;
    let simulation =
        PostureSimulation::new(&truth, &nominal, &asked, sensors(&nominal), 5).unwrap();
    let device = simulation.device();
    let point = |id: &str| {
        let index = device.surroundings.contact_index(id).unwrap();
        Vector3::from(device.surroundings.contacts[index].position_m)
    };
    assert!(((point("left") - point("right")).norm() - 0.05).abs() < 1e-9);
    let plane = &device.surroundings.planes[0];
    let recording = simulation.exact().unwrap();
    let kept = recording.len();
    assert_eq!(kept + simulation.left_out().len(), rows);
    assert!(kept > 40, "{kept}");
    let (mut squares, mut count) = (0.0, 0.0);
    for (row, pose) in true_poses(&truth, &recording).unwrap().iter().enumerate() {
        for (joint, column) in truth.joints.iter().zip(&recording.joint) {
            assert!((joint.lower_rad..=joint.upper_rad).contains(&column[row]));
        }
        let id = recording.contact.as_ref().unwrap()[row].clone();
        if id.is_empty() {
            let gap = Vector3::from(plane.normal).dot(&pose.position_m) - plane.offset_m;
            squares += gap * gap;
            count += 1.0;
        } else {
            squares += (pose.position_m - point(&id)).norm_squared();
            count += 3.0;
        }
    }
    let rms = (squares / count).sqrt();
    // chi-square of more than a hundred numbers
    assert!((0.75..1.25).contains(&(rms / sd_m)), "{rms}");
}

#[test]
fn what_effects_show_moves_the_joints_until_both_together_touch() {
    let nominal = nominal();
    let mut truth = truth(&nominal);
    truth.surroundings.contact_sd_m = Some(1e-12);
    let rows = 8;
    let mut asked = asked(&nominal, rows);
    asked.contact = names(rows, |_| "socket");
    let mut simulation =
        PostureSimulation::new(&truth, &nominal, &asked, sensors(&nominal), 1).unwrap();
    assert!(simulation.left_out().is_empty());
    let shift_m = 1e-3;
    let shown = AddedReadings {
        effect: 0,
        channel: "contact".to_owned(),
        axis: 1,
        by: AddedBy::default(),
        readings: vec![shift_m; rows],
        at: Vec::new(),
        slopes: Vec::new(),
    };
    assert!(simulation.meet(std::slice::from_ref(&shown)).unwrap() > 1e-4);
    assert!(simulation.meet(&[shown]).unwrap() < 1e-12);
    let socket = Vector3::from(simulation.device().surroundings.contacts[0].position_m);
    // the axes of the robot's base: row 0 of this device turns by its alpha
    let row = truth.links[0];
    let base = Rotation3::from_axis_angle(&Vector3::z_axis(), row.theta_rad)
        * Rotation3::from_axis_angle(&Vector3::x_axis(), row.alpha_rad);
    let wanted = socket - base * Vector3::new(0.0, shift_m, 0.0);
    for pose in true_poses(&truth, &simulation.exact().unwrap()).unwrap() {
        assert!(
            (pose.position_m - wanted).norm() < 1e-9,
            "{}",
            pose.position_m - wanted
        );
    }
}

#[test]
fn a_fixture_holds_the_link_where_it_says() {
    let nominal = nominal();
    let mut truth = truth(&nominal);
    truth.surroundings.fixture_sd_rad = Some(1e-15);
    let mut asked = asked(&nominal, 4);
    let held = vec![f64::NAN, 0.2, -0.3, f64::NAN];
    asked.covariates.push(("fixture2_rad".to_owned(), held));
    let simulation =
        PostureSimulation::new(&truth, &nominal, &asked, sensors(&nominal), 1).unwrap();
    let recording = simulation.exact().unwrap();
    for (row, angle) in [(1, 0.2), (2, -0.3)] {
        let reading = recording.joint[1][row];
        let output = reading + truth.joints[1].error_rad(reading).unwrap();
        assert!((output + truth.links[2].theta_rad - angle).abs() < 1e-12);
    }
    // the others stay, and so do rows that nothing holds
    assert_eq!(recording.joint[0], asked.joint[0]);
    assert_eq!(recording.joint[1][0], asked.joint[1][0]);

    asked.contact = names(4, |row| if row == 1 { "socket" } else { "" });
    let refused = PostureSimulation::new(&truth, &nominal, &asked, sensors(&nominal), 1);
    assert_eq!(refused.unwrap_err(), SimulatorError::HeldTouch { row: 1 });
}

#[test]
fn a_tracker_stands_in_one_place_in_each_run_and_noise_is_as_stated() {
    let nominal = nominal();
    let rig = "[[joint]]\n[tracker]\nbase = \"per-run\"\ntool = \"unknown\"\nposition_sd_m = 2e-4\nrotation_sd_rad = 3e-4\n";
    let rig = Device::from_toml(rig, "rig.toml").unwrap().device;
    let truth = with_places_of(&truth(&nominal), &rig);
    let rows = 200;
    let mut asked = asked(&nominal, rows);
    asked.run = Some((0..rows).map(|row| i64::from(row >= 100)).collect());
    let tracked = PostureSensors {
        position: true,
        orientation: true,
        ..sensors(&nominal)
    };
    let simulation = PostureSimulation::new(&truth, &nominal, &asked, tracked, 3).unwrap();
    let exact = simulation.exact().unwrap();
    let mut noisy = exact.clone();
    simulation.disturb(&mut noisy).unwrap();
    let poses = true_poses(&truth, &asked).unwrap();
    let tool = simulation
        .device()
        .surroundings
        .tracker_tool
        .unwrap()
        .pose();
    let bases = &simulation.device().surroundings.run_bases;
    assert_eq!(bases.len(), 2);
    assert_ne!(bases[0].placement, bases[1].placement);
    let at = |recording: &Recording, row: usize| {
        let axes = recording.position_m.as_ref().unwrap();
        let parts = recording.orientation_wxyz.as_ref().unwrap();
        let [w, x, y, z] = parts.each_ref().map(|part| part[row]);
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        (Vector3::new(axes[0][row], axes[1][row], axes[2][row]), turn)
    };
    let (mut lengths, mut turns) = (0.0, 0.0);
    for (row, pose) in poses.iter().enumerate() {
        let base = bases[usize::from(row >= 100)].placement.pose();
        let marker = pose.position_m + pose.rotation * tool.position_m;
        let (position, turn) = at(&exact, row);
        assert!((position - base.position_m - base.rotation * marker).norm() < ROUNDING_M);
        let expected = base.rotation * pose.rotation * tool.rotation;
        assert!((turn.to_rotation_matrix().into_inner() - expected).norm() < ROUNDING_M);
        let (seen, turned) = at(&noisy, row);
        lengths += (seen - position).norm_squared();
        turns += (turned * turn.inverse()).scaled_axis().norm_squared();
    }
    let sd = |sum: f64| (sum / (3 * rows) as f64).sqrt();
    // 600 numbers: a standard deviation within 10 % in all but one of a thousand recordings
    assert!(
        (0.9..1.1).contains(&(sd(lengths) / 2e-4)),
        "{}",
        sd(lengths)
    );
    assert!((0.9..1.1).contains(&(sd(turns) / 3e-4)), "{}", sd(turns));
}

#[test]
fn a_tool_moves_what_is_seen_and_takes_the_cable_away() {
    let nominal = nominal();
    let rig = "[[joint]]\n[tracker]\nposition_sd_m = 1e-5\ntool = \"unknown\"\n[[tool]]\nid = \"near\"\nxyz_m = [0.0, 0.03, 0.0]\n";
    let rig = Device::from_toml(rig, "rig.toml").unwrap().device;
    let truth = with_places_of(&truth(&nominal), &rig);
    let mut asked = asked(&nominal, 6);
    asked.tool = names(6, |row| ["near", "far", ""][row % 3]);
    let seen = PostureSensors {
        cables: vec![true; nominal.cables.len()],
        position: true,
        ..sensors(&nominal)
    };
    let simulation = PostureSimulation::new(&truth, &nominal, &asked, seen, 1).unwrap();
    let recording = simulation.exact().unwrap();
    let poses = true_poses(&truth, &asked).unwrap();
    let axes = recording.position_m.as_ref().unwrap();
    let cable = recording.cable_m[0].as_ref().unwrap();
    let mut ways = Vec::new();
    for (row, pose) in poses.iter().enumerate() {
        let at = Vector3::new(axes[0][row], axes[1][row], axes[2][row]);
        ways.push(pose.rotation.transpose() * (at - pose.position_m));
        assert_eq!(cable[row].is_nan(), row % 3 != 2);
    }
    assert!((ways[0] - Vector3::new(0.0, 0.03, 0.0)).norm() < ROUNDING_M);
    assert!((ways[1] - ways[4]).norm() < ROUNDING_M && ways[1].norm() > 1e-3);
}

#[test]
fn what_is_out_of_reach_is_said() {
    let nominal = nominal();
    let mut asked = asked(&nominal, 3);
    asked.plane = names(3, |row| if row < 2 { "table" } else { "" });
    let refused = PostureSimulation::new(&nominal, &nominal, &asked, sensors(&nominal), 1);
    let id = "table".to_owned();
    assert_eq!(
        refused.unwrap_err(),
        SimulatorError::NoPlane { id, postures: 2 }
    );

    let far = "[[joint]]\n[[contact_point]]\nid = \"moon\"\nposition_m = [9.0, 0.0, 0.0]\n";
    let far = Device::from_toml(far, "far.toml").unwrap().device;
    asked.plane = None;
    asked.contact = names(3, |_| "moon");
    let truth = with_places_of(&nominal, &far);
    let refused = PostureSimulation::new(&truth, &nominal, &asked, sensors(&nominal), 1);
    let what = "contact `moon`".to_owned();
    assert_eq!(
        refused.unwrap_err(),
        SimulatorError::OutOfReach { what, postures: 3 }
    );
}
