//! What is assumed of the links' masses, where torques show them and where they do not.

use std::ops::Range;

use haptical_linalg::LinalgError;
use haptical_model::{RowBody, Segments};

use super::along::Along;
use super::posture::PER_LINK;
use super::rows::TorqueRows;
use crate::engine::layout::Layout;
use crate::engine::regression::Regression;
use crate::thresholds::torque::{CENTRE_SD_M, LEAST_MASS_SD_KG, MASS_SD, ROD_SD};

/// What is known beforehand of a link's mass and first moments.
pub(super) struct Assumed {
    pub(super) joint: usize,
    /// Whether the device file gives the mass; else it is that of a plausible rod (A150).
    pub(super) is_in_file: bool,
    /// Inertial numbers, each by its place with value and standard deviation.
    pub(super) numbers: [(usize, f64, f64); 4],
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
        let number = |place: usize| {
            let value = values[place];
            let sd = match place {
                0 => (share * value).max(LEAST_MASS_SD_KG),
                _ => (CENTRE_SD_M * body.mass_kg).hypot(share * value).max(1e-6),
            };
            (PER_LINK * joint + place, value, sd)
        };
        Assumed {
            joint,
            is_in_file,
            numbers: [0, 1, 2, 3].map(number),
        }
    };
    rows.iter().enumerate().map(of_link).collect()
}

/// Those that the torques show, by their columns.
pub(super) fn shown(along: &Along<'_>, numbers: &[(usize, f64, f64)]) -> Vec<(usize, f64, f64)> {
    let shown = |&(number, value, sd): &(usize, f64, f64)| {
        let column = along.parameters.iter().position(|&own| own == number)?;
        Some((column, value, sd))
    };
    numbers.iter().filter_map(shown).collect()
}

/// Inertial numbers by a model of the links alone, with what is assumed of those that the torques do not show.
pub(super) fn with_assumed(along: &Along<'_>, links: &Regression<TorqueRows>) -> Vec<f64> {
    let assumed: Vec<_> = assumed(along)
        .iter()
        .flat_map(|link| link.numbers)
        .collect();
    let solution = match with_knowledge(links, &shown(along, &assumed)) {
        Ok(knowing) => knowing.solution(),
        // squares that overflow are none of a number that follows
        Err(_) => links.solution(),
    };
    let mut inertia = along.all_parameters(&solution);
    for (number, value, _) in assumed {
        if !along.parameters.contains(&number) {
            inertia[number] = value;
        }
    }
    inertia
}

/// Rows one after the other.
#[derive(Debug, Clone)]
pub(super) struct Rows(usize);

impl Layout for Rows {
    const SURVIVING: f64 = TorqueRows::SURVIVING;

    fn count(&self) -> usize {
        self.0
    }

    fn range(&self, _: usize) -> Range<usize> {
        0..self.0
    }
}

/// The model with numbers known beforehand, `(column, value, deviation)`. What block means say is folded into one row for
/// each number of the model; the row of what is known of it follows.
pub(super) fn with_knowledge(
    base: &Regression<TorqueRows>,
    known: &[(usize, f64, f64)],
) -> Result<Regression<Rows>, LinalgError> {
    let means = base.system.layout.prior(0);
    let (mut columns, mut reading) = base.condensed(means)?;
    let count = columns.len();
    for &(column, value, sd) in known {
        let weight = columns[column][count + column].hypot(1.0 / sd);
        columns[column][count + column] = weight;
        reading[count + column] = value / (sd * sd * weight);
    }
    let mut assuming = Regression::new(Rows(reading.len()), Vec::new(), reading);
    columns.into_iter().for_each(|column| assuming.add(column));
    Ok(assuming)
}
