//! A device file with every key that the format knows: none is refused, none is overlooked.

use haptical_model::kinematics::{Convention, Link};
use haptical_model::transmission::CapstanError;
use haptical_model::{
    Body, Cable, ContactPair, Device, JointType, Tracker, TransmissionError, TransmissionKind,
};

const MAXIMAL: &str = r#"
[device]
name = "everything"
dof = 4
convention = "modified"

[[link]]
a_m = 0.25
alpha_rad = -0.5
d_m = 1
theta_offset_rad = 0.01
beta_rad = 0.02
mass_kg = 0.35
inertia_kgm2 = [0.02, 0.03, 0.04, 0.001, -0.002, 0.003]
centre_of_mass_m = [0.1, 0.2, 0.3]
[[link]]
a_m = 0.1
alpha_rad = 0.1
d_m = 0.1
[[link]]
a_m = 0.2
alpha_rad = 0.2
d_m = 0.2
mass_kg = 0.1
[[link]]
a_m = 0.3
alpha_rad = 0.3
d_m = 0.3
[[link]]
a_m = 0.4
alpha_rad = 0.4
d_m = 0.4

[[joint]]
name = "shoulder"
type = "revolute"
home_rad = -2.5
lower_rad = -1.5
upper_rad = 1.25
sampling_sd_rad = 0.5
transmission = "capstan"
transmission_ratio = 8
drum_distance_m = 0.0675
input_drum_denominator_m = 2.9e-3
encoder_counts_per_rev = 20_000
external_encoder_counts_per_rev = 10000
external_encoder_sd_rad = 1e-4
torque_scale_sd = 0.05
[joint.transmission_error]
offset_rad = 0.001
ratio_deviation = -0.02
output_drum_xy_m = [1e-4, -2e-4]
input_drum_xy_m = [3e-6, -4e-6]
[[joint]]
transmission = "parallelogram"
transmission_ratio = -12.0
drum_distance_m = 0.0975
parallelogram_lengths_m = [0.18, 0.076, 0.18, 0.076]
[joint.transmission_error]
offset_rad = 0.002
length_deviations_m = [-5e-4, -7e-4, 0, 0]
[[joint]]
type = "prismatic"
home_m = 0.1
lower_m = -0.05
upper_m = 0.06
transmission = "direct"
[joint.transmission_error]
offset_m = 0.003
[[joint]]
type = "prismatic"
home_rad = 0.2
lower_rad = -0.07
upper_rad = 0.08
[joint.transmission_error]
range_rad = [-0.5, 0.25]
chebyshev = [0.001, 0.002, 0.003]

[cable_encoder]
drum_radius_m = 0.015
counts_per_rev = 20000
distance_sd_m = 1e-5
exit_axis = [0, 0, 1]
[[cable]]
anchor_m = [0.1, 0.2, 0.3]
drum_radius_m = 0.02
counts_per_rev = 10000
distance_sd_m = 2e-5
[[cable]]
anchor_m = [0.4, 0.5, 0.6]

[tracker]
base = "unknown"
tool = "known"
position_sd_m = 5e-5
rotation_sd_rad = 1e-3
scale_sd = 2e-4

[[contact_pair]]
a = "north"
b = "south"
distance_m = 0.12
sd_m = 2e-6

[gravity]
vector_mps2 = [0, -9.81, 0]

[[nominal.link]]
a_m = 1.0
alpha_rad = 0.0
d_m = 0.0
[[nominal.link]]
a_m = 2.0
alpha_rad = 0.0
d_m = 0.0
[[nominal.link]]
a_m = 3.0
alpha_rad = 0.0
d_m = 0.0
[[nominal.link]]
a_m = 4.0
alpha_rad = 0.0
d_m = 0.0
[[nominal.link]]
a_m = 5.0
alpha_rad = 0.0
d_m = 0.0
"#;

