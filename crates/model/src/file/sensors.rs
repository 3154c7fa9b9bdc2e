//! Reads what surrounds a device: cable encoders, tracker, contact pairs, gravity.

use crate::DeviceFileError;
use crate::device::cable::{Cable, CableFit};
use crate::device::{ContactPair, Tracker};
use crate::file::reader::Section;
use crate::file::{BASES, PLACES};

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
    let cables = sections.iter().enumerate();
    cables
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
                scale_sd: section.not_negative("scale_sd", "a standard deviation")?,
                exit_axis: section.vector("exit_axis")?,
                zero_m: section.number("zero_m")?.unwrap_or(0.0),
                scale: section.positive("scale")?.unwrap_or(1.0),
                exit_radius_m: section
                    .not_negative("exit_radius_m", "a radius")?
                    .unwrap_or(0.0),
                fit: read_fit(section)?,
            };
            section.unknown_keys(warnings);
            Ok(cable)
        })
        .collect()
}

/// Words of `fit`, and whether each is set.
pub(crate) fn fit_words(mut fit: CableFit) -> [(&'static str, bool); 4] {
    fit_flags(&mut fit).map(|(word, is_fitted)| (word, *is_fitted))
}

fn fit_flags(fit: &mut CableFit) -> [(&'static str, &mut bool); 4] {
    [
        ("anchor", &mut fit.anchor),
        ("zero", &mut fit.zero),
        ("scale", &mut fit.scale),
        ("exit_radius", &mut fit.exit_radius),
    ]
}

fn read_fit(section: &Section<'_, '_>) -> Result<CableFit> {
    let mut fit = CableFit::default();
    for word in section.texts("fit")?.unwrap_or_default() {
        let mut flags = fit_flags(&mut fit).into_iter();
        let (_, is_fitted) = flags.find(|(known, _)| *known == word).ok_or_else(|| {
            let allowed = "it may list \"anchor\", \"zero\", \"scale\" and \"exit_radius\"";
            section.refuse("fit", format!("\"{word}\""), allowed)
        })?;
        *is_fitted = true;
    }
    Ok(fit)
}

/// Keys of `[tracker]` that say where its base and its tool are.
pub(crate) const PLACEMENT_KEYS: [[&str; 2]; 2] =
    [["base_xyz_m", "base_wxyz"], ["tool_xyz_m", "tool_wxyz"]];

/// Key of `[tracker]` for its places run by run.
pub(crate) const BASE_OF_RUN: &str = "base_of_run";
/// Keys of such a place, and of a tool's.
pub(crate) const PLACE_KEYS: [&str; 2] = ["xyz_m", "wxyz"];

pub(crate) fn read_tracker(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Option<Tracker>> {
    root.within("tracker", warnings, |section, _| {
        // the places are read with the surroundings
        for key in PLACEMENT_KEYS.as_flattened().iter().chain(&[BASE_OF_RUN]) {
            section.has(key);
        }
        let (base_known, base_per_run) = section.word("base", BASES)?.unwrap_or((true, false));
        Ok(Tracker {
            base_known,
            base_per_run,
            tool_known: section.word("tool", PLACES)?.unwrap_or(true),
            position_sd_m: section.positive("position_sd_m")?,
            rotation_sd_rad: section.positive("rotation_sd_rad")?,
            scale_sd: section.not_negative("scale_sd", "a standard deviation")?,
        })
    })
}

pub(crate) fn read_contact_pairs(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<ContactPair>> {
    root.each("contact_pair", warnings, |section| {
        let length = |key: &str| {
            let length_m = section.positive(key)?;
            length_m.ok_or_else(|| section.missing(key, "give it in m"))
        };
        let id = |key: &str| read_id(section, key, "give the contact's id");
        Ok(ContactPair {
            a: id("a")?,
            b: id("b")?,
            distance_m: length("distance_m")?,
            sd_m: length("sd_m")?,
        })
    })
}

/// The name of what is touched.
pub(crate) fn read_id(section: &Section<'_, '_>, key: &str, advice: &str) -> Result<String> {
    let text = section.text(key)?;
    let text = text.ok_or_else(|| section.missing(key, advice))?;
    Ok(text.to_owned())
}

pub(crate) fn read_gravity(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Option<[f64; 3]>> {
    root.within("gravity", warnings, |gravity, _| {
        gravity.required_vector("vector_mps2", "give gravity in frame (-1) in m/s^2")
    })
}
