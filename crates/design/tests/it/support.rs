//! Devices and plans that several tests share.

use haptical_design::{Equipped, Information, Limits, Posture, Rig, Terms, equip, postures};
use haptical_model::{Device, ParameterId};

/// Three joints without any special angle, measured from frame (-1).
pub(crate) fn arm() -> Device {
    let rows = [
        (0.2, 0.7, 0.1),
        (0.25, -1.1, 0.05),
        (0.2, 0.9, -0.04),
        (0.15, 0.4, 0.08),
    ];
    let joint = "lower_rad = -1.2\nupper_rad = 1.0\nexternal_encoder_sd_rad = 1e-4";
    haptical_testkit::arm(
        &rows,
        &[joint; 3],
        "[cable_encoder]\ndistance_sd_m = 1e-5\n",
    )
}

pub(crate) fn rig(device: &Device, text: &str, terms: Terms) -> Equipped {
    equip(device, &Rig::parse(text).unwrap(), terms).unwrap()
}

pub(crate) fn plan(
    device: &Device,
    text: &str,
    terms: Terms,
    count: usize,
) -> (Information, Vec<Posture>) {
    let mut equipped = rig(device, text, terms);
    let poses = postures(&mut equipped, &Limits::default(), count, 3).unwrap();
    (Information::new(&equipped, &poses, &[]).unwrap(), poses)
}

pub(crate) fn names(information: &Information, parameters: &[usize]) -> Vec<String> {
    let name = |&index: &usize| information.infos[index].name.clone();
    parameters.iter().map(name).collect()
}

pub(crate) fn is_link(parameter: ParameterId) -> bool {
    matches!(parameter, ParameterId::Link { .. })
}
