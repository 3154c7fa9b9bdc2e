//! Every refusal, and what it names.

use haptical_simulator::model::{Device, ModelError, Recording};
use haptical_simulator::{
    CableSigma, Noise, Part, Sampling, Settings, SimulatorError, simulate, simulate_transmission,
    true_poses,
};

use crate::device::{arm, transmissions_only};

fn refusal(truth: &Device, settings: &Settings) -> SimulatorError {
    simulate(truth, settings, 3, 61).expect_err("a refusal")
}

/// The arm after one change.
fn changed(change: impl FnOnce(&mut Device)) -> Device {
    let mut device = arm();
    change(&mut device);
    device
}

#[track_caller]
#[allow(clippy::panic, reason = "an assertion, called by tests only")]
fn assert_missing(refused: &SimulatorError, want_part: &str, want_key: &str) {
    let SimulatorError::MissingKey { part, key, .. } = refused else {
        panic!("{refused:?}");
    };
    assert_eq!((part.to_string().as_str(), *key), (want_part, want_key));
    let text = refused.to_string();
    assert!(
        text.contains(want_part) && text.contains(want_key),
        "{text}"
    );
}

#[test]
fn a_missing_number_is_named_with_its_joint() {
    let (paper, real) = (Settings::paper(), Settings::real_encoders());
    let truth = changed(|device| device.joints[1].sampling_sd_rad = None);
    assert_missing(
        &refusal(&truth, &paper),
        "joint 2 (`elbow`)",
        "sampling_sd_rad",
    );
    let truth = changed(|device| device.joints[3].encoder_counts_per_rev = None);
    assert_missing(
        &refusal(&truth, &real),
        "joint 4 (`wrist`)",
        "encoder_counts_per_rev",
    );
    assert!(
        simulate(&truth, &paper, 3, 61).is_ok(),
        "not needed without motor counts"
    );
    let truth = changed(|device| device.joints[0].external_encoder_counts_per_rev = None);
    assert_missing(
        &refusal(&truth, &paper),
        "joint 1 (`turret`)",
        "external_encoder_sd_rad",
    );
    let key = "external_encoder_counts_per_rev";
    assert_missing(&refusal(&truth, &real), "joint 1 (`turret`)", key);
    let alone = simulate_transmission(&truth, &real, 0, 3, 61).expect_err("a refusal");
    assert_missing(&alone, "joint 1 (`turret`)", key);
    let alone = simulate_transmission(&arm(), &paper, 3, 3, 61).expect_err("a refusal");
    assert_missing(&alone, "joint 4 (`wrist`)", "external_encoder_sd_rad");
}

#[test]
fn a_missing_number_is_named_with_its_cable() {
    let with = |cable_sigma| Settings {
        cable_sigma,
        ..Settings::paper()
    };
    let truth = changed(|device| device.cables[1].distance_sd_m = None);
    assert_missing(
        &refusal(&truth, &with(CableSigma::Stated)),
        "cable 2",
        "distance_sd_m",
    );
    assert!(
        simulate(&truth, &Settings::paper(), 3, 61).is_ok(),
        "not needed as printed"
    );
    let truth = changed(|device| device.cables[0].drum_radius_m = None);
    for sigma in [CableSigma::Printed, CableSigma::Geometric] {
        assert_missing(&refusal(&truth, &with(sigma)), "cable 1", "drum_radius_m");
    }
    assert!(simulate(&truth, &with(CableSigma::Stated), 3, 61).is_ok());
    let truth = changed(|device| device.cables[0].counts_per_rev = None);
    assert_missing(
        &refusal(&truth, &Settings::real_encoders()),
        "cable 1",
        "counts_per_rev",
    );
}

#[test]
fn limits_without_room_name_the_joint() {
    let truth = changed(|device| device.joints[2].lower_rad = 0.13);
    let refused = refusal(&truth, &Settings::paper());
    let SimulatorError::NoRoom {
        part,
        low,
        high,
        attempts: 0,
    } = refused
    else {
        panic!("{refused:?}");
    };
    assert_eq!(
        part,
        Part::Joint {
            number: 3,
            name: "slide".to_owned()
        }
    );
    assert_eq!((low, high), (0.13, 0.1), "3 sd are beyond the upper limit");
    // an interval that is not empty, but is never hit
    let truth = changed(|device| {
        device.joints[0].lower_rad = 1.570;
        device.joints[0].upper_rad = 1.570_000_000_1;
    });
    let refused = refusal(&truth, &Settings::paper());
    let SimulatorError::NoRoom { part, attempts, .. } = refused else {
        panic!("{refused:?}");
    };
    assert!(part.to_string().contains("turret") && attempts > 0);
}

#[test]
fn uniform_sampling_needs_finite_limits() {
    let settings = Settings {
        sampling: Sampling::Uniform,
        ..Settings::paper()
    };
    let truth = changed(|device| device.joints[3].upper_rad = f64::INFINITY);
    let refused = refusal(&truth, &settings);
    assert!(
        matches!(
            &refused,
            SimulatorError::Value {
                key: "upper_rad",
                ..
            }
        ),
        "{refused:?}"
    );
    assert!(
        simulate(&truth, &Settings::paper(), 3, 61).is_ok(),
        "3 sd bound the normal"
    );
    let truth = changed(|device| device.joints[3].lower_rad = f64::NAN);
    for settings in [settings, Settings::paper()] {
        let refused = refusal(&truth, &settings);
        assert!(matches!(
            &refused,
            SimulatorError::Value {
                key: "lower_rad",
                ..
            }
        ));
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let paper = Settings::paper();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let truth = changed(|device| device.joints[0].sampling_sd_rad = Some(bad));
        let refused = refusal(&truth, &paper);
        assert!(matches!(
            &refused,
            SimulatorError::Value {
                key: "sampling_sd_rad",
                ..
            }
        ));
        let truth = changed(|device| device.cables[0].counts_per_rev = Some(bad));
        let refused = refusal(&truth, &paper);
        assert!(matches!(
            &refused,
            SimulatorError::Value {
                key: "counts_per_rev",
                ..
            }
        ));
        let truth = changed(|device| device.joints[2].external_encoder_sd_rad = Some(bad));
        let refused = refusal(&truth, &paper);
        assert!(matches!(
            &refused,
            SimulatorError::Value {
                key: "external_encoder_sd_rad",
                ..
            }
        ));
    }
    let truth = changed(|device| device.joints[3].transmission_ratio = 0.0);
    let real = Settings {
        motor_counts: true,
        ..paper
    };
    let SimulatorError::Value {
        key: "transmission_ratio",
        value,
        ..
    } = refusal(&truth, &real)
    else {
        panic!("the ratio is zero");
    };
    assert_eq!(value, 0.0);
}

