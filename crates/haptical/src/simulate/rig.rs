//! The rig of a simulated log: what it measures, and the file that says so to whoever reads the log.

use haptical_calibration::Channel;
use haptical_design::{Measure, Rig, Terms, equip};
use haptical_model::{ContactPair, Device as Model, PlanePair, Recording};
use haptical_simulator::PostureSensors;
use toml_edit::DocumentMut;

use crate::columns::measured_columns;
use crate::device::Device;
use crate::error::Error;

/// Noise that a rig file states where the device file does not: what a calibration takes then \[m, rad\].
const UNSTATED_SD: f64 = 1e-4;
/// Standard deviation of a distance or angle that a rig's name states, as `haptical plan` takes it \[m, rad\].
const STATED_SD: f64 = 1e-5;
/// Angles that homing fixtures hold each link at, as shares of the way from the lowest to the highest, and how often.
const HELD_AT: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
const TIMES: usize = 2;
/// Lowest and highest of these angles, within the joint's limits \[rad, m\].
const HELD: f64 = 0.5;

/// Sections of a rig file for each kind of reading.
const CABLES: [&str; 2] = ["cable_encoder", "cable"];
const TRACKER: [&str; 1] = ["tracker"];
const POINTS: [&str; 2] = ["contact", "contact_pair"];
const PLANES: [&str; 2] = ["plane", "plane_pair"];
const FIXTURES: [&str; 1] = ["fixture"];

/// A device with a rig, and what is read of it.
pub(super) struct Rigged {
    pub(super) model: Model,
    pub(super) sensors: PostureSensors,
    /// Joints that a homing fixture holds, from 0.
    pub(super) fixtures: Vec<usize>,
    /// A rig file; none for the device's own sensors.
    pub(super) file: Option<String>,
}

/// The device with its own sensors: those that a log has readings of, else external encoders that it describes, cables, the
/// tracker.
pub(super) fn described(model: &Model, log: &Recording) -> Rigged {
    let is_log = has_readings(log);
    let has_links = model.has_links();
    let tracker = model.tracker.filter(|_| has_links);
    // a tracker of which the noise of positions alone is stated sees points
    let sees_turn =
        tracker.is_some_and(|own| own.rotation_sd_rad.is_some() || own.position_sd_m.is_none());
    let is_there = |columns: &[Option<Vec<f64>>], index: usize, usual: bool| match is_log {
        true => columns.get(index).is_some_and(Option::is_some),
        false => usual,
    };
    let outputs = model.joints.iter().enumerate();
    let outputs = outputs.map(|(joint, described)| {
        is_there(&log.output, joint, described.output_sd_rad().is_some())
    });
    let cables = (0..model.cables.len())
        .map(|index| has_links && is_there(&log.cable_m, index, true))
        .collect();
    Rigged {
        sensors: PostureSensors {
            outputs: outputs.collect(),
            cables,
            position: match is_log {
                true => log.position_m.is_some(),
                false => tracker.is_some(),
            },
            orientation: match is_log {
                true => log.orientation_wxyz.is_some(),
                false => sees_turn,
            },
        },
        model: model.clone(),
        fixtures: Vec::new(),
        file: None,
    }
}

/// Whether postures are a log that was measured.
fn has_readings(log: &Recording) -> bool {
    let mut columns = log.output.iter().chain(&log.cable_m);
    columns.any(Option::is_some) || log.position_m.is_some() || log.orientation_wxyz.is_some()
}

/// Empties the cells that a log has no readings in; `left_out` are its rows that the recording does not have.
pub(super) fn blank_as(recording: &mut Recording, log: &Recording, left_out: &[usize]) {
    let kept: Vec<usize> = (0..log.len())
        .filter(|row| !left_out.contains(row))
        .collect();
    let blank = |column: &mut Vec<f64>, own: &[f64]| {
        for (value, &row) in column.iter_mut().zip(&kept) {
            if own[row].is_nan() {
                *value = f64::NAN;
            }
        }
    };
    for column in measured_columns(log) {
        if let (Some(values), Some(own)) = (column.readings_mut(recording), column.readings(log)) {
            blank(values, own);
        }
    }
}

