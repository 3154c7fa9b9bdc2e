//! Reads `[[link]]` tables of a device file: numbers, masses, origins, and which joint drives a row.

use std::collections::BTreeMap;

use haptical_kinematics::Link;

use crate::device::Body;
use crate::device::joint::{Joint, JointType};
use crate::device::rows::{Drive, Origin};
use crate::file::JOINT_TYPES;
use crate::file::hand::{read_hands, read_parents};
use crate::file::joint::angle;
use crate::file::reader::{SMALLEST, Section};
use crate::parameter::unknown::{DEVIATION_KEYS, numbers_of};
use crate::sizes::LARGEST_ANGLE_RAD;
use crate::{DeviceFileError, Hand, Parameter};

type Result<T> = std::result::Result<T, DeviceFileError>;

/// How far the length of a quaternion may be from 1: what four digits in a file leave.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// What the `[[link]]` tables say.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) links: Vec<Link>,
    pub(crate) bodies: Vec<Option<Body>>,
    pub(crate) origins: Vec<Option<Origin>>,
    pub(crate) drives: Vec<Drive>,
    pub(crate) parents: Vec<usize>,
    pub(crate) hands: Vec<Hand>,
    pub(crate) deviations: BTreeMap<(usize, Parameter), f64>,
}

/// Reads all rows; `head` is `[device]`, which says where the handle is behind the last row.
pub(crate) fn read_rows(
    root: &Section<'_, '_>,
    head: Option<&Section<'_, '_>>,
    joints: &[Joint],
    warnings: &mut Vec<String>,
) -> Result<Rows> {
    let sections = root.tables("link", 0)?;
    let mut rows = Rows::default();
    for (row, section) in sections.iter().enumerate() {
        for (number, size) in read_deviations(section)? {
            rows.deviations.insert((row, number), size);
        }
        rows.links.push(read_link(section, warnings)?);
        rows.bodies.push(read_body(section)?);
        rows.origins
            .push(read_origin(section, "origin_xyz_m", "origin_wxyz")?);
    }
    let handle = match head {
        Some(head) => read_origin(head, "handle_xyz_m", "handle_wxyz")?,
        None => None,
    };
    rows.origins.push(handle);
    if sections.is_empty() || rows.origins.iter().all(Option::is_none) {
        rows.origins.clear();
    }
    rows.parents = read_parents(&sections)?;
    rows.hands = read_hands(root, head, &sections, &rows.parents, warnings)?;
    let (drives, is_plain) = read_drives(&sections, joints)?;
    sections.iter().for_each(|row| row.unknown_keys(warnings));
    check_counts(root, &sections, &drives, is_plain, joints)?;
    let own = |(index, drive): (usize, &Drive)| {
        let motion = joints.get(index).map(|joint| joint.joint_type);
        drive.joint == index
            && Some(drive.motion) == motion
            && drive.multiplier == 1.0
            && drive.offset == 0.0
    };
    if drives.len() != joints.len() || !drives.iter().enumerate().all(own) {
        rows.drives = drives;
    }
    Ok(rows)
}

/// What a row says of how far its numbers may be off.
fn read_deviations(section: &Section<'_, '_>) -> Result<Vec<(Parameter, f64)>> {
    let mut found = Vec::new();
    for (number, key) in DEVIATION_KEYS {
        let size = section.not_negative(key, "a size")?;
        found.extend(size.map(|size| (number, size)));
    }
    for word in section.texts("hold")?.unwrap_or_default() {
        let numbers = numbers_of(word).ok_or_else(|| {
            let allowed = "it may list lengths, twists, offsets, a, b, d, alpha, theta, beta";
            section.refuse("hold", format!("\"{word}\""), allowed)
        })?;
        found.extend(numbers.iter().map(|number| (*number, 0.0)));
    }
    Ok(found)
}

