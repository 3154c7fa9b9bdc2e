//! A written file is read again with the same bits, and keeps the file's comments.

use haptical_model::kinematics::Parameter;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, DeviceFileError, JointType, ParameterId, TransmissionError};
use proptest::prelude::*;

use haptical_testkit::HAPTIC7;

use crate::support::{CASES, all_parameters, device_and_readings, nominal_text};

fn load(text: &str) -> Device {
    Device::from_toml(text, "device.toml").unwrap().device
}

fn bits(device: &Device) -> Vec<u64> {
    all_parameters(device)
        .iter()
        .map(|id| id.value(device).to_bits())
        .collect()
}

fn comments(text: &str) -> Vec<&str> {
    text.match_indices('#')
        .map(|(at, _)| text[at..].lines().next().unwrap_or("").trim_end())
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn every_parameter_survives_and_comments_stay((calibrated, _) in device_and_readings()) {
        let mut nominal = calibrated.clone();
        for joint in &mut nominal.joints {
            joint.transmission_error = TransmissionError::default();
        }
        for (row, link) in nominal.links.iter_mut().enumerate() {
            for parameter in Parameter::ALL {
                link.set(parameter, 0.125 * (row + 1) as f64);
            }
            (link.beta_rad, link.b_m) = (0.0, 0.0);
        }
        let original = nominal_text(&nominal);
        prop_assert_eq!(&load(&original).links, &nominal.links);

        let once = calibrated.to_toml(&original, "device.toml").unwrap();
        let read = load(&once);
        prop_assert_eq!(bits(&read), bits(&calibrated));
        prop_assert_eq!(&read.joints.iter().map(|j| &j.transmission_error).collect::<Vec<_>>(),
            &calibrated.joints.iter().map(|j| &j.transmission_error).collect::<Vec<_>>());
        prop_assert_eq!(read.nominal_links.as_ref(), Some(&nominal.links));
        prop_assert_eq!(comments(&once), comments(&original));
        prop_assert!(once.contains("inventory = 12") && once.contains("not_ours = 0"));

        // a second calibration: the first values stay the nominal ones
        let mut second = read.clone();
        for id in all_parameters(&second) {
            let value = id.value(&second);
            id.set(&mut second, value * (1.0 + 1e-3) + 1e-9);
        }
        let twice = second.to_toml(&once, "device.toml").unwrap();
        let read = load(&twice);
        prop_assert_eq!(bits(&read), bits(&second));
        prop_assert_eq!(read.nominal_links, Some(nominal.links));
        prop_assert_eq!(comments(&twice), comments(&original));
        prop_assert_eq!(twice.matches("[[nominal.link]]").count(), calibrated.links.len());
    }
}

#[test]
fn an_unchanged_device_changes_no_line_of_its_file() {
    let written = load(HAPTIC7).to_toml(HAPTIC7, "haptic7.toml").unwrap();
    assert!(written.starts_with(HAPTIC7.trim_end()), "{written}");
    assert_eq!(written.matches("[[nominal.link]]").count(), 8);
    assert!(!written.contains("transmission_error"));
}

#[test]
fn comments_inside_a_transmission_error_stay() {
    let original = "\
[[joint]] # first
transmission = \"capstan\"
transmission_ratio = 8.0
drum_distance_m = 0.0675
# measured in May
[joint.transmission_error] # eq. (1)
# at home
offset_rad = 0.001 # rad
ratio_deviation = 0.02 # of 8
measured_by = \"hand\"
";
    let mut device = load(original);
    let id = device.parameter("offset1").unwrap();
    id.set(&mut device, 0.25);
    let written = device.to_toml(original, "f").unwrap();
    assert_eq!(comments(&written), comments(original));
    assert!(written.contains("offset_rad = 0.25 # rad"), "{written}");
    assert!(written.contains("measured_by = \"hand\""), "{written}");
    assert!(
        !written.contains("nominal"),
        "no links, so none to keep: {written}"
    );
}

#[test]
fn another_kind_of_error_replaces_the_keys_of_the_old_one() {
    let original =
        "[[joint]]\n[joint.transmission_error]\noffset_rad = 0.001\nratio_deviation = 0.1\n";
    let mut device = load(original);
    let series = TransmissionError::Chebyshev {
        range_rad: [-0.5, 0.75],
        coefficients: vec![0.1, -0.2, 0.3],
    };
    device.joints[0].transmission_error = series.clone();
    let written = device.to_toml(original, "f").unwrap();
    let loaded = Device::from_toml(&written, "f").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    assert_eq!(loaded.device.joints[0].transmission_error, series);

    let capstan = TransmissionError::Capstan(CapstanError {
        input_drum_xy_m: [1e-5, 2e-5],
        ..CapstanError::default()
    });
    device.joints[0].transmission_error = capstan.clone();
    let loaded = Device::from_toml(&device.to_toml(&written, "f").unwrap(), "f").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    assert_eq!(loaded.device.joints[0].transmission_error, capstan);
}

#[test]
fn a_prismatic_joint_writes_metres() {
    let original = "[[joint]]\ntype = \"prismatic\"\n";
    let mut device = load(original);
    assert_eq!(device.joints[0].joint_type, JointType::Prismatic);
    let id = device.parameter("offset1").unwrap();
    assert_eq!(id.key(&device), "joint[1].transmission_error.offset_m");
    id.set(&mut device, 0.004);
    let written = device.to_toml(original, "f").unwrap();
    assert!(written.contains("offset_m = 0.004"), "{written}");
    assert_eq!(bits(&load(&written)), bits(&device));
}

