//! What is assumed of the links' masses, where torques show them and where they do not.

use haptical_model::{RowBody, Segments};

use super::along::Along;
use super::posture::PER_LINK;
use super::rows::TorqueRows;
use crate::engine::Regression;
use crate::thresholds::torque::{CENTRE_SD_M, LEAST_MASS_SD_KG, MASS_SD, ROD_SD};

/// An inertial number: its place, its assumed value and the standard deviation of that value.
pub(super) type Known = (usize, f64, f64);

/// What is known beforehand of a link's mass and first moments.
pub(super) struct Assumed {
    pub(super) joint: usize,
    /// Whether the device file gives the mass; else it is that of a plausible rod (A150).
    pub(super) is_in_file: bool,
    /// Numbers that the torques show, and numbers that they do not.
    pub(super) shown: Vec<Known>,
    hidden: Vec<Known>,
}

/// Mass and first moments of every link.
pub(super) fn assumed(along: &Along<'_>) -> Vec<Assumed> {
    let device = along.recorded.context.device;
    // a device without links has no rows here
    let segments = Segments::of_device(device).ok();
    let rows = segments.map_or_else(Vec::new, |segments| RowBody::of_rows(device, &segments));
    let of_link = |(joint, body): (usize, &RowBody)| {
        let is_in_file = device.bodies.get(joint + 1).is_some_and(Option::is_some);
        let share = if is_in_file { MASS_SD } else { ROD_SD };
        let moment = body.centre_m * body.mass_kg;
        let values = [body.mass_kg, moment.x, moment.y, moment.z];
        let number = |(place, value): (usize, f64)| {
            let sd = match place {
                0 => (share * value).max(LEAST_MASS_SD_KG),
                _ => (CENTRE_SD_M * body.mass_kg).hypot(share * value).max(1e-6),
            };
            (PER_LINK * joint + place, value, sd)
        };
        let numbers = values.into_iter().enumerate().map(number);
        let is_shown = |known: &Known| along.inertia[known.0].iter().any(|entry| *entry != 0.0);
        let (shown, hidden) = numbers.partition(is_shown);
        Assumed {
            joint,
            is_in_file,
            shown,
            hidden,
        }
    };
    rows.iter().enumerate().map(of_link).collect()
}

/// Inertial numbers by a model of the links alone, with what is assumed of those that the torques do not show.
pub(super) fn with_assumed(along: &Along<'_>, links: &Regression<TorqueRows>) -> Vec<f64> {
    let assumed = assumed(along);
    let shown: Vec<Known> = assumed.iter().flat_map(|link| link.shown.clone()).collect();
    let mut inertia = with_knowledge(links, &shown).solution();
    for (number, value, _) in assumed.into_iter().flat_map(|link| link.hidden) {
        inertia[number] = value;
    }
    inertia
}

/// The model with numbers known beforehand.
pub(super) fn with_knowledge(
    base: &Regression<TorqueRows>,
    known: &[Known],
) -> Regression<TorqueRows> {
    let mut reading = base.reading().to_vec();
    let columns = (0..base.len()).map(|index| base.column(index).to_vec());
    let mut columns: Vec<Vec<f64>> = columns.collect();
    for &(number, value, sd) in known {
        let row = base.system.layout.prior(number);
        let weight = columns[number][row].hypot(1.0 / sd);
        columns[number][row] = weight;
        reading[row] = value / (sd * sd * weight);
    }
    let mut knowing = Regression::new(base.system.layout.clone(), Vec::new(), reading);
    columns.into_iter().for_each(|column| knowing.add(column));
    knowing
}
