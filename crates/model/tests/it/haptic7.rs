//! The device of the paper: it loads without a warning, and its handle at home is where it should be.

use haptical_model::{Device, Evaluation, TransmissionKind};
use haptical_testkit::{HAPTIC7, haptic7};

/// The design study prints the handle and the cable at home to a millimetre.
const PRINTED_M: f64 = 5e-4;

#[test]
fn it_loads_without_a_warning() {
    let loaded = Device::from_toml(HAPTIC7, "haptic7.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    let device = loaded.device;
    assert_eq!((device.links.len(), device.joints.len()), (8, 7));
    let drives: Vec<TransmissionKind> = device.joints.iter().map(|j| j.transmission).collect();
    let (capstan, direct) = (TransmissionKind::Capstan, TransmissionKind::Direct);
    let expected = [
        capstan,
        capstan,
        capstan,
        TransmissionKind::Parallelogram,
        direct,
        direct,
        direct,
    ];
    assert_eq!(drives, expected);
    // the paper's sigma_m, as printed
    assert!((device.cable_sd_m(0).unwrap() - 9.87e-6).abs() < 5e-9);
    assert_eq!(device.nominal_links, None);
}

#[test]
fn the_handle_at_home() {
    let device = haptic7();
    let mut at = Evaluation::new(&device);
    at.move_to(&[0.0; 7]).unwrap();
    let position_m = at.pose().unwrap().position_m;
    for (axis, printed) in [0.072, 0.053, 0.091].into_iter().enumerate() {
        assert!(
            (position_m[axis] - printed).abs() < PRINTED_M,
            "{position_m}"
        );
    }
    assert!(
        (position_m.norm() - 0.128).abs() < PRINTED_M,
        "{}",
        position_m.norm()
    );
    for joint in 0..7 {
        assert_eq!((at.output_rad(joint), at.error_rad(joint)), (0.0, 0.0));
    }
}
