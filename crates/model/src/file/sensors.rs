//! Reads what surrounds a device: cable encoders, tracker, contact pairs, gravity.

use crate::DeviceFileError;
use crate::device::cable::{Cable, CableFit};
use crate::device::{ContactPair, Tracker};
use crate::file::reader::Section;

type Result<T> = std::result::Result<T, DeviceFileError>;

pub(crate) fn read_cables(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Cable>> {
    let mut sections = Vec::new();
    sections.extend(root.table("cable_encoder")?);
    let further = root.tables("cable", 2)?;
    if let (true, Some(first)) = (sections.is_empty(), further.first()) {
        let advice = "the first cable is [cable_encoder]; further ones are [[cable]]";
        return Err(root.missing_for(first, "cable_encoder", advice));
    }
    sections.extend(further);
    sections
        .iter()
        .enumerate()
        .map(|(index, section)| {
            let anchor = section.vector("anchor_m")?;
            if index > 0 && anchor.is_none() {
                let advice = "give the point in frame (-1) where this cable leaves its guide";
                return Err(section.missing("anchor_m", advice));
            }
            section.warn_of_millimetres("drum_radius_m", warnings)?;
            let cable = Cable {
                anchor_m: anchor.unwrap_or([0.0; 3]),
                drum_radius_m: section.positive("drum_radius_m")?,
                counts_per_rev: section.positive("counts_per_rev")?,
                distance_sd_m: section.positive("distance_sd_m")?,
                exit_axis: section.vector("exit_axis")?,
                zero_m: section.number("zero_m")?.unwrap_or(0.0),
                scale: section.positive("scale")?.unwrap_or(1.0),
                exit_radius_m: read_radius(section)?,
                fit: read_fit(section)?,
            };
            section.unknown_keys(warnings);
            Ok(cable)
        })
        .collect()
}

fn read_radius(section: &Section<'_, '_>) -> Result<f64> {
    match section.number("exit_radius_m")? {
        Some(radius_m) if radius_m < 0.0 => {
            let allowed = "a radius is not negative";
            Err(section.refuse("exit_radius_m", radius_m.to_string(), allowed))
        }
        other => Ok(other.unwrap_or(0.0)),
    }
}

fn read_fit(section: &Section<'_, '_>) -> Result<CableFit> {
    let mut fit = CableFit::default();
    for word in section.texts("fit")?.unwrap_or_default() {
        match word {
            "anchor" => fit.anchor = true,
            "zero" => fit.zero = true,
            "scale" => fit.scale = true,
            "exit_radius" => fit.exit_radius = true,
            other => {
                let allowed = "it may list \"anchor\", \"zero\", \"scale\" and \"exit_radius\"";
                return Err(section.refuse("fit", format!("\"{other}\""), allowed));
            }
        }
    }
    Ok(fit)
}

/// Keys of `[tracker]` that say where its base and its tool are.
pub(crate) const PLACEMENT_KEYS: [[&str; 2]; 2] =
    [["base_xyz_m", "base_wxyz"], ["tool_xyz_m", "tool_wxyz"]];

pub(crate) fn read_tracker(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Option<Tracker>> {
    let Some(section) = root.table("tracker")? else {
        return Ok(None);
    };
    let known = |key: &str| match section.text(key)? {
        None | Some("known") => Ok(true),
        Some("unknown") => Ok(false),
        Some(other) => {
            let allowed = "it must be \"known\" or \"unknown\"";
            Err(section.refuse(key, format!("\"{other}\""), allowed))
        }
    };
    let tracker = Tracker {
        base_known: known("base")?,
        tool_known: known("tool")?,
        position_sd_m: section.positive("position_sd_m")?,
        rotation_sd_rad: section.positive("rotation_sd_rad")?,
    };
    // read with the surroundings
    let _ = PLACEMENT_KEYS
        .as_flattened()
        .iter()
        .filter(|key| section.has(key))
        .count();
    section.unknown_keys(warnings);
    Ok(Some(tracker))
}

pub(crate) fn read_contact_pairs(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<ContactPair>> {
    root.tables("contact_pair", 1)?
        .iter()
        .map(|section| {
            let id = |key: &str| match section.text(key)? {
                Some(text) => Ok(text.to_owned()),
                None => Err(section.missing(key, "give the contact's id")),
            };
            let missing = |key: &str| section.missing(key, "give it in m");
            let pair = ContactPair {
                a: id("a")?,
                b: id("b")?,
                distance_m: section
                    .positive("distance_m")?
                    .ok_or_else(|| missing("distance_m"))?,
                sd_m: section.positive("sd_m")?.ok_or_else(|| missing("sd_m"))?,
            };
            section.unknown_keys(warnings);
            Ok(pair)
        })
        .collect()
}

pub(crate) fn read_gravity(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Option<[f64; 3]>> {
    let Some(gravity) = root.table("gravity")? else {
        return Ok(None);
    };
    let vector = gravity.vector("vector_mps2")?;
    gravity.unknown_keys(warnings);
    match vector {
        Some(vector) => Ok(Some(vector)),
        None => Err(gravity.missing("vector_mps2", "give gravity in frame (-1) in m/s^2")),
    }
}
