//! The text of corrected.toml: the device with the causes.

use haptical_diagnosis::{Diagnosis, Verdict};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_model::Device as Model;

use crate::device::Device;
use crate::error::Error;
use crate::files::without_comments;

/// The device file with geometry and drives refitted together with the causes, and a table `[[effect]]` for each of them, or
/// for the correction; none where no cause is named that is part of a device, and no correction found.
pub(super) fn text(device: &Device, diagnosis: &Diagnosis) -> Result<Option<String>, Error> {
    let Some(corrected) = &diagnosis.corrected else {
        return Ok(None);
    };
    let path = &device.source().path;
    let refuse = |error: &_| Error::device_file(error, path);
    let label = &device.source().label;
    let mut text = without_comments(device.to_toml()).to_owned();
    let marked = yielding(&device.model, corrected, diagnosis);
    text.push_str(&marked);
    let written = corrected
        .to_toml(&text, label)
        .map_err(|error| refuse(&error))?;
    let head = match diagnosis.verdict {
        Verdict::Ambiguous => {
            "# The data cannot tell the first cause from others: confusable_with lists them.\n"
        }
        Verdict::Unknown => {
            "# The cause is unknown: `correction` is a curve that was fitted to the gap. It is no cause.\n"
        }
        Verdict::NoGap | Verdict::Named => "",
    };
    Ok(Some(head.to_owned() + &written))
}

/// Tables of the joints that were found to yield: in the file of a device they are effects as the others are. Their
/// stiffness is written with the rest of the device.
fn yielding(device: &Model, corrected: &Model, diagnosis: &Diagnosis) -> String {
    let mut tables = String::new();
    for joint in 0..corrected.joints.len() {
        let is_new = device.compliance_rad_per_nm(joint) == 0.0
            && corrected.compliance_rad_per_nm(joint) > 0.0
            && !device
                .surroundings
                .compliance
                .get(joint)
                .is_some_and(|own| own.fit);
        if !is_new {
            continue;
        }
        let number = joint + 1;
        let is_own = |cause: &&haptical_diagnosis::CauseAnswer| {
            cause.effect == JOINT_COMPLIANCE.name && cause.joint == Some(number)
        };
        let cause = diagnosis.causes.iter().find(is_own);
        let key = JOINT_COMPLIANCE.parameters[0].name;
        let interval = cause.and_then(|cause| cause.parameters.get(key));
        let interval = interval.map_or_else(String::new, |answer| {
            let [low, high] = answer.ci95;
            format!("ci95 = {{ {key} = [{low:?}, {high:?}] }}\n")
        });
        let names = cause.map_or(&[][..], |cause| &cause.confusable_with);
        let confusable = match names {
            [] => String::new(),
            names => format!("confusable_with = {names:?}\n"),
        };
        let name = JOINT_COMPLIANCE.name;
        tables.push_str(&format!(
            "\n[[effect]]\nname = \"{name}\"\njoint = {number}\nstiffness_nm_per_rad = 1.0\n{interval}{confusable}fit = true\n"
        ));
    }
    tables
}
