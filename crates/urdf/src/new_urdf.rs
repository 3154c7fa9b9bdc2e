//! A minimal URDF of a device that has none.

use std::fmt::Write;

use haptical_model::Device;

use crate::UrdfError;
use crate::correct::{TRANSMISSIONS, origin_element, segments_are_dirty, type_name};
use crate::numbers::{escaped, written};
use crate::segments::segments;

/// Stands where one limit is known and the other is not \[rad\] or \[m\].
const FAR: f64 = 1000.0;

/// A URDF with a link for each row, joints along z, the masses that are known, and a link `handle`; and
/// what it leaves out. Its joint values are those of the device, home included: where the device's home
/// is not 0, neither is the URDF's there.
///
/// ```
/// use haptical_model::Device;
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let (text, _) = haptical_urdf::new_urdf(&device)?;
/// let again = haptical_urdf::device_from_urdf(&text, "haptic7.urdf", Some("handle"))?.device;
/// assert_eq!(again.joints.len(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError::Device`] for a device without links.
pub fn new_urdf(device: &Device) -> Result<(String, Vec<String>), UrdfError> {
    let segments = segments(device)?;
    let names = joint_names(device, segments.rows.len());
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <!-- Lengths in m, angles in rad. Inertia tensors and \
         limits of effort and velocity are not known. -->\n  <link name=\"base\"/>\n",
        escaped(&device.name)
    );
    let mut parent = "base".to_owned();
    for (index, segment) in segments.rows.iter().enumerate() {
        let joint = &device.joints[segment.drive.joint];
        let link = format!("link{}", index + 1);
        let _ = match segment.body {
            None => writeln!(text, "  <link name=\"{link}\"/>"),
            Some((mass_kg, centre_m)) => writeln!(
                text,
                "  <link name=\"{link}\">\n    <inertial>\n      <origin xyz=\"{}\"/>\n      \
                 <mass value=\"{}\"/>\n      <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" \
                 izz=\"0\"/>\n    </inertial>\n  </link>",
                written(&centre_m),
                written(&[mass_kg])
            ),
        };
        let source = device.first_row(segment.drive.joint).unwrap_or(index + 1);
        let follows = source != index + 1;
        let limits = match (joint.lower_rad.is_finite(), joint.upper_rad.is_finite()) {
            (false, false) => None,
            _ => {
                // one of the row's own variable
                let ends = [joint.lower_rad.max(-FAR), joint.upper_rad.min(FAR)].map(|end| {
                    segment.drive.multiplier * (joint.home_rad + end) + segment.drive.offset
                });
                Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
            }
        };
        let kind = type_name(segment.drive.motion, limits.is_some());
        // a slide without limits has none in a file either, but must say so
        let limits = limits.or((kind == "prismatic").then_some([-FAR, FAR]));
        let _ = write!(
            text,
            "  <joint name=\"{}\" type=\"{kind}\">\n    {}\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"{link}\"/>\n    <axis xyz=\"0 0 1\"/>\n",
            escaped(&names[index]),
            origin_element(&segment.before),
        );
        if let Some([lower, upper]) = limits {
            let _ = writeln!(
                text,
                "    <limit lower=\"{}\" upper=\"{}\" effort=\"0\" velocity=\"0\"/>",
                written(&[lower]),
                written(&[upper])
            );
        }
        if follows {
            let first = &segments.rows[source - 1].drive;
            let multiplier = segment.drive.multiplier / first.multiplier;
            let offset = segment.drive.offset - multiplier * first.offset;
            let _ = writeln!(
                text,
                "    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>",
                escaped(&names[source - 1]),
                written(&[multiplier]),
                written(&[offset])
            );
        }
        text.push_str("  </joint>\n");
        parent = link;
    }
    let _ = write!(
        text,
        "  <link name=\"handle\"/>\n  <joint name=\"handle_fixed\" type=\"fixed\">\n    {}\n    \
         <parent link=\"{parent}\"/>\n    <child link=\"handle\"/>\n  </joint>\n</robot>\n",
        origin_element(&segments.handle)
    );
    let warnings = segments_are_dirty(device).then(|| TRANSMISSIONS.to_owned());
    Ok((text, warnings.into_iter().collect()))
}

/// A name for each row's joint: the device's own for the first row of a joint; all different.
pub(crate) fn joint_names(device: &Device, rows: usize) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for row in 1..=rows {
        let joint = device.drive(row).map_or(0, |drive| drive.joint);
        let own = device
            .joints
            .get(joint)
            .map_or("", |joint| joint.name.as_str());
        let mut name = match (
            own.parse::<f64>().is_ok(),
            device.first_row(joint) == Some(row),
        ) {
            // a file that names no joints numbers them
            (true, true) => format!("joint{own}"),
            (false, true) => own.to_owned(),
            (_, false) => format!("row{row}"),
        };
        while names.contains(&name) || name == "handle_fixed" || name.is_empty() {
            name.push('_');
        }
        names.push(name);
    }
    names
}
