//! Calibrated origins of a URDF's joints as parameters of a xacro, in the form of ur_description's
//! `default_kinematics.yaml`.

use std::fmt::Write;

use haptical_model::Device;
use haptical_model::kinematics::Pose;

use crate::UrdfError;
use crate::chain::gaps::Correction;
use crate::chain::path::BaseAndTip;
use crate::device::ReadChain;
use crate::numbers::{commented, written};
use crate::rigid::to_rpy;
use crate::write::corrected::all_corrections;
use crate::write::not_carried::beside_origins;

/// The origins of the calibrated joints, and of the last fixed one behind them, as a YAML table, and what it leaves out.
///
/// Each entry has the name of the joint's child link without `_link` (ur_description: `shoulder`, `upper_arm`, `forearm`,
/// `wrist_1`, ...) and the six numbers of `<origin>` in the parent link's frame: `x`, `y`, `z` in m, `roll`, `pitch`, `yaw`
/// in rad. `hash` says which calibration it is.
///
/// ```
/// use haptical_urdf::{BaseAndTip, device_from_urdf, kinematics_yaml};
/// let text = r#"<robot name="lever">
///   <link name="base"/> <link name="arm_link"/> <link name="tool"/>
///   <joint name="shoulder" type="continuous">
///     <parent link="base"/> <child link="arm_link"/> <axis xyz="0 0 1"/>
///   </joint>
///   <joint name="flange" type="fixed">
///     <origin xyz="0.1 0 0"/> <parent link="arm_link"/> <child link="tool"/>
///   </joint>
/// </robot>"#;
/// let mut lever = device_from_urdf(text, "lever.urdf", BaseAndTip::to("tool"))?.device;
/// lever.links[1].d_m = 0.002; // behind the joint, along its axis
/// let (yaml, _) = kinematics_yaml(text, "lever.urdf", BaseAndTip::to("tool"), &lever, "calib_1")?;
/// assert!(yaml.contains("  tool:\n    x: 0.1\n    y: 0.0\n    z: 0.002\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`corrected_urdf`](crate::corrected_urdf).
pub fn kinematics_yaml(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
    device: &Device,
    hash: &str,
) -> Result<(String, Vec<String>), UrdfError> {
    let read = ReadChain::of_urdf(text, file, ends)?;
    let corrections = all_corrections(&read, device, (file, "URDF"))?;
    let mut warnings = read.warnings.clone();
    let mut yaml = format!(
        "# Calibrated origins of {}: m and rad, in the frame of each joint's parent link\nkinematics:\n",
        commented(&device.name)
    );
    for (_, correction) in corrections {
        match correction {
            Correction::Joint(joint, origin) => {
                let own = &read.robot.joints[joint];
                let child = &read.robot.links[own.child].name;
                let key = child.strip_suffix("_link").unwrap_or(child);
                entry(&mut yaml, key, &own.name, &origin);
            }
            Correction::Base(_) | Correction::Tip(_) => warnings.push(format!(
                "{file}: nothing fixed takes up the place of {}, which is left out of the table; --format urdf adds a link \
                 for it",
                match correction {
                    Correction::Base(_) => "the base",
                    _ => "the handle",
                }
            )),
        }
    }
    let _ = writeln!(yaml, "  hash: {}", quoted(hash));
    for own in beside_origins(device) {
        let _ = writeln!(yaml, "# {}", commented(&own));
        warnings.push(own);
    }
    Ok((yaml, warnings))
}

fn entry(yaml: &mut String, key: &str, joint: &str, origin: &Pose) {
    let _ = writeln!(
        yaml,
        "  # origin of joint {}\n  {}:",
        commented(joint),
        quoted(key)
    );
    let [x, y, z]: [f64; 3] = origin.position_m.into();
    let [roll, pitch, yaw] = to_rpy(&origin.rotation);
    for (name, value) in [
        ("x", x),
        ("y", y),
        ("z", z),
        ("roll", roll),
        ("pitch", pitch),
        ("yaw", yaw),
    ] {
        let _ = writeln!(yaml, "    {name}: {}", float(value));
    }
}

/// A number that YAML 1.1 reads as one: with a point, also before an exponent.
fn float(value: f64) -> String {
    let word = written(&[value]);
    match word.split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0e{exponent}"),
        Some(_) => word,
        None if word.contains('.') => word,
        None => format!("{word}.0"),
    }
}

/// A key that is no word of YAML's own.
fn quoted(text: &str) -> String {
    let is_plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && !["y", "n", "yes", "no", "on", "off", "true", "false", "null"]
            .contains(&text.to_ascii_lowercase().as_str());
    match is_plain {
        true => text.to_owned(),
        false => {
            let inner: String = text.chars().filter(|c| !c.is_control()).collect();
            format!("\"{}\"", inner.replace('\\', "\\\\").replace('"', "\\\""))
        }
    }
}
