//! Causes that those picked after them have made superfluous are taken out again (docs/diagnosis.md,
//! "Selection").

use haptical_judge::{Backward, Less, Needless, Without, without_needless};

use crate::DiagnosisError;
use crate::engine::model::Refit;
use crate::engine::system::SlowEnergy;
use crate::select::scan::Score;
use crate::select::{Grown, Selector};

impl Selector<'_> {
    /// Takes out, one after the other, causes that explain no more than chance when all others are in the model or the
    /// others' laws; what is left is credited with what it explains then.
    pub(crate) fn trim(&self, grown: &mut Grown) -> Result<(), DiagnosisError> {
        let causes = grown.refit.model.causes.len();
        let mut trim = Trim {
            cost: self.cost(&grown.refit),
            after: grown.after.clone(),
            selector: self,
            causes,
        };
        let kept = without_needless(&mut trim, grown.refit.clone(), 1)?;
        if let Some(worth) = kept.worth {
            grown.explained = worth;
        }
        if kept.state.model.causes.len() < causes {
            grown.refit = kept.state;
            grown.system = self.system_of(&grown.refit);
            grown.after = grown.system.slow_energy(&grown.system.residual);
        }
        Ok(())
    }

    /// Whether a cause explains no more than chance or than what the others' laws may get wrong.
    fn is_superfluous(
        &self,
        (refit, after): (&Refit, &[SlowEnergy]),
        index: usize,
        explained: &[f64],
    ) -> Result<bool, DiagnosisError> {
        let causes = &refit.model.causes;
        let pick = Score::of_cause(&causes[index], explained[index]);
        let mut others = causes.clone();
        others.remove(index);
        let mut of_others = explained.to_vec();
        of_others.remove(index);
        let within_laws = !self.is_elsewhere(&pick, &others)
            && pick.score <= self.law_errors(&others, &of_others, &pick);
        Ok(within_laws || !self.is_more_than_chance(&pick, after)?)
    }
}

/// Causes that are taken out.
struct Trim<'s, 'e> {
    selector: &'s Selector<'e>,
    /// Of the model with so many causes: its cost, and the slow energy that it leaves.
    causes: usize,
    cost: f64,
    after: Vec<SlowEnergy>,
}

impl Backward for Trim<'_, '_> {
    type State = Refit;
    type Error = DiagnosisError;

    fn effects(&self, refit: &Refit) -> usize {
        refit.model.causes.len()
    }

    fn without(&mut self, refit: &Refit, index: usize) -> Less<Self> {
        let selector = self.selector;
        if refit.model.causes.len() != self.causes {
            let system = selector.system_of(refit);
            self.after = system.slow_energy(&system.residual);
            self.cost = selector.cost(refit);
            self.causes = refit.model.causes.len();
        }
        let mut model = refit.model.clone();
        model.causes.remove(index);
        let state = selector.engine.refit(selector.effects, &model)?;
        Ok(Without {
            worth: (selector.cost(&state) - self.cost).max(0.0),
            state,
        })
    }
}

impl Needless for Trim<'_, '_> {
    fn is_needless(
        &mut self,
        refit: &Refit,
        index: usize,
        all: &[Without<Refit>],
    ) -> Result<bool, DiagnosisError> {
        // where the others found no minimum, nobody knows what they leave
        if !all[index].state.has_converged() {
            return Ok(false);
        }
        let explained: Vec<f64> = all.iter().map(|without| without.worth).collect();
        (self.selector).is_superfluous((refit, &self.after), index, &explained)
    }
}
