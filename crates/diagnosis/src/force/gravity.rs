//! Unbalanced gravity: a mass or its centre that is not where the device file assumes it.

use haptical_effects::force::{PAYLOAD, UNBALANCED_GRAVITY};
use haptical_judge::probability;
use haptical_metrics::chi_square_p_value;

use super::Means;
use super::along::Along;
use super::assumed::{Assumed, Known, assumed, with_knowledge};
use super::base::Base;
use super::posture::PER_LINK;
use crate::Result;
use crate::answer::{CauseAnswer, ParameterAnswer};
use crate::select::Candidate;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{FAMILY_WISE_P, LEAST_WEIGHT, LISTED_PROBABILITY};

/// A link whose weight is not the assumed one, with the torque of the difference. Each link's assumed mass and centre
/// are tested against what the torques imply. `rest` is the structured energy of what else is left. `may_be_payload`
/// says whether the catalogue has payloads.
pub(super) fn unbalanced(
    along: &Along<'_>,
    base: &Base,
    (rest, may_be_payload): (f64, bool),
) -> Result<Option<(CauseAnswer, Means)>> {
    let mut links = assumed(along);
    links.retain(|link| link.is_in_file && !link.shown.is_empty());
    let known: Vec<Known> = links.iter().flat_map(|link| link.shown.clone()).collect();
    let assuming = with_knowledge(&base.regression, &known);
    let system = &assuming.system;
    // columns that free a link's numbers from what is known of them
    let released = |link: &Assumed| -> Vec<Vec<f64>> {
        let rows = &system.layout;
        let release = |number: &Known| {
            rows.release(number.0, assuming.column(number.0)[rows.prior(number.0)])
        };
        link.shown.iter().map(release).collect()
    };
    let split = |column: &Vec<f64>| system.layout.split(column);
    let saved = links.iter().map(|link| {
        let columns = released(link).iter().map(split).collect();
        let candidate = Candidate::of_columns(system, columns, 0, 0.0);
        candidate.score(system).score
    });
    let saved: Vec<f64> = saved.collect();
    let Some(best) = (0..saved.len()).max_by(|&a, &b| saved[a].total_cmp(&saved[b])) else {
        return Ok(None);
    };
    let (link, score) = (&links[best], saved[best]);
    let mut free = assuming.clone();
    released(link)
        .into_iter()
        .for_each(|column| free.add(column));
    let solution = free.solution();
    let p = chi_square_p_value(score, link.shown.len() as f64)?;
    let mut change = vec![0.0; along.inertia.len()];
    for &(number, value, _) in &link.shown {
        change[number] = solution[number] - value;
    }
    let torque_nm = along.link_torques(&change);
    let mut channels = torque_nm.column_iter().enumerate();
    let is_large = channels.any(|(channel, column)| {
        let least = (LEAST_WEIGHT * along.row_sd(channel)).powi(2);
        column.norm_squared() > least * column.len() as f64
    });
    if p * links.len() as f64 >= FAMILY_WISE_P || !is_large {
        return Ok(None);
    }
    let moment_nm = torque_nm.amax();
    let deviations = score.sqrt();
    let behind = |index: usize| 0.5 * (score - saved[index]);
    let number = PER_LINK * link.joint;
    let mass_kg = link
        .shown
        .iter()
        .any(|(place, ..)| *place == number)
        .then(|| {
            let variance = free.covariance()[(number, number)];
            (change[number], variance.sqrt())
        });
    let mass_kg = mass_kg.filter(|(mass, sd)| *sd < 0.3 * mass.abs());
    let others = (0..saved.len()).filter(|&index| index != best);
    let probability = LISTED_PROBABILITY * probability(others.map(behind));
    // `deviations` says how far beyond the file's tolerance, in standard deviations
    let numbers = [
        Some((moment_nm, moment_nm / deviations.max(1.0))),
        Some((deviations, 0.0)),
        mass_kg,
    ];
    let specs = UNBALANCED_GRAVITY.parameters.iter().zip(numbers);
    let parameters = specs.filter_map(|(spec, number)| {
        let (value, sd) = number?;
        Some((spec.name.to_owned(), ParameterAnswer::normal(value, sd)))
    });
    let mut cause = CauseAnswer {
        parameters: parameters.collect(),
        share: score / (score + rest),
        ..CauseAnswer::named(UNBALANCED_GRAVITY.name, Some(link.joint), probability)
    };
    // in one run, a mass at the flange and one on the last link share a column
    let last = links
        .iter()
        .position(|link| link.joint + 1 == along.joints());
    let is_put_on = mass_kg.is_none_or(|(mass, _)| mass > 0.0);
    if may_be_payload && is_put_on && last.is_some_and(|last| behind(last) < CONFUSABLE_NATS) {
        cause.confusable_with.push(PAYLOAD.name.to_owned());
        cause.probability *= 0.5;
    }
    Ok(Some((cause, torque_nm)))
}
