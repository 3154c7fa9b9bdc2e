//! How far the numbers of a device moved, those that moved most first; of a URDF's arm the origins of its joints.

use haptical_calibration::{Calibration, ParameterFit};
use haptical_model::kinematics::nalgebra::Rotation3;
use haptical_model::{Device as Model, ParameterId};
use haptical_report::{Cell, Table, earned_decimals};
use haptical_urdf::{JointOrigin, UrdfOrigins};
use serde::Serialize;

use crate::device::{Device, is_urdf};
use crate::error::Error;
use crate::identify::result::ParameterEntry;
use crate::units::Shown;

/// Numbers that are listed; identified.json has all.
pub(super) const LISTED: usize = 10;
/// Half the width of a 95 % interval in standard deviations.
const HALF_WIDTH_SD: f64 = 1.96;
/// Step of a difference quotient, in plausible sizes.
const STEP: f64 = 1e-3;
/// Numbers of an origin: a shift and a turn.
const NUMBERS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];
/// Plausible sizes of the two: those of a length and of an angle of a link (docs/assumptions.md, "Plausible sizes").
const PLAUSIBLE: [f64; 2] = [5e-3, 0.02];

/// A number that was identified, and how far it is from the given device's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovedEntry {
    /// The parameter's name; of a URDF's arm `origin of JOINT, x` for a shift in the frame of the joint's parent link, and
    /// `origin of JOINT, about x` for a turn about an axis of the joint's own frame.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Identified minus given.
    pub deviation: f64,
    /// 95 % interval of the deviation.
    pub ci95: [f64; 2],
    /// Size that a deviation may plausibly have: the entries are in the order of the deviation over it, largest first, those whose
    /// interval holds zero behind the others.
    pub plausible_size: f64,
}

impl MovedEntry {
    /// Whether the interval tells that it moved, and to which side.
    fn is_known(&self) -> bool {
        self.ci95[0] > 0.0 || self.ci95[1] < 0.0
    }

    fn multiples(&self) -> f64 {
        self.deviation.abs() / self.plausible_size
    }
}

/// All numbers that were identified with an interval, those that moved most first; whose interval holds zero come last.
pub(super) fn moved(
    device: &Device,
    calibration: &Calibration,
    parameters: &[ParameterEntry],
) -> Vec<MovedEntry> {
    let mut all = origins(device, calibration).unwrap_or_default();
    let are_origins_said = !all.is_empty();
    let of_parameter = |entry: &ParameterEntry| {
        // a URDF's reader knows no rows of Denavit and Hartenberg
        if are_origins_said && entry.key.starts_with("link[") {
            return None;
        }
        let ([low, high], nominal) = (entry.ci95?, entry.nominal?);
        Some(MovedEntry {
            name: entry.name.clone(),
            unit: entry.unit.clone(),
            deviation: entry.deviation?,
            ci95: [low - nominal, high - nominal],
            plausible_size: entry.plausible_size,
        })
    };
    all.extend(parameters.iter().filter_map(of_parameter));
    let by_size = |a: &MovedEntry, b: &MovedEntry| b.multiples().total_cmp(&a.multiples());
    all.sort_by(|a, b| (b.is_known().cmp(&a.is_known())).then(by_size(a, b)));
    all
}

/// The origins of a URDF's joints that moved, shift and turn one number after the other; none for other devices.
fn origins(device: &Device, calibration: &Calibration) -> Option<Vec<MovedEntry>> {
    let source = device.source();
    if !is_urdf(&source.path) {
        return None;
    }
    let fit = calibration.fitted.whole.as_ref()?;
    let text = source.read_text().ok()?;
    let chain = UrdfOrigins::read(&text, &source.label, device.equipment().ends()).ok()?;
    let given = chain.of(&calibration.nominal).ok()?;
    let deviations = changes(&given, &chain.of(&calibration.device).ok()?);
    let spread = spread(&chain, &given, &calibration.device, fit)?;
    let entries = deviations.iter().zip(&spread).enumerate();
    let entries = entries.map(|(index, (&deviation, &sd))| {
        let (joint, number) = (&given[index / NUMBERS.len()].joint, index % NUMBERS.len());
        let (unit, plausible_size) = match number < 3 {
            true => ("m", PLAUSIBLE[0]),
            false => ("rad", PLAUSIBLE[1]),
        };
        let half = HALF_WIDTH_SD * sd;
        MovedEntry {
            name: format!("origin of {joint}, {}", NUMBERS[number]),
            unit: unit.to_owned(),
            deviation,
            ci95: [deviation - half, deviation + half],
            plausible_size,
        }
    });
    // what no parameter moves is given, not identified
    let is_told = |own: &MovedEntry| own.ci95[0] < own.ci95[1] && own.deviation != 0.0;
    Some(entries.filter(is_told).collect())
}

