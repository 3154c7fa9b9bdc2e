//! Random devices, and their device files written by other means than the crate's writer.

use std::fmt::Write;

use haptical_model::kinematics::{Convention, Link};
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, Joint, JointType, ParameterId, TransmissionError, TransmissionKind};
use proptest::prelude::*;

/// Cases per property.
pub(crate) const CASES: u32 = 64;

/// Every parameter of a device, Hayati's included.
pub(crate) fn all_parameters(device: &Device) -> Vec<ParameterId> {
    let transmissions =
        (0..device.joints.len()).flat_map(|joint| device.transmission_parameters(joint));
    device
        .link_parameters(true)
        .into_iter()
        .chain(transmissions)
        .collect()
}

/// Whether a range of a joint's series ends within `step` of a reading: the series goes on as its tangent, so a difference across the
/// end is no derivative.
pub(crate) fn bends_near(device: &Device, joint: usize, reading: f64, step: f64) -> bool {
    match &device.joints[joint].transmission_error {
        TransmissionError::Chebyshev { range_rad, .. } => {
            range_rad.iter().any(|end| (reading - end).abs() < step)
        }
        _ => false,
    }
}

fn link() -> impl Strategy<Value = Link> {
    (
        -0.4..0.4,
        -3.0..3.0,
        -0.4..0.4,
        -3.0..3.0,
        prop_oneof![Just(0.0), -0.3..0.3],
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

fn capstan_error() -> impl Strategy<Value = CapstanError> {
    (
        -0.02..0.02,
        -0.3..0.3,
        [-1e-3..1e-3, -1e-3..1e-3],
        [-1e-4..1e-4, -1e-4..1e-4],
    )
        .prop_map(
            |(offset_rad, ratio_deviation, output_drum_xy_m, input_drum_xy_m)| CapstanError {
                offset_rad,
                ratio_deviation,
                output_drum_xy_m,
                input_drum_xy_m,
            },
        )
}

fn drums() -> impl Strategy<Value = (f64, f64, Option<f64>)> {
    (
        prop_oneof![2.0..15.0, -15.0..-2.0],
        0.05..0.2,
        proptest::option::of(0.003..0.2),
    )
}

/// Each kind of transmission error with the dimensions that it needs.
fn drive() -> impl Strategy<Value = Joint> {
    let capstan =
        (drums(), capstan_error()).prop_map(|((ratio, distance, denominator), error)| Joint {
            transmission: TransmissionKind::Capstan,
            transmission_ratio: ratio,
            drum_distance_m: Some(distance),
            input_drum_denominator_m: denominator,
            transmission_error: TransmissionError::Capstan(error),
            ..Joint::default()
        });
    let direct = capstan_error().prop_map(|error| Joint {
        transmission_error: TransmissionError::Capstan(error),
        ..Joint::default()
    });
    let polynomial = (
        [-1.2..-0.3, 0.3..1.2],
        proptest::collection::vec(-0.02..0.02, 1..12),
    )
        .prop_map(|(range_rad, coefficients)| Joint {
            transmission_error: TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            },
            ..Joint::default()
        });
    let parallelogram = (
        drums(),
        capstan_error(),
        (0.1..0.25, 0.06..0.09),
        prop::array::uniform4(-1e-3..1e-3),
    )
        .prop_map(
            |((ratio, distance, denominator), capstan, bars, deviations)| Joint {
                transmission: TransmissionKind::Parallelogram,
                transmission_ratio: ratio,
                drum_distance_m: Some(distance),
                input_drum_denominator_m: denominator,
                parallelogram_lengths_m: Some([bars.0, bars.1, bars.0, bars.1]),
                transmission_error: TransmissionError::Parallelogram {
                    capstan,
                    length_deviations_m: deviations,
                },
                ..Joint::default()
            },
        );
    prop_oneof![capstan, direct, polynomial, parallelogram]
}

fn joint() -> impl Strategy<Value = Joint> {
    (drive(), any::<bool>(), -2.0..2.0).prop_map(|(drive, prismatic, home_rad)| Joint {
        joint_type: if prismatic {
            JointType::Prismatic
        } else {
            JointType::Revolute
        },
        home_rad,
        ..drive
    })
}

/// A device of one to four joints and readings of it that its transmissions can take.
pub(crate) fn device_and_readings() -> impl Strategy<Value = (Device, Vec<f64>)> {
    (1_usize..5).prop_flat_map(|joints| {
        (
            any::<bool>(),
            proptest::collection::vec(link(), joints + 1),
            proptest::collection::vec(joint(), joints),
            proptest::collection::vec(-0.7..0.7, joints),
        )
            .prop_map(|(modified, links, joints, readings)| {
                let convention = if modified {
                    Convention::Modified
                } else {
                    Convention::Standard
                };
                (Device::new(convention, links, joints), readings)
            })
    })
}

/// The device file of a random device with its transmission errors left out.
pub(crate) fn nominal_text(device: &Device) -> String {
    let convention = match device.convention {
        Convention::Standard => "standard",
        Convention::Modified => "modified",
    };
    let mut text = format!(
        "# kept: head\n[device]\nname = {:?}\nconvention = \"{convention}\"\n",
        device.name
    );
    for (row, link) in device.links.iter().enumerate() {
        let _ = write!(
            text,
            "\n# kept: row {row}\n[[link]]\n# kept: above a of {row}\na_m = {:?} # kept: behind a of {row}\n\
             alpha_rad = {:?}\nd_m = {:?}\ntheta_offset_rad = {:?}\nnot_ours = {row}\n",
            link.a_m, link.alpha_rad, link.d_m, link.theta_rad
        );
    }
    for (index, joint) in device.joints.iter().enumerate() {
        let (joint_type, transmission) = (
            match joint.joint_type {
                JointType::Revolute => "revolute",
                JointType::Prismatic => "prismatic",
            },
            match joint.transmission {
                TransmissionKind::Capstan => "capstan",
                TransmissionKind::Parallelogram => "parallelogram",
                TransmissionKind::Direct => "direct",
            },
        );
        let _ = write!(
            text,
            "\n# kept: joint {index}\n[[joint]]\ntype = \"{joint_type}\"\nhome_rad = {:?}\n\
             transmission = \"{transmission}\" # kept: drive of {index}\ntransmission_ratio = {:?}\n",
            joint.home_rad, joint.transmission_ratio
        );
        for (key, length) in [
            ("drum_distance_m", joint.drum_distance_m),
            ("input_drum_denominator_m", joint.input_drum_denominator_m),
        ] {
            if let Some(length) = length {
                let _ = writeln!(text, "{key} = {length:?}");
            }
        }
        if let Some(lengths) = joint.parallelogram_lengths_m {
            let _ = writeln!(text, "parallelogram_lengths_m = {lengths:?}");
        }
    }
    text.push_str("\n# kept: foot\n[workshop]\ninventory = 12\n");
    text
}
