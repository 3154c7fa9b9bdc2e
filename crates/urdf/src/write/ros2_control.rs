//! A ROS 2 `ros2_control` block of a device: offsets and reductions of its drives as transmissions.

use std::fmt::Write;

use haptical_model::{Device, Joint, JointType, TransmissionError};

use crate::numbers::{commented, escaped, rounded, written};
use crate::write::effects::{AHEAD, FITTED_BESIDE, has_own_row, is_ahead};
use crate::write::names::{joint_names, said_of_renamed};
use crate::write::not_carried::of_dynamics;

/// Readings over which the line through a drive's error is drawn (assumption A213).
const SAMPLES: usize = 401;
/// Range of a joint without limits \[rad\], \[m\] (assumption A213).
const UNLIMITED: [f64; 2] = [-std::f64::consts::PI, std::f64::consts::PI];
/// What a line leaves that is worth a word \[rad\], \[m\].
const WORTH_SAYING: f64 = 1e-6;

/// The line through a drive's error: `joint = offset + (1 + slope) reading`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    offset: f64,
    slope: f64,
    /// The most that it leaves over the range.
    left: f64,
}

/// A xacro macro with a `<ros2_control>` block of a device, and what it leaves out.
///
/// Each joint with a row of its own has a position command, the states position and velocity, and a
/// `transmission_interface/SimpleTransmission`, whose law is `joint = actuator / mechanical_reduction + offset`: the line
/// through the error of the joint's drive, least squares over its limits. Actuator values are the readings of a log. The
/// geometry is not part of it: it belongs to the URDF. The zeros of a device that came from a URDF are in the corrected URDF's
/// origins; who stays with the original one calls the macro with `zeros_in_offsets:=true`, which adds them to the offsets.
///
/// ```
/// let text = "[[joint]]\nname = \"elbow\"\ntransmission = \"capstan\"\ntransmission_ratio = 10.0\noffset_rad = 0.01\n";
/// # let text = "[[joint]]\nname = \"elbow\"\n";
/// let device = haptical_model::Device::from_toml(text, "arm.toml")?.device;
/// let (xacro, _) = haptical_urdf::ros2_control(&device);
/// assert!(xacro.contains("<joint name=\"elbow\" role=\"joint1\">"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ros2_control(device: &Device) -> (String, Vec<String>) {
    let rows = device.links.len().saturating_sub(1);
    let of_rows = joint_names(device, rows);
    let name = |joint: usize| match device.own_row(joint).filter(|_| rows > 0) {
        Some(row) => of_rows.get(row - 1).cloned(),
        None => Some(device.joints[joint].name.clone()),
    };
    let (mut joints, mut transmissions) = (String::new(), String::new());
    let mut said = Vec::new();
    for (index, joint) in device.joints.iter().enumerate() {
        let Some(name) = name(index).filter(|_| rows == 0 || has_own_row(device, index)) else {
            said.push(format!(
                "joint `{}` has no row that moves as it reads, so it is left out of ros2_control",
                joint.name
            ));
            continue;
        };
        let line = line(joint);
        if line.left > WORTH_SAYING {
            said.push(format!(
                "joint `{name}`: the line of its transmission leaves up to {} {} of its drive's error; `haptical correct` and \
                 the forms rust, c-header and json have all of it",
                rounded(line.left),
                joint.unit()
            ));
        }
        interfaces(&mut joints, &escaped(&name), joint);
        transmission(
            &mut transmissions,
            &escaped(&name),
            line,
            zero(device, index),
        );
    }
    said.extend(said_of_renamed(device, &of_rows));
    said.extend(left_out(device));
    said.extend(of_dynamics(device));
    let own = escaped(&device.name);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n  <!-- Offsets and reductions of the \
         drives of {}: joint = actuator / mechanical_reduction + offset, in rad (m where it slides).\n       Actuator values are \
         the readings of a log. Geometry is in the corrected URDF. With zeros_in_offsets the turns of joints\n       about their \
         own axes are in the offsets: for the original URDF, and not for the corrected one, which has them. -->\n  \
         <xacro:macro name=\"{}_ros2_control\" params=\"hardware:=mock_components/GenericSystem zeros_in_offsets:=false\">\n    \
         <ros2_control name=\"{own}\" type=\"system\">\n      <hardware>\n        <plugin>${{hardware}}</plugin>\n      \
         </hardware>\n{joints}{transmissions}    </ros2_control>\n  </xacro:macro>\n",
        commented(&device.name),
        identifier(&device.name),
    );
    if !said.is_empty() {
        text.push_str("  <!-- What this file does not carry of the device:\n");
        for own in &said {
            let _ = writeln!(text, "       {}", commented(own));
        }
        text.push_str("  -->\n");
    }
    text.push_str("</robot>\n");
    (text, said)
}

