//! Unbalanced gravity: a mass or its centre that is not where the device file assumes it.

use std::ops::Range;

use haptical_metrics::chi_square_p_value;

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
    CENTRE_SD_M, FAMILY_WISE_P, LEAST_MASS_SD_KG, LEAST_WEIGHT, MASS_SD,
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

/// Links whose masses the file gives.
pub(super) fn assumed(along: &Along<'_>) -> Vec<Option<[f64; 4]>> {
    let device = along.recorded.context.device;
    (0..device.joints.len())
        .map(|joint| {
            let body = device.bodies.get(joint + 1).copied().flatten()?;
            let [x, y, z] = body.centre_of_mass_m.map(|place| place * body.mass_kg);
            Some([body.mass_kg, x, y, z])
        })
        .collect()
}

/// Tests each link's assumed mass and centre against what the torques imply.
pub(super) fn unbalanced(
    along: &Along<'_>,
    base: &Base,
    row_sd: &[f64],
) -> Result<Option<Unbalanced>, DiagnosisError> {
    let assumed = assumed(along);
    let mut known = Vec::new();
    let mut groups = Vec::new();
    let mut links = Vec::new();
    for (joint, values) in assumed.iter().enumerate() {
        let Some(values) = values else {
            continue;
        };
        let start = known.len();
        for (place, &value) in values.iter().enumerate() {
            let parameter = PER_LINK * joint + place;
            let Some(column) = along.parameters.iter().position(|&own| own == parameter) else {
                continue;
            };
            let sd = if place == 0 {
                (MASS_SD * values[0]).max(LEAST_MASS_SD_KG)
            } else {
                (CENTRE_SD_M * values[0]).hypot(MASS_SD * value).max(1e-6)
            };
            known.push((column, value, sd));
        }
        if known.len() > start {
            groups.push(start..known.len());
            links.push(joint);
        }
    }
    if groups.is_empty() {
        return Ok(None);
    }
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
    let mut change = vec![0.0; numbers(assumed.len())];
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
    let last = links.iter().position(|&joint| joint + 1 == assumed.len());
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
