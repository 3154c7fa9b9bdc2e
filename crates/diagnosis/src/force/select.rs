//! Stepwise selection of effects on the torques, with the rivals of each.

use haptical_metrics::chi_square_p_value;

use super::base::Base;
use super::effects::{Effects, Kind, Place};
use super::recorded::Recorded;
use super::whitener::Whitener;
use crate::DiagnosisError;
use crate::engine::system::SlowEnergy;
use crate::select::scan::{Candidate, Score};
use crate::select::{excess, misfit};

/// Chance of any name on torques without an effect.
const FAMILY_WISE_P: f64 = 1e-3;
/// Least size of an effect: its mean square over that of a row's noise. Errors of the angles and of
/// the geometry that are no effects on torques leave less than this.
const LEAST_SHARE_OF_NOISE: f64 = 0.04;
/// Least share of its columns that the base model must leave.
const RETAINED: f64 = 0.05;
/// Least part of what is left that a further effect must explain.
const SHARE_OF_REST: f64 = 0.1;
/// Effects that are named at most.
const MOST: usize = 3;
/// Harmonic errors of angles that are allowed for beside them.
const MOST_RIPPLES: usize = 4;
/// Steps of the search for a transition, and the factor that it goes to each side.
const STEPS: usize = 8;
const REACH: f64 = 3.2;
/// Step of its derivative, of its logarithm.
const SHAPE_STEP: f64 = 0.05;
/// Part of a hysteresis that neither a bias nor a gain of the sensor explains.
const LEAST_LOOP: f64 = 0.5;
/// Orders of cogging that one joint may have: more of them would follow any function of its angle.
const MOST_ORDERS: usize = 2;

/// A chosen effect.
#[derive(Debug, Clone)]
pub(super) struct Pick {
    pub(super) place: Place,
    /// Its columns among the model's.
    pub(super) first: usize,
    /// The last of them is the derivative by the logarithm of a continuous shape.
    pub(super) count: usize,
    /// Chi-square that it saves beside the others.
    pub(super) score: f64,
    pub(super) probability: f64,
    /// Names and channels of effects that would do nearly as well.
    pub(super) rivals: Vec<(Kind, Option<usize>)>,
}

/// What the selection came to.
#[derive(Debug)]
pub(super) struct Selection {
    pub(super) picks: Vec<Pick>,
    /// Slow energy per channel of the base model, and of the picks' model.
    pub(super) before: Vec<SlowEnergy>,
    pub(super) after: Vec<SlowEnergy>,
    pub(super) rest_before: Vec<f64>,
    pub(super) rest_after: Vec<f64>,
}

/// Everything that a selection works on.
#[derive(Debug)]
pub(super) struct Selector<'s, 'a> {
    pub(super) recorded: &'s Recorded<'a>,
    pub(super) whitener: &'s Whitener,
    pub(super) effects: &'s Effects<'s, 'a>,
    places: Vec<Place>,
    rows: f64,
}

impl<'s, 'a> Selector<'s, 'a> {
    pub(super) fn new(
        recorded: &'s Recorded<'a>,
        whitener: &'s Whitener,
        effects: &'s Effects<'s, 'a>,
    ) -> Self {
        let rows: usize = recorded.blocks.iter().map(|block| block.usable.len()).sum();
        Self {
            recorded,
            whitener,
            effects,
            places: effects.places(),
            rows: rows as f64,
        }
    }

    /// Usable rows of a channel.
    pub(super) fn rows(&self) -> f64 {
        self.rows
    }

    fn energy(&self, base: &Base) -> Vec<SlowEnergy> {
        let free = if self.recorded.force_n.is_none() {
            3
        } else {
            0
        };
        base.energy(free)
    }

