//! Reads what a device is measured against: the tracker's place, touched points and planes; and compliances.

use crate::DeviceFileError;
use crate::device::Tracker;
use crate::device::mount::{RunBase, Tool};
use crate::device::surroundings::{
    ContactPoint, JointCompliance, Placement, PlanePair, Surroundings, TouchedPlane,
};
use crate::file::reader::Section;
use crate::file::row::read_origin;
use crate::file::sensors::{BASE_OF_RUN, PLACE_KEYS, PLACEMENT_KEYS, read_id};

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
    let (places, run_bases) = match root.table("tracker")? {
        None => ([None, None], Vec::new()),
        Some(section) => (
            [
                read_placement(&section, PLACEMENT_KEYS[0])?,
                read_placement(&section, PLACEMENT_KEYS[1])?,
            ],
            read_run_bases(&section, warnings)?,
        ),
    };
    let unknown = tracker.map_or([false; 3], |tracker| {
        let is_one = !tracker.base_per_run;
        [!tracker.base_known && is_one, !tracker.tool_known, !is_one]
    });
    if let (Some(section), Some(_)) = (root.table("tracker")?, tracker) {
        let is_lost = |place: usize| places[place].is_some() && !unknown[place];
        refuse_lost_places(&section, [is_lost(0), is_lost(1)])?;
    }
    Ok(Surroundings {
        tracker_base: places[0].filter(|_| unknown[0]),
        run_bases: if unknown[2] { run_bases } else { Vec::new() },
        tracker_tool: places[1].filter(|_| unknown[1]),
        tools: read_tools(root, warnings)?,
        contact_sd_m: read_sd(root, "contact", "sd_m", warnings)?,
        contacts: read_contacts(root, warnings)?,
        plane_sd_m: read_sd(root, "plane", "sd_m", warnings)?,
        planes: read_planes(root, warnings)?,
        plane_pairs: read_plane_pairs(root, warnings)?,
        fixture_sd_rad: read_sd(root, "fixture", "sd_rad", warnings)?,
        compliance,
    })
}

/// A place that the words `base` and `tool` leave no use for must not be lost without a word.
fn refuse_lost_places(tracker: &Section<'_, '_>, is_lost: [bool; 2]) -> Result<()> {
    let words = [
        "`base` says otherwise: \"known\" (also where it is left out) is the frame (-1) of the device, \"per-run\" has \
         [[tracker.base_of_run]]; write base = \"unknown\", whose fit starts at this place",
        "`tool` says otherwise: \"known\" (also where it is left out) is the handle itself; write tool = \"unknown\", whose \
         fit starts at this place, or make this place the device's handle",
    ];
    for (index, keys) in PLACEMENT_KEYS.iter().enumerate() {
        if is_lost[index] {
            let key = keys.iter().find(|key| tracker.has(key)).unwrap_or(&keys[0]);
            return Err(tracker.refuse(key, "a place", words[index]));
        }
    }
    Ok(())
}

fn read_placement(section: &Section<'_, '_>, keys: [&str; 2]) -> Result<Option<Placement>> {
    let origin = read_origin(section, keys[0], keys[1])?;
    Ok(origin.map(|start| Placement {
        start,
        turn_rad: [0.0; 3],
    }))
}

fn read_run_bases(tracker: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<RunBase>> {
    let mut seen = Vec::new();
    tracker.each(BASE_OF_RUN, warnings, |section| {
        let run = whole(
            section,
            "run",
            "the integer of the log's column run is expected",
        )?;
        let run = run.ok_or_else(|| section.missing("run", "give the run that the log has"))?;
        if seen.contains(&run) {
            return Err(section.refuse("run", format!("{run} again"), "each run has one place"));
        }
        seen.push(run);
        let placement = read_placement(section, PLACE_KEYS)?;
        let advice = "give frame (-1) seen from the tracker, in m";
        let placement = placement.ok_or_else(|| section.missing(PLACE_KEYS[0], advice))?;
        Ok(RunBase { run, placement })
    })
}

fn read_tools(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<Tool>> {
    let mut seen = Vec::new();
    root.each("tool", warnings, |section| {
        let id = new_id(section, &mut seen)?;
        if id.is_empty() {
            let allowed = "no text means the handle itself, which needs no table";
            return Err(section.refuse("id", "\"\"", allowed));
        }
        let allowed = "a line of the log is expected, of which line 1 has the names";
        let from_line = whole(section, "from_line", allowed)?;
        let from_line = from_line.map(|line| match u64::try_from(line) {
            Ok(line @ 2..) => Ok(line),
            _ => Err(section.refuse("from_line", line.to_string(), allowed)),
        });
        Ok(Tool {
            id,
            placement: read_placement(section, PLACE_KEYS)?,
            has_turn: section.has(PLACE_KEYS[1]),
            from_line: from_line.transpose()?,
        })
    })
}

/// An integer that a number of 64 bits holds exactly.
fn whole(section: &Section<'_, '_>, key: &str, allowed: &str) -> Result<Option<i64>> {
    let number = section.number(key)?;
    let number = number.map(|number| {
        let is_whole = number.fract() == 0.0 && number.abs() < 2_f64.powi(53);
        is_whole
            .then_some(number as i64)
            .ok_or_else(|| section.refuse(key, number.to_string(), allowed))
    });
    number.transpose()
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
