//! Fixtures, poses of devices, and gaps between poses.

use std::path::Path;

use haptical_model::kinematics::{Parameter, Pose};
use haptical_model::{Device, Evaluation};

/// Two ways to the same pose, some thirty transforms of lengths up to 1 m: rounding with a factor of ten.
pub(crate) const ROUNDING: f64 = 1e-13;

/// A file of fixtures/urdf; none where they were not shipped, said on standard output.
pub(crate) fn fixture(name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/urdf")
        .join(name);
    if !path.exists() {
        println!("skipped: {name} is not here, as in a packaged crate");
        return None;
    }
    Some(std::fs::read_to_string(path).unwrap())
}

/// Handle pose at readings.
pub(crate) fn pose(device: &Device, readings: &[f64]) -> Pose {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_to(readings).unwrap();
    *evaluation.pose().unwrap()
}

/// Largest gap of two poses, in m and as an entry of a rotation; a NaN is infinite.
pub(crate) fn gap(left: &Pose, right: &Pose) -> f64 {
    let gap = (left.position_m - right.position_m)
        .amax()
        .max((left.rotation - right.rotation).amax());
    let all = left.position_m.sum() + left.rotation.sum() + right.position_m.sum();
    if all.is_finite() { gap } else { f64::INFINITY }
}

/// Every number of every row moved, the base's too, as a calibration does and more.
pub(crate) fn calibrated(nominal: &Device, deviations: &[f64]) -> Device {
    let mut device = nominal.clone();
    let mut next = deviations.iter().cycle();
    for link in &mut device.links {
        for parameter in Parameter::ALL {
            link.set(parameter, *next.next().unwrap());
        }
    }
    device
}
