//! Devices of every kind for the tests, and the same devices as the runtime takes them.

use haptical_model::kinematics::{Convention, Link};
use haptical_model::transmission::CapstanError;
use haptical_model::{
    Device, Drive, Joint as ModelJoint, JointType, Origin, TransmissionError, TransmissionKind,
};
use haptical_runtime::{
    Capstan, CoupledModel, GeneralRow, Joint, Model, Motion, POLYNOMIAL_TERMS, Parallelogram, Pose,
    RowDrive, Transmission,
};
use proptest::collection::vec;
use proptest::prelude::*;

/// A device file of the fixtures.
pub(crate) fn fixture(name: &str) -> Device {
    let text = std::fs::read_to_string(format!(
        "{}/tests/fixtures/{name}",
        env!("CARGO_MANIFEST_DIR")
    ));
    Device::from_toml(&text.unwrap(), name).unwrap().device
}

/// A device as a device file with it would give the runtime.
pub(crate) fn model<const JOINTS: usize>(device: &Device) -> Model<JOINTS> {
    let convention = device.convention;
    let rows = std::array::from_fn(|index| row(device, index + 1));
    let joints = std::array::from_fn(|index| joint(&device.joints[index]));
    if device.is_plain_table() {
        let rows = rows.map(|row: GeneralRow| row.link);
        let model = Model::new(convention, device.links[0], rows, joints).unwrap();
        return model.with_limits(limits(device)).unwrap();
    }
    let handle = frame(device, device.links.len());
    let model = Model::general(convention, row(device, 0), rows, handle, joints).unwrap();
    model.with_limits(limits(device)).unwrap()
}

/// A device with rows that follow, as a device file with it would give the runtime.
pub(crate) fn coupled<const JOINTS: usize, const ROWS: usize>(
    device: &Device,
) -> CoupledModel<JOINTS, ROWS> {
    let convention = device.convention;
    let rows = std::array::from_fn(|index| row(device, index + 1));
    let joints = std::array::from_fn(|index| joint(&device.joints[index]));
    let drives = std::array::from_fn(|index| {
        let drive = device.drives[index];
        RowDrive {
            motion: motion(drive.motion),
            joint: drive.joint,
            multiplier: drive.multiplier,
            offset: drive.offset,
        }
    });
    let handle = frame(device, device.links.len());
    let model =
        CoupledModel::new(convention, row(device, 0), rows, handle, joints, drives).unwrap();
    model.with_limits(limits(device)).unwrap()
}

fn limits<const JOINTS: usize>(device: &Device) -> [[f64; 2]; JOINTS] {
    std::array::from_fn(|index| {
        let joint = &device.joints[index];
        [joint.lower_rad, joint.upper_rad]
    })
}

fn motion(joint_type: JointType) -> Motion {
    match joint_type {
        JointType::Revolute => Motion::Revolute,
        JointType::Prismatic => Motion::Prismatic,
    }
}

fn joint(joint: &ModelJoint) -> Joint {
    Joint {
        motion: motion(joint.joint_type),
        home: joint.home_rad,
        transmission: transmission(joint),
    }
}

fn frame(device: &Device, row: usize) -> Option<Pose> {
    Some(device.origins.get(row).copied().flatten()?.pose())
}

fn row(device: &Device, index: usize) -> GeneralRow {
    GeneralRow {
        origin: frame(device, index),
        link: device.links[index],
    }
}

fn transmission(joint: &ModelJoint) -> Transmission {
    let capstan = |error: &CapstanError| Capstan {
        transmission_ratio: joint.transmission_ratio,
        drum_distance_m: joint.drum_distance_m.unwrap_or(1.0),
        input_drum_denominator_m: joint
            .input_drum_denominator_m
            .or(joint.drum_distance_m)
            .unwrap_or(1.0),
        offset: error.offset_rad,
        ratio_deviation: error.ratio_deviation,
        output_drum_xy_m: error.output_drum_xy_m,
        input_drum_xy_m: error.input_drum_xy_m,
    };
    match &joint.transmission_error {
        TransmissionError::Capstan(error) if *error == CapstanError::default() => {
            Transmission::Exact
        }
        TransmissionError::Capstan(error) => Transmission::Capstan(capstan(error)),
        TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } => {
            let mut padded = [0.0; POLYNOMIAL_TERMS];
            padded[..coefficients.len()].copy_from_slice(coefficients);
            Transmission::Polynomial {
                range: *range_rad,
                coefficients: padded,
            }
        }
        TransmissionError::Parallelogram {
            capstan: error,
            length_deviations_m,
        } => {
            let lengths_m = joint.parallelogram_lengths_m.unwrap();
            Transmission::Parallelogram(Parallelogram {
                capstan: capstan(error),
                lengths_m: std::array::from_fn(|bar| lengths_m[bar] + length_deviations_m[bar]),
            })
        }
    }
}

/// Devices of `joints` joints with every convention, joint type and transmission.
pub(crate) fn any_device(joints: usize) -> impl Strategy<Value = Device> {
    (
        any::<bool>(),
        vec(any_link(), joints + 1),
        vec(any_joint(), joints),
    )
        .prop_map(|(modified, links, joints)| Device {
            name: "random".to_owned(),
            convention: if modified {
                Convention::Modified
            } else {
                Convention::Standard
            },
            bodies: vec![None; links.len()],
            origins: Vec::new(),
            drives: Vec::new(),
            links,
            joints,
            cables: Vec::new(),
            tracker: None,
            contact_pairs: Vec::new(),
            gravity_mps2: None,
            nominal_links: None,
            deviations: Default::default(),
            surroundings: Default::default(),
            effects: Vec::new(),
            hands: Vec::new(),
            parents: Vec::new(),
        })
}

