//! What a step and a model refuse, and that nothing else ever comes out than finite numbers.

use haptical_runtime::{
    Capstan, Convention, CoupledModel, DeviceError, GeneralRow, Joint, Link, Model, Motion,
    Parallelogram, Pose, RowDrive, RuntimeError, Transmission, padded,
};
use proptest::prelude::*;

use crate::exported::{identified, parallelogram};

const DRIVE: Capstan = Capstan {
    transmission_ratio: 8.0,
    drum_distance_m: 0.07,
    input_drum_denominator_m: 0.07,
    offset: 0.0,
    ratio_deviation: 0.0,
    output_drum_xy_m: [0.0; 2],
    input_drum_xy_m: [0.0; 2],
};

fn with(transmission: Transmission) -> Result<Model<1>, DeviceError> {
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.0,
        transmission,
    };
    Model::new(
        Convention::Standard,
        Link::IDENTITY,
        [Link::IDENTITY],
        [joint],
    )
}

fn refused_key(transmission: Transmission) -> &'static str {
    match with(transmission) {
        Err(DeviceError::Joint {
            joint: 1, quantity, ..
        }) => quantity,
        other => panic!("{other:?}"),
    }
}

#[test]
fn limits_that_are_none_are_refused_and_readings_are_held_against_the_others() {
    let model = with(Transmission::Exact).unwrap();
    assert_eq!(model.limits(), [[f64::NEG_INFINITY, f64::INFINITY]]);
    assert_eq!(model.check_limits(&[1e300]), Ok(()));
    for bad in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::NAN]] {
        let refused = model.with_limits([bad]).unwrap_err();
        assert!(refused.to_string().contains("joint 1: lower limit"));
    }
    let limited = model.with_limits([[f64::NEG_INFINITY, 1.0]]).unwrap();
    assert_eq!(limited.check_limits(&[-1e300]), Ok(()));
    for reading in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(
            limited.check_limits(&[reading]),
            Err(RuntimeError::NonFiniteReading { joint: 1, .. })
        ));
    }
}

#[test]
fn origins_that_are_no_rigid_transforms_are_refused_with_their_row() {
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.0,
        transmission: Transmission::Exact,
    };
    let mut bad = [Pose::default(); 5];
    bad[0].rotation[(1, 1)] = f64::NAN;
    bad[1].rotation[(2, 2)] = -1.0; // mirrors
    bad[2].rotation[(0, 0)] = 1.001; // stretches
    bad[3].position_m[2] = f64::INFINITY;
    bad[4].rotation[(0, 1)] = 0.01; // shears
    for frame in bad {
        for row in 0..3 {
            let general = |index| GeneralRow {
                origin: (index == row).then_some(frame),
                ..GeneralRow::IDENTITY
            };
            let handle = (row == 2).then_some(frame);
            let convention = Convention::Modified;
            let model = Model::general(convention, general(0), [general(1)], handle, [joint]);
            assert_eq!(model, Err(DeviceError::Origin { row }), "{frame:?}");
        }
    }
    let row = GeneralRow {
        link: Link {
            b_m: 2e6,
            ..Link::IDENTITY
        },
        ..GeneralRow::IDENTITY
    };
    let Err(DeviceError::Row {
        row: 1,
        quantity: "b_m",
        ..
    }) = Model::general(
        Convention::Standard,
        GeneralRow::IDENTITY,
        [row],
        None,
        [joint],
    )
    else {
        panic!("a slide of 2000 km is no length");
    };
}

#[test]
fn rows_that_follow_are_refused_with_their_joint() {
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.0,
        transmission: Transmission::Exact,
    };
    let coupled = |joint_index, multiplier| {
        let drive = |joint, multiplier| RowDrive {
            motion: Motion::Revolute,
            joint,
            multiplier,
            offset: 0.0,
        };
        CoupledModel::new(
            Convention::Standard,
            GeneralRow::IDENTITY,
            [GeneralRow::IDENTITY; 2],
            None,
            [joint],
            [drive(0, 1.0), drive(joint_index, multiplier)],
        )
    };
    let expected = DeviceError::Drive {
        row: 2,
        joint: 2,
        joints: 1,
    };
    assert_eq!(coupled(1, 1.0), Err(expected));
    let Err(DeviceError::Joint {
        joint: 1,
        quantity: "driven_multiplier",
        ..
    }) = coupled(0, f64::NAN)
    else {
        panic!("a multiplier must be a number");
    };
    // a reading that is allowed may still drive a row too far
    let model = coupled(0, 1e5).unwrap();
    assert!(model.step(&[1.0]).is_ok());
    let far = RuntimeError::OutputOutOfRange {
        joint: 1,
        reading: 11.0,
        output: 1.1e6,
    };
    assert_eq!(model.step(&[11.0]), Err(far));
    let Err(RuntimeError::NonFiniteReading { joint: 1, .. }) = model.step(&[f64::NAN]) else {
        panic!("a reading must be a number");
    };
}

#[test]
fn a_reading_that_is_not_finite_is_refused_with_its_joint() {
    for joint in 0..7 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut readings = [0.0; 7];
            readings[joint] = value;
            for model in [&identified::MODEL, &parallelogram::MODEL] {
                let Err(RuntimeError::NonFiniteReading { joint: named, .. }) =
                    model.step(&readings)
                else {
                    panic!("joint {joint} at {value} is not refused");
                };
                assert_eq!(named, joint + 1);
            }
        }
    }
}