    /// Chooses effects one after the other; they become base columns of `base`.
    pub(super) fn select(&self, base: &mut Base) -> Result<Selection, DiagnosisError> {
        let mut candidates: Vec<Candidate> = self
            .places
            .iter()
            .enumerate()
            .map(|(index, place)| {
                let columns = self.effects.columns(base, place);
                Candidate::of_columns(&base.regression.system, columns, index, place.shape)
            })
            .collect();
        let mut rest_before = base.rest();
        let mut before = self.energy(base);
        let mut after = before.clone();
        let mut picks: Vec<Pick> = Vec::new();
        let mut ripples: Vec<Place> = Vec::new();
        while picks.len() < MOST {
            let taken = |place: &Place| {
                let is_same = |other: &Place| {
                    let shape = place.kind != Kind::Cogging || place.shape == other.shape;
                    place.kind == other.kind && place.channel == other.channel && shape
                };
                let orders = picks.iter().filter(|pick| {
                    pick.place.kind == Kind::Cogging && pick.place.channel == place.channel
                });
                let is_many = place.kind == Kind::Cogging && orders.count() >= MOST_ORDERS;
                is_many
                    || picks.iter().any(|pick| is_same(&pick.place))
                    || ripples.iter().any(is_same)
            };
            let scored = self.scores(base, &mut candidates);
            let Some((place, score)) = scored
                .into_iter()
                .filter(|(place, _)| !taken(place))
                .max_by(|a, b| self.merit(&a.0, &a.1).total_cmp(&self.merit(&b.0, &b.1)))
            else {
                break;
            };
            let fresh = place.kind == Kind::Scale || picks.is_empty();
            let rest = excess(&after).0.max(0.0);
            let is_part =
                fresh || place.kind == Kind::Cogging || score.score >= SHARE_OF_REST * rest;
            if !self.is_found(&place, &score, candidates.len())?
                || !is_part
                || !self.is_a_loop(base, &place, &score)
            {
                break;
            }
            if place.kind == Kind::Cogging && ripples.len() < MOST_RIPPLES {
                let columns = self.effects.ripple(base, &place);
                let rival = base.score(columns.clone());
                if rival.rank > 0 && self.merit(&place, &rival) > self.merit(&place, &score) {
                    base.adopt(&columns);
                    ripples.push(place);
                    if picks.is_empty() {
                        // what an angle's error adds is no gap of the torques
                        rest_before = base.rest();
                        before = self.energy(base);
                        after = before.clone();
                    }
                    continue;
                }
            }
            let (place, columns) = self.refined(base, &place);
            picks.push(Pick {
                place,
                first: base.regression.len(),
                count: columns.len(),
                score: score.score,
                probability: 1.0,
                rivals: Vec::new(),
            });
            columns
                .into_iter()
                .for_each(|column| base.regression.add(column));
            if place.kind == Kind::Scale {
                self.effects.along.settle(base);
                for candidate in &mut candidates {
                    candidate.reset(&base.regression.system, base.scales);
                }
            }
            after = self.energy(base);
        }
        let rest_after = base.rest();
        if !picks.is_empty() {
            self.compare(base, &mut candidates, &mut picks, &after)?;
        }
        Ok(Selection {
            picks,
            before,
            after,
            rest_before,
            rest_after,
        })
    }

    /// Scores of the candidates that are possible.
    fn scores(&self, base: &Base, candidates: &mut [Candidate]) -> Vec<(Place, Score)> {
        candidates
            .iter_mut()
            .filter_map(|candidate| {
                candidate.extend(&base.regression.system);
                let score = candidate.score(&base.regression.system);
                let place = self.places[candidate.effect];
                let possible =
                    score.rank > 0 && self.effects.is_possible(&place, &score.amplitudes);
                possible.then_some((place, score))
            })
            .collect()
    }

    /// Bayes' criterion: the score less what as many free numbers explain of nothing.
    fn merit(&self, place: &Place, score: &Score) -> f64 {
        score.score - score.rank as f64 * self.rows.ln() - 2.0 * (place.shapes as f64).ln()
    }

    fn is_found(
        &self,
        place: &Place,
        score: &Score,
        tested: usize,
    ) -> Result<bool, DiagnosisError> {
        let p = chi_square_p_value(score.score, score.rank as f64)?;
        let is_large = place.kind == Kind::Scale || score.score >= LEAST_SHARE_OF_NOISE * self.rows;
        Ok(p * (tested as f64) < FAMILY_WISE_P && is_large && score.retained > RETAINED)
    }

    /// Whether a hysteresis shows as a loop: a state that hardly reverses is a bias, one that hardly saturates a gain.
    /// These are asked whether or not the catalogue has them.
    fn is_a_loop(&self, base: &Base, place: &Place, score: &Score) -> bool {
        if place.kind != Kind::Hysteresis {
            return true;
        }
        let mut beside = base.clone();
        beside.adopt(&self.effects.bias_and_gain(&base.regression.system.layout));
        let left = beside.score(self.effects.columns(base, place)).score;
        left >= LEAST_LOOP * score.score
    }

