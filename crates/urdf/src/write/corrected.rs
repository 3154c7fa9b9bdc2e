//! A URDF with the calibrated geometry, masses and friction in place: the rest of the text stays.

use std::ops::Range;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::rigid::{about_z, inverse, then, turn};
use haptical_model::{Device, Hand, JointType};

use crate::UrdfError;
use crate::chain::End;
use crate::chain::friction::friction as known_friction;
use crate::chain::gaps::{Correction, corrections};
use crate::chain::path::{BaseAndTip, Path};
use crate::device::{ReadChain, parents};
use crate::numbers::{escaped, written};
use crate::rigid::to_rpy;
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::document;
use crate::robot::{Robot, RobotJoint};
use crate::words::{joined, listed};
use crate::write::effects::Effects;
use crate::write::inertials::{put, urdf_element, weighed};
use crate::write::not_carried::{Form, comment, not_carried};
use crate::write::patched::Edit;
use crate::write::urdf::dynamics;
use haptical_model::Segments;

/// A corrected URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectedUrdf {
    /// The text.
    pub text: String,
    /// Link at which the calibrated chain begins.
    pub base: String,
    /// Link at which the calibrated chain ends.
    pub tip: String,
    /// Links at which the further chains of a device with several hands end.
    pub further_tips: Vec<String>,
    /// What a URDF cannot hold, and what was chosen.
    pub warnings: Vec<String>,
}

/// How far an origin of the device may be from the one of the URDF, in m and as an entry of a rotation:
/// what the digits of a device file leave.
const SAME: f64 = 1e-6;

/// The text of a URDF with the origins of the chain's joints, and of the last fixed joint behind them,
/// replaced so that its forward kinematics is that of `device`, of every chain where it has several; with `<inertial>` of links whose
/// masses the device has otherwise, and `<dynamics>` where it knows a joint's friction. What a URDF cannot hold is a comment at its end. Comments, meshes and all other elements stay
/// as they are.
///
/// `device` must have come from this URDF, this base and this tip: its constant origins are compared. Where no
/// fixed joint is behind the last moving one, a link and a fixed joint for the handle are added; so they are for
/// the base where the first moving joint is passed upwards. Where the chain turns from upwards to downwards, the
/// joint behind the turning point takes up what lies between the two; where it ends upwards, the handle does.
///
/// ```
/// use haptical_urdf::{BaseAndTip, corrected_urdf, device_from_urdf};
/// let text = r#"<robot name="lever"> <!-- kept -->
///   <link name="base"/> <link name="arm"/> <link name="tool"/>
///   <joint name="shoulder" type="continuous">
///     <parent link="base"/> <child link="arm"/> <axis xyz="0 1 0"/>
///   </joint>
///   <joint name="flange" type="fixed">
///     <origin xyz="0.1 0 0"/> <parent link="arm"/> <child link="tool"/>
///   </joint>
/// </robot>"#;
/// let mut lever = device_from_urdf(text, "lever.urdf", BaseAndTip::to("tool"))?.device;
/// lever.links[1].d_m = 0.002; // along the axis, y
/// let corrected = corrected_urdf(text, "lever.urdf", BaseAndTip::to("tool"), &lever)?;
/// assert!(corrected.text.contains("<!-- kept -->"));
/// let again = device_from_urdf(&corrected.text, "again.urdf", BaseAndTip::to("tool"))?.device;
/// let pose = haptical_model::DeviceChain::new(&again).pose(&[0.0])?;
/// assert!((pose.position_m.y - 0.002).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError`] as [`device_from_urdf`](crate::device_from_urdf); [`UrdfError::Device`] for a device that
/// is not of this URDF.
pub fn corrected_urdf(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
    device: &Device,
) -> Result<CorrectedUrdf, UrdfError> {
    let read = ReadChain::of_urdf(text, file, ends)?;
    let corrections = all_corrections(&read, device, (file, "URDF"))?;
    let (drives, said) = drives(text, file, &read, device)?;
    let moved = said_of_moved_masses(&read, device, &corrections, file);
    let ReadChain {
        robot,
        paths,
        mut warnings,
        ..
    } = read;
    warnings.extend(said);
    warnings.extend(moved);
    let link = |index: usize| robot.links[index].name.clone();
    let mut base = link(paths[0].base);
    let mut tips: Vec<String> = paths.iter().map(|path| link(path.tip)).collect();
    // the path has joints, so the robot has a closing tag
    let end = robot.end.unwrap_or(text.len());
    let mut edits = drives;
    let mut add = |link: &mut String, what: &str, place: &str, origin: &Pose| {
        let (addition, name) = added_link(&robot, link, what, origin);
        warnings.push(format!(
            "{file}: nothing is fixed {place} joint, so the link `{name}` was added for the {what}"
        ));
        *link = name;
        (end..end, addition)
    };
    for (path, correction) in corrections {
        edits.push(match correction {
            Correction::Joint(joint, origin) => edit(text, &robot.joints[joint], &origin),
            Correction::Base(origin) => add(&mut base, "base", "before the first", &origin),
            Correction::Tip(origin) => add(&mut tips[path], "handle", "behind the last", &origin),
        });
    }
    let mut tips = tips.into_iter();
    let tip = tips.next().unwrap_or_default();
    Ok(CorrectedUrdf {
        text: replaced(text, edits),
        base,
        tip,
        further_tips: tips.collect(),
        warnings,
    })
}

