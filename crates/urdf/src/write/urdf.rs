//! A minimal URDF of a device that has none.

use std::fmt::Write;

use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, GivenInertia, SegmentBody};

use crate::UrdfError;
use crate::numbers::{escaped, written};
use crate::write::corrected::{origin_element, type_name};
use crate::write::effects::{Effects, Friction};
use crate::write::loaders::Loader;
use crate::write::mjcf::GRAVITY_MPS2;
use crate::write::names::{joint_names, said_of_renamed};
use crate::write::not_carried::{Form, comment, not_carried};
use haptical_model::RowBody;
use haptical_model::Segments;

/// Stands where one limit is known and the other is not \[rad\] or \[m\].
pub(crate) const FAR: f64 = 1000.0;

/// A URDF with a link for each row, joints along z, the masses that are known, and a link `handle`, or one for each hand
/// by its name; and
/// what it leaves out. Its joint values are those of the device, home included: where the device's home
/// is not 0, neither is the URDF's there.
///
/// ```
/// use haptical_model::Device;
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let (text, _) = haptical_urdf::new_urdf(&device)?;
/// let again = haptical_urdf::device_from_urdf(&text, "haptic7.urdf", haptical_urdf::BaseAndTip::to("handle"))?.device;
/// assert_eq!(again.joints.len(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError::Device`] for a device without links.
pub fn new_urdf(device: &Device) -> Result<(String, Vec<String>), UrdfError> {
    written_urdf(device, None)
}

/// A URDF as [`new_urdf`] for a program that takes what is left out for 0: limits of effort and velocity that are not known
/// are 1000, where a program simulates every link that moves has a mass, a plausible one (assumption A150) where none is
/// known, and Drake gets the `<transmission>` elements without which it has no actuators.
///
/// # Errors
/// As [`new_urdf`].
pub fn new_urdf_for(device: &Device, loader: Loader) -> Result<(String, Vec<String>), UrdfError> {
    written_urdf(device, Some(loader))
}

fn written_urdf(
    device: &Device,
    loader: Option<Loader>,
) -> Result<(String, Vec<String>), UrdfError> {
    let simulates = loader.is_some_and(Loader::simulates);
    let segments = Segments::of_device(device)?;
    let names = joint_names(device, segments.rows.len());
    let bodies = RowBody::of_rows(device, &segments);
    let effects = Effects::new(device);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <!-- Lengths in m, angles in rad. Joint values are \
         the readings of a log, 0 at home. What is marked as\n       plausible is not known, \
         nor are limits of velocity, nor of effort where it is 0. -->\n  <link name=\"base\"/>\n",
        escaped(&device.name)
    );
    let link_of = |row: usize| match row {
        0 => "base".to_owned(),
        _ => format!("link{row}"),
    };
    for (index, segment) in segments.rows.iter().enumerate() {
        let (link, parent) = (link_of(index + 1), device.parent(index + 1));
        let parent = link_of(parent.unwrap_or(0));
        let _ = match segment.body {
            own if simulates || own.is_some_and(|own| own.mass_kg > 0.0) => writeln!(
                text,
                "  <link name=\"{link}\">\n{}  </link>",
                inertial(&bodies[index])
            ),
            None => writeln!(text, "  <link name=\"{link}\"/>"),
            Some(own) => writeln!(
                text,
                "  <link name=\"{link}\">\n{}  </link>",
                inertial(&weightless(&own, &bodies[index]))
            ),
        };
        let limits = segment.limits(device);
        let limits = (limits[0].is_finite() || limits[1].is_finite())
            .then_some([limits[0].max(-FAR), limits[1].min(FAR)]);
        let kind = type_name(segment.drive.motion, limits.is_some());
        // a slide without limits has none in a file either, but must say so
        let limits = limits.or((kind == "prismatic").then_some([-FAR, FAR]));
        let _ = write!(
            text,
            "  <joint name=\"{}\" type=\"{kind}\">\n    {}\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"{link}\"/>\n    <axis xyz=\"0 0 1\"/>\n",
            escaped(&names[index]),
            origin_element(&segment.origin(device)),
        );
        let is_own = segments.followed(device, index).is_none();
        let effort = segment.torque_limit(device).filter(|_| is_own);
        text.push_str(&limit_element(limits, effort, loader.is_some()));
        if is_own {
            let friction = effects.friction.get(segment.drive.joint);
            text.push_str(&dynamics(friction.copied().unwrap_or_default()));
        }
        if let Some((source, multiplier)) = segments.followed(device, index) {
            let _ = writeln!(
                text,
                "    <mimic joint=\"{}\" multiplier=\"{}\"/>",
                escaped(&names[source]),
                written(&[multiplier]),
            );
        }
        text.push_str("  </joint>\n");
    }
    for (hand, handle) in segments.handles.iter().enumerate() {
        let own = device.hands.get(hand);
        let name = own.map_or("handle", |hand| hand.name.as_str());
        let (name, parent) = (
            escaped(name),
            link_of(own.map_or(segments.rows.len(), |hand| hand.row)),
        );
        let _ = write!(
            text,
            "  <link name=\"{name}\"/>\n  <joint name=\"{name}_fixed\" type=\"fixed\">\n    {}\n    \
             <parent link=\"{parent}\"/>\n    <child link=\"{name}\"/>\n  </joint>\n",
            origin_element(handle)
        );
    }
    if loader == Some(Loader::Drake) {
        actuators(&mut text, device, &segments, &names);
    }
    let mut warnings = not_carried(device, &effects, Form::Urdf);
    warnings.extend(said_of_renamed(device, &names));
    warnings.extend(gravity(device));
    text.push_str(&comment(&warnings));
    text.push_str("</robot>\n");
    warnings.extend(scaled(device));
    warnings.extend(made_up(&segments, &bodies, simulates));
    warnings.extend(loader.map(|loader| unlimited(device, loader)));
    Ok((text, warnings))
}

