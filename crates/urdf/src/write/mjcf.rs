//! A minimal MJCF (MuJoCo's XML) of a device.

use std::fmt::Write;

use haptical_model::{Device, JointType, Origin};

use crate::UrdfError;
use crate::numbers::{escaped, written};
use crate::write::segments::segments;
use crate::write::urdf::{joint_names, left_out};

/// An MJCF with a body for each row, joints along z with their ranges, the masses that are known, and a
/// site `handle`; and what it leaves out. Its joint values are those of [`new_urdf`](crate::new_urdf): the
/// readings of a log, 0 at home. Rows that follow another's joint are bound to it by an `<equality>`.
///
/// MuJoCo needs masses and inertias above zero: the file asks it to put small ones where none are known
/// (`boundmass`, `boundinertia`).
///
/// ```
/// use haptical_model::Device;
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let (text, _) = haptical_urdf::new_mjcf(&device)?;
/// assert!(text.contains("<site name=\"handle\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError::Device`] for a device without links.
pub fn new_mjcf(device: &Device) -> Result<(String, Vec<String>), UrdfError> {
    if device.has_hands() {
        return Err(UrdfError::Device {
            device: device.name.clone(),
            message: "it has several hands, and an MJCF is written of one chain: write a URDF, which MuJoCo reads too"
                .to_owned(),
        });
    }
    let segments = segments(device)?;
    let names = joint_names(device, segments.rows.len());
    let mut text = format!(
        "<mujoco model=\"{}\">\n  <!-- Lengths in m, angles in rad. Joint values are the readings of a log, \
         0 at home. Inertias are not\n       known: see boundmass and boundinertia. -->\n  <compiler \
         angle=\"radian\" autolimits=\"true\" boundmass=\"1e-6\" boundinertia=\"1e-9\"/>\n",
        escaped(&device.name)
    );
    if let Some(gravity) = &device.gravity_mps2 {
        let _ = writeln!(text, "  <option gravity=\"{}\"/>", written(gravity));
    }
    text.push_str("  <worldbody>\n");
    let mut bonds = String::new();
    for (index, segment) in segments.rows.iter().enumerate() {
        let indent = "  ".repeat(index + 2);
        let _ = writeln!(
            text,
            "{indent}<body name=\"link{}\" {}>",
            index + 1,
            place(&Origin::from_pose(&segment.origin(device)))
        );
        if let Some((mass_kg, centre_m)) = segment.body {
            let _ = writeln!(
                text,
                "{indent}  <inertial pos=\"{}\" mass=\"{}\" diaginertia=\"0 0 0\"/>",
                written(&centre_m),
                written(&[mass_kg])
            );
        }
        let kind = match segment.drive.motion {
            JointType::Revolute => "hinge",
            JointType::Prismatic => "slide",
        };
        let name = escaped(&names[index]);
        let _ = write!(
            text,
            "{indent}  <joint name=\"{name}\" type=\"{kind}\" axis=\"0 0 1\""
        );
        let range = segment.limits(device);
        if let Some((source, multiplier)) = segments.followed(device, index) {
            let _ = writeln!(
                bonds,
                "    <joint joint1=\"{name}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\"/>",
                escaped(&names[source]),
                written(&[multiplier])
            );
        } else if range.iter().all(|end| end.is_finite()) {
            let _ = write!(text, " range=\"{}\"", written(&range));
        }
        text.push_str("/>\n");
    }
    let rows = segments.rows.len();
    let handle = place(&Origin::from_pose(&segments.handles[0]));
    let _ = writeln!(
        text,
        "{}<site name=\"handle\" {handle}/>",
        "  ".repeat(rows + 2)
    );
    for row in (0..rows).rev() {
        let _ = writeln!(text, "{}</body>", "  ".repeat(row + 2));
    }
    text.push_str("  </worldbody>\n");
    if !bonds.is_empty() {
        let _ = write!(text, "  <equality>\n{bonds}  </equality>\n");
    }
    text.push_str("</mujoco>\n");
    Ok((text, left_out(device)))
}

fn place(origin: &Origin) -> String {
    format!(
        "pos=\"{}\" quat=\"{}\"",
        written(&origin.position_m),
        written(&origin.orientation_wxyz)
    )
}