/// Masses and friction that the file has otherwise, and what a URDF cannot hold of them.
fn drives(
    text: &str,
    file: &str,
    read: &ReadChain,
    device: &Device,
) -> Result<(Vec<Edit>, Vec<String>), UrdfError> {
    let (links, mut said) = weighed(read, device, file)?;
    let plain = without_prefixes(text);
    let document = document(&plain, file)?;
    let end = read.robot.end.unwrap_or(text.len());
    let at = |place: usize| {
        let mut all = document.descendants();
        all.find(|own| own.is_element() && own.range().start == place)
    };
    let mut edits = Vec::new();
    for own in &links {
        let element = urdf_element(&own.inertia);
        edits.extend(
            at(read.robot.links[own.link].place).map(|node| put(text, node, "inertial", &element)),
        );
    }
    let effects = Effects::new(device);
    for (joint, friction) in effects.friction.iter().enumerate() {
        let driver = read
            .rows
            .drivers
            .get(joint)
            .map(|own| &read.robot.joints[*own]);
        let known = known_friction(&read.robot, &read.rows, joint);
        if friction.sizes() == known {
            continue;
        }
        let element = dynamics(*friction);
        let node = driver
            .and_then(|own| at(own.place))
            .filter(|_| !element.is_empty());
        edits.extend(node.map(|node| put(text, node, "dynamics", element.trim())));
    }
    let lost = not_carried(device, &effects, Form::Urdf);
    edits.push((end..end, comment(&lost)));
    said.extend(lost);
    Ok((edits, said))
}

/// What a device asks of the description that it came from, and for which path; `file` and its kind name it in refusals.
pub(crate) fn all_corrections(
    read: &ReadChain,
    device: &Device,
    (file, kind): (&str, &str),
) -> Result<Vec<(usize, Correction)>, UrdfError> {
    check_same(read, device, (file, kind))?;
    let segments = Segments::of_device(device)?;
    let (paths, rows) = (&read.paths, &read.rows);
    let mut corrected = vec![false; rows.rows.len()];
    let mut all = Vec::new();
    let ends = rows.ends.iter().zip(&segments.handles);
    for (index, (path, (end, handle))) in paths.iter().zip(ends).enumerate() {
        let others = [&paths[..index], &paths[index + 1..]].concat();
        let (before, handle) = zeros_with_their_joints(read, path, end, device, &segments, handle);
        let own = corrections(&read.robot, path, before.into_iter(), &handle, &others);
        let places = end.rows.iter().map(|row| Some(*row)).chain([None]);
        for (correction, row) in own.into_iter().zip(places) {
            // what several chains share is corrected once
            if row.is_some_and(|row| std::mem::replace(&mut corrected[row], true)) {
                continue;
            }
            all.push((index, correction));
        }
    }
    Ok(all)
}