/// Shift \[m\] in the parent's frame and turn \[rad\] in the own one, of each joint in turn.
fn changes(given: &[JointOrigin], now: &[JointOrigin]) -> Vec<f64> {
    let pairs = given.iter().zip(now);
    let numbers = pairs.flat_map(|(from, to)| {
        let shift: [f64; 3] = (to.pose.position_m - from.pose.position_m).into();
        let turn = from.pose.rotation.transpose() * to.pose.rotation;
        let turn: [f64; 3] = Rotation3::from_matrix_unchecked(turn).scaled_axis().into();
        [shift, turn].concat()
    });
    numbers.collect()
}

/// Standard deviations of all numbers of the origins. What acts like a combination of others keeps its value, and may be off
/// by as much as is plausible: the others are off with it.
fn spread(
    chain: &UrdfOrigins,
    given: &[JointOrigin],
    fitted: &Model,
    fit: &ParameterFit,
) -> Option<Vec<f64>> {
    let (parameters, covariance) = fit.uncertain_with_dependent();
    let of_links = parameters.iter().enumerate();
    let of_links = of_links.filter(|(_, id)| matches!(id, ParameterId::Link { .. }));
    let of_links: Vec<(usize, ParameterId)> = of_links.map(|(index, id)| (index, *id)).collect();
    let mut slopes: Vec<Vec<f64>> = Vec::with_capacity(of_links.len());
    for (_, id) in &of_links {
        let step = STEP * id.plausible_size(fitted);
        let at = |step: f64| {
            let mut moved = fitted.clone();
            id.set(&mut moved, id.value(fitted) + step);
            Some(changes(given, &chain.of(&moved).ok()?))
        };
        let (ahead, behind) = (at(step)?, at(-step)?);
        let pairs = ahead.iter().zip(&behind);
        slopes.push(pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect());
    }
    let variance = |number: usize| {
        let mut sum = 0.0;
        for (a, (row, _)) in of_links.iter().enumerate() {
            for (b, (column, _)) in of_links.iter().enumerate() {
                sum += slopes[a][number] * covariance[(*row, *column)] * slopes[b][number];
            }
        }
        sum.max(0.0).sqrt()
    };
    Some((0..NUMBERS.len() * given.len()).map(variance).collect())
}

/// Those that moved most as a table; none where none did.
pub(super) fn most(moved: &[MovedEntry]) -> Result<Option<Table>, Error> {
    let (count, listed) = (moved.len(), moved.len().min(LISTED));
    let title = match count > listed {
        true => format!("The {listed} of {count} numbers that moved most"),
        false => "What moved".to_owned(),
    };
    match count {
        0 => Ok(None),
        _ => table(&title, &moved[..listed]).map(Some),
    }
}

/// The numbers as a table, lengths in mm and angles in degrees.
pub(super) fn table(title: &str, moved: &[MovedEntry]) -> Result<Table, Error> {
    let rows = moved.iter().map(|entry| {
        let shown = Shown::for_people(&entry.unit);
        let [low, high] = entry.ci95.map(|end| end * shown.per_si);
        let decimals = earned_decimals(0.5 * (high - low)).unwrap_or(6);
        let name = match shown.name {
            "" => entry.name.clone(),
            unit => format!("{} [{unit}]", entry.name),
        };
        vec![
            name.into(),
            Cell::number(entry.deviation * shown.per_si, decimals),
            Cell::interval(low, high, decimals),
        ]
    });
    let columns = "number | moved by | 95 % interval";
    Ok(Table::with_heads(title, columns).with_rows(rows)?)
}

/// Whether the numbers are of the origins of a URDF's joints.
pub(super) fn says_origins(moved: &[MovedEntry]) -> bool {
    let mut names = moved.iter().map(|entry| &entry.name);
    names.any(|name| name.starts_with("origin of "))
}

/// What the order of the table of [`most`] is, and what its intervals leave out; `keeps_more` says that readings keep more than noise.
pub(super) fn note(moved: &[MovedEntry], keeps_more: bool) -> String {
    let moved = &moved[..moved.len().min(LISTED)];
    let mut note = "Moved most: in multiples of what is plausible, 5 mm or 1.1° of a link unless stated; first those whose interval holds no zero.".to_owned();
    if says_origins(moved) {
        note.push_str(
            " Origins are those of the URDF's joints: x, y, z in the parent link's frame, turns about the joint's own axes; \
             what acts like a combination of others keeps its value, and the intervals count what it may be off by.",
        );
    }
    if keeps_more {
        note.push_str(
            " More than noise is left: the intervals count noise alone, and beside a missing effect they do not hold.",
        );
    }
    note
}
