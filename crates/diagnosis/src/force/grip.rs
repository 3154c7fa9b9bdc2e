//! A force of the hand that the sensor does not see: whether any force at the handle, changing as
//! it likes, accounts for what is left.

use haptical_effects::force::GRIP_FORCE;
use nalgebra::{Matrix3, Vector3};

use super::Means;
use super::along::Along;
use super::recorded::Besides;
use super::rows::Whitener;
use crate::answer::{CauseAnswer, IN_NO_CATALOGUE, ParameterAnswer};
use crate::select::excess;
use crate::thresholds::torque::{
    GRIP_LEFT, GRIP_PROBABILITY, LISTED_PROBABILITY, NOISE_DEVIATIONS, SPARE_CHANNELS,
    UNKNOWN_FORCE_SD_N,
};

/// Whether there are torques enough for the test.
pub(super) fn is_testable(channels: usize) -> bool {
    channels >= 3 + SPARE_CHANNELS
}

/// Fits the base model with any force of the hand allowed for. Where that accounts for what is left, returns the
/// force as a cause, and the part of the structure that it leaves. `before` is what the model leaves otherwise,
/// `excess` the structured energy of that.
pub(super) fn grip(
    along: &Along<'_>,
    ordinary: &Whitener,
    before: &Means,
    excess: f64,
) -> Option<(CauseAnswer, f64)> {
    let (blocks, channels) = along.recorded.shape();
    if along.recorded.force_n.is_none() || !is_testable(channels) {
        return None;
    }
    let anything = Besides::Hand(UNKNOWN_FORCE_SD_N);
    let (rest, left) = left_beside(along, anything, 3, excess)?;
    let left = left?;
    // a torque on one joint alone is simpler than a hand that leaves all others as they are
    let square = |channel: &usize| before.column(*channel).norm_squared();
    let mut loudest: Vec<usize> = (0..channels).collect();
    loudest.sort_by(|a, b| square(b).total_cmp(&square(a)));
    for &channel in &loudest[..2] {
        let (_, left) = left_beside(along, Besides::Channel(channel), 1, excess)?;
        if left.is_some() {
            return None;
        }
    }
    // with a force of about the right size allowed for, the base model takes less of it
    let size = rms(&along.hand_force(ordinary, &rest)).max(1e-3);
    let base = along.fit(Besides::Hand(size))?;
    let force_n = rms(&along.hand_force(ordinary, &base.rest()));
    // a force holds over a few blocks, so that about a quarter of them are independent
    let independent = 0.25 * blocks as f64;
    let spec = &GRIP_FORCE.parameters[0];
    let mut number = ParameterAnswer::normal(force_n, force_n / (2.0 * independent).sqrt());
    number.ci95[0] = number.ci95[0].max(0.0);
    let plausible = spec.is_plausible(force_n, 1.0);
    let left = left.min(1.0);
    let probability = LISTED_PROBABILITY * GRIP_PROBABILITY;
    let cause = CauseAnswer {
        confusable_with: vec![IN_NO_CATALOGUE.to_owned()],
        parameters: [(spec.name.to_owned(), number)].into(),
        share: 1.0 - left,
        plausible,
        implausible: !plausible,
        ..CauseAnswer::named(GRIP_FORCE.name, None, probability)
    };
    Some((cause, left))
}

/// Root mean square of a force, its noise taken out.
fn rms(forces: &[(Vector3<f64>, Matrix3<f64>)]) -> f64 {
    let forces = forces.iter();
    let squares = forces.map(|(force, covariance)| force.norm_squared() - covariance.trace());
    let count = squares.len().max(1) as f64;
    (squares.sum::<f64>().max(0.0) / count).sqrt()
}

/// What the base model leaves when something is allowed for in addition, and the part of the
/// structure in that, if that is small.
fn left_beside(
    along: &Along<'_>,
    besides: Besides,
    free: usize,
    before: f64,
) -> Option<(Means, Option<f64>)> {
    let base = along.fit(besides)?;
    let (energy, sd) = excess(&base.energy(free));
    let left = energy.max(0.0) / before.max(1.0);
    let is_small = left <= GRIP_LEFT || energy < NOISE_DEVIATIONS * sd;
    // the geometry stays within its tolerance
    let is_enough = is_small && base.strain() <= 1.0;
    Some((base.rest(), is_enough.then_some(left)))
}