/// Masses that corrected origins take with them, and that the device has where they were: of what is fixed behind a fixed joint,
/// and of slides whose zero is another one.
pub(crate) fn said_of_moved_masses(
    read: &ReadChain,
    device: &Device,
    corrections: &[(usize, Correction)],
    file: &str,
) -> Option<String> {
    let robot = &read.robot;
    let fixed = corrections.iter().filter_map(|(_, own)| match own {
        Correction::Joint(joint, origin) => Some((*joint, origin)),
        Correction::Base(_) | Correction::Tip(_) => None,
    });
    let fixed = fixed.filter(|(joint, origin)| {
        let own = &robot.joints[*joint];
        let gap_m = (own.origin.position_m - origin.position_m).amax();
        let gap = (own.origin.rotation - origin.rotation).amax();
        !own.moves() && gap_m.max(gap) > 0.0
    });
    let slides = read.rows.rows.iter().enumerate().filter(|(row, own)| {
        let link = device.links.get(row + 1);
        own.drive.motion == JointType::Prismatic && link.is_some_and(|link| link.d_m != 0.0)
    });
    let moved = fixed
        .map(|(joint, _)| joint)
        .chain(slides.map(|(_, own)| own.joint));
    let heavy = moved.map(|joint| robot.joints[joint].child);
    let names = heavy.filter(|link| robot.is_heavy_behind(*link));
    let names: Vec<String> = names
        .map(|link| format!("`{}`", robot.links[link].name))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "{file}: the masses of {} move with their corrected origins, and the device has them where they were: torques differ \
             by as much",
            joined(&names)
        )
    })
}

/// What is before each row and behind the last, with each joint's zero beside its own origin: before the motion, but behind it
/// where the joint is passed upwards, or has no element that places it. [`Segments`] have the turn of a joint before its motion,
/// and the shift of a slide behind it.
fn zeros_with_their_joints(
    read: &ReadChain,
    path: &Path,
    end: &End,
    device: &Device,
    segments: &Segments,
    handle: &Pose,
) -> (Vec<Pose>, Pose) {
    let mut before: Vec<Pose> = (end.rows.iter())
        .map(|row| segments.rows[*row].before)
        .chain([*handle])
        .collect();
    let moving = path.steps.iter();
    let moving = moving.filter(|step| read.robot.joints[step.joint].moves());
    for (place, (step, row)) in moving.zip(&end.rows).enumerate() {
        let link = &device.links[row + 1];
        let is_behind = step.is_upward || read.robot.joints[step.joint].is_part;
        let forward = match (is_behind, segments.rows[*row].drive.motion) {
            (true, _) => turn(about_z(-link.theta_rad)),
            (false, JointType::Revolute) => continue,
            (false, JointType::Prismatic) => Pose {
                position_m: Vector3::z() * link.d_m,
                ..Pose::default()
            },
        };
        before[place] = then(&before[place], &forward);
        before[place + 1] = then(&inverse(&forward), &before[place + 1]);
    }
    let handle = before.pop().unwrap_or_default();
    (before, handle)
}

/// Said where a device has transmission errors.
pub(crate) const TRANSMISSIONS: &str = "a robot description has no transmission errors: feed it joint \
     values that are corrected for them (`haptical export --format rust` or `c-header`)";

/// Whether any joint's value differs from its reading.
pub(crate) fn has_transmission_errors(device: &Device) -> bool {
    let none = haptical_model::TransmissionError::default();
    let mut joints = device.joints.iter();
    joints.any(|joint| joint.transmission_error != none)
}

