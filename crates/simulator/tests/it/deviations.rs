//! The true device out of the nominal one.

use haptical_simulator::model::Recording;
use haptical_simulator::model::{ModelError, TransmissionError};
use haptical_simulator::{SimulatorError, apply_deviations, true_poses};

use crate::device::{arm, planar};

#[test]
fn deviations_are_added_to_the_parameters_they_name() {
    let nominal = arm();
    let deviations = [
        ("alpha4", 1.2e-3),
        ("a2", -5e-4),
        ("d0", 2e-3),
        ("theta2", 1e-3),
        ("beta1", 3e-4),
        ("ratio_deviation1", 0.1),
        ("output_drum_y1", 1e-5),
        ("length_deviation2[2]", 1e-4),
        ("chebyshev3[1]", 1e-6),
        ("a2", 1e-4),
    ];
    let truth = apply_deviations(&nominal, &deviations).expect("a device");
    let mut want = nominal.clone();
    want.links[4].alpha_rad += 1.2e-3;
    want.links[2].a_m = want.links[2].a_m - 5e-4 + 1e-4;
    want.links[0].d_m += 2e-3;
    want.links[2].theta_rad += 1e-3;
    want.links[1].beta_rad += 3e-4;
    let TransmissionError::Capstan(capstan) = &mut want.joints[0].transmission_error else {
        panic!("a capstan");
    };
    capstan.ratio_deviation += 0.1;
    capstan.output_drum_xy_m[1] += 1e-5;
    let TransmissionError::Parallelogram {
        length_deviations_m,
        ..
    } = &mut want.joints[1].transmission_error
    else {
        panic!("a parallelogram");
    };
    length_deviations_m[1] += 1e-4;
    let TransmissionError::Chebyshev { coefficients, .. } = &mut want.joints[2].transmission_error
    else {
        panic!("a polynomial");
    };
    coefficients[1] += 1e-6;
    assert_eq!(truth, want);
    assert_eq!(apply_deviations(&nominal, &[]).expect("a device"), nominal);
}

#[test]
fn length_deviations_extend_the_capstan_of_a_parallelogram() {
    let mut nominal = arm();
    let TransmissionError::Parallelogram { capstan, .. } = nominal.joints[1].transmission_error
    else {
        panic!("a parallelogram");
    };
    nominal.joints[1].transmission_error = TransmissionError::Capstan(capstan);
    let named = [
        ("length_deviation2[1]", -5e-4),
        ("length_deviation2[2]", -7e-4),
    ];
    let truth = apply_deviations(&nominal, &named).expect("a device");
    assert_eq!(truth, arm());
    // only where the joint is one
    let refused = apply_deviations(&nominal, &[("length_deviation1[1]", 1e-4)]);
    let Err(SimulatorError::Model(ModelError::NoParameter { name })) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(name, "length_deviation1[1]");
}

#[test]
fn unknown_names_and_numbers_that_are_none_are_refused() {
    let nominal = arm();
    for name in ["alpha5", "ratio_deviation3", "gamma1", ""] {
        let refused = apply_deviations(&nominal, &[("a1", 1e-3), (name, 1e-3)]);
        let Err(SimulatorError::Model(ModelError::NoParameter { name: got })) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(got, name);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let refused = apply_deviations(&nominal, &[("a1", bad)]);
        assert!(matches!(&refused, Err(SimulatorError::Deviation { name, .. }) if name == "a1"));
    }
}

/// One rounding of a length below 1 m.
const LENGTH_TOLERANCE: f64 = 1e-15;

#[test]
fn true_poses_are_those_of_the_true_device() {
    let nominal = planar();
    let truth = apply_deviations(&nominal, &[("d1", 0.004), ("d2", -0.001)]).expect("a device");
    let recording = Recording {
        joint: vec![vec![0.1, -0.2], vec![0.3, 0.0]],
        ..Recording::default()
    };
    let [before, after] =
        [&nominal, &truth].map(|device| true_poses(device, &recording).expect("poses"));
    for (before, after) in before.iter().zip(&after) {
        let moved = after.position_m - before.position_m;
        assert!((moved.z - 0.003).abs() < LENGTH_TOLERANCE);
        assert_eq!((moved.x, moved.y), (0.0, 0.0));
    }
    assert_ne!(before[0], before[1]);
}
