//! The whole calibration in one fit: what step 1 and step 2 recorded, merged, transmissions and rows together.

use anyhow::Result;
use haptical_calibration::{CalibrationMethod, Options, fit_device};
use haptical_model::{Device, Recording};

/// One recording of the rows of several, without what only single ones have.
///
/// A cell that a row's recording does not have is NaN: an absent reading.
fn merged(recordings: &[&Recording], joints: usize) -> Recording {
    let gather = |of: &dyn Fn(&Recording) -> Option<&Vec<f64>>| -> Vec<f64> {
        let parts = recordings.iter();
        let parts = parts.map(|part| of(part).map_or(vec![f64::NAN; part.len()], Clone::clone));
        parts.collect::<Vec<_>>().concat()
    };
    let joint: Vec<Vec<f64>> = (0..joints)
        .map(|index| gather(&|part| part.joint.get(index)))
        .collect();
    let rows = joint.first().map_or(0, Vec::len);
    Recording {
        line: (1..=rows as u64).collect(),
        output: (0..joints)
            .map(|index| Some(gather(&|part| part.output.get(index)?.as_ref())))
            .collect(),
        cable_m: vec![Some(gather(&|part| part.cable_m.first()?.as_ref()))],
        torque_nm: vec![None; joints],
        joint,
        ..Recording::default()
    }
}

/// The device that fits step 1's recordings and step 2's at once.
pub(super) fn fit_at_once(
    nominal: &Device,
    step_one: &[Recording],
    step_two: &Recording,
    options: &Options,
) -> Result<Device> {
    let all: Vec<&Recording> = step_one.iter().chain([step_two]).collect();
    let options = Options {
        method: CalibrationMethod::Joint,
        ..options.clone()
    };
    let recording = merged(&all, nominal.joints.len());
    Ok(fit_device(nominal, &recording, &options)?.device)
}
