//! Refits of the effects that contend for the next cause: close ones are all refitted, and the costs decide.

use haptical_effects::Shape;

use crate::engine::{Cause, Model, Refit};
use crate::select::{Grown, Refused, Score, Selector};
use crate::thresholds::chance::FAMILY_WISE_P;
use crate::thresholds::fit::{COMPARED, ROUGH};
use crate::thresholds::selection::{CONTENDERS, CONTENDING, FALLS_LEFT, TIE};
use crate::{DiagnosisError, Result};

/// An effect refitted together with the causes so far.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    effect: usize,
    refit: Refit,
    cost: f64,
    /// Whether its search went to the last digit.
    is_refined: bool,
}

/// Whether a first cause that was fitted roughly is known well enough, as all is computed anew with it.
pub(crate) type RoughIsEnough<'r> = dyn Fn(&Refit) -> bool + 'r;

impl Refused {
    /// Notes which of the contenders ended at no minimum.
    pub(super) fn note(&mut self, tried: &[Tried], scan: &[Score]) {
        let unconverged = tried.iter().filter(|own| !own.refit.has_converged());
        for effect in unconverged.map(|own| own.effect) {
            let is_known = self.unconverged.iter().any(|score| score.effect == effect);
            let score = scan.iter().find(|score| score.effect == effect);
            self.unconverged
                .extend(score.filter(|_| !is_known).cloned());
        }
    }
}

