//! Reads what a device is measured against: the tracker's place, touched points and planes; and compliances.

use crate::DeviceFileError;
use crate::device::Tracker;
use crate::device::surroundings::{
    ContactPoint, JointCompliance, Placement, PlanePair, Surroundings, Tool, TouchedPlane,
};
use crate::file::reader::Section;
use crate::file::row::read_origin;
use crate::file::sensors::{PLACEMENT_KEYS, read_id};

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
    let tools = read_tools(root, warnings)?;
    let unknown = tracker.map_or([false; 2], |tracker| {
        [!tracker.base_known, !tracker.tool_known]
    });
    Ok(Surroundings {
        tracker_base: places[0].filter(|_| unknown[0]),
        tracker_tool: places[1].filter(|_| unknown[1]),
        tools: if unknown[1] { tools } else { Vec::new() },
        contact_sd_m: read_sd(root, "contact", "sd_m", warnings)?,
        contacts: read_contacts(root, warnings)?,
        plane_sd_m: read_sd(root, "plane", "sd_m", warnings)?,
        planes: read_planes(root, warnings)?,
        plane_pairs: read_plane_pairs(root, warnings)?,
        fixture_sd_rad: read_sd(root, "fixture", "sd_rad", warnings)?,
        compliance,
    })
}

/// Keys of a `[[tool]]` that say where it is on its hand.
pub(crate) const TOOL_KEYS: [&str; 2] = ["xyz_m", "wxyz"];

fn read_tools(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<Tool>> {
    let mut seen = Vec::new();
    root.each("tool", warnings, |section| {
        Ok(Tool {
            id: new_id(section, &mut seen)?,
            placement: read_placement(section, TOOL_KEYS)?,
        })
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
    let sd = root.within(table, warnings, |section, _| section.positive(key))?;
    Ok(sd.flatten())
}

/// Says where an id comes from.
const OF_LOG: &str = "give the id that the log has";

/// An id that no earlier table has.
fn new_id(section: &Section<'_, '_>, seen: &mut Vec<String>) -> Result<String> {
    let id = read_id(section, "id", OF_LOG)?;
    if seen.contains(&id) {
        return Err(section.refuse("id", format!("\"{id}\" again"), "each id is used once"));
    }
    seen.push(id.clone());
    Ok(id)
}

fn read_contacts(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<ContactPoint>> {
    let mut seen = Vec::new();
    root.each("contact_point", warnings, |section| {
        let advice = "give the point in frame (-1) in m";
        Ok(ContactPoint {
            id: new_id(section, &mut seen)?,
            position_m: section.required_vector("position_m", advice)?,
        })
    })
}

fn read_planes(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<TouchedPlane>> {
    let mut seen = Vec::new();
    root.each("touched_plane", warnings, |section| {
        let id = new_id(section, &mut seen)?;
        let advice = "give the unit normal in frame (-1)";
        let normal: [f64; 3] = section.required_vector("normal", advice)?;
        let square: f64 = normal.iter().map(|part| part * part).sum();
        if (square.sqrt() - 1.0).abs() > NORMAL_TOLERANCE {
            let found = format!("a vector of length {}", square.sqrt());
            return Err(section.refuse("normal", found, "a unit vector is expected"));
        }
        Ok(TouchedPlane {
            id,
            normal,
            tilt: [0.0; 2],
            offset_m: section.required("offset_m", "give it in m along the normal")?,
        })
    })
}

fn read_plane_pairs(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<PlanePair>> {
    root.each("plane_pair", warnings, |section| {
        let angle_rad = section
            .number("angle_rad")?
            .unwrap_or(std::f64::consts::FRAC_PI_2);
        if !(LEAST_ANGLE_RAD..=std::f64::consts::FRAC_PI_2 + 1e-6).contains(&angle_rad) {
            let allowed = "the angle between two planes is from 0.01 to a right angle, in rad";
            return Err(section.refuse("angle_rad", angle_rad.to_string(), allowed));
        }
        let sd_rad = section.positive("sd_rad")?;
        Ok(PlanePair {
            a: read_id(section, "a", OF_LOG)?,
            b: read_id(section, "b", OF_LOG)?,
            angle_rad,
            sd_rad: sd_rad.ok_or_else(|| section.missing("sd_rad", "give it in rad"))?,
        })
    })
}
