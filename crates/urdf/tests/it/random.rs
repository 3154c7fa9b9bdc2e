//! Random chains: forward kinematics against a product written as URDF defines it, derivatives against
//! differences.

use std::fmt::Write;

use haptical_model::kinematics::nalgebra::{
    Isometry3, Translation3, Unit, UnitQuaternion, Vector3,
};
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{Device, Evaluation, ParameterId};
use haptical_urdf::device_from_urdf;
use proptest::prelude::*;

use crate::support::{ROUNDING, gap, pose};

/// Step of the differences, in m and rad, and what rounding over it and its fourth power leave.
const STEP: f64 = 1e-3;
const DIFFERENCE: f64 = 1e-9;

/// One joint of a chain.
#[derive(Debug, Clone)]
struct Part {
    kind: &'static str,
    xyz: [f64; 3],
    rpy: [f64; 3],
    axis: [f64; 3],
    /// Follows the moving joint of this number, where that is another one that follows none.
    follows: Option<(usize, f64, f64)>,
}

fn part() -> impl Strategy<Value = Part> {
    let kind = prop::sample::select(vec![
        "fixed",
        "revolute",
        "continuous",
        "prismatic",
        "revolute",
    ]);
    let axis = prop_oneof![
        prop::sample::select(vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, -1.0],
        ]),
        prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |axis| {
            axis.iter().map(|part| part * part).sum::<f64>() > 0.01
        }),
    ];
    let place = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-0.5..0.5_f64)];
    let turn = prop_oneof![
        Just([0.0; 3]),
        Just([0.0, std::f64::consts::FRAC_PI_2, 0.3]),
        prop::array::uniform3(-3.2..3.2_f64),
    ];
    let follows = prop_oneof![
        3 => Just(None),
        1 => (0..6_usize, prop_oneof![-2.0..-0.2, 0.2..2.0], -0.5..0.5).prop_map(Some),
    ];
    (kind, place, turn, axis, follows).prop_map(|(kind, xyz, rpy, axis, follows)| Part {
        kind,
        xyz,
        rpy,
        axis,
        follows,
    })
}

/// A chain with at least one joint that moves, and who follows whom resolved.
fn chain() -> impl Strategy<Value = Vec<Part>> {
    prop::collection::vec(part(), 1..9).prop_map(|mut parts| {
        if parts.iter().all(|part| part.kind == "fixed") {
            parts[0].kind = "revolute";
        }
        let moving: Vec<usize> = (0..parts.len())
            .filter(|part| parts[*part].kind != "fixed")
            .collect();
        // the first free one is free, so that there is a joint of its own
        parts[moving[0]].follows = None;
        for part in 0..parts.len() {
            if let Some((which, _, _)) = parts[part].follows {
                let source = moving[which % moving.len()];
                if source == part || parts[source].follows.is_some() {
                    parts[part].follows = None;
                }
            }
        }
        let resolved: Vec<usize> = moving.clone();
        for part in &mut parts {
            if let Some((which, _, _)) = &mut part.follows {
                *which = resolved[*which % resolved.len()];
            }
        }
        parts
    })
}

fn text(parts: &[Part]) -> String {
    let mut text = "<robot name=\"random\">\n<link name=\"l0\"/>\n".to_owned();
    for (index, part) in parts.iter().enumerate() {
        let vector = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
        let _ = write!(
            text,
            "<link name=\"l{}\"/>\n<joint name=\"j{index}\" type=\"{}\">\n<origin xyz=\"{}\" rpy=\"{}\"/>\n\
             <parent link=\"l{index}\"/><child link=\"l{}\"/><axis xyz=\"{}\"/>",
            index + 1,
            part.kind,
            vector(part.xyz),
            vector(part.rpy),
            index + 1,
            vector(part.axis)
        );
        if let Some((source, multiplier, offset)) = part.follows {
            let _ = write!(
                text,
                "<mimic joint=\"j{source}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>"
            );
        }
        text.push_str("</joint>\n");
    }
    text + "</robot>"
}

/// The tip as URDF defines it, by quaternions: T(xyz) R(rpy) then a turn about or a slide along the axis.
fn by_definition(parts: &[Part], value: impl Fn(&str) -> f64) -> Pose {
    let mut product = Isometry3::identity();
    for (index, part) in parts.iter().enumerate() {
        let [roll, pitch, yaw] = part.rpy;
        let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        product *= Isometry3::from_parts(Translation3::from(Vector3::from(part.xyz)), turn);
        let own = match part.follows {
            Some((source, multiplier, offset)) => {
                multiplier * value(&format!("j{source}")) + offset
            }
            None if part.kind == "fixed" => 0.0,
            None => value(&format!("j{index}")),
        };
        let axis = Unit::new_normalize(Vector3::from(part.axis));
        match part.kind {
            "fixed" => {}
            "prismatic" => product *= Translation3::from(axis.into_inner() * own),
            _ => product *= UnitQuaternion::from_axis_angle(&axis, own),
        }
    }
    Pose {
        position_m: product.translation.vector,
        rotation: product.rotation.to_rotation_matrix().into_inner(),
    }
}

