//! The modules that `haptical export --format rust` wrote, compiled here, against their device files.

use haptical_runtime::{CoupledModel, Model, RuntimeError};
use proptest::prelude::*;

use crate::against_model::compare;
use crate::devices::{self, fixture, model};

/// Joint 4 as a polynomial, as identified from a log.
pub(crate) mod identified {
    include!("../fixtures/identified.rs");
}
/// Joint 4 as a parallelogram.
pub(crate) mod parallelogram {
    include!("../fixtures/parallelogram.rs");
}

/// Rows behind origins, with slides along y, tilts and a handle.
pub(crate) mod general {
    include!("../fixtures/general.rs");
}
/// Two joints that move three rows.
pub(crate) mod coupled {
    include!("../fixtures/coupled.rs");
}

#[test]
fn the_exported_constants_of_general_rows_are_those_of_the_files() {
    let there: Model<2> = model(&fixture("general.toml"));
    assert_eq!((general::MODEL, general::JOINTS), (there, 2));
    assert_eq!(
        (general::DEVICE, coupled::DEVICE),
        ("general rows", "coupled rows")
    );
    assert_ne!(general::DEVICE_SHA256, coupled::DEVICE_SHA256);
    let there: CoupledModel<2, 3> = devices::coupled(&fixture("coupled.toml"));
    assert_eq!((coupled::JOINTS, coupled::ROWS), (2, 3));
    assert_eq!(coupled::MODEL, there);
}

#[test]
fn the_exported_constant_is_the_device_of_the_file() {
    assert_eq!(identified::JOINTS, 7);
    assert_eq!(identified::DEVICE, fixture("identified.toml").name);
    assert_eq!(identified::DEVICE_SHA256.len(), 64);
    assert_eq!(identified::MODEL, model::<7>(&fixture("identified.toml")));
    assert_eq!(parallelogram::DEVICE, identified::DEVICE);
    assert_ne!(parallelogram::DEVICE_SHA256, identified::DEVICE_SHA256);
    assert_eq!(parallelogram::JOINTS, 7);
    // the square root of a constant and that of a step may differ in the last place
    let there: Model<7> = model(&fixture("parallelogram.toml"));
    assert_eq!(parallelogram::MODEL, there);
}

#[test]
fn a_reading_beyond_the_polynomial_is_refused_with_its_joint() {
    let [lower, upper] = identified::MODEL.ranges()[3];
    let mut readings = [0.0; 7];
    readings[3] = upper;
    assert!(identified::MODEL.step(&readings).is_ok());
    readings[3] = upper.next_up();
    let expected = RuntimeError::ReadingOutOfRange {
        joint: 4,
        reading: readings[3],
        lower,
        upper,
    };
    assert_eq!(identified::MODEL.step(&readings), Err(expected));
}

#[test]
fn the_exported_limits_are_those_of_the_file() {
    let device = fixture("identified.toml");
    let there: Vec<[f64; 2]> = device
        .joints
        .iter()
        .map(|joint| [joint.lower_rad, joint.upper_rad])
        .collect();
    assert_eq!(identified::LIMITS.to_vec(), there);
    assert_eq!(identified::MODEL.limits(), identified::LIMITS);
    let [lower, upper] = identified::LIMITS[2];
    let mut readings = [0.0; 7];
    for inside in [lower, upper] {
        readings[2] = inside;
        assert_eq!(identified::MODEL.check_limits(&readings), Ok(()));
    }
    for outside in [lower.next_down(), upper.next_up()] {
        readings[2] = outside;
        let expected = RuntimeError::BeyondLimit {
            joint: 3,
            reading: outside,
            lower,
            upper,
        };
        assert_eq!(identified::MODEL.check_limits(&readings), Err(expected));
        assert!(identified::MODEL.step(&readings).is_ok(), "a step goes on");
    }
}

proptest! {
    #[test]
    fn the_paper_s_device_in_its_whole_workspace(
        readings in proptest::collection::vec(-1.3..1.3_f64, 7),
        fourth in -0.65..0.65_f64,
        force_n in [-10.0..10.0_f64, -10.0..10.0_f64, -10.0..10.0_f64],
    ) {
        let mut readings = readings;
        readings[3] = fourth;
        compare::<7>(&fixture("identified.toml"), &readings, force_n);
        compare::<7>(&fixture("parallelogram.toml"), &readings, force_n);
    }
}