/// One row's numbers.
pub(crate) fn read_link(section: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Link> {
    let advice = "give the Denavit-Hartenberg row in full";
    for key in ["a_m", "b_m", "d_m"] {
        section.warn_of_millimetres(key, warnings)?;
    }
    Ok(Link {
        a_m: section.required("a_m", advice)?,
        alpha_rad: angle(section, "alpha_rad", LARGEST_ANGLE_RAD)?
            .ok_or_else(|| section.missing("alpha_rad", advice))?,
        d_m: section.required("d_m", advice)?,
        theta_rad: angle(section, "theta_offset_rad", LARGEST_ANGLE_RAD)?.unwrap_or(0.0),
        beta_rad: angle(section, "beta_rad", LARGEST_ANGLE_RAD)?.unwrap_or(0.0),
        b_m: section.number("b_m")?.unwrap_or(0.0),
    })
}

fn read_body(section: &Section<'_, '_>) -> Result<Option<Body>> {
    let centre = section.vector("centre_of_mass_m")?;
    let mass = section.not_negative("mass_kg", "a mass")?;
    let inertia_kgm2 = section.vector("inertia_kgm2")?;
    if mass.is_none() && inertia_kgm2.is_some() {
        return Err(section.missing("mass_kg", "`inertia_kgm2` is that of a mass: give it too"));
    }
    Ok(mass.map(|mass_kg| Body {
        mass_kg,
        centre_of_mass_m: centre.unwrap_or([0.0; 3]),
        inertia_kgm2,
    }))
}

pub(crate) fn read_origin(
    section: &Section<'_, '_>,
    place: &str,
    turn: &str,
) -> Result<Option<Origin>> {
    let position_m = section.vector(place)?;
    let orientation_wxyz = section.vector::<4>(turn)?;
    if position_m.is_none() && orientation_wxyz.is_none() {
        return Ok(None);
    }
    let origin = Origin {
        position_m: position_m.unwrap_or([0.0; 3]),
        orientation_wxyz: orientation_wxyz.unwrap_or(Origin::IDENTITY.orientation_wxyz),
    };
    let square: f64 = origin.orientation_wxyz.iter().map(|part| part * part).sum();
    if (square.sqrt() - 1.0).abs() > QUATERNION_TOLERANCE {
        let found = format!("a quaternion of length {}", square.sqrt());
        return Err(section.refuse(turn, found, "a unit quaternion w, x, y, z is expected"));
    }
    Ok(Some(origin))
}

/// Drives of rows 1 to n, and whether no row says anything of them. A row without `driven_by` takes the
/// joint behind the last one that a row before it has.
fn read_drives(sections: &[Section<'_, '_>], joints: &[Joint]) -> Result<(Vec<Drive>, bool)> {
    let mut drives = Vec::new();
    let (mut next, mut is_plain) = (0, true);
    for section in sections.iter().skip(1) {
        let stated = section.number("driven_by")?;
        let joint = match stated {
            None => next,
            Some(number) => {
                is_plain = false;
                let joint = (1..=joints.len()).find(|joint| *joint as f64 == number);
                let allowed = format!("a joint from 1 to {} is expected", joints.len());
                joint.ok_or_else(|| section.refuse("driven_by", number.to_string(), &allowed))? - 1
            }
        };
        next = next.max(joint + 1);
        drives.push(read_drive(section, joint, joints, stated.is_some())?);
    }
    Ok((drives, is_plain))
}

fn read_drive(
    section: &Section<'_, '_>,
    joint: usize,
    joints: &[Joint],
    is_stated: bool,
) -> Result<Drive> {
    let own = joints.get(joint).map(|joint| joint.joint_type);
    let motion = section.word("driven_type", JOINT_TYPES)?.or(own);
    let motion = motion.unwrap_or(JointType::Revolute);
    let multiplier = section.number("driven_multiplier")?;
    if let Some(value) = multiplier
        && value.abs() < SMALLEST
    {
        let allowed = format!("at least {SMALLEST:e} in size is expected");
        return Err(section.refuse("driven_multiplier", value.to_string(), &allowed));
    }
    let (offset_key, offset) = match motion {
        JointType::Revolute => {
            let key = "driven_offset_rad";
            (key, angle(section, key, LARGEST_ANGLE_RAD)?)
        }
        JointType::Prismatic => ("driven_offset_m", section.number("driven_offset_m")?),
    };
    if !is_stated {
        for key in ["driven_type", "driven_multiplier", offset_key] {
            if section.has(key) {
                let advice = format!("`{key}` is about the joint that drives the row: name it");
                return Err(section.missing("driven_by", &advice));
            }
        }
    }
    Ok(Drive {
        joint,
        motion,
        multiplier: multiplier.unwrap_or(1.0),
        offset: offset.unwrap_or(0.0),
    })
}

fn check_counts(
    root: &Section<'_, '_>,
    sections: &[Section<'_, '_>],
    drives: &[Drive],
    is_plain: bool,
    joints: &[Joint],
) -> Result<()> {
    if sections.is_empty() {
        return Ok(());
    }
    let found = format!("a list of {} rows", sections.len());
    let joints = joints.len();
    if is_plain {
        if drives.len() == joints {
            return Ok(());
        }
        let allowed = format!(
            "{joints} joints need {} [[link]] rows: row 0 carries frame (-1) to the base",
            joints + 1
        );
        return Err(root.refuse("link", found, &allowed));
    }
    let idle = (0..joints).find(|joint| drives.iter().all(|drive| drive.joint != *joint));
    if let Some(joint) = idle {
        let allowed = format!(
            "no row is driven by joint {}: give it one, or remove the joint",
            joint + 1
        );
        return Err(root.refuse("link", found, &allowed));
    }
    if drives.iter().any(|drive| drive.joint >= joints) {
        let allowed = format!(
            "{joints} joints drive fewer rows: a row that follows another's joint names it with \
             `driven_by`"
        );
        return Err(root.refuse("link", found, &allowed));
    }
    Ok(())
}
