//! The surroundings of a chain: read, named, set, written and read again.

use haptical_model::kinematics::nalgebra::{Rotation3, Vector3};
use haptical_model::kinematics::{Chain, Convention, Pose};
use haptical_model::{
    Cable, Device, DeviceChain, DeviceFileError, Evaluation, Origin, ParameterId, Placement,
    Recording, Statics, SurroundingParameter, holding_torques_nm,
};
use proptest::prelude::*;

/// Two joints, two cables, and every section of a rig.
const FILE: &str = r#"
[device]
name = "rig" # a comment that stays
[[link]]
a_m = 0.1
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.3
alpha_rad = -0.4
d_m = 0.1
mass_kg = 2.0
centre_of_mass_m = [0.1, 0.02, 0.03]
[[link]]
a_m = 0.25
alpha_rad = 0.2
d_m = 0.05
mass_kg = 1.0
centre_of_mass_m = [0.05, 0.0, 0.01]
[[joint]]
compliance_rad_per_nm = 2e-4
fit = ["compliance"]
[[joint]]
[cable_encoder]
distance_sd_m = 1e-5
fit = ["zero"]
[[cable]]
anchor_m = [1.0, 0.5, 0.2] # measured by hand
exit_axis = [0.0, -1.0, 0.0]
zero_m = 0.002
scale = 1.01
exit_radius_m = 0.01
fit = ["anchor", "scale", "exit_radius"]
[tracker]
base = "unknown"
tool = "unknown"
base_xyz_m = [1.0, 2.0, 3.0]
base_wxyz = [0.6, 0.0, 0.8, 0.0]
[contact]
sd_m = 2e-4
[[contact_point]]
id = "a \"quoted\" id"
position_m = [0.1, 0.2, 0.3]
[[contact_pair]]
a = "left"
b = "right"
distance_m = 0.05
sd_m = 1e-4
[plane]
sd_m = 1e-4
[[touched_plane]]
id = "table"
normal = [0.0, 0.0, 1.0]
offset_m = 0.4
[[plane_pair]]
a = "table"
b = "wall"
sd_rad = 1e-3
[fixture]
sd_rad = 1e-3
[gravity]
vector_mps2 = [0.0, 0.0, -9.81]
"#;