    /// The place with its transition searched between those of the grid (golden section), and its
    /// columns with the derivative by the transition's logarithm.
    fn refined(&self, base: &Base, place: &Place) -> (Place, Vec<Vec<f64>>) {
        let dense = |place: &Place| -> Vec<Vec<f64>> {
            let columns = self.effects.columns(base, place);
            let columns = columns.iter();
            columns
                .map(|column| base.regression.system.dense(column))
                .collect()
        };
        if !place.is_continuous() {
            return (*place, dense(place));
        }
        let placed = |log: f64| Place {
            shape: place.shape * log.exp(),
            ..*place
        };
        let score = |place: &Place| base.score(self.effects.columns(base, place));
        let at = |log: f64| score(&placed(log)).score;
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (-REACH.ln(), REACH.ln());
        let (mut left, mut right) = (high - golden * (high - low), low + golden * (high - low));
        let (mut of_left, mut of_right) = (at(left), at(right));
        for _ in 0..STEPS {
            if of_left > of_right {
                (high, right, of_right) = (right, left, of_left);
                left = high - golden * (high - low);
                of_left = at(left);
            } else {
                (low, left, of_left) = (left, right, of_right);
                right = low + golden * (high - low);
                of_right = at(right);
            }
        }
        let best = 0.5 * (low + high);
        let place = placed(best);
        let amplitudes = score(&place).amplitudes;
        let mut columns = dense(&place);
        let mut slope = vec![0.0; base.regression.reading().len()];
        for (side, log) in [(1.0, best + SHAPE_STEP), (-1.0, best - SHAPE_STEP)] {
            for (column, amplitude) in dense(&placed(log)).iter().zip(&amplitudes) {
                let factor = side * amplitude / (2.0 * SHAPE_STEP);
                for (sum, value) in slope.iter_mut().zip(column) {
                    *sum += factor * value;
                }
            }
        }
        columns.push(slope);
        (place, columns)
    }

    /// For each pick: what it saves beside the others, and who would do as well in its place.
    fn compare(
        &self,
        base: &Base,
        candidates: &mut [Candidate],
        picks: &mut Vec<Pick>,
        after: &[SlowEnergy],
    ) -> Result<(), DiagnosisError> {
        let first = picks.iter().map(|pick| pick.first).min().unwrap_or(0);
        let mut without = base.clone();
        // whatever is between picks (ripples) stays where it is
        let columns = without.regression.truncate(first);
        let known = without.regression.system.basis.len();
        let dispersion = misfit(after);
        let mut kept = vec![true; picks.len()];
        for (index, pick) in picks.iter_mut().enumerate() {
            let own = pick.first - first..pick.first - first + pick.count;
            let mut beside = without.clone();
            for (index, column) in columns.iter().enumerate() {
                if !own.contains(&index) {
                    beside.regression.add(column.clone());
                }
            }
            for candidate in candidates.iter_mut() {
                candidate.reset(&beside.regression.system, known);
            }
            let layout = &beside.regression.system.layout;
            let score = beside.score(columns[own].iter().map(|own| layout.split(own)).collect());
            pick.score = score.score;
            kept[index] = self.is_found(&pick.place, &score, candidates.len())?;
            let own = self.merit(&pick.place, &score);
            let mut best: Vec<(Kind, Option<usize>, f64)> = Vec::new();
            for (place, score) in self.scores(&beside, candidates) {
                let nats = 0.5 * (own - self.merit(&place, &score)) / dispersion;
                let is_own = place.kind == pick.place.kind && place.channel == pick.place.channel;
                if is_own || score.retained < RETAINED {
                    continue;
                }
                match best
                    .iter_mut()
                    .find(|b| b.0 == place.kind && b.1 == place.channel)
                {
                    Some(known) => known.2 = known.2.min(nats),
                    None => best.push((place.kind, place.channel, nats)),
                }
            }
            if pick.place.kind == Kind::Cogging {
                let ripple = beside.score(self.effects.ripple(&beside, &pick.place));
                let rival = self.merit(&pick.place, &ripple);
                let nats = 0.5 * (own - rival) / dispersion;
                best.push((Kind::Ripple, pick.place.channel, nats));
            }
            let sum: f64 = best.iter().map(|rival| (-rival.2).min(50.0).exp()).sum();
            pick.probability = 1.0 / (1.0 + sum);
            pick.rivals = best
                .into_iter()
                .filter(|rival| rival.2 < 100.0_f64.ln())
                .map(|(kind, channel, _)| (kind, channel))
                .collect();
            // a second effect that does worse than another shape of the first makes up for its
            // misfit
            kept[index] &= index == 0 || pick.probability > 0.5;
        }
        let mut index = 0;
        picks.retain(|_| {
            index += 1;
            kept[index - 1]
        });
        Ok(())
    }
}