#[test]
fn readings_beyond_the_sine_are_refused() {
    // the input drum turns 8 times as far
    let model = with(Transmission::Capstan(DRIVE)).unwrap();
    assert_eq!(model.ranges(), [[-125_000.0, 125_000.0]]);
    assert!(model.step(&[125_000.0]).is_ok());
    let refused = model.step(&[125_001.0]);
    assert!(matches!(
        refused,
        Err(RuntimeError::ReadingOutOfRange { joint: 1, .. })
    ));
}

#[test]
fn a_loop_that_opens_is_refused() {
    let closed = parallelogram::MODEL.step(&[0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0]);
    assert!(closed.is_ok());
    for reading in [1.7, -1.7, 3.0, 1e5 / 2.0] {
        let open = parallelogram::MODEL.step(&[0.0, 0.0, 0.0, reading, 0.0, 0.0, 0.0]);
        assert_eq!(open, Err(RuntimeError::OpenLoop { joint: 4, reading }));
    }
}

#[test]
fn an_output_that_is_too_large_is_refused() {
    let slack = Capstan {
        ratio_deviation: -7.999,
        ..DRIVE
    };
    let refused = with(Transmission::Capstan(slack)).unwrap().step(&[1000.0]);
    assert!(
        matches!(
            refused,
            Err(RuntimeError::OutputOutOfRange { joint: 1, .. })
        ),
        "{refused:?}"
    );
}

#[test]
fn a_device_that_cannot_be_held_is_refused_with_the_key() {
    let drum = |output_drum_xy_m| {
        Transmission::Capstan(Capstan {
            output_drum_xy_m,
            ..DRIVE
        })
    };
    assert!(with(drum([0.0209, 0.0])).is_ok());
    assert_eq!(refused_key(drum([0.0, 0.0211])), "output_drum_xy_m");
    assert_eq!(refused_key(drum([f64::NAN, 0.0])), "output_drum_xy_m");
    let ratio = |ratio_deviation| {
        Transmission::Capstan(Capstan {
            ratio_deviation,
            ..DRIVE
        })
    };
    assert_eq!(refused_key(ratio(-8.0)), "ratio_deviation");
    assert_eq!(refused_key(ratio(f64::INFINITY)), "ratio_deviation");
    let distance = |drum_distance_m| {
        Transmission::Capstan(Capstan {
            drum_distance_m,
            ..DRIVE
        })
    };
    assert_eq!(refused_key(distance(0.0)), "drum_distance_m");
    let bars = |lengths_m| {
        Transmission::Parallelogram(Parallelogram {
            capstan: DRIVE,
            lengths_m,
        })
    };
    assert!(with(bars([0.18, 0.076, 0.18, 0.076])).is_ok());
    assert_eq!(
        refused_key(bars([0.5, 0.076, 0.18, 0.076])),
        "parallelogram_lengths_m"
    );
    assert_eq!(
        refused_key(bars([0.18, -0.076, 0.18, 0.076])),
        "parallelogram_lengths_m"
    );
    let series = |range| Transmission::Polynomial {
        range,
        coefficients: padded([0.0]),
    };
    assert_eq!(refused_key(series([0.5, 0.5])), "range_rad");
    assert_eq!(refused_key(series([0.5, f64::NAN])), "range_rad");
    let coefficients = padded([0.0, f64::NAN]);
    let range = [-1.0, 1.0];
    assert_eq!(
        refused_key(Transmission::Polynomial {
            range,
            coefficients
        }),
        "chebyshev"
    );
}

#[test]
fn a_row_that_is_not_finite_is_refused_with_its_number() {
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.0,
        transmission: Transmission::Exact,
    };
    let bad = Link {
        d_m: f64::NAN,
        ..Link::IDENTITY
    };
    let refused = Model::new(
        Convention::Modified,
        Link::IDENTITY,
        [Link::IDENTITY, bad],
        [joint; 2],
    );
    let Err(
        error @ DeviceError::Row {
            row: 2,
            quantity: "d_m",
            ..
        },
    ) = refused
    else {
        panic!("{refused:?}");
    };
    assert!(
        error.to_string().starts_with("row 2: d_m is NaN"),
        "{error}"
    );
}

proptest! {
    #[test]
    fn any_bits_give_finite_numbers_or_an_error(
        bits in proptest::array::uniform7(any::<u64>()),
        size in -30..30_i32,
    ) {
        for model in [&identified::MODEL, &parallelogram::MODEL] {
            for readings in [
                bits.map(f64::from_bits),
                bits.map(|bits| (bits as f64 / u64::MAX as f64 - 0.5) * 2f64.powi(size)),
            ] {
                let Ok(state) = model.step(&readings) else { continue };
                let twists = state.jacobian.iter().flat_map(|t| t.linear.iter().chain(t.angular.iter()));
                let all = state.outputs.iter().chain(&state.output_slopes).chain(&state.pose.position_m)
                    .chain(&state.pose.rotation).chain(twists);
                for number in all {
                    prop_assert!(number.is_finite());
                }
            }
        }
    }
}