/// Gravity of another direction or size than every program takes.
fn gravity(device: &Device) -> Option<String> {
    let [x, y, z] = device.gravity_mps2?;
    let [there_x, there_y, there_z] = GRAVITY_MPS2;
    let is_usual = (x - there_x).hypot(y - there_y).hypot(z - there_z) < 1e-6;
    (!is_usual).then(|| {
        format!(
            "a URDF has no gravity, and programs take {} m/s^2 in the frame of its root: give them {} m/s^2",
            written(&GRAVITY_MPS2),
            written(&[x, y, z])
        )
    })
}

/// Inertias that are plausible and not known.
fn made_up(segments: &Segments, bodies: &[RowBody], all: bool) -> Vec<String> {
    let weighs = |row: usize| segments.rows[row].body.is_some_and(|own| own.mass_kg > 0.0);
    let keys = if all {
        "mass_kg, inertia_kgm2"
    } else {
        "inertia_kgm2"
    };
    RowBody::said_of_plausible(bodies, keys, |row| all || weighs(row))
}

/// Which limits are written as none.
fn unlimited(device: &Device, loader: Loader) -> String {
    let unknown = device.joints.iter().enumerate();
    let unknown = unknown.filter(|(_, joint)| joint.torque_limit_nm.is_none());
    let unknown: Vec<String> = unknown.map(|(joint, _)| (joint + 1).to_string()).collect();
    let efforts = match unknown.is_empty() {
        true => String::new(),
        false => format!(
            ", nor efforts of joints {} (torque_limit_nm)",
            unknown.join(", ")
        ),
    };
    let next = match loader {
        Loader::Moveit => "; give max_velocity in joint_limits.yaml before you time a trajectory",
        _ => "",
    };
    format!(
        "limits of velocity are not known{efforts}: {FAR} is written, because {} takes 0 for a limit{next}",
        loader.name()
    )
}

/// Transmissions of the joints that drive rows of their own.
fn actuators(text: &mut String, device: &Device, segments: &Segments, names: &[String]) {
    for (index, name) in names.iter().enumerate() {
        if segments.followed(device, index).is_some() {
            continue;
        }
        let name = escaped(name);
        let _ = write!(
            text,
            "  <transmission name=\"{name}_transmission\">\n    <type>transmission_interface/SimpleTransmission</type>\n    \
             <joint name=\"{name}\">\n      <hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface>\n    \
             </joint>\n    <actuator name=\"{name}_actuator\"/>\n  </transmission>\n"
        );
    }
}

/// Limits of position, effort and velocity; 0 is not known, and nor is [`FAR`] where a program takes 0 for a limit.
fn limit_element(limits: Option<[f64; 2]>, effort: Option<f64>, is_far: bool) -> String {
    let ends = limits.map_or(String::new(), |[lower, upper]| {
        format!(
            " lower=\"{}\" upper=\"{}\"",
            written(&[lower]),
            written(&[upper])
        )
    });
    if limits.is_none() && effort.is_none() && !is_far {
        return String::new();
    }
    let unknown = if is_far { FAR } else { 0.0 };
    let (effort, velocity) = (written(&[effort.unwrap_or(unknown)]), written(&[unknown]));
    format!("    <limit{ends} effort=\"{effort}\" velocity=\"{velocity}\"/>\n")
}

/// A row whose mass is given as 0, as it is given: its inertia is that of a rotor, or none.
fn weightless(own: &SegmentBody, body: &RowBody) -> RowBody {
    let inertia_kgm2 = match own.given_inertia() {
        GivenInertia::Body(inertia) => inertia,
        _ => Matrix3::zeros(),
    };
    RowBody {
        mass_kg: 0.0,
        inertia_kgm2,
        plausible: None,
        ..body.clone()
    }
}

fn inertial(body: &RowBody) -> String {
    let centre: [f64; 3] = body.centre_m.into();
    let [xx, yy, zz, xy, xz, yz] = body.inertia_entries_kgm2().map(|entry| written(&[entry]));
    let plausible = body.plausible.map_or(String::new(), |what| {
        format!("      <!-- plausible: {what} -->\n")
    });
    format!(
        "    <inertial>\n{plausible}      <origin xyz=\"{}\"/>\n      <mass value=\"{}\"/>\n      <inertia ixx=\"{xx}\" \
         ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>\n    </inertial>\n",
        written(&centre),
        written(&[body.mass_kg])
    )
}

/// What a joint's friction is in a URDF.
pub(crate) fn dynamics(friction: Friction) -> String {
    if friction == Friction::default() {
        return String::new();
    }
    let number = |own: Option<f64>| written(&[own.unwrap_or(0.0)]);
    format!(
        "    <dynamics damping=\"{}\" friction=\"{}\"/>\n",
        number(friction.viscous),
        number(friction.coulomb)
    )
}

/// Joints whose values in a file are no readings.
pub(crate) fn scaled(device: &Device) -> Vec<String> {
    let scaled = device.joints.iter().enumerate().filter_map(|(index, joint)| {
        let drive = device.drive(device.own_row(index)?)?;
        let is_own = drive.multiplier == 1.0 && drive.motion == joint.joint_type;
        (!is_own).then(|| {
            format!(
                "joint `{}` drives other rows and has none of its own: its value in {} is {} times the \
                 reading in {}",
                joint.name,
                drive.motion.unit(),
                drive.multiplier,
                joint.unit()
            )
        })
    });
    scaled.collect()
}
