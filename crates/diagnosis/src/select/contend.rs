//! Refits of the effects that contend for the next cause: close ones are all refitted, and the costs decide.

use haptical_effects::Shape;

use crate::engine::{Cause, Model, Refit};
use crate::select::{Grown, Refused, Score, Selector};
use crate::thresholds::chance::FAMILY_WISE_P;
use crate::thresholds::selection::{CONTENDERS, CONTENDING, TIE};
use crate::{DiagnosisError, Result};

/// An effect refitted together with the causes so far.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    effect: usize,
    refit: Refit,
    cost: f64,
}

impl Tried {
    /// Notes where the refit of an effect ends that was only compared: one that ends at no minimum contends no more.
    pub(super) fn note_end(tried: &mut [Self], effect: usize, refit: &Refit) {
        let own = tried.iter_mut().filter(|tried| tried.effect == effect);
        own.for_each(|tried| tried.refit.clone_from(refit));
    }
}

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
    pub(crate) fn best(
        &self,
        grown: &Grown,
        scan: &[Score],
        tried: &mut Vec<Tried>,
        least_fall: f64,
    ) -> Result<Option<(Refit, Score)>> {
        let Some(first) = scan.first() else {
            return Ok(None);
        };
        let is_worth_it = self.family_wise_p(first, 1.0)? < FAMILY_WISE_P;
        let contends = |score: &&Score| {
            let is_near = score.score >= CONTENDING * first.score - 20.0;
            is_worth_it && (is_near || score.effect == first.effect)
        };
        let near: Vec<&Score> = scan.iter().take_while(contends).take(CONTENDERS).collect();
        let refits = haptical_parallel::map(&near, |score| {
            let effect = score.effect;
            if let Some(before) = tried.iter().find(|tried| tried.effect == effect) {
                return Ok(before.clone());
            }
            let (refit, cost) = self.refit_with(&grown.refit.model, score, Some(least_fall))?;
            Ok(Tried {
                effect,
                refit,
                cost,
            })
        });
        let mut refits: Vec<Tried> = refits.into_iter().collect::<Result<_>>()?;
        self.refine_ties(&mut refits)?;
        tried.extend_from_slice(&refits);
        let before = grown.system.residual.iter();
        let before: f64 = before.map(|value| value * value).sum();
        let is_anchored = self.engine.base.anchor.is_some();
        let mut best: Option<(Refit, Score, f64)> = None;
        for (score, Tried { refit, cost, .. }) in near.into_iter().zip(refits) {
            let may_be = refit.has_converged() && self.is_possible(&refit.model);
            if !may_be || (is_anchored && !self.is_sound(&refit.model)) {
                continue;
            }
            // what anchors hold back counts too: directions that they bound are not free
            let gained = match is_anchored {
                true => self.engine.cost(&grown.refit) - self.engine.cost(&refit),
                false => before - cost,
            };
            let mut own = Score {
                score: gained,
                ..score.clone()
            };
            let criterion = self.criterion(&own);
            if best.as_ref().is_none_or(|(_, _, other)| criterion > *other) {
                own.score = if is_anchored {
                    gained
                } else {
                    score.score.max(gained)
                };
                best = Some((refit, own, criterion));
            }
        }
        Ok(best.map(|(fitted, score, _)| (fitted, score)))
    }

    /// Fits those to the last digit that are as good as the best as far as their searches went: the last digits decide.
    fn refine_ties(&self, refits: &mut [Tried]) -> Result<()> {
        let costs = refits.iter().filter(|own| own.refit.has_converged());
        let least = costs.map(|own| own.cost).fold(f64::INFINITY, f64::min);
        let is_tie = |own: &&mut Tried| own.refit.has_converged() && own.cost < least + TIE;
        let ties: Vec<&mut Tried> = refits.iter_mut().filter(is_tie).collect();
        if ties.len() < 2 {
            return Ok(());
        }
        for own in ties {
            own.refit = self.engine.refit(self.effects, &own.refit.model)?;
            own.cost = self.cost(&own.refit);
        }
        Ok(())
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
            let known = engine.known_with(&with.causes).map(refit).transpose()?;
            let fitted = match known.filter(Refit::has_converged) {
                Some(known) => known,
                None => refit(&with)?,
            };
            let fitted = self.with_steps_at_rows(fitted, &refit)?;
            let cost = self.cost(&fitted);
            Ok((fitted, cost))
        });
        let refits: Vec<(Refit, f64)> = refits.into_iter().collect::<Result<_>>()?;
        // of equals the first
        let best = refits
            .into_iter()
            .reduce(|a, b| if b.1 < a.1 { b } else { a });
        best.ok_or(DiagnosisError::NoShape {
            effect: effect.name(),
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
