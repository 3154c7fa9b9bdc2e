//! What would explain as much in the place of an effect.

use crate::question::{InPlace, Without};
use crate::thresholds::MOST_AHEAD_NATS;

/// Another effect in the place of one that was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Rival<N, F> {
    /// Its name and place.
    pub name: N,
    /// How far it is behind, in the rows' unit over `misfit`.
    pub behind: f64,
    /// What else is known of it.
    pub fit: F,
}

/// Rivals of an effect.
pub type Rivals<Q> = Vec<Rival<<Q as InPlace>::Name, <Q as InPlace>::Fit>>;

/// The rivals of an effect, the nearest first: each name at a place once, by its best. `without`: the model that lacks the effect;
/// `misfit`: what all effects leave, over noise. The more is left, the less differences weigh.
///
/// # Errors
/// Those of the models.
pub fn rivals<Q: InPlace>(
    question: &mut Q,
    whole: &Q::State,
    effect: usize,
    without: &Without<Q::State>,
    misfit: f64,
) -> Result<Rivals<Q>, Q::Error> {
    let others = question.in_place(&without.state, whole, effect)?;
    Ok(nearest(others.into_iter().map(|other| Rival {
        name: other.name,
        behind: (without.worth - other.merit) / misfit,
        fit: other.fit,
    })))
}

/// Rivals, the nearest first: each name at a place once, by its nearest.
///
/// ```
/// use haptical_judge::{Rival, nearest};
///
/// let all = [("lag", 4.0), ("play", 3.0), ("lag", 2.0)];
/// let all = all.map(|(name, behind)| Rival { name, behind, fit: () });
/// let found: Vec<_> = nearest(all).iter().map(|rival| (rival.name, rival.behind)).collect();
/// assert_eq!(found, [("lag", 2.0), ("play", 3.0)]);
/// ```
pub fn nearest<N: PartialEq, F>(rivals: impl IntoIterator<Item = Rival<N, F>>) -> Vec<Rival<N, F>> {
    let mut found: Vec<Rival<N, F>> = Vec::new();
    for rival in rivals {
        match found.iter_mut().find(|known| known.name == rival.name) {
            Some(known) if known.behind <= rival.behind => {}
            Some(known) => *known = rival,
            None => found.push(rival),
        }
    }
    found.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    found
}

/// Probability of an effect among its rivals, all as likely beforehand, by how many nats each of these is behind it.
///
/// ```
/// use haptical_judge::probability;
///
/// assert_eq!(probability([]), 1.0);
/// assert_eq!(probability([0.0]), 0.5);
/// assert!((probability([9.0_f64.ln()]) - 0.9).abs() < 1e-12);
/// ```
pub fn probability(behind_nats: impl IntoIterator<Item = f64>) -> f64 {
    let weight = |behind: f64| (-behind).min(MOST_AHEAD_NATS).exp();
    1.0 / (1.0 + behind_nats.into_iter().map(weight).sum::<f64>())
}