fn check_same(
    read: &ReadChain,
    device: &Device,
    (file, kind): (&str, &str),
) -> Result<(), UrdfError> {
    let tips = read.paths.iter();
    let tips = listed(tips.map(|path| read.robot.links[path.tip].name.as_str()));
    let refuse = |what: String| UrdfError::Device {
        device: device.name.clone(),
        message: format!(
            "{what}: give the {kind} that it was calibrated from, and the same --base and --tip ({file} was read \
             from `{}` to {})",
            read.robot.links[read.paths[0].base].name, tips
        ),
    };
    let rows = &read.rows.rows;
    if device.links.len() != rows.len() + 1 {
        let (has, file_has) = (device.links.len().saturating_sub(1), rows.len());
        return Err(refuse(format!(
            "it has {has} moving rows, the {kind}'s chain {file_has}"
        )));
    }
    let hands = crate::device::hands(&read.robot, &read.paths, &read.rows);
    let ends = |hands: &[Hand]| -> Vec<(String, usize)> {
        hands
            .iter()
            .map(|hand| (hand.name.clone(), hand.row))
            .collect()
    };
    if device.parents != parents(&read.rows) || ends(&device.hands) != ends(&hands) {
        return Err(refuse(
            "its rows branch in another way, or it has other hands".to_owned(),
        ));
    }
    let mut origins = device.chain_origins();
    origins.truncate(rows.len() + 1);
    origins.resize(rows.len() + 1, None);
    let handles = (0..read.rows.ends.len()).map(|hand| device.handle_of(hand));
    origins.extend(handles);
    let wanted = rows.iter().map(|row| row.origin);
    let wanted = wanted.chain(read.rows.ends.iter().map(|end| end.handle));
    for (index, wanted) in wanted.enumerate() {
        let place = match rows.get(index) {
            Some(row) => format!("joint `{}`", read.robot.joints[row.joint].name),
            None => "the handle".to_owned(),
        };
        let Some(origin) = origins.get(index + 1).copied().flatten() else {
            return Err(refuse(format!("{place} has no origin in it")));
        };
        let gap_m = (origin.position_m - wanted.position_m).amax();
        let gap = (origin.rotation - wanted.rotation).amax();
        if !(gap_m <= SAME && gap <= SAME) {
            return Err(refuse(format!("{place} is elsewhere in it")));
        }
        let drives = device.drive(index + 1).zip(rows.get(index));
        if drives.is_some_and(|(own, row)| own != row.drive) {
            return Err(refuse(format!("{place} is driven in another way in it")));
        }
    }
    Ok(())
}

/// The replacement of a joint's origin, or a new one.
fn edit(text: &str, joint: &RobotJoint, origin: &Pose) -> (Range<usize>, String) {
    let element = origin_element(origin);
    match &joint.origin_range {
        Some(range) => (range.clone(), element),
        None => {
            let indent = indent_at(text, joint.inside);
            (joint.inside..joint.inside, format!("{indent}{element}"))
        }
    }
}

/// Blanks with which a joint's own elements begin, so that a new one is like the others.
pub(crate) fn indent_at(text: &str, place: usize) -> &str {
    let rest = text.get(place..).unwrap_or_default();
    let blank = rest.len() - rest.trim_start().len();
    &rest[..blank]
}

pub(crate) fn origin_element(pose: &Pose) -> String {
    let [xyz, rpy] = [pose.position_m.into(), to_rpy(&pose.rotation)];
    format!(
        "<origin xyz=\"{}\" rpy=\"{}\"/>",
        written(&xyz),
        written(&rpy)
    )
}

/// A link fixed to another one, under names that are free; and its name.
fn added_link(robot: &Robot, parent: &str, what: &str, origin: &Pose) -> (String, String) {
    let mut name = format!("{parent}_{what}");
    while robot.links.iter().any(|link| link.name == name)
        || robot
            .joints
            .iter()
            .any(|joint| joint.name == format!("{name}_fixed"))
    {
        name.push('_');
    }
    let element = origin_element(origin);
    let (link, parent) = (escaped(&name), escaped(parent));
    let addition = format!(
        "  <link name=\"{link}\"/>\n  <joint name=\"{link}_fixed\" type=\"fixed\">\n    {element}\n    \
         <parent link=\"{parent}\"/>\n    <child link=\"{link}\"/>\n  </joint>\n"
    );
    (addition, name)
}

pub(crate) fn replaced(text: &str, mut edits: Vec<(Range<usize>, String)>) -> String {
    edits.sort_by_key(|(range, _)| range.start);
    let mut written = String::with_capacity(text.len() + 64 * edits.len());
    let mut done = 0;
    for (range, new) in edits {
        written.push_str(&text[done..range.start]);
        written.push_str(&new);
        done = range.end;
    }
    written.push_str(&text[done..]);
    written
}

/// Names of the two kinds of joint in URDF, and the unit of their values.
pub(crate) fn type_name(motion: JointType, has_limits: bool) -> &'static str {
    match motion {
        JointType::Prismatic => "prismatic",
        JointType::Revolute if has_limits => "revolute",
        JointType::Revolute => "continuous",
    }
}