/// The device with the sensors of a rig.
pub(super) fn rigged(device: &Device, rig: &Rig) -> Result<Rigged, Error> {
    let path = &device.source().path;
    let equipped = equip(&device.model, rig, Terms::Known)
        .map_err(|error| Error::design(&error, path).with_equipment(device))?;
    let mut model = equipped.device;
    // encoders that the file does not describe stay so for whoever reads the log
    model.joints.clone_from(&device.model.joints);
    model.surroundings.clone_from(&device.model.surroundings);
    if let Some(tracker) = &mut model.tracker {
        let around = &mut model.surroundings;
        around.tracker_base = around.tracker_base.filter(|_| !tracker.base_known);
        around.tracker_tool = around.tracker_tool.filter(|_| !tracker.tool_known);
        around.run_bases.clear();
        tracker.position_sd_m = tracker.position_sd_m.or(Some(UNSTATED_SD));
        tracker.rotation_sd_rad = tracker.rotation_sd_rad.or(Some(UNSTATED_SD));
    }
    for measure in &rig.measures {
        add_references(&mut model, measure);
    }
    let has = |channel: Channel| equipped.channels.contains(&channel);
    let joints = 0..model.joints.len();
    let outputs = joints.clone().map(|joint| has(Channel::Output { joint }));
    let cables = (0..model.cables.len()).map(|index| has(Channel::Cable { index }));
    let sensors = PostureSensors {
        outputs: outputs.collect(),
        cables: cables.collect(),
        position: has(Channel::Position),
        orientation: has(Channel::Orientation),
    };
    let fixtures: Vec<usize> = joints
        .filter(|&joint| has(Channel::Fixture { joint }))
        .collect();
    let mut kept: Vec<&str> = Vec::new();
    for (is_kept, sections) in [
        (sensors.cables.contains(&true), &CABLES[..]),
        (sensors.position, &TRACKER),
        (has(Channel::Contact), &POINTS),
        (has(Channel::Plane), &PLANES),
        (!fixtures.is_empty(), &FIXTURES),
    ] {
        kept.extend(sections.iter().filter(|_| is_kept));
    }
    Ok(Rigged {
        file: file(&model, rig, &kept)?,
        model,
        sensors,
        fixtures,
    })
}

/// What is known of touched things and fixtures.
fn add_references(model: &mut Model, measure: &Measure) {
    let around = &mut model.surroundings;
    let names = |kind: &str| [1, 2].map(|number| format!("{kind}{number}"));
    match measure {
        Measure::Contact { distance_m, .. } => {
            around.contact_sd_m.get_or_insert(UNSTATED_SD);
            let [a, b] = names("socket");
            if let Some(distance_m) = *distance_m {
                model.contact_pairs = vec![ContactPair {
                    a,
                    b,
                    distance_m,
                    sd_m: STATED_SD,
                }];
            }
        }
        Measure::Plane { planes } => {
            around.plane_sd_m.get_or_insert(UNSTATED_SD);
            if *planes > 1 {
                let [a, b] = names("plane");
                around.plane_pairs = vec![PlanePair {
                    a,
                    b,
                    angle_rad: std::f64::consts::FRAC_PI_2,
                    sd_rad: STATED_SD,
                }];
            }
        }
        Measure::Fixture { .. } => {
            around.fixture_sd_rad.get_or_insert(UNSTATED_SD);
        }
        _ => {}
    }
}

/// A rig file with these sections of a device; none where it would be empty. No place is in it that somebody would have to
/// find out.
fn file(model: &Model, rig: &Rig, kept: &[&str]) -> Result<Option<String>, Error> {
    if kept.is_empty() {
        return Ok(None);
    }
    let mut bare = model.clone();
    bare.forget_tracker_places();
    let text = bare.to_new_toml().map_err(Error::internal)?;
    let mut document: DocumentMut = text.parse().map_err(Error::internal)?;
    document.retain(|key, _| kept.contains(&key));
    let (name, text) = (&rig.name, document.to_string());
    let text = text.trim_start();
    Ok(Some(format!(
        "# Sensors of the rig {name}, for --rig.\n\n{text}"
    )))
}

/// The postures, and after them the fixtures: all of them hold their links at five angles about home, twice, unless the
/// postures have their columns.
pub(super) fn with_fixtures(
    postures: &Recording,
    fixtures: &[usize],
    model: &Model,
) -> Option<Recording> {
    let name = |joint: usize| format!("fixture{}_{}", joint + 1, model.joints[joint].unit());
    let is_there = |joint: &&usize| {
        let name = name(**joint);
        postures.covariates.iter().any(|(known, _)| *known == name)
    };
    if postures.is_empty() || fixtures.iter().all(|joint| is_there(&joint)) {
        return None;
    }
    let rows = postures.len();
    let held = HELD_AT.repeat(TIMES);
    let picked: Vec<usize> = (0..rows)
        .chain(std::iter::repeat_n(rows - 1, held.len()))
        .collect();
    let mut with = postures.select(&picked);
    for row in rows..picked.len() {
        with.joint.iter_mut().for_each(|column| column[row] = 0.0);
        let ids = [&mut with.contact, &mut with.plane, &mut with.tool];
        ids.into_iter().flatten().for_each(|ids| ids[row].clear());
        if let Some(time_s) = &mut with.time_s {
            time_s[row] = time_s[row - 1] + 1.0;
        }
    }
    for &joint in fixtures.iter().filter(|joint| !is_there(joint)) {
        let described = &model.joints[joint];
        let low = described.lower_rad.clamp(-HELD, HELD);
        let high = described.upper_rad.min(HELD).max(low);
        let angles = held.iter().map(|share| low + share * (high - low));
        let column = std::iter::repeat_n(f64::NAN, rows).chain(angles).collect();
        with.covariates.push((name(joint), column));
    }
    Some(with)
}
