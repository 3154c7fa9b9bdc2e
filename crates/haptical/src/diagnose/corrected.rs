//! The text of corrected.toml: the device with the causes.

use haptical_diagnosis::{ChannelGap, Diagnosis, Verdict};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_model::{Device as Model, stiffness_key};

use crate::device::Device;
use crate::error::Error;
use crate::files::{DIAGNOSIS_FILES, without_comments};
use crate::log::Log;
use crate::reproduced::{Left, comments};

/// What the device with the causes leaves of each channel, read again and replayed on the log of its fit; none without such a device.
///
/// # Errors
/// Why it does not hold its own fit.
pub(super) fn reproduced(
    device: &Device,
    log: &Log,
    diagnosis: &Diagnosis,
) -> Result<Option<Vec<(String, f64)>>, String> {
    let has = |channel: &str, row: usize| diagnosis.fit_rows.has(channel, row);
    let text = text(device, diagnosis).map_err(|error| error.to_string())?;
    let left = left(diagnosis);
    let of_text =
        |text: String| crate::reproduced::reproduced(&text, DIAGNOSIS_FILES[3], log, &left, &has);
    text.map(of_text).transpose()
}

/// Says in the answer what the device with the causes leaves of each channel; without such a device where it does not hold its fit.
pub(super) fn tell(
    diagnosis: &mut Diagnosis,
    reproduced: Result<Option<Vec<(String, f64)>>, String>,
) {
    match reproduced {
        Ok(left) => tell_left(diagnosis, left.into_iter().flatten()),
        Err(why) => {
            diagnosis.corrected = None;
            let warning = format!("{} is not written: {why}", DIAGNOSIS_FILES[3]);
            diagnosis.warnings.insert(0, warning);
        }
    }
}

/// Says what a file leaves of channels.
pub(super) fn tell_left(diagnosis: &mut Diagnosis, left: impl IntoIterator<Item = (String, f64)>) {
    for (name, rms) in left {
        let mut channels = diagnosis.gap.channels.iter_mut();
        let own = channels.find(|own| own.channel == name);
        own.into_iter().for_each(|own| own.rms_fit = Some(rms));
    }
}

/// What the fit leaves of each channel, on all rows that it used.
fn left(diagnosis: &Diagnosis) -> Vec<Left> {
    let of_channel = |gap: &ChannelGap| {
        Some(Left {
            channel: gap.channel.clone(),
            unit: gap.unit.clone(),
            rms: gap.rms_fit?,
            held_out: gap.held_out.then_some(gap.rms_after),
            noise_floor: gap.noise_floor,
        })
    };
    let channels = diagnosis.gap.channels.iter();
    channels.filter_map(of_channel).collect()
}

/// The text of corrected.toml, which says what its fit leaves and what it does not hold.
///
/// # Errors
/// As [`text`].
pub(super) fn commented(device: &Device, diagnosis: &Diagnosis) -> Result<Option<String>, Error> {
    let comments = comments(&left(diagnosis), &diagnosis.not_in_file);
    Ok(text(device, diagnosis)?.map(|text| comments + &text))
}

/// The device file with geometry and drives refitted together with the causes, and a table `[[effect]]` for each of them, or
/// for the correction; none where no cause is named that is part of a device, and no correction found.
pub(super) fn text(device: &Device, diagnosis: &Diagnosis) -> Result<Option<String>, Error> {
    let Some(corrected) = &diagnosis.corrected else {
        return Ok(None);
    };
    let source = device.source();
    let marked = yielding(&device.model, corrected, diagnosis);
    let text = without_comments(device.to_toml()).to_owned() + &marked;
    let written = corrected.to_toml(&text, &source.label);
    let written = written.map_err(|error| Error::device_file(&error, &source.path))?;
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
        let asked = device.surroundings.compliance.get(joint);
        if device.compliance_rad_per_nm(joint) != 0.0
            || corrected.compliance_rad_per_nm(joint) <= 0.0
            || asked.is_some_and(|own| own.fit)
        {
            continue;
        }
        let number = joint + 1;
        let name = JOINT_COMPLIANCE.name;
        let mut causes = diagnosis.causes.iter();
        let cause = causes.find(|own| own.effect == name && own.joint == Some(number));
        let name_in_answer = JOINT_COMPLIANCE.parameters[0].name;
        let key = stiffness_key(corrected.joints[joint].joint_type);
        let interval = cause.and_then(|cause| cause.parameters.get(name_in_answer));
        let interval = interval.map_or_else(String::new, |answer| {
            let [low, high] = answer.ci95;
            format!("ci95 = {{ {key} = [{low:?}, {high:?}] }}\n")
        });
        let names = cause.map_or(&[][..], |cause| &cause.confusable_with);
        let confusable = match names {
            [] => String::new(),
            names => format!("confusable_with = {names:?}\n"),
        };
        tables.push_str(&format!(
            "\n[[effect]]\nname = \"{name}\"\njoint = {number}\n{key} = 1.0\n{interval}{confusable}fit = true\n"
        ));
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::named;
    use haptical_model::JointCompliance;

    /// The stiffness of a joint that slides has another unit in its name.
    #[test]
    fn joints_of_every_kind_that_were_found_to_yield_are_read_again() {
        let joint = |kind: &str| format!("[[joint]]\ntype = \"{kind}\"\n");
        let text = joint("revolute") + &joint("prismatic");
        let before = Model::from_toml(&text, "two.toml").unwrap().device;
        let mut corrected = before.clone();
        corrected.surroundings.compliance = [2e-3, 4e-6]
            .map(|rad_per_nm| JointCompliance {
                rad_per_nm,
                fit: true,
            })
            .to_vec();
        let text = text + &yielding(&before, &corrected, &named());
        let text = corrected.to_toml(&text, "two.toml").unwrap();
        let again = Model::from_toml(&text, "again.toml").unwrap().device;
        for joint in 0..2 {
            let relative =
                again.compliance_rad_per_nm(joint) / corrected.compliance_rad_per_nm(joint);
            assert!((relative - 1.0).abs() < 1e-12, "joint {joint}: {relative}");
        }
    }
}