/// Devices of `joints` joints and `rows` moving rows with origins before some of them and slides along y.
/// Where there are more rows than joints, drives must be given to it.
pub(crate) fn any_general_device(joints: usize, rows: usize) -> impl Strategy<Value = Device> {
    let origin = (
        [-0.5..0.5_f64, -0.5..0.5_f64, -0.5..0.5_f64],
        [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.1..1.0_f64],
    )
        .prop_map(|(position_m, quaternion)| {
            let length = quaternion
                .iter()
                .map(|part| part * part)
                .sum::<f64>()
                .sqrt();
            Origin {
                position_m,
                orientation_wxyz: quaternion.map(|part| part / length),
            }
        });
    (
        any_device(joints),
        vec((any_link(), -0.3..0.3_f64), rows + 1),
        vec(proptest::option::of(origin), rows + 2),
    )
        .prop_map(|(device, links, origins)| Device {
            bodies: vec![None; links.len()],
            links: links
                .into_iter()
                .map(|(link, b_m)| Link { b_m, ..link })
                .collect(),
            origins,
            ..device
        })
}

/// What drives `rows` rows of `joints` joints, each joint at least one of the first.
pub(crate) fn any_drives(joints: usize, rows: usize) -> impl Strategy<Value = Vec<Drive>> {
    let drive = (0..joints, any::<bool>(), -2.0..2.0_f64, -0.5..0.5_f64);
    let drive = drive.prop_map(|(joint, slides, multiplier, offset)| Drive {
        joint,
        motion: match slides {
            true => JointType::Prismatic,
            false => JointType::Revolute,
        },
        multiplier,
        offset,
    });
    vec(drive, rows).prop_map(move |mut drives| {
        for (joint, drive) in drives.iter_mut().take(joints).enumerate() {
            drive.joint = joint;
        }
        drives
    })
}

fn any_link() -> impl Strategy<Value = Link> {
    let angle = || -3.2..3.2_f64;
    (
        -0.5..0.5_f64,
        // parallel axes as well
        prop_oneof![3 => angle(), 1 => Just(0.0)],
        -0.5..0.5_f64,
        angle(),
        prop_oneof![Just(0.0), -0.1..0.1_f64],
    )
        .prop_map(|(a_m, alpha_rad, d_m, theta_rad, beta_rad)| Link {
            a_m,
            alpha_rad,
            d_m,
            theta_rad,
            beta_rad,
            b_m: 0.0,
        })
}

fn any_joint() -> impl Strategy<Value = ModelJoint> {
    let ratio = prop_oneof![2.0..20.0_f64, -20.0..-2.0_f64];
    (
        prop_oneof![3 => Just(JointType::Revolute), 1 => Just(JointType::Prismatic)],
        -3.0..3.0_f64,
        ratio,
        0.03..0.2_f64,
        proptest::option::of(0.002..0.2_f64),
        any_error(),
    )
        .prop_map(
            |(joint_type, home_rad, ratio, distance_m, denominator_m, error)| ModelJoint {
                has_numeric_name: false,
                name: "any".to_owned(),
                joint_type,
                home_rad,
                lower_rad: -2.0,
                upper_rad: 2.0,
                armature_kgm2: None,
                torque_offset_nm: None,
                torque_delay_s: None,
                torque_limit_nm: None,
                sampling_sd_rad: None,
                transmission: TransmissionKind::Capstan,
                transmission_ratio: ratio,
                drum_distance_m: Some(distance_m),
                input_drum_denominator_m: denominator_m,
                encoder_counts_per_rev: None,
                external_encoder_counts_per_rev: None,
                external_encoder_sd_rad: None,
                torque_scale_sd: 0.03,
                parallelogram_lengths_m: Some([0.18, 0.076, 0.18, 0.076]),
                transmission_error: error,
            },
        )
}

fn any_error() -> impl Strategy<Value = TransmissionError> {
    let capstan = || {
        let xy = |size: f64| [-size..size, -size..size];
        (-0.02..0.02_f64, -0.05..0.05_f64, xy(4e-3), xy(4e-4)).prop_map(
            |(offset_rad, ratio_deviation, output_drum_xy_m, input_drum_xy_m)| CapstanError {
                offset_rad,
                ratio_deviation,
                output_drum_xy_m,
                input_drum_xy_m,
            },
        )
    };
    let deviation = || -2e-3..2e-3_f64;
    prop_oneof![
        Just(TransmissionError::default()),
        capstan().prop_map(TransmissionError::Capstan),
        (
            capstan(),
            [deviation(), deviation(), deviation(), deviation()]
        )
            .prop_map(
                |(capstan, length_deviations_m)| TransmissionError::Parallelogram {
                    capstan,
                    length_deviations_m,
                }
            ),
        (
            -3.0..-1.3_f64,
            1.3..3.0_f64,
            vec(-0.01..0.01_f64, 1..=POLYNOMIAL_TERMS)
        )
            .prop_map(
                |(lower, upper, coefficients)| TransmissionError::Chebyshev {
                    range_rad: [lower, upper],
                    coefficients,
                }
            ),
    ]
}