fn five_point(pose: impl Fn(f64) -> Pose) -> Twist {
    let at = [-2.0, -1.0, 1.0, 2.0].map(|steps| pose(steps * STEP));
    let weights = [1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0];
    let mut linear = Vector3::zeros();
    let mut rate = haptical_model::kinematics::nalgebra::Matrix3::zeros();
    for (pose, weight) in at.iter().zip(weights) {
        linear += pose.position_m * (weight / STEP);
        rate += pose.rotation * (weight / STEP);
    }
    // dR = [w]x R dx
    let spin = rate * pose(0.0).rotation.transpose();
    Twist {
        linear,
        angular: Vector3::new(
            spin.m32 - spin.m23,
            spin.m13 - spin.m31,
            spin.m21 - spin.m12,
        ) / 2.0,
    }
}

fn check(found: &Twist, expected: &Twist) -> bool {
    (found.linear - expected.linear).amax() < DIFFERENCE
        && (found.angular - expected.angular).amax() < DIFFERENCE
}

/// A device with small numbers in all rows, and an error in every transmission.
fn deviated(nominal: &Device, deviations: &[f64]) -> Device {
    let mut device = nominal.clone();
    let mut next = deviations.iter().cycle();
    for parameter in nominal.link_parameters(false) {
        parameter.set(&mut device, *next.next().unwrap());
    }
    for joint in 0..device.joints.len() {
        for parameter in nominal.transmission_parameters(joint) {
            parameter.set(&mut device, 0.3 * *next.next().unwrap());
        }
    }
    device
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn poses_are_the_product_that_urdf_defines(parts in chain(), values in prop::array::uniform8(-2.0..2.0_f64)) {
        let text = text(&parts);
        let read = device_from_urdf(&text, "random.urdf", None).unwrap();
        let names: Vec<String> = read.device.joints.iter().map(|joint| joint.name.clone()).collect();
        let readings = &values[..names.len()];
        let value = |name: &str| readings[names.iter().position(|own| own == name).unwrap()];
        let gap = gap(&pose(&read.device, readings), &by_definition(&parts, value));
        prop_assert!(gap < ROUNDING, "{gap:e}\n{text}");
    }

    #[test]
    fn derivatives_are_differences(
        parts in chain(),
        deviations in prop::collection::vec(-0.1..0.1_f64, 29),
        values in prop::array::uniform8(-1.0..1.0_f64),
    ) {
        let nominal = device_from_urdf(&text(&parts), "random.urdf", None).unwrap().device;
        let device = deviated(&nominal, &deviations);
        let readings = &values[..device.joints.len()];
        let mut evaluation = Evaluation::new(&device);
        evaluation.move_to(readings).unwrap();
        let transmissions = (0..device.joints.len()).flat_map(|joint| device.transmission_parameters(joint));
        let all: Vec<ParameterId> = device.link_parameters(false).into_iter().chain(transmissions).collect();
        prop_assert!(all.len() >= 12 + 6);
        for parameter in all {
            let at = |step: f64| {
                let mut moved = device.clone();
                parameter.set(&mut moved, parameter.value(&device) + step);
                pose(&moved, readings)
            };
            let found = evaluation.pose_derivative(parameter);
            prop_assert!(check(&found, &five_point(at)), "{} {found:?}", parameter.key(&device));
        }
        for joint in 0..device.joints.len() {
            let at = |step: f64| {
                let mut moved = readings.to_vec();
                moved[joint] += step;
                pose(&device, &moved)
            };
            prop_assert!(check(&evaluation.reading_twist(joint), &five_point(at)), "reading {joint}");
        }
    }

    #[test]
    fn device_files_come_back(parts in chain(), deviations in prop::collection::vec(-0.1..0.1_f64, 29)) {
        let nominal = device_from_urdf(&text(&parts), "random.urdf", None).unwrap().device;
        let device = deviated(&nominal, &deviations);
        let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
        prop_assert_eq!(again.warnings, Vec::<String>::new());
        prop_assert_eq!(again.device, device);
    }
}