#[test]
fn tables_written_in_line_are_written_too() {
    let original = "\
link = [
  { a_m = 0.0, alpha_rad = 0.0, d_m = 0.0 }, # base
  { a_m = 0.2, alpha_rad = 0.1, d_m = 0.0 },
]
joint = [{ home_rad = 0.5, transmission_error = { offset_rad = 0.1 } }]
";
    let nominal = load(original);
    let mut device = nominal.clone();
    for (step, id) in all_parameters(&device).into_iter().enumerate() {
        id.set(&mut device, 0.001 * (step + 1) as f64);
    }
    let written = device.to_toml(original, "f").unwrap();
    assert_eq!(bits(&load(&written)), bits(&device), "{written}");
    assert_eq!(load(&written).nominal_links, Some(nominal.links));
    assert_eq!(comments(&written), ["# base"]);
}

#[test]
fn an_error_set_to_zero_again_is_written_as_zero() {
    let original = "[[joint]]\n[joint.transmission_error]\noffset_rad = 0.1\n";
    let mut device = load(original);
    device.joints[0].transmission_error = TransmissionError::default();
    let written = device.to_toml(original, "f").unwrap();
    assert_eq!(
        load(&written).joints[0].transmission_error,
        TransmissionError::default()
    );
}

#[test]
fn what_cannot_be_written_is_refused() {
    let one = load("[[joint]]\n");
    let refused = one
        .to_toml("[[joint]]\n[[joint]]\n", "two.toml")
        .unwrap_err();
    assert!(
        matches!(refused, DeviceFileError::Shape { .. }),
        "{refused}"
    );
    assert!(refused.to_string().starts_with("two.toml: "), "{refused}");
    let refused = one.to_toml("not a device", "f").unwrap_err();
    assert!(
        matches!(refused, DeviceFileError::Syntax { .. }),
        "{refused}"
    );
    for value in [f64::NAN, f64::INFINITY] {
        let mut broken = one.clone();
        ParameterId::Transmission { joint: 0, index: 1 }.set(&mut broken, value);
        let refused = broken.to_toml("[[joint]]\n", "f").unwrap_err().to_string();
        assert!(refused.contains("ratio_deviation1"), "{refused}");
    }
}

#[test]
fn masses_armatures_and_gravity_that_changed_are_written_and_the_rest_stays() {
    let text = "\
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.4 # the upper arm
alpha_rad = 0.0
d_m = 0.0
mass_kg = 3.0 # weighed
centre_of_mass_m = [0.2, 0.0, 0.0]
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
[[joint]]
armature_kgm2 = 0.3
[[joint]]
type = \"prismatic\"
[gravity]
vector_mps2 = [0.0, -9.81, 0.0] # y is up
";
    let mut device = load(text);
    let inertia_kgm2 = Some([0.01, 0.05, 0.06, 0.001, 0.0, -0.002]);
    for (row, mass_kg) in [(1, 3.5), (2, 1.25)] {
        device.bodies[row] = Some(haptical_model::Body {
            mass_kg,
            centre_of_mass_m: [0.1, 0.02, -0.03],
            inertia_kgm2,
        });
    }
    device.joints[0].armature_kgm2 = Some(0.35);
    device.joints[1].armature_kgm2 = Some(2.0);
    device.gravity_mps2 = Some([1.0, -9.7, 0.0]);
    let written = device.to_toml(text, "device.toml").unwrap();
    let again = load(&written);
    assert_eq!(again.bodies, device.bodies);
    assert_eq!(again.joints, device.joints);
    assert_eq!(again.gravity_mps2, device.gravity_mps2);
    assert_eq!(comments(&written), comments(text));
    // a slide's is a mass
    assert!(written.contains("armature_kg = 2.0"), "{written}");
}

/// A play says in a word what it follows, the load among them; a loop of friction has no such side.
#[test]
fn what_a_play_follows_is_a_word() {
    let text = |name: &str, side: &str| {
        format!(
            "[[joint]]\n[[effect]]\nname = \"{name}\"\njoint = 1\nwidth_rad = 0.004\ndriven_by = \"{side}\"\n"
        )
    };
    let sides = [
        ("motor", 0.0),
        ("hand", 1.0),
        ("load", 2.0),
        ("motor-read-at-link", 3.0),
        ("hand-read-at-motor", 4.0),
    ];
    for (side, number) in sides {
        let text = text("backlash", side);
        let device = Device::from_toml(&text, "one.toml").unwrap().device;
        assert_eq!(device.effects[0].numbers["driven_by"], number);
        let mut other = device.clone();
        other.effects[0]
            .numbers
            .insert("width_rad".to_owned(), 0.005);
        let written = other.to_toml(&text, "one.toml").unwrap();
        assert!(
            written.contains(&format!("driven_by = \"{side}\"")),
            "{written}"
        );
    }
    let refused = Device::from_toml(&text("hysteresis", "load"), "one.toml").unwrap_err();
    assert!(
        refused.to_string().contains("\"motor\" or \"hand\""),
        "{refused}"
    );
}