/// Name of a macro, which is called as an element: no digit at its beginning.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => name,
        false => format!("_{name}"),
    }
}

fn interfaces(text: &mut String, name: &str, joint: &Joint) {
    let mut limits = String::new();
    for (key, limit) in [("min", joint.lower_rad), ("max", joint.upper_rad)] {
        if limit.is_finite() {
            let limit = written(&[limit]);
            let _ = write!(limits, "\n          <param name=\"{key}\">{limit}</param>");
        }
    }
    let command = match limits.is_empty() {
        true => "<command_interface name=\"position\"/>".to_owned(),
        false => {
            format!("<command_interface name=\"position\">{limits}\n        </command_interface>")
        }
    };
    let _ = write!(
        text,
        "      <joint name=\"{name}\">\n        {command}\n        <state_interface name=\"position\"/>\n        \
         <state_interface name=\"velocity\"/>\n      </joint>\n"
    );
}

fn transmission(text: &mut String, name: &str, line: Line, zero: f64) {
    let offset = written(&[line.offset]);
    let offset = match zero == 0.0 {
        true => offset,
        false => format!(
            "${{{offset} + ({} if zeros_in_offsets else 0)}}",
            written(&[zero])
        ),
    };
    let reduction = written(&[1.0 / (1.0 + line.slope)]);
    let _ = write!(
        text,
        "      <transmission name=\"{name}_transmission\">\n        \
         <plugin>transmission_interface/SimpleTransmission</plugin>\n        <actuator name=\"{name}_actuator\" \
         role=\"actuator1\"/>\n        <joint name=\"{name}\" role=\"joint1\">\n          \
         <mechanical_reduction>{reduction}</mechanical_reduction>\n          <offset>{offset}</offset>\n        </joint>\n      \
         </transmission>\n"
    );
}

/// How far the geometry turns (slides) a joint about its own axis, of a row that stands on a constant origin, as rows of a
/// URDF do: there the number is what a calibration found.
fn zero(device: &Device, joint: usize) -> f64 {
    let row = device.own_row(joint);
    let row = row.filter(|row| {
        device
            .chain_origins()
            .get(*row)
            .copied()
            .flatten()
            .is_some()
    });
    let link = row.and_then(|row| device.links.get(row));
    link.map_or(0.0, |link| match device.joints[joint].joint_type {
        JointType::Revolute => link.theta_rad,
        JointType::Prismatic => link.d_m,
    })
}

/// Least squares over the joint's range; readings at which the drive has no value do not count.
fn line(joint: &Joint) -> Line {
    let mut range = [joint.lower_rad, joint.upper_rad];
    if let TransmissionError::Chebyshev { range_rad, .. } = &joint.transmission_error {
        range = [range[0].max(range_rad[0]), range[1].min(range_rad[1])];
    }
    for (end, usual) in range.iter_mut().zip(UNLIMITED) {
        *end = if end.is_finite() { *end } else { usual };
    }
    let [lower, upper] = range;
    let place = |sample: usize| lower + (upper - lower) * sample as f64 / (SAMPLES - 1) as f64;
    let samples = (0..SAMPLES).map(place);
    let samples = samples.filter_map(|at| Some((at, joint.error_rad(at).ok()?)));
    let samples: Vec<(f64, f64)> = samples.collect();
    let count = samples.len().max(1) as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| samples.iter().map(of).sum::<f64>() / count;
    let (at, error) = (mean(&|own| own.0), mean(&|own| own.1));
    let spread = mean(&|own| (own.0 - at) * (own.0 - at));
    let slope = match spread > 0.0 {
        true => mean(&|own| (own.0 - at) * (own.1 - error)) / spread,
        false => 0.0,
    };
    let offset = error - slope * at;
    let left = samples
        .iter()
        .map(|own| (own.1 - offset - slope * own.0).abs());
    Line {
        offset,
        slope,
        left: left.fold(0.0, f64::max),
    }
}

/// Effects and springs, for which there is no means.
fn left_out(device: &Device) -> Option<String> {
    let mut labels: Vec<String> = device
        .effects
        .iter()
        .map(|own| match is_ahead(own) {
            true => format!("`{}` ({AHEAD})", own.label()),
            false => format!("`{}`", own.label()),
        })
        .collect();
    let yields =
        (0..device.joints.len()).filter(|joint| device.compliance_rad_per_nm(*joint) != 0.0);
    labels.extend(yields.map(|joint| format!("`joint-compliance@{}`", joint + 1)));
    (!labels.is_empty()).then(|| {
        format!(
            "a SimpleTransmission has an offset and a reduction alone: {} are left out; {FITTED_BESIDE}",
            labels.join(", ")
        )
    })
}
