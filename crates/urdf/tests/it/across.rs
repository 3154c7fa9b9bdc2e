//! Chains between any two links: poses against products over the tree, corrected files, gravity in the base's frame.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Isometry3;
use haptical_model::{Device, Statics};
use haptical_urdf::{BaseAndTip, UrdfDevice, UrdfError, corrected_urdf, device_from_urdf};
use proptest::prelude::*;

use crate::support::{calibrated, gap, pose};
use crate::trees::{Part, as_pose, placed, text, tree};

/// What was asked for of poses, in m and as an entry of a rotation: a product of twenty transforms by another way.
const SAME: f64 = 1e-12;
/// What was asked for of a corrected file is 1e-9; rounding is left of it.
const RELOADED: f64 = 1e-12;

/// All pairs of links with a moving joint between them, and their devices.
fn across(parts: &[Part], text: &str) -> Vec<([usize; 2], UrdfDevice)> {
    let links = 0..=parts.len();
    let pairs = links
        .clone()
        .flat_map(|base| links.clone().map(move |tip| [base, tip]));
    let read = pairs.filter_map(|ends| {
        let [base, tip] = ends.map(|link| format!("l{link}"));
        match device_from_urdf(text, "tree.urdf", BaseAndTip::between(&base, &tip)) {
            Ok(read) => Some((ends, read)),
            Err(UrdfError::SameLink { .. }) => {
                assert_eq!(base, tip);
                None
            }
            Err(UrdfError::Unmoved { .. }) => {
                assert!(!moves_between(parts, ends), "{base} {tip}\n{text}");
                None
            }
            Err(other) => panic!("{other}\n{text}"),
        }
    });
    read.collect()
}

/// Whether a joint between two links moves: on the one's way to the root alone.
fn moves_between(parts: &[Part], ends: [usize; 2]) -> bool {
    let above = ends.map(|mut link| {
        let mut joints = Vec::new();
        while link > 0 {
            joints.push(link - 1);
            link = parts[link - 1].parent;
        }
        joints
    });
    (0..parts.len()).any(|joint| {
        above[0].contains(&joint) != above[1].contains(&joint) && parts[joint].kind != "fixed"
    })
}

/// The tip in the base's frame at a device's readings.
fn expected(parts: &[Part], [base, tip]: [usize; 2], device: &Device, readings: &[f64]) -> Pose {
    let value = |name: &str| {
        let own = device.joints.iter().position(|joint| joint.name == name);
        // above both ends a joint's value is of no consequence
        own.map_or(0.37, |own| readings[own])
    };
    let [base, tip]: [Isometry3<f64>; 2] = [base, tip].map(|link| placed(parts, link, &value));
    as_pose(&(base.inverse() * tip))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn poses_are_those_of_the_tree(parts in tree(), values in prop::array::uniform9(-2.0..2.0_f64)) {
        let text = text(&parts);
        for (ends, read) in across(&parts, &text) {
            prop_assert_eq!([&read.base, &read.tip], [&format!("l{}", ends[0]), &format!("l{}", ends[1])]);
            let readings = &values[..read.device.joints.len()];
            let gap = gap(&pose(&read.device, readings), &expected(&parts, ends, &read.device, readings));
            prop_assert!(gap < SAME, "{ends:?} {gap:e}\n{text}");
        }
    }

    /// Rows that are passed upwards, downwards, and both: a corrected file moves as the device, and so does what is
    /// corrected once more.
    #[test]
    fn corrected_files_move_as_the_device(
        parts in tree(),
        deviations in prop::collection::vec(-0.05..0.05_f64, 41),
        values in prop::array::uniform9(-2.0..2.0_f64),
    ) {
        let text = text(&parts);
        for (ends, read) in across(&parts, &text) {
            let device = calibrated(&read.device, &deviations);
            let named = BaseAndTip::between(&read.base, &read.tip);
            let corrected = corrected_urdf(&text, "tree.urdf", named, &device).unwrap();
            let named = BaseAndTip::between(&corrected.base, &corrected.tip);
            let again = device_from_urdf(&corrected.text, "again.urdf", named).unwrap();
            for sign in [1.0, -0.6] {
                let readings: Vec<f64> =
                    values.iter().take(device.joints.len()).map(|value| sign * value).collect();
                let gap = gap(&pose(&device, &readings), &pose(&again.device, &readings));
                prop_assert!(gap < RELOADED, "{ends:?} {gap:e}\n{text}\n{}", corrected.text);
            }
            prop_assert_eq!(&again.device.joints, &device.joints);
            // now there is a fixed joint, or an origin, for everything: no link is added
            let other = calibrated(&again.device, &deviations[7..]);
            let third = corrected_urdf(&corrected.text, "again.urdf", named, &other).unwrap();
            prop_assert_eq!([&third.base, &third.tip], [&corrected.base, &corrected.tip]);
            let third = device_from_urdf(&third.text, "third.urdf", named).unwrap();
            let readings = &values[..device.joints.len()];
            let gap = gap(&pose(&other, readings), &pose(&third.device, readings));
            prop_assert!(gap < RELOADED, "{ends:?} again {gap:e}\n{text}");
        }
    }

    /// A base that is fixed to the root bears the same weights: gravity is turned into its frame.
    #[test]
    fn holding_torques_from_a_fixed_base_are_those_from_the_root(
        mut parts in tree(),
        values in prop::array::uniform9(-2.0..2.0_f64),
    ) {
        parts[0].kind = "fixed";
        parts[0].follows = None;
        // who followed it is its own
        parts.iter_mut().for_each(|part| part.follows = part.follows.filter(|follows| follows.0 != 0));
        let text = weighty(&text(&parts), parts.len());
        for tip in 1..=parts.len() {
            let tip = format!("l{tip}");
            let Ok(from_root) = device_from_urdf(&text, "tree.urdf", BaseAndTip::to(&tip)) else {
                continue;
            };
            let from_base = device_from_urdf(&text, "tree.urdf", BaseAndTip::between("l1", &tip)).unwrap();
            let [of_root, of_base] = [&from_root, &from_base].map(|read| torques_nm(&read.device, &values));
            for (own, other) in of_root.iter().zip(&of_base) {
                // some kilograms at some metres
                prop_assert!((own - other).abs() < 1e-11, "{tip}: {of_root:?} {of_base:?}\n{text}");
            }
            prop_assert_eq!(from_base.device.bodies, from_root.device.bodies);
            prop_assert_eq!(from_base.warnings, from_root.warnings);
        }
    }
}

/// The same text, its links with masses.
fn weighty(text: &str, joints: usize) -> String {
    (0..=joints).fold(text.to_owned(), |text, link| {
        let centre = 0.02 * (link + 1) as f64;
        let inertial = format!(
            "<link name=\"l{link}\"><inertial><origin xyz=\"{centre} -0.05 0.1\"/><mass value=\"{}\"/></inertial></link>",
            0.3 + 0.2 * link as f64
        );
        text.replace(&format!("<link name=\"l{link}\"/>"), &inertial)
    })
}

fn torques_nm(device: &Device, readings: &[f64]) -> Vec<f64> {
    let mut statics = Statics::new(device);
    assert!(statics.has_weights());
    let load = statics.load(&readings[..device.joints.len()], |_| None);
    load.unwrap().torques_nm.to_vec()
}