fn load(text: &str) -> Device {
    let loaded = Device::from_toml(text, "rig.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

#[test]
fn every_section_is_read() {
    let device = load(FILE);
    let surroundings = &device.surroundings;
    let base = surroundings.tracker_base.unwrap();
    assert_eq!(base.start.position_m, [1.0, 2.0, 3.0]);
    // an unknown tool without a place has none until it is prepared
    assert_eq!(surroundings.tracker_tool, None);
    assert_eq!(surroundings.contact_sd_m, Some(2e-4));
    assert_eq!(surroundings.contacts[0].id, "a \"quoted\" id");
    assert_eq!(surroundings.planes[0].offset_m, 0.4);
    assert_eq!(
        surroundings.plane_pairs[0].angle_rad,
        std::f64::consts::FRAC_PI_2
    );
    assert_eq!(surroundings.fixture_sd_rad, Some(1e-3));
    assert_eq!(device.compliance_rad_per_nm(0), 2e-4);
    assert_eq!(device.compliance_rad_per_nm(1), 0.0);
    assert!(device.cables[0].fit.zero && !device.cables[0].fit.anchor);
    assert!(!device.cables[0].is_plain() && !device.is_plain_table());
}

#[test]
fn names_are_told_apart_and_lead_to_their_numbers() {
    let mut device = load(FILE);
    let parameters = device.further_parameters();
    // base 6, point 3, plane 3, first cable 1, second 3 + 1 + 1, compliance 1
    assert_eq!(parameters.len(), 6 + 3 + 3 + 1 + 5 + 1);
    let mut names: Vec<String> = parameters.iter().map(|id| id.name(&device)).collect();
    for name in [
        "tracker_base_rx",
        "plane.table.offset",
        "cable_zero",
        "cable2_anchor_x",
        "joint_compliance1",
    ] {
        assert!(
            names.contains(&name.to_owned()),
            "{name} is none of {names:?}"
        );
    }
    for (number, parameter) in parameters.iter().enumerate() {
        let name = parameter.name(&device);
        assert_eq!(device.parameter(&name).unwrap(), *parameter);
        let value = 0.01 * (number + 1) as f64;
        parameter.set(&mut device, value);
        assert_eq!(parameter.value(&device), value, "{name}");
        assert!(parameter.plausible_size(&device) > 0.0 && !parameter.unit(&device).is_empty());
        assert!(!parameter.key(&device).is_empty());
    }
    names.sort();
    names.dedup();
    assert_eq!(names.len(), parameters.len());
    // a parameter of another device has no value here, and setting it does nothing
    let foreign = ParameterId::Surrounding(SurroundingParameter::Contact { point: 9, axis: 0 });
    let before = device.clone();
    foreign.set(&mut device, 1.0);
    assert!(foreign.value(&device).is_nan() && device == before);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Calibrated numbers are written, the file's comments stay, and what is read again is the same transform;
    /// once more written it is the same bits.
    #[test]
    fn calibrated_numbers_survive(values in prop::collection::vec(-0.4..0.4_f64, 19)) {
        let mut device = load(FILE);
        for (parameter, value) in device.further_parameters().into_iter().zip(values) {
            let positive = matches!(parameter, ParameterId::Surrounding(
                SurroundingParameter::CableScale { .. } | SurroundingParameter::CableExitRadius { .. }));
            parameter.set(&mut device, if positive { value.abs() + 0.1 } else { value });
        }
        let text = device.to_toml(FILE, "rig.toml").unwrap();
        prop_assert!(text.contains("# a comment that stays") && text.contains("# measured by hand"));
        let read = load(&text);
        prop_assert_eq!(&read.cables, &device.cables);
        prop_assert_eq!(&read.surroundings, &device.surroundings.settled());
        let (have, want) = (read.surroundings.tracker_base.unwrap().pose(),
            device.surroundings.tracker_base.unwrap().pose());
        prop_assert!((have.rotation - want.rotation).norm() < 1e-14);
        prop_assert_eq!(have.position_m, want.position_m);
        let normal = |device: &Device| device.surroundings.planes[0].normal_and_slopes().0;
        prop_assert!((normal(&read) - normal(&device)).norm() < 1e-15);
        prop_assert_eq!(read.to_toml(&text, "rig.toml").unwrap(), text);

        let whole = device.to_new_toml().unwrap();
        let again = Device::from_toml(&whole, "whole.toml").unwrap().device;
        prop_assert_eq!(&again.surroundings, &device.surroundings.settled());
        prop_assert_eq!(&again.cables, &device.cables);
    }

    /// The columns of the turn's axes are what the orientation turns by.
    #[test]
    fn turns_have_their_axes(turn in prop::array::uniform3(-1.5..1.5_f64), small: bool) {
        let factor = if small { 1e-5 } else { 1.0 };
        let turn_rad = turn.map(|part| factor * part);
        let start = Origin::from_pose(&Pose {
            rotation: Rotation3::new(Vector3::new(0.3, -1.0, 0.4)).into_inner(),
            ..Pose::default()
        });
        let step = 1e-6;
        let placement = Placement { start, turn_rad };
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut placement = placement;
                placement.turn_rad[axis] += by;
                placement.pose().rotation
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step) * placement.pose().rotation.transpose();
            let found = Vector3::new(slope[(2, 1)], slope[(0, 2)], slope[(1, 0)]);
            prop_assert!((found - placement.turn_axes().column(axis)).norm() < 1e-8);
        }
    }

    /// A cable over its guide: derivatives by differences, and the straight distance where there is no guide.
    #[test]
    fn cables_have_their_derivatives(
        position in prop::array::uniform3(-0.5..0.5_f64),
        radius in 0.0..0.02_f64,
        scale in 0.9..1.1_f64,
    ) {
        let mut cable = Cable {
            anchor_m: [0.7, -0.6, 0.8],
            exit_axis: Some([-1.0, 0.5, -0.6]),
            zero_m: 0.01,
            scale,
            exit_radius_m: radius,
            ..Cable::default()
        };
        cable.fit.exit_radius = true;
        let at = Vector3::from(position);
        let read = cable.reading(&at).unwrap();
        let step = 1e-6;
        for axis in 0..3 {
            let moved = |by: f64| cable.reading(&(at + Vector3::ith(axis, by))).unwrap().reading_m;
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            prop_assert!((slope - read.by_position[axis]).abs() < 1e-8);
        }
        let wider = |by: f64| Cable { exit_radius_m: radius + by, ..cable }.reading(&at).unwrap().reading_m;
        let slope = (wider(step) - wider(-step)) / (2.0 * step);
        prop_assert!((slope - read.by_exit_radius).abs() < 1e-7, "{} for {}", read.by_exit_radius, slope);
        let distance = (at - Vector3::from(cable.anchor_m)).norm();
        prop_assert!(read.length_m >= distance - 1e-15);
        cable.exit_radius_m = 0.0;
        prop_assert!((cable.reading(&at).unwrap().length_m - distance).abs() < 1e-14);
    }

    /// Holding torques are the slopes of the potential energy, whichever convention the rows have.
    #[test]
    fn holding_torques_are_the_slopes_of_the_energy(
        angles in prop::array::uniform2(-1.5..1.5_f64), modified: bool, push in -5.0..5.0_f64,
    ) {
        let mut device = load(FILE);
        device.surroundings.compliance.clear();
        if modified {
            device.convention = Convention::Modified;
        }
        let energy = |angles: [f64; 2]| {
            let chain = DeviceChain::new(&device);
            let mut sum = 0.0;
            for row in 1..3 {
                let body = device.bodies[row].unwrap();
                let before = chain.part(row).unwrap().pose(&angles[..row - 1]).unwrap();
                let mut own = chain.links[row];
                own.theta_rad += angles[row - 1];
                let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), own.theta_rad);
                let centre = turn * Vector3::from(body.centre_of_mass_m);
                let centre = if modified {
                    let twist = Rotation3::from_axis_angle(&Vector3::x_axis(), own.alpha_rad);
                    Vector3::new(own.a_m, 0.0, 0.0) + twist * centre
                } else {
                    centre
                };
                let place = before.position_m + before.rotation * centre;
                sum += 9.81 * body.mass_kg * place.z;
            }
            sum
        };
        let mut recording = Recording {
            line: vec![2],
            joint: angles.iter().map(|angle| vec![*angle]).collect(),
            ..Recording::default()
        };
        let torques = holding_torques_nm(&device, &recording).unwrap().unwrap();
        let step = 1e-5;
        for joint in 0..2 {
            let moved = |by: f64| {
                let mut angles = angles;
                angles[joint] += by;
                energy(angles)
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            prop_assert!((torques[joint][0] - slope).abs() < 1e-7, "{} for {slope}", torques[joint][0]);
        }
        // the base bears what the first drive holds, about that drive's own axis
        if !modified {
            let mut statics = Statics::new(&device);
            let load = statics.load(&angles, |_| None).unwrap();
            let axis = DeviceChain::new(&device).part(1).unwrap().pose(&[]).unwrap();
            let about = load.base_moment_nm.dot(&axis.rotation.column(2));
            prop_assert!((about + torques[0][0]).abs() < 1e-12, "{about}");
        }
        // the hand pushes the handle along its own x: the drive pushes back
        recording.force_n = Some([vec![push], vec![0.0], vec![0.0]]);
        let pushed = holding_torques_nm(&device, &recording).unwrap().unwrap();
        let mut evaluation = Evaluation::new(&device);
        evaluation.move_to(&angles).unwrap();
        let force = evaluation.pose().unwrap().rotation * Vector3::new(push, 0.0, 0.0);
        for joint in 0..2 {
            let back = -force.dot(&evaluation.joint_twist(joint).linear);
            prop_assert!((pushed[joint][0] - torques[joint][0] - back).abs() < 1e-12);
        }
    }
}