impl Selector<'_> {
    /// The best effect with its refit; close contenders are refitted too and the costs decide. One whose refit ended at no
    /// minimum has no numbers, and is not taken. `tried` keeps refits with the same causes.
    ///
    /// Contenders are fitted to few digits. The best, and those that few digits do not tell from it, are then fitted to the last, unless
    /// a rough fit is enough.
    pub(crate) fn best(
        &self,
        grown: &Grown,
        scan: &[Score],
        tried: &mut Vec<Tried>,
        rough: Option<&RoughIsEnough<'_>>,
    ) -> Result<Option<(Refit, Score)>> {
        let Some(first) = scan.first() else {
            return Ok(None);
        };
        let least_fall = rough.map_or(COMPARED, |_| ROUGH);
        let is_worth_it = self.family_wise_p(first, 1.0)? < FAMILY_WISE_P;
        let contends = |score: &&Score| {
            let is_near = score.score >= CONTENDING * first.score - 20.0;
            is_worth_it && (is_near || score.effect == first.effect)
        };
        let near: Vec<&Score> = scan.iter().take_while(contends).take(CONTENDERS).collect();
        let fresh = near.iter().copied();
        let fresh = fresh.filter(|score| tried.iter().all(|tried| tried.effect != score.effect));
        let refits = haptical_parallel::map(fresh.collect::<Vec<_>>(), |score| {
            let (refit, cost) = self.refit_with(&grown.refit.model, score, Some(least_fall))?;
            Ok(Tried {
                effect: score.effect,
                refit,
                cost,
                is_refined: false,
            })
        });
        tried.extend(refits.into_iter().collect::<Result<Vec<Tried>>>()?);
        loop {
            let weighed = tried.iter().enumerate().filter_map(|(place, tried)| {
                let score = near.iter().find(|score| score.effect == tried.effect)?;
                let weighed = self.weighed(grown, score, tried)?;
                Some((place, weighed))
            });
            let weighed: Vec<(usize, (Score, f64))> = weighed.collect();
            // of equals the first
            let best = weighed
                .iter()
                .reduce(|a, b| if b.1.1 > a.1.1 { b } else { a });
            let Some((place, (score, criterion))) = best else {
                return Ok(None);
            };
            let best = &tried[*place];
            if best.is_refined || rough.is_some_and(|is_enough| is_enough(&best.refit)) {
                return Ok(Some((best.refit.clone(), score.clone())));
            }
            let width = open_squares(least_fall, best.cost) / 2.0;
            let ties = weighed.iter().filter(|(place, (_, other))| {
                !tried[*place].is_refined && *other >= criterion - width
            });
            let ties: Vec<usize> = ties.map(|(place, _)| *place).collect();
            for place in ties {
                let (refit, cost) = self.refined(&tried[place].refit.model)?;
                tried[place] = Tried {
                    effect: tried[place].effect,
                    refit,
                    cost,
                    is_refined: true,
                };
            }
        }
    }

    /// What a contender explains, and the criterion by which contenders are compared; none where it has no numbers, or impossible ones.
    fn weighed(&self, grown: &Grown, score: &Score, tried: &Tried) -> Option<(Score, f64)> {
        let refit = &tried.refit;
        let is_anchored = self.engine.base.anchor.is_some();
        let may_be = refit.has_converged() && self.is_possible(&refit.model);
        if !may_be || (is_anchored && !self.is_sound(&refit.model)) {
            return None;
        }
        // what anchors hold back counts too: directions that they bound are not free
        let gained = match is_anchored {
            true => self.engine.cost(&grown.refit) - self.engine.cost(refit),
            false => {
                let before = grown.system.residual.iter();
                before.map(|value| value * value).sum::<f64>() - tried.cost
            }
        };
        let of_gain = Score {
            score: gained,
            ..score.clone()
        };
        let criterion = self.criterion(&of_gain);
        let explained = match is_anchored {
            true => gained,
            false => score.score.max(gained),
        };
        let explained = Score {
            score: explained,
            ..of_gain
        };
        Some((explained, criterion))
    }

    /// The refit of a model to the last digit, with its cost.
    fn refined(&self, model: &Model) -> Result<(Refit, f64)> {
        let refit = |model: &Model| self.engine.refit(self.effects, model);
        let fitted = self.with_steps_at_rows(refit(model)?, &refit)?;
        let cost = self.cost(&fitted);
        Ok((fitted, cost))
    }

    /// The best refit of a model with one more effect: an event at its best rows, a play driven from
    /// either side; with few digits where it is one of many that are only compared.
    pub(crate) fn refit_with(
        &self,
        model: &Model,
        score: &Score,
        least_fall: Option<f64>,
    ) -> Result<(Refit, f64)> {
        self.engine.base.interrupt.check()?;
        let cause = Cause::from(score);
        let effect = self.effects[score.effect].as_ref();
        let shapes = if effect.spec().shape == Shape::Sides {
            effect.shapes(&self.engine.context)
        } else {
            vec![cause.shape]
        };
        let refits = haptical_parallel::map(shapes, |shape| {
            let mut with = model.clone();
            with.causes.push(Cause {
                shape,
                ..cause.clone()
            });
            let (engine, effects) = (self.engine, self.effects);
            let refit = |model: &Model| engine.refit_on(&engine.whole, effects, model, least_fall);
            let known = engine.known_with(&with.causes);
            let known = known.filter(|known| self.are_shapes_open(&known.causes, &with.causes));
            let known = known.map(refit).transpose()?;
            let fitted = match known.filter(Refit::has_converged) {
                Some(known) => known,
                None => refit(&with)?,
            };
            let fitted = self.with_steps_at_rows(fitted, &refit)?;
            let cost = self.cost(&fitted);
            Ok((fitted, cost))
        });
        let mut refits: Vec<(Refit, f64)> = refits.into_iter().collect::<Result<_>>()?;
        if let (Some(share), [one, other]) = (least_fall, refits.as_mut_slice())
            && (one.1 - other.1).abs() < open_squares(share, one.1.min(other.1))
        {
            for side in [one, other] {
                *side = self.refined(&side.0.model)?;
            }
        }
        // of equals the first
        let best = refits
            .into_iter()
            .reduce(|a, b| if b.1 < a.1 { b } else { a });
        best.ok_or(DiagnosisError::NoShape {
            effect: effect.name(),
        })
    }

    /// Whether causes differ at most in shapes that a refit moves.
    fn are_shapes_open(&self, causes: &[Cause], others: &[Cause]) -> bool {
        causes.iter().zip(others).all(|(one, other)| {
            let shape = self.effects[one.effect].spec().shape;
            one.shape == other.shape || shape.is_continuous()
        })
    }

    pub(crate) fn is_possible(&self, model: &Model) -> bool {
        model.causes.iter().all(|cause| {
            let effect = self.effects[cause.effect].as_ref();
            effect.is_possible(&self.engine.context, &cause.amplitudes)
        })
    }

    /// Whether all causes have sizes that a sound device can show. Touches with anything larger in the model can agree
    /// because the handle hardly moves in it any more, whatever the device is.
    fn is_sound(&self, model: &Model) -> bool {
        model.causes.iter().all(|cause| {
            let effect = self.effects[cause.effect].as_ref();
            let amplitudes = &cause.amplitudes[..effect.spec().amplitudes];
            let values = effect.values(&self.engine.context, amplitudes, cause.shape);
            effect.is_plausible(&values)
        })
    }

    /// Whitened square of a refit's residuals, across the base model's directions.
    pub(crate) fn cost(&self, refit: &Refit) -> f64 {
        let mut system = self.engine.system.clone();
        system.set_residual(&refit.residual);
        system.residual.iter().map(|value| value * value).sum()
    }
}

/// Squares that a search may still be above its minimum where it ended at a step that lowered the cost by less than a share.
fn open_squares(least_fall: f64, cost: f64) -> f64 {
    (FALLS_LEFT * least_fall * cost).max(TIE)
}