fn maximal() -> Device {
    let loaded = Device::from_toml(MAXIMAL, "everything.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

#[test]
fn head_and_links() {
    let device = maximal();
    assert_eq!(device.name, "everything");
    assert_eq!(device.convention, Convention::Modified);
    let row = Link {
        a_m: 0.25,
        alpha_rad: -0.5,
        d_m: 1.0,
        theta_rad: 0.01,
        beta_rad: 0.02,
        b_m: 0.0,
    };
    assert_eq!(device.links[0], row);
    assert_eq!(device.links.len(), 5);
    assert_eq!(
        (device.links[3].theta_rad, device.links[3].beta_rad),
        (0.0, 0.0)
    );
    let body = |mass_kg, centre_of_mass_m, inertia_kgm2| {
        Some(Body {
            mass_kg,
            centre_of_mass_m,
            inertia_kgm2,
        })
    };
    let inertia = [0.02, 0.03, 0.04, 0.001, -0.002, 0.003];
    let bodies = [
        body(0.35, [0.1, 0.2, 0.3], Some(inertia)),
        None,
        body(0.1, [0.0; 3], None),
        None,
        None,
    ];
    assert_eq!(device.bodies, bodies);
    assert_eq!(device.gravity_mps2, Some([0.0, -9.81, 0.0]));
    let nominal: Vec<f64> = device
        .nominal_links
        .unwrap()
        .iter()
        .map(|row| row.a_m)
        .collect();
    assert_eq!(nominal, [1.0, 2.0, 3.0, 4.0, 5.0]);
}

#[test]
fn joints() {
    let device = maximal();
    let [shoulder, crank, slide, last] = &device.joints[..] else {
        panic!("four joints");
    };
    assert_eq!(shoulder.name, "shoulder");
    assert_eq!(
        (shoulder.joint_type, slide.joint_type),
        (JointType::Revolute, JointType::Prismatic)
    );
    assert_eq!(
        [shoulder.home_rad, shoulder.lower_rad, shoulder.upper_rad],
        [-2.5, -1.5, 1.25]
    );
    assert_eq!(shoulder.sampling_sd_rad, Some(0.5));
    assert_eq!(shoulder.transmission, TransmissionKind::Capstan);
    assert_eq!(
        (shoulder.transmission_ratio, crank.transmission_ratio),
        (8.0, -12.0)
    );
    assert_eq!(shoulder.drum_distance_m, Some(0.0675));
    assert_eq!(shoulder.input_drum_denominator_m, Some(2.9e-3));
    assert_eq!(shoulder.encoder_counts_per_rev, Some(20_000.0));
    assert_eq!(shoulder.external_encoder_counts_per_rev, Some(10_000.0));
    assert_eq!(shoulder.external_encoder_sd_rad, Some(1e-4));
    assert_eq!(
        (shoulder.torque_scale_sd, crank.torque_scale_sd),
        (0.05, 0.03)
    );
    let capstan = CapstanError {
        offset_rad: 0.001,
        ratio_deviation: -0.02,
        output_drum_xy_m: [1e-4, -2e-4],
        input_drum_xy_m: [3e-6, -4e-6],
    };
    assert_eq!(
        shoulder.transmission_error,
        TransmissionError::Capstan(capstan)
    );

    assert_eq!(crank.name, "2", "a joint without a name has its number");
    assert_eq!(crank.transmission, TransmissionKind::Parallelogram);
    assert_eq!(
        crank.parallelogram_lengths_m,
        Some([0.18, 0.076, 0.18, 0.076])
    );
    let cascade = TransmissionError::Parallelogram {
        capstan: CapstanError {
            offset_rad: 0.002,
            ..CapstanError::default()
        },
        length_deviations_m: [-5e-4, -7e-4, 0.0, 0.0],
    };
    assert_eq!(crank.transmission_error, cascade);

    assert_eq!(
        [slide.home_rad, slide.lower_rad, slide.upper_rad],
        [0.1, -0.05, 0.06]
    );
    assert_eq!(
        [last.home_rad, last.lower_rad, last.upper_rad],
        [0.2, -0.07, 0.08]
    );
    assert_eq!(
        (slide.transmission, slide.transmission_ratio),
        (TransmissionKind::Direct, 1.0)
    );
    let offset = CapstanError {
        offset_rad: 0.003,
        ..CapstanError::default()
    };
    assert_eq!(slide.transmission_error, TransmissionError::Capstan(offset));
    let series = TransmissionError::Chebyshev {
        range_rad: [-0.5, 0.25],
        coefficients: vec![0.001, 0.002, 0.003],
    };
    assert_eq!(last.transmission_error, series);
}

#[test]
fn sensors() {
    let device = maximal();
    let cable = |anchor_m, radius, counts, sd, exit_axis| Cable {
        anchor_m,
        drum_radius_m: radius,
        counts_per_rev: counts,
        distance_sd_m: sd,
        exit_axis,
        ..Cable::default()
    };
    let cables = [
        cable(
            [0.0; 3],
            Some(0.015),
            Some(2e4),
            Some(1e-5),
            Some([0.0, 0.0, 1.0]),
        ),
        cable([0.1, 0.2, 0.3], Some(0.02), Some(1e4), Some(2e-5), None),
        cable([0.4, 0.5, 0.6], None, None, None, None),
    ];
    assert_eq!(device.cables, cables);
    let tracker = Tracker {
        base_known: false,
        base_per_run: false,
        tool_known: true,
        position_sd_m: Some(5e-5),
        rotation_sd_rad: Some(1e-3),
        scale_sd: Some(2e-4),
    };
    assert_eq!(device.tracker, Some(tracker));
    let pair = ContactPair {
        a: "north".to_owned(),
        b: "south".to_owned(),
        distance_m: 0.12,
        sd_m: 2e-6,
    };
    assert_eq!(device.contact_pairs, [pair]);
}

#[test]
fn a_device_without_links_has_transmissions_only() {
    let text = "[[joint]]\ntransmission = \"direct\"\n[[joint]]\n";
    let device = Device::from_toml(text, "bench.toml").unwrap().device;
    assert!(!device.has_links());
    assert_eq!(device.name, "bench.toml");
    assert_eq!(device.joints.len(), 2);
    assert_eq!(device.joints[1].lower_rad, f64::NEG_INFINITY);
    assert!(device.cables.is_empty() && device.tracker.is_none());
}

#[test]
fn what_a_drive_weighs_and_gives_is_read_in_its_unit() {
    let text = "[[joint]]\narmature_kgm2 = 0.25\ntorque_limit_nm = 40.0\n\
        [[joint]]\ntype = \"prismatic\"\narmature_kg = 3.0\ntorque_limit_n = 200.0\n\
        [[joint]]\ntype = \"prismatic\"\narmature_kgm2 = 2.0\n";
    let loaded = Device::from_toml(text, "drives.toml").unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let own = |joint: usize| {
        let joint = &loaded.device.joints[joint];
        (joint.armature_kgm2, joint.torque_limit_nm)
    };
    assert_eq!(own(0), (Some(0.25), Some(40.0)));
    assert_eq!(own(1), (Some(3.0), Some(200.0)));
    assert_eq!(own(2), (Some(2.0), None));
    let written = loaded.device.to_new_toml().unwrap();
    assert!(written.contains("armature_kg = 3.0"), "{written}");
    let refused = |text: &str| {
        Device::from_toml(text, "drives.toml")
            .unwrap_err()
            .to_string()
    };
    assert!(refused("[[joint]]\narmature_kgm2 = -0.1\n").contains("an inertia is not negative"));
    assert!(refused("[[joint]]\ntorque_limit_nm = 0.0\n").contains("torque_limit_nm"));
}
