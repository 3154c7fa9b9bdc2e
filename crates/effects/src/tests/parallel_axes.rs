//! The axes of a wobble where two joints' axes are parallel.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, DeviceChain};

use super::assert_is_felt;
use super::rig::{context, seven_joints};
use crate::catalogue;
use crate::structure::axis_wobble::across;

/// The joint whose axis is made parallel to the one before.
const JOINT: usize = 2;

fn rotation(device: &Device, outputs: &[f64]) -> Matrix3<f64> {
    DeviceChain::new(device).pose(outputs).unwrap().rotation
}

/// Of two parallel axes the directions are x and y of the frame between them: what changes of that row's alpha and beta
/// turn the handle about.
#[test]
fn parallel_axes_have_directions_of_the_link_between() {
    let mut rig = seven_joints();
    (
        rig.device.links[JOINT].alpha_rad,
        rig.device.links[JOINT].a_m,
    ) = (0.0, 0.12);
    let context = context(&rig.device, &rig.recording);
    for row in [0, 100, 500] {
        let outputs: Vec<f64> = context.output.iter().map(|output| output[row]).collect();
        let own = across(&context, JOINT, row).unwrap();
        for (index, direction) in own.iter().enumerate() {
            let turned = |by: f64| {
                let mut device = rig.device.clone();
                let link = &mut device.links[JOINT];
                *[&mut link.alpha_rad, &mut link.beta_rad][index] += by;
                rotation(&device, &outputs)
            };
            let step = 1e-5;
            let rate = (turned(step) - turned(-step)) / (2.0 * step);
            let skew = rate * rotation(&rig.device, &outputs).transpose();
            let expected = Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]);
            assert!(
                (direction - expected).norm() < 1e-8,
                "{direction} {expected}"
            );
        }
    }
    let wobble = catalogue(&rig.device)
        .into_iter()
        .find(|effect| effect.name() == "axis-wobble" && effect.joint() == Some(JOINT));
    assert_is_felt(wobble.unwrap().as_ref(), &context);
}

/// Where the two axes are one there is nothing to tilt about.
#[test]
fn one_axis_has_none() {
    let mut rig = seven_joints();
    (
        rig.device.links[JOINT].alpha_rad,
        rig.device.links[JOINT].a_m,
    ) = (0.0, 0.0);
    let context = context(&rig.device, &rig.recording);
    assert!(across(&context, JOINT, 0).is_none());
}
