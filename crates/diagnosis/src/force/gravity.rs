//! Unbalanced gravity: a mass or its centre that is not where the device file assumes it.

use haptical_metrics::chi_square_p_value;

use super::along::{Along, numbers};
use super::assumed::{Rows, assumed, shown, with_knowledge};
use super::base::Base;
use super::posture::PER_LINK;
use crate::DiagnosisError;
use crate::engine::regression::Regression;
use crate::engine::system::Column;
use crate::select::scan::Candidate;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{FAMILY_WISE_P, LEAST_WEIGHT};

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
    let assuming = with_knowledge(&base.regression, &known)?;
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

/// Column that sets a number free of what is known of it.
fn release(assuming: &Regression<Rows>, column: usize) -> Column {
    let row = assuming.len() + column;
    let mut entries = vec![0.0; assuming.reading().len()];
    entries[row] = assuming.column(column)[row];
    Column {
        parts: vec![(0, entries)],
    }
}
