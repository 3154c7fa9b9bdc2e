//! Which laws are between a joint's current and its torque.

use std::convert::Infallible;

use haptical_judge::{
    Backward, Forward, Gain, InPlace, Less, Needless, Other, Others, Proposal, Proposals, Rival,
    Ruled, Ruling, Without, rivals, select, without_needless,
};

use super::rows::Rows;
use crate::thresholds::current::{LEAST_NATS, LEAST_SHARE, SURE_SD};

/// A model with some laws.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Places of its laws among those of the rows.
    pub(super) taken: Vec<usize>,
    /// The torque constant first.
    pub(super) coefficients: Vec<f64>,
    /// The same without each part.
    pub(super) folds: Vec<Vec<f64>>,
    /// Squares that fits to the others leave of each part, over the variance of noise.
    pub(super) unseen: Vec<f64>,
}

pub(super) struct Chosen {
    pub(super) before: Fitted,
    pub(super) fitted: Fitted,
    /// Of each law what it explains with the others in the model \[nats\], and what would do in its place.
    pub(super) worth: Vec<f64>,
    pub(super) rivals: Vec<Vec<Rival<&'static str, ()>>>,
}

struct Search<'r>(&'r Rows);
pub(super) fn choose(rows: &Rows) -> Chosen {
    let mut search = Search(rows);
    let before = search.fit(Vec::new());
    let Ok(fitted) = select(&mut search, before.clone());
    let Ok(kept) = without_needless(&mut search, fitted, 0);
    let fitted = kept.state;
    let blocks = rows.torque_nm.len() as f64;
    let misfit = (fitted.unseen.iter().sum::<f64>() / blocks).max(1.0);
    let near = (0..fitted.taken.len()).map(|effect| {
        let Ok(without) = search.without(&fitted, effect);
        let Ok(near) = rivals(&mut search, &fitted, effect, &without, misfit);
        near
    });
    Chosen {
        rivals: near.collect(),
        worth: kept.worth.unwrap_or_default(),
        before,
        fitted,
    }
}

/// Logarithm of the likelihood that a model gains on unseen parts.
fn nats(before: &Fitted, after: &Fitted) -> f64 {
    0.5 * Gain::between(&before.unseen, &after.unseen).sum
}

impl Search<'_> {
    fn fit(&self, taken: Vec<usize>) -> Fitted {
        let columns = self.0.columns_of(&taken);
        let solve = |products: &haptical_linalg::NormalEquations| {
            products.solve(&columns, |_| 0.0).coefficients().to_vec()
        };
        let parts = &self.0.parts;
        let folds: Vec<Vec<f64>> = (parts.iter())
            .map(|part| solve(&self.0.all.plus(part, -1.0)))
            .collect();
        let left = parts.iter().zip(&folds);
        let left = left.map(|(part, fold)| part.left(&columns, fold));
        Fitted {
            unseen: left.map(|own| own / self.0.noise_nm.powi(2)).collect(),
            coefficients: solve(&self.0.all),
            folds,
            taken,
        }
    }

    /// A model with a further law, where nature allows all of its numbers.
    fn with(&self, taken: &[usize], law: usize) -> Option<Fitted> {
        let next = self.fit([taken, &[law]].concat());
        let numbers = self.0.numbers(&next.taken, &next.coefficients);
        let mut laws = next.taken.iter().zip(&numbers);
        let is_possible = laws.all(|(law, own)| !self.0.terms[*law].is_positive || own[0] > 0.0);
        is_possible.then_some(next)
    }

    /// Models with each law of a name that a model has not.
    fn further(&self, taken: &[usize]) -> impl Iterator<Item = (usize, Fitted)> {
        let rows = self.0;
        let name = move |law: usize| rows.terms[law].effect;
        let is_open = move |law: &usize| taken.iter().all(|own| name(*own) != name(*law));
        let open = (0..rows.terms.len()).filter(is_open);
        open.filter_map(move |law| Some((law, self.with(taken, law)?)))
    }

    /// Whether a model surely leaves less of unseen parts, and by a share of the torque that is not negligible.
    fn is_sure(&self, before: &Fitted, after: &Fitted) -> bool {
        let gain = Gain::between(&before.unseen, &after.unseen);
        let torque = self.0.all.target_square() / self.0.noise_nm.powi(2);
        nats(before, after) > LEAST_NATS
            && gain.sum > LEAST_SHARE * torque
            && gain.deviations_by_sign() > SURE_SD
    }
}

impl Forward for Search<'_> {
    type State = Fitted;
    type Further = Fitted;
    type Error = Infallible;

    fn proposals(&mut self, state: &Fitted) -> Proposals<Self> {
        let further = self.further(&state.taken).map(|(_, further)| further);
        let sure = further.filter(|further| self.is_sure(state, further));
        Ok(sure
            .map(|further| Proposal {
                merit: nats(state, &further),
                further,
            })
            .collect())
    }

    fn rule(&mut self, _: &Fitted, best: Proposal<Fitted>) -> Ruled<Self> {
        Ok(Ruling::Taken(best.further))
    }
}

impl Backward for Search<'_> {
    type State = Fitted;
    type Error = Infallible;

    fn effects(&self, state: &Fitted) -> usize {
        state.taken.len()
    }

    fn without(&mut self, state: &Fitted, effect: usize) -> Less<Self> {
        let mut taken = state.taken.clone();
        taken.remove(effect);
        let less = self.fit(taken);
        Ok(Without {
            worth: nats(&less, state),
            state: less,
        })
    }
}

impl Needless for Search<'_> {
    fn is_needless(
        &mut self,
        state: &Fitted,
        effect: usize,
        all: &[Without<Fitted>],
    ) -> Result<bool, Infallible> {
        Ok(!self.is_sure(&all[effect].state, state))
    }
}

impl InPlace for Search<'_> {
    type Name = &'static str;
    type Fit = ();

    fn in_place(&mut self, without: &Fitted, whole: &Fitted, _: usize) -> Others<Self> {
        let name = |law: usize| self.0.terms[law].effect;
        let is_in = |law: &usize| whole.taken.iter().any(|own| name(*own) == name(*law));
        let others = self.further(&without.taken);
        let others = others.filter(|(law, _)| !is_in(law));
        Ok(others
            .map(|(law, there)| Other {
                name: name(law),
                merit: nats(without, &there),
                fit: (),
            })
            .collect())
    }
}
