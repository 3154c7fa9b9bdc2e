//! Random chains: forward kinematics against a product written as URDF defines it, derivatives against
//! differences.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{Device, Evaluation, ParameterId};
use haptical_urdf::{BaseAndTip, device_from_urdf};
use proptest::prelude::*;

use crate::support::{ROUNDING, gap, pose};
use crate::trees::{by_definition, chain, text};

/// Step of the differences, in m and rad, and what rounding over it and its fourth power leave.
const STEP: f64 = 1e-3;
const DIFFERENCE: f64 = 1e-9;

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
        let read = device_from_urdf(&text, "random.urdf", BaseAndTip::default()).unwrap();
        let names: Vec<String> = read.device.joints.iter().map(|joint| joint.name.clone()).collect();
        let readings = &values[..names.len()];
        let value = |name: &str| readings[names.iter().position(|own| own == name).unwrap()];
        let gap = gap(&pose(&read.device, readings), &by_definition(&parts, parts.len(), value));
        prop_assert!(gap < ROUNDING, "{gap:e}\n{text}");
    }

    #[test]
    fn derivatives_are_differences(
        parts in chain(),
        deviations in prop::collection::vec(-0.1..0.1_f64, 29),
        values in prop::array::uniform8(-1.0..1.0_f64),
    ) {
        let nominal = device_from_urdf(&text(&parts), "random.urdf", BaseAndTip::default()).unwrap().device;
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
        let nominal = device_from_urdf(&text(&parts), "random.urdf", BaseAndTip::default()).unwrap().device;
        let device = deviated(&nominal, &deviations);
        let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap();
        prop_assert_eq!(again.warnings, Vec::<String>::new());
        prop_assert_eq!(again.device, device);
    }
}
