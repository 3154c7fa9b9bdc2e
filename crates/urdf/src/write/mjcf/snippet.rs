//! A comment with what MuJoCo has no means for, and Python that adds what can be added to readings.

use std::fmt::Write;

use haptical_effects::{Form, Hook, law};
use haptical_model::{Device, DeviceEffect};

use crate::numbers::{commented, written};

/// Readings by the names of the file's sensors.
pub(crate) const BY_SENSORS: &str =
    "{model.sensor(i).name: data.sensor(i).data.copy() for i in range(model.nsensor)}";

/// Readings by the names of a log, of joints by the names that they have in a file.
pub(crate) fn by_joints(device: &Device, names: &[&str]) -> String {
    let mut readings = String::from("{");
    for (index, (joint, name)) in device.joints.iter().zip(names).enumerate() {
        let (number, unit) = (index + 1, joint.unit());
        let _ = write!(
            readings,
            "\"theta{number}_{unit}\": data.joint({name:?}).qpos[0], \"theta{number}_{unit}_per_s\": \
             data.joint({name:?}).qvel[0], "
        );
    }
    readings.trim_end_matches(", ").to_owned() + "}"
}

/// A joint that a file does not have, and Python that adds what it does to the readings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MissingJoint {
    pub(crate) what: String,
    pub(crate) python: String,
}

/// The comment at the end of the file; empty where everything is carried. `outs` says which joints have an external encoder
/// in it; `readings` is Python for a dictionary of what the file's sensors say.
pub(crate) fn comment(
    device: &Device,
    left_out: &[&DeviceEffect],
    missing: &[MissingJoint],
    outs: &[bool],
    readings: &str,
) -> String {
    if left_out.is_empty() && missing.is_empty() {
        return String::new();
    }
    let mut text = String::from("  <!-- Not in this model");
    if !left_out.is_empty() {
        text.push_str(", because MuJoCo has no means for it:\n");
    }
    for effect in left_out {
        let _ = writeln!(text, "       {}", commented(&described(effect)));
    }
    if !missing.is_empty() {
        let also = if left_out.is_empty() {
            ""
        } else {
            "       Not in it"
        };
        let _ = writeln!(text, "{also}, because the file has no joints for it:");
    }
    for own in missing {
        let _ = writeln!(text, "       {}", commented(&own.what));
    }
    text.push_str(
        "       The program that runs the model can add what is only in readings, in Python:\n\nimport numpy as np\n\n\
         def haptical_readings(model, data):\n    \"\"\"Readings by the names of a log, with what the model lacks.\"\"\"\n",
    );
    let _ = writeln!(text, "    r = {}", commented(readings));
    for effect in left_out {
        let line = added(device, effect, outs).unwrap_or_else(|| {
            format!(
                "# {}: add its law here (docs/diagnosis.md of Haptical, Catalogue)",
                described(effect)
            )
        });
        let _ = writeln!(text, "    {}", commented(&line));
    }
    for own in missing {
        let _ = writeln!(text, "    {}", commented(&own.python));
    }
    text.push_str("    return r\n  -->\n");
    text
}

/// What a command says of an effect that is in the comment.
pub(crate) fn said(effect: &str) -> String {
    format!(
        "`{effect}` is not in the model, because MuJoCo has no means for it: the comment at the file's end has Python for it, or the place for its law"
    )
}

/// `drum-eccentricity@2 (amplitude_rad 0.001, phase_rad 0.2)`.
pub(crate) fn described(effect: &DeviceEffect) -> String {
    let numbers = effect.numbers.iter();
    let numbers: Vec<String> = numbers
        .map(|(key, value)| format!("{key} {}", written(&[*value])))
        .collect();
    match numbers.is_empty() {
        true => effect.label(),
        false => format!("{} ({})", effect.label(), numbers.join(", ")),
    }
}

/// A line of Python that adds an effect to a reading: the motor reads theta where theta + e(theta) is the joint's angle, so
/// the reading is less by e.
fn added(device: &Device, effect: &DeviceEffect, outs: &[bool]) -> Option<String> {
    let own = effect.joint?;
    let joint = device.joints.get(own)?;
    let (number, unit) = (own + 1, joint.unit());
    let (theta, out) = (
        format!("r[\"theta{number}_{unit}\"]"),
        format!("r[\"out{number}_{unit}\"]"),
    );
    let value = |key: &str| Some(written(&[*effect.numbers.get(key)?]));
    let wave = |periods: Option<f64>| {
        let of_motor = || Some(effect.numbers.get("order")? * joint.transmission_ratio);
        let periods = periods.or_else(of_motor)?;
        let (amplitude, phase) = (value("amplitude_rad")?, value("phase_rad")?);
        Some(format!(
            "{amplitude} * np.cos({} * {theta} - {phase})",
            written(&[periods])
        ))
    };
    let has_out = outs.get(own).copied().unwrap_or(false);
    Some(match law(&effect.name)? {
        (Hook::Transmission, Form::Harmonic(periods)) => format!("{theta} -= {}", wave(periods)?),
        (Hook::Transmission, Form::Polynomial) => {
            let cubic = value("cubic_per_rad2").unwrap_or_else(|| "0".to_owned());
            let square = value("quadratic_per_rad")?;
            format!("{theta} -= {square} * {theta} ** 2 + {cubic} * {theta} ** 3")
        }
        (Hook::Transmission, Form::Delay) => format!(
            "{theta} += {} * r[\"theta{number}_{unit}_per_s\"]",
            value("delay_s")?
        ),
        (Hook::Transmission, Form::Drift) => {
            format!("{theta} -= {} * data.time", value("rad_per_s")?)
        }
        (Hook::ExternalEncoder, Form::Drift) if has_out => {
            format!("{out} += {} * data.time", value("rad_per_s")?)
        }
        (Hook::ExternalEncoder, Form::Harmonic(periods)) if has_out => {
            format!("{out} += {}", wave(periods)?)
        }
        _ => return None,
    })
}
