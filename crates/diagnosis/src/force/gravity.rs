//! Unbalanced gravity: a mass or its centre that is not where the device file assumes it.

use std::ops::Range;

use haptical_metrics::chi_square_p_value;
use haptical_model::{RowBody, Segments};

use super::along::{Along, numbers};
use super::base::Base;
use super::posture::PER_LINK;
use super::rows::TorqueRows;
use crate::DiagnosisError;
use crate::engine::layout::Layout;
use crate::engine::regression::Regression;
use crate::engine::system::Column;
use crate::select::scan::Candidate;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{
    CENTRE_SD_M, FAMILY_WISE_P, LEAST_MASS_SD_KG, LEAST_WEIGHT, MASS_SD, ROD_SD,
};

/// A link whose weight is not the assumed one.
#[derive(Debug, Clone)]
pub(super) struct Unbalanced {
    /// Joint that carries it, from 0.
    pub(super) joint: usize,
    /// Largest torque of the difference on any channel \[N m\], with its standard deviation.
    pub(super) moment_nm: f64,
    pub(super) moment_sd_nm: f64,
    /// Difference of the mass \[kg\] and its standard deviation, where the torques fix it.
    pub(super) mass_kg: Option<(f64, f64)>,
    /// How far beyond the file's tolerance, in standard deviations.
    pub(super) deviations: f64,
    pub(super) probability: f64,
    /// Whether a mass at the flange, which moves with the last link, would do as well.
    pub(super) may_be_payload: bool,
    /// Torque of the difference, channel after channel.
    pub(super) torque_nm: Vec<f64>,
}

/// What is known beforehand of a link's mass and first moments.
pub(super) struct Assumed {
    joint: usize,
    /// Whether the device file gives the mass; else it is that of a plausible rod (A150).
    pub(super) is_in_file: bool,
    /// Inertial numbers, each by its place with value and standard deviation.
    numbers: [(usize, f64, f64); 4],
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
fn shown(along: &Along<'_>, numbers: &[(usize, f64, f64)]) -> Vec<(usize, f64, f64)> {
    let shown = |&(number, value, sd): &(usize, f64, f64)| {
        let column = along.parameters.iter().position(|&own| own == number)?;
        Some((column, value, sd))
    };
    numbers.iter().filter_map(shown).collect()
}

/// Inertial numbers by a model of the links alone, with what is assumed of those that the torques do not show.
pub(super) fn with_assumed(along: &Along<'_>, links: &Base) -> Vec<f64> {
    let assumed: Vec<_> = assumed(along)
        .iter()
        .flat_map(|link| link.numbers)
        .collect();
    let solution = match with_knowledge(links, &shown(along, &assumed)) {
        Ok(knowing) => knowing.solution(),
        // squares that overflow are none of a number that follows
        Err(_) => links.regression.solution(),
    };
    let mut inertia = along.all_parameters(&solution);
    for (number, value, _) in assumed {
        if !along.parameters.contains(&number) {
            inertia[number] = value;
        }
    }
    inertia
}

/// Tests each link's assumed mass and centre against what the torques imply.
pub(super) fn unbalanced(
    along: &Along<'_>,
    base: &Base,
    row_sd: &[f64],
) -> Result<Option<Unbalanced>, DiagnosisError> {
    let mut known = Vec::new();
    let mut groups = Vec::new();
    let mut links = Vec::new();
    for link in assumed(along) {
        let shown = shown(along, &link.numbers);
        if link.is_in_file && !shown.is_empty() {
            let start = known.len();
            known.extend(shown);
            groups.push(start..known.len());
            links.push(link.joint);
        }
    }
    if groups.is_empty() {
        return Ok(None);
    }
    let joints = along.recorded.context.device.joints.len();
    let assuming = with_knowledge(base, &known)?;
    let releases: Vec<Vec<Column>> = groups
        .iter()
        .map(|group| {
            let columns = known[group.clone()].iter();
            columns
                .map(|(column, ..)| release(&assuming, *column))
                .collect()
        })
        .collect();
    let saved: Vec<f64> = releases
        .iter()
        .map(|columns| {
            let system = &assuming.system;
            Candidate::of_columns(system, columns.clone(), 0, 0.0).score(system)
        })
        .map(|score| score.score)
        .collect();
    let Some(best) = (0..saved.len()).max_by(|&a, &b| saved[a].total_cmp(&saved[b])) else {
        return Ok(None);
    };
    let score = saved[best];
    let mut released = assuming.clone();
    for column in &releases[best] {
        released.add(assuming.system.dense(column));
    }
    let solution = released.solution();
    let p = chi_square_p_value(score, groups[best].len() as f64)?;
    let mut change = vec![0.0; numbers(joints)];
    for &(column, value, _) in &known[groups[best].clone()] {
        change[along.parameters[column]] = solution[column] - value;
    }
    let torque_nm = along.link_torques(&change);
    let blocks = along.recorded.blocks.len();
    let is_large = (0..row_sd.len()).any(|channel| {
        let own = &torque_nm[channel * blocks..(channel + 1) * blocks];
        let square = own.iter().map(|torque| torque * torque).sum::<f64>();
        square > (LEAST_WEIGHT * row_sd[channel]).powi(2) * blocks as f64
    });
    if p * groups.len() as f64 >= FAMILY_WISE_P || !is_large {
        return Ok(None);
    }
    let moment_nm = torque_nm
        .iter()
        .fold(0.0, |most: f64, torque| most.max(torque.abs()));
    let deviations = score.sqrt();
    let behind = |index: usize| 0.5 * (score - saved[index]);
    let mass = known[groups[best].clone()]
        .iter()
        .find(|(column, _, _)| along.parameters[*column] == PER_LINK * links[best])
        .map(|&(column, value, _)| {
            let variance = released.covariance()[(column, column)];
            (solution[column] - value, variance.sqrt())
        });
    let mass = mass.filter(|(mass, sd)| *sd < 0.3 * mass.abs());
    let last = links.iter().position(|&joint| joint + 1 == joints);
    let may_be_payload = last.is_some_and(|last| behind(last) < CONFUSABLE_NATS)
        && mass.is_none_or(|(mass, _)| mass > 0.0);
    let others = (0..saved.len()).filter(|&index| index != best);
    let sum: f64 = others.map(|index| (-behind(index)).exp()).sum();
    Ok(Some(Unbalanced {
        joint: links[best],
        moment_nm,
        moment_sd_nm: moment_nm / deviations.max(1.0),
        mass_kg: mass,
        may_be_payload,
        deviations,
        probability: 1.0 / (1.0 + sum),
        torque_nm,
    }))
}

/// Rows one after the other.
#[derive(Debug, Clone)]
struct Rows(usize);

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
fn with_knowledge(
    base: &Base,
    known: &[(usize, f64, f64)],
) -> Result<Regression<Rows>, DiagnosisError> {
    let means = base.regression.system.layout.prior(0);
    let (mut columns, mut reading) = base.regression.condensed(means)?;
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

/// Column that sets a number free of what is known of it.
fn release(assuming: &Regression<Rows>, column: usize) -> Column {
    let row = assuming.len() + column;
    let mut entries = vec![0.0; assuming.reading().len()];
    entries[row] = assuming.column(column)[row];
    Column {
        parts: vec![(0, entries)],
    }
}
