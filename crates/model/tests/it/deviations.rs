//! `hold` and the deviations of a `[[link]]`.

use haptical_model::{Device, Parameter, ParameterId};

const FILE: &str = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    [[link]]\na_m = 0.4\nalpha_rad = 0.1\nd_m = 0.0\nhold = [\"lengths\", \"alpha\"]\n\
    theta_offset_deviation_rad = 0.06\n[[joint]]\n";

#[test]
fn a_row_says_what_it_holds() {
    let device = Device::from_toml(FILE, "lever.toml").unwrap().device;
    for (number, deviation) in [
        (Parameter::A, Some(0.0)),
        (Parameter::D, Some(0.0)),
        (Parameter::Alpha, Some(0.0)),
        (Parameter::Theta, Some(0.06)),
        (Parameter::Beta, None),
    ] {
        assert_eq!(device.deviation(1, number), deviation, "{number:?}");
        assert_eq!(device.deviation(0, number), None, "{number:?}");
    }
    let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
    assert_eq!(again.device, device);
    assert_eq!(again.warnings, Vec::<String>::new());
    let offset = ParameterId::Link {
        row: 1,
        parameter: Parameter::Theta,
    };
    assert_eq!(offset.plausible_size(&device), 0.06);
}

#[test]
fn words_stand_for_rows() {
    let mut device = Device::from_toml(FILE, "lever.toml").unwrap().device;
    device.deviations.clear();
    device.hold("twists").unwrap();
    assert!(device.is_held(1, Parameter::Beta) && !device.is_held(0, Parameter::Beta));
    device.hold("a0").unwrap();
    assert!(device.is_held(0, Parameter::A) && !device.is_held(1, Parameter::A));
    for wrong in ["a2", "length", "", "3", "theta99999999999999999999", "a-1"] {
        assert!(device.hold(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    for (from, to, words) in [
        ("\"alpha\"", "\"alhpa\"", "alhpa"),
        ("0.06", "-0.06", "not negative"),
    ] {
        let error = Device::from_toml(&FILE.replace(from, to), "lever.toml").unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}
