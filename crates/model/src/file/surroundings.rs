//! Reads what stands beside the chain: the tracker's place, touched points and planes, compliances.

use crate::DeviceFileError;
use crate::device::Tracker;
use crate::device::surroundings::{
    ContactPoint, JointCompliance, Placement, PlanePair, Surroundings, TouchedPlane,
};
use crate::file::reader::Section;
use crate::file::row::read_origin;
use crate::file::sensors::PLACEMENT_KEYS;

type Result<T> = std::result::Result<T, DeviceFileError>;

/// How far a normal's length may be from 1.
const NORMAL_TOLERANCE: f64 = 1e-3;
/// Least angle between two planes: that of parallel ones has no derivative.
const LEAST_ANGLE_RAD: f64 = 0.01;

/// Compliances of `[[joint]]`: `compliance_rad_per_nm`, and `fit = ["compliance"]` where it is to be found.
pub(crate) fn read_compliance(joints: &[Section<'_, '_>]) -> Result<Vec<JointCompliance>> {
    let mut found = Vec::with_capacity(joints.len());
    for section in joints {
        let mut compliance = JointCompliance::default();
        for key in ["compliance_rad_per_nm", "compliance_m_per_n"] {
            if let Some(value) = section.number(key)? {
                compliance.rad_per_nm = value;
            }
        }
        for word in section.texts("fit")?.unwrap_or_default() {
            if word != "compliance" {
                let allowed = "it may list \"compliance\"";
                return Err(section.refuse("fit", format!("\"{word}\""), allowed));
            }
            compliance.fit = true;
        }
        found.push(compliance);
    }
    let is_rigid = |joint: &JointCompliance| *joint == JointCompliance::default();
    if found.iter().all(is_rigid) {
        found.clear();
    }
    Ok(found)
}

pub(crate) fn read_surroundings(
    root: &Section<'_, '_>,
    tracker: Option<&Tracker>,
    compliance: Vec<JointCompliance>,
    warnings: &mut Vec<String>,
) -> Result<Surroundings> {
    let places = match root.table("tracker")? {
        None => [None, None],
        Some(section) => [
            read_placement(&section, PLACEMENT_KEYS[0])?,
            read_placement(&section, PLACEMENT_KEYS[1])?,
        ],
    };
    let unknown = tracker.map_or([false; 2], |tracker| {
        [!tracker.base_known, !tracker.tool_known]
    });
    Ok(Surroundings {
        tracker_base: places[0].filter(|_| unknown[0]),
        tracker_tool: places[1].filter(|_| unknown[1]),
        contact_sd_m: read_sd(root, "contact", "sd_m", warnings)?,
        contacts: read_contacts(root, warnings)?,
        plane_sd_m: read_sd(root, "plane", "sd_m", warnings)?,
        planes: read_planes(root, warnings)?,
        plane_pairs: read_plane_pairs(root, warnings)?,
        fixture_sd_rad: read_sd(root, "fixture", "sd_rad", warnings)?,
        compliance,
    })
}

fn read_placement(section: &Section<'_, '_>, keys: [&str; 2]) -> Result<Option<Placement>> {
    let origin = read_origin(section, keys[0], keys[1])?;
    Ok(origin.map(|start| Placement {
        start,
        turn_rad: [0.0; 3],
    }))
}

fn read_sd(
    root: &Section<'_, '_>,
    table: &str,
    key: &str,
    warnings: &mut Vec<String>,
) -> Result<Option<f64>> {
    let Some(section) = root.table(table)? else {
        return Ok(None);
    };
    let sd = section.positive(key)?;
    section.unknown_keys(warnings);
    Ok(sd)
}

fn id(section: &Section<'_, '_>, key: &str) -> Result<String> {
    let text = section.text(key)?;
    let text = text.ok_or_else(|| section.missing(key, "give the id that the log has"))?;
    Ok(text.to_owned())
}

fn read_contacts(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<ContactPoint>> {
    let mut points: Vec<ContactPoint> = Vec::new();
    for section in &root.tables("contact_point", 1)? {
        let id = id(section, "id")?;
        if points.iter().any(|point| point.id == id) {
            return Err(section.refuse("id", format!("\"{id}\" again"), "each id stands once"));
        }
        let position_m = section.vector("position_m")?;
        let advice = "give the point in frame (-1) in m";
        points.push(ContactPoint {
            id,
            position_m: position_m.ok_or_else(|| section.missing("position_m", advice))?,
        });
        section.unknown_keys(warnings);
    }
    Ok(points)
}

fn read_planes(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<TouchedPlane>> {
    let mut planes: Vec<TouchedPlane> = Vec::new();
    for section in &root.tables("touched_plane", 1)? {
        let id = id(section, "id")?;
        if planes.iter().any(|plane| plane.id == id) {
            return Err(section.refuse("id", format!("\"{id}\" again"), "each id stands once"));
        }
        let advice = "give the unit normal in frame (-1)";
        let normal: Option<[f64; 3]> = section.vector("normal")?;
        let normal = normal.ok_or_else(|| section.missing("normal", advice))?;
        let square: f64 = normal.iter().map(|part| part * part).sum();
        if (square.sqrt() - 1.0).abs() > NORMAL_TOLERANCE {
            let found = format!("a vector of length {}", square.sqrt());
            return Err(section.refuse("normal", found, "a unit vector is expected"));
        }
        planes.push(TouchedPlane {
            id,
            normal,
            tilt: [0.0; 2],
            offset_m: section.required("offset_m", "give it in m along the normal")?,
        });
        section.unknown_keys(warnings);
    }
    Ok(planes)
}

fn read_plane_pairs(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<PlanePair>> {
    let mut pairs = Vec::new();
    for section in &root.tables("plane_pair", 1)? {
        let angle_rad = section
            .number("angle_rad")?
            .unwrap_or(std::f64::consts::FRAC_PI_2);
        if !(LEAST_ANGLE_RAD..=std::f64::consts::FRAC_PI_2 + 1e-6).contains(&angle_rad) {
            let allowed = "the angle between two planes is from 0.01 to a right angle, in rad";
            return Err(section.refuse("angle_rad", angle_rad.to_string(), allowed));
        }
        let sd_rad = section.positive("sd_rad")?;
        pairs.push(PlanePair {
            a: id(section, "a")?,
            b: id(section, "b")?,
            angle_rad,
            sd_rad: sd_rad.ok_or_else(|| section.missing("sd_rad", "give it in rad"))?,
        });
        section.unknown_keys(warnings);
    }
    Ok(pairs)
}
