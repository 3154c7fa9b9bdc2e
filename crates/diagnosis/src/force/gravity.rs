//! Unbalanced gravity: a mass or its centre that is not where the device file assumes it.

use haptical_metrics::chi_square_p_value;

use super::Means;
use super::along::Along;
use super::assumed::{Assumed, Known, assumed, with_knowledge};
use super::base::Base;
use super::posture::PER_LINK;
use crate::DiagnosisError;
use crate::select::scan::Candidate;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{FAMILY_WISE_P, LEAST_WEIGHT};

/// A link whose weight is not the assumed one.
#[derive(Debug, Clone)]
pub(super) struct Unbalanced {
    /// Joint that carries it, from 0.
    pub(super) joint: usize,
    /// Largest torque of the difference on any channel \[N m\], with its standard deviation.
    pub(super) moment_nm: (f64, f64),
    /// Difference of the mass \[kg\] and its standard deviation, where the torques fix it.
    pub(super) mass_kg: Option<(f64, f64)>,
    /// How far beyond the file's tolerance, in standard deviations.
    pub(super) deviations: f64,
    pub(super) probability: f64,
    /// Whether a mass at the flange, which moves with the last link, would do as well.
    pub(super) may_be_payload: bool,
    /// Torque of the difference.
    pub(super) torque_nm: Means,
}

/// Tests each link's assumed mass and centre against what the torques imply.
pub(super) fn unbalanced(
    along: &Along<'_>,
    base: &Base,
) -> Result<Option<Unbalanced>, DiagnosisError> {
    let mut links = assumed(along);
    links.retain(|link| link.is_in_file && !link.shown.is_empty());
    let known: Vec<Known> = links.iter().flat_map(|link| link.shown.clone()).collect();
    let assuming = with_knowledge(&base.regression, &known);
    let system = &assuming.system;
    // what sets a link's numbers free of what is known of them
    let released = |link: &Assumed| -> Vec<Vec<f64>> {
        let rows = &system.layout;
        let release = |own: &Known| rows.release(own.0, assuming.column(own.0)[rows.prior(own.0)]);
        link.shown.iter().map(release).collect()
    };
    let saved = links.iter().map(|link| {
        let columns = released(link)
            .iter()
            .map(|own| system.layout.split(own))
            .collect();
        let candidate = Candidate::of_columns(system, columns, 0, 0.0);
        candidate.score(system).score
    });
    let saved: Vec<f64> = saved.collect();
    let Some(best) = (0..saved.len()).max_by(|&a, &b| saved[a].total_cmp(&saved[b])) else {
        return Ok(None);
    };
    let (link, score) = (&links[best], saved[best]);
    let mut free = assuming.clone();
    released(link).into_iter().for_each(|own| free.add(own));
    let solution = free.solution();
    let p = chi_square_p_value(score, link.shown.len() as f64)?;
    let mut change = vec![0.0; along.inertia.len()];
    for &(number, value, _) in &link.shown {
        change[number] = solution[number] - value;
    }
    let torque_nm = along.link_torques(&change);
    let mut channels = torque_nm.column_iter().enumerate();
    let is_large = channels.any(|(channel, own)| {
        let least = (LEAST_WEIGHT * along.row_sd(channel)).powi(2);
        own.norm_squared() > least * own.len() as f64
    });
    if p * links.len() as f64 >= FAMILY_WISE_P || !is_large {
        return Ok(None);
    }
    let moment_nm = torque_nm.amax();
    let deviations = score.sqrt();
    let behind = |index: usize| 0.5 * (score - saved[index]);
    let number = PER_LINK * link.joint;
    let mass_kg = link.shown.iter().any(|own| own.0 == number).then(|| {
        let variance = free.covariance()[(number, number)];
        (change[number], variance.sqrt())
    });
    let mass_kg = mass_kg.filter(|(mass, sd)| *sd < 0.3 * mass.abs());
    let last = links.iter().position(|own| own.joint + 1 == along.joints());
    let others = (0..saved.len()).filter(|&index| index != best);
    let sum: f64 = others.map(|index| (-behind(index)).exp()).sum();
    Ok(Some(Unbalanced {
        joint: link.joint,
        moment_nm: (moment_nm, moment_nm / deviations.max(1.0)),
        mass_kg,
        may_be_payload: last.is_some_and(|last| behind(last) < CONFUSABLE_NATS)
            && mass_kg.is_none_or(|(mass, _)| mass > 0.0),
        deviations,
        probability: 1.0 / (1.0 + sum),
        torque_nm,
    }))
}
