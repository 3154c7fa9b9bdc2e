//! A comment with what MuJoCo has no means for, and Python that adds what can be added to readings.

use std::fmt::Write;

use haptical_model::{Device, DeviceEffect};

use crate::numbers::{commented, written};

/// The comment at the end of the file; empty where everything is carried. `outs` says which joints have an external encoder
/// in it.
pub(crate) fn comment(device: &Device, left_out: &[&DeviceEffect], outs: &[bool]) -> String {
    if left_out.is_empty() {
        return String::new();
    }
    let mut text = String::from("  <!-- Not in this model, because MuJoCo has no means for it:\n");
    for effect in left_out {
        let _ = writeln!(text, "       {}", commented(&described(effect)));
    }
    text.push_str(
        "       The program that runs the model can add what is only in readings, in Python:\n\nimport numpy as np\n\n\
         def haptical_readings(model, data):\n    \"\"\"Readings by the names of the sensors, with what the model lacks.\"\"\"\n    \
         r = {model.sensor(i).name: data.sensor(i).data.copy() for i in range(model.nsensor)}\n",
    );
    for effect in left_out {
        let line = added(device, effect, outs).unwrap_or_else(|| {
            format!(
                "# {}: add its law here (docs/diagnosis.md of Haptical, Catalogue)",
                described(effect)
            )
        });
        let _ = writeln!(text, "    {}", commented(&line));
    }
    text.push_str("    return r\n  -->\n");
    text
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
    let wave = |periods: f64| {
        let (amplitude, phase) = (value("amplitude_rad")?, value("phase_rad")?);
        Some(format!(
            "{amplitude} * np.cos({} * {theta} - {phase})",
            written(&[periods])
        ))
    };
    let has_out = outs.get(own).copied().unwrap_or(false);
    Some(match effect.name.as_str() {
        "drum-eccentricity" => format!("{theta} -= {}", wave(1.0)?),
        "drum-out-of-round" => format!("{theta} -= {}", wave(2.0)?),
        "input-drum-harmonic" => {
            let order = effect.numbers.get("order")?;
            format!("{theta} -= {}", wave(order * joint.transmission_ratio)?)
        }
        "cable-pitch" => {
            let cubic = value("cubic_per_rad2").unwrap_or_else(|| "0".to_owned());
            let square = value("quadratic_per_rad")?;
            format!("{theta} -= {square} * {theta} ** 2 + {cubic} * {theta} ** 3")
        }
        "viscous-lag" => format!(
            "{theta} += {} * r[\"theta{number}_{unit}_per_s\"]",
            value("delay_s")?
        ),
        "joint-drift" => format!("{theta} -= {} * data.time", value("rad_per_s")?),
        "external-encoder-drift" if has_out => {
            format!("{out} += {} * data.time", value("rad_per_s")?)
        }
        "external-encoder-eccentricity" if has_out => format!("{out} += {}", wave(1.0)?),
        _ => return None,
    })
}