#[test]
fn settings_out_of_range_are_refused() {
    let truth = arm();
    for uniform_share in [0.0, -0.5, 1.1, f64::NAN] {
        let settings = Settings {
            uniform_share,
            ..Settings::paper()
        };
        let SimulatorError::Setting { setting, .. } = refusal(&truth, &settings) else {
            panic!("{uniform_share}");
        };
        assert_eq!(setting, "uniform_share");
    }
    for minimum_distance_m in [-1e-3, f64::NAN, f64::INFINITY] {
        let settings = Settings {
            minimum_distance_m,
            ..Settings::paper()
        };
        let SimulatorError::Setting { setting, .. } = refusal(&truth, &settings) else {
            panic!("{minimum_distance_m}");
        };
        assert_eq!(setting, "minimum_distance_m");
    }
    let rows = usize::MAX;
    let refused = simulate(&truth, &Settings::paper(), rows, 61).expect_err("too many rows");
    assert!(matches!(
        refused,
        SimulatorError::Setting {
            setting: "rows",
            ..
        }
    ));
}

#[test]
fn a_minimum_distance_out_of_reach_is_refused() {
    let settings = Settings {
        minimum_distance_m: 10.0,
        ..Settings::paper()
    };
    let refused = refusal(&arm(), &settings);
    let SimulatorError::TooNearCableExit {
        row,
        minimum_distance_m,
        ..
    } = refused
    else {
        panic!("{refused:?}");
    };
    assert_eq!((row, minimum_distance_m), (0, 10.0));
    assert!(
        simulate(&transmissions_only(), &settings, 3, 61).is_ok(),
        "no handle, no distance"
    );
}

#[test]
fn a_handle_that_stays_at_the_cable_exit_has_no_distance() {
    let truth = changed(|device| {
        for link in &mut device.links {
            (link.a_m, link.d_m, link.alpha_rad) = (0.0, 0.0, 0.0);
        }
        device.cables.truncate(1);
        device.joints[2].joint_type = haptical_simulator::model::JointType::Revolute;
    });
    let settings = Settings {
        minimum_distance_m: 0.0,
        ..Settings::paper()
    };
    let refused = refusal(&truth, &settings);
    assert!(
        matches!(&refused, SimulatorError::TooNearCableExit { .. }),
        "{refused:?}"
    );
}

#[test]
fn what_the_model_refuses_is_passed_on_with_its_row() {
    let truth = changed(|device| {
        device.joints[1].parallelogram_lengths_m = Some([0.18, 0.076, 1.0, 0.076]);
    });
    let refused = refusal(&truth, &Settings::paper());
    let SimulatorError::Row {
        row: 0,
        source: ModelError::Transmission { joint: 2, .. },
    } = refused
    else {
        panic!("{refused:?}");
    };
    let refused = simulate_transmission(&truth, &Settings::paper(), 1, 3, 61);
    assert!(
        matches!(refused, Err(SimulatorError::Row { row: 0, .. })),
        "{refused:?}"
    );
    let refused = simulate_transmission(&truth, &Settings::paper(), 4, 3, 61);
    assert_eq!(
        refused,
        Err(SimulatorError::NoJoint {
            joint: 4,
            joints: 4
        })
    );
}

#[test]
fn true_poses_need_links_and_columns_of_one_length() {
    let mut recording = Recording {
        joint: vec![vec![0.0; 2]; 4],
        ..Recording::default()
    };
    let refused = true_poses(&transmissions_only(), &recording).expect_err("no links");
    assert!(matches!(
        refused,
        SimulatorError::Row {
            source: ModelError::NoLinks { .. },
            ..
        }
    ));
    recording.joint[2].pop();
    let refused = true_poses(&arm(), &recording).expect_err("a short column");
    assert_eq!(
        refused,
        SimulatorError::ColumnLength {
            joint: 3,
            expected: 2,
            got: 1
        }
    );
    recording.joint = vec![vec![0.0; 2]; 3];
    let refused = true_poses(&arm(), &recording).expect_err("a missing joint");
    let source = ModelError::JointCount {
        expected: 4,
        found: 3,
    };
    assert_eq!(refused, SimulatorError::Row { row: 0, source });
}

#[test]
fn a_result_that_overflows_is_refused() {
    let settings = Settings {
        output_noise: Noise::Gaussian,
        ..Settings::paper()
    };
    let truth = changed(|device| {
        device.links.clear();
        device.joints[0].external_encoder_sd_rad = Some(f64::MAX);
    });
    // three of a hundred normal numbers being above 1 in size is as good as certain
    let refused = simulate(&truth, &settings, 100, 61).expect_err("an overflow");
    let SimulatorError::NonFinite { channel, .. } = &refused else {
        panic!("{refused:?}");
    };
    assert_eq!(channel, "out1");
}
