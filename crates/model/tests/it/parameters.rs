//! Parameters: value after set, names and keys that are unique and lead back.

use std::collections::BTreeSet;

use haptical_model::{Device, ModelError, Parameter, ParameterId, TransmissionError};
use proptest::prelude::*;

use haptical_testkit::haptic7;

use crate::support::{CASES, all_parameters, device_and_readings};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn setting_one_changes_that_one((device, _) in device_and_readings()) {
        let ids = all_parameters(&device);
        for changed in &ids {
            let mut other = device.clone();
            let value = changed.value(&device) + 0.25;
            changed.set(&mut other, value);
            for id in &ids {
                let expected = if id == changed { value } else { id.value(&device) };
                prop_assert_eq!(id.value(&other), expected, "{} after {}", id.name(&device), changed.name(&device));
            }
        }
    }

    #[test]
    fn names_and_keys_are_unique_and_names_lead_back((device, _) in device_and_readings()) {
        let ids = all_parameters(&device);
        let names: BTreeSet<String> = ids.iter().map(|id| id.name(&device)).collect();
        let keys: BTreeSet<String> = ids.iter().map(|id| id.key(&device)).collect();
        prop_assert_eq!(names.len(), ids.len());
        prop_assert_eq!(keys.len(), ids.len());
        for id in ids {
            prop_assert_eq!(device.parameter(&id.name(&device)), Ok(id));
            prop_assert!(id.plausible_size(&device) > 0.0);
        }
    }

    #[test]
    fn the_key_is_where_the_file_has_the_value((mut device, _) in device_and_readings()) {
        // every value distinct, so that a wrong place shows
        let ids = all_parameters(&device);
        for (step, id) in ids.iter().enumerate() {
            id.set(&mut device, 1e-6 * (step + 1) as f64);
        }
        for joint in &mut device.joints {
            if let TransmissionError::Chebyshev { range_rad, .. } = &mut joint.transmission_error {
                *range_rad = [-1.0, 1.0];
            }
        }
        let text = device.to_toml(&crate::support::nominal_text(&device), "f").unwrap();
        let document: toml::Table = text.parse().unwrap();
        for id in ids.iter().filter(|id| !matches!(id, ParameterId::Link { parameter: Parameter::Beta, .. })) {
            prop_assert_eq!(lookup(&document, &id.key(&device)), Some(id.value(&device)), "{}", id.key(&device));
        }
    }
}

/// Follows a key such as `joint[2].transmission_error.chebyshev[3]`; joints count from 1.
fn lookup(document: &toml::Table, key: &str) -> Option<f64> {
    let root = toml::Value::Table(document.clone());
    let mut here = &root;
    for part in key.split('.') {
        let (name, index) = match part.split_once('[') {
            None => (part, None),
            Some((name, rest)) => (name, Some(rest.strip_suffix(']')?.parse::<usize>().ok()?)),
        };
        here = here.get(name)?;
        if let Some(index) = index {
            here = here.get(if name == "joint" { index - 1 } else { index })?;
        }
    }
    here.as_float()
}

#[test]
fn names_keys_and_units_of_the_paper_s_device() {
    let mut device = haptic7();
    device.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan: Default::default(),
        length_deviations_m: [0.0; 4],
    };
    for (name, key, unit) in [
        ("a0", "link[0].a_m", "m"),
        ("alpha4", "link[4].alpha_rad", "rad"),
        ("d7", "link[7].d_m", "m"),
        ("theta2", "link[2].theta_offset_rad", "rad"),
        ("beta3", "link[3].beta_rad", "rad"),
        ("offset1", "joint[1].transmission_error.offset_rad", "rad"),
        (
            "ratio_deviation2",
            "joint[2].transmission_error.ratio_deviation",
            "1",
        ),
        (
            "output_drum_y3",
            "joint[3].transmission_error.output_drum_xy_m[1]",
            "m",
        ),
        (
            "input_drum_x4",
            "joint[4].transmission_error.input_drum_xy_m[0]",
            "m",
        ),
        (
            "length_deviation4[1]",
            "joint[4].transmission_error.length_deviations_m[0]",
            "m",
        ),
        (
            "length_deviation4[4]",
            "joint[4].transmission_error.length_deviations_m[3]",
            "m",
        ),
    ] {
        let id = device.parameter(name).unwrap();
        assert_eq!((id.key(&device).as_str(), id.unit(&device)), (key, unit));
    }
    assert_eq!(device.link_parameters(false).len(), 32);
    assert_eq!(device.link_parameters(true).len(), 40);
    let missing = device.parameter("alpha8").unwrap_err();
    let name = "alpha8".to_owned();
    assert_eq!(missing, ModelError::NoParameter { name });
}

#[test]
fn a_polynomial_of_a_prismatic_joint_is_in_metres() {
    let text = "[[joint]]\ntype = \"prismatic\"\n[joint.transmission_error]\nrange_rad = [-1, 1]\n\
                chebyshev = [0.1, 0.2]\n";
    let device = Device::from_toml(text, "f").unwrap().device;
    let id = device.parameter("chebyshev1[1]").unwrap();
    assert_eq!((id.unit(&device), id.value(&device)), ("m", 0.2));
}