#[test]
fn a_yielding_joint_lags_its_encoder() {
    let mut device = load(FILE);
    device.surroundings.compliance[0].rad_per_nm = 1e-3;
    let mut evaluation = Evaluation::new(&device);
    evaluation.set_torques(&[5.0, f64::NAN]);
    evaluation.move_to(&[0.3, 0.2]).unwrap();
    let rigid = DeviceChain::new(&device).pose(&[0.3 - 5e-3, 0.2]).unwrap();
    assert!((evaluation.pose().unwrap().position_m - rigid.position_m).norm() < 1e-15);
    // the encoder in front of the spring does not see it
    assert_eq!(evaluation.output_rad(0), 0.3);
    let slope = evaluation.pose_derivative(ParameterId::Compliance { joint: 0 });
    assert!((slope.linear + evaluation.joint_twist(0).linear * 5.0).norm() < 1e-15);
    let base = evaluation.base_pose().unwrap();
    let chain = DeviceChain::new(&device);
    let links = &chain.links[..1];
    let motions = &chain.motions()[..1];
    let same = Chain::new(device.convention, links, motions)
        .unwrap()
        .pose(&[])
        .unwrap();
    assert_eq!(base, same);
}

/// 2 kg at 0.3 m on a spring: at rest where the spring bears the weight there, found by halving.
#[test]
fn a_soft_joint_is_held_where_it_has_yielded_to() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
        [[joint]]\ncompliance_rad_per_nm = 0.02\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
    let lever = Device::from_toml(text, "lever.toml").unwrap().device;
    assert_eq!(lever.compliance_rad_per_nm(0), 0.02);
    for reading in [-1.2, 0.4, 1.1_f64] {
        let (mut low, mut high) = (reading - 1.0, reading + 1.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if middle + 0.02 * 6.0 * middle.cos() < reading {
                low = middle;
            } else {
                high = middle;
            }
        }
        let recording = Recording {
            joint: vec![vec![reading]],
            ..Recording::default()
        };
        let torque = holding_torques_nm(&lever, &recording).unwrap().unwrap()[0][0];
        assert!((torque - 6.0 * low.cos()).abs() < 1e-10, "{torque}");
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let refuse = |from: &str, to: &str| {
        assert!(FILE.contains(from), "{from}");
        Device::from_toml(&FILE.replacen(from, to, 1), "rig.toml").unwrap_err()
    };
    for (from, to, words) in [
        ("fit = [\"zero\"]", "fit = [\"zreo\"]", "exit_radius"),
        (
            "fit = [\"compliance\"]",
            "fit = \"compliance\"",
            "a list of texts",
        ),
        (
            "fit = [\"compliance\"]",
            "fit = [\"stiffness\"]",
            "compliance",
        ),
        (
            "exit_radius_m = 0.01",
            "exit_radius_m = -0.01",
            "not negative",
        ),
        ("scale = 1.01", "scale = 0.0", "above zero"),
        (
            "base_wxyz = [0.6, 0.0, 0.8, 0.0]",
            "base_wxyz = [1.0, 1.0, 0.0, 0.0]",
            "unit quaternion",
        ),
        (
            "normal = [0.0, 0.0, 1.0]",
            "normal = [0.0, 0.0, 2.0]",
            "unit vector",
        ),
        (
            "sd_rad = 1e-3\n[fixture]",
            "angle_rad = 3.0\nsd_rad = 1e-3\n[fixture]",
            "right angle",
        ),
        (
            "position_m = [0.1, 0.2, 0.3]",
            "position_m = [0.1, 0.2]",
            "3 numbers",
        ),
        (
            "[[contact_pair]]",
            "[[contact_point]]\nid = \"a \\\"quoted\\\" id\"\nposition_m = [0.0, 0.0, 0.0]\n[[contact_pair]]",
            "once",
        ),
    ] {
        let refused = refuse(from, to);
        assert!(
            matches!(refused, DeviceFileError::Value { .. }),
            "{refused}"
        );
        assert!(refused.to_string().contains(words), "{refused}");
        assert!(refused.position().is_some());
    }
}
