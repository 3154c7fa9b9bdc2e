//! Causes that those picked after them have made superfluous are taken out again (docs/diagnosis.md,
//! "Selection").

use crate::DiagnosisError;
use crate::engine::model::Refit;
use crate::select::scan::Score;
use crate::select::{Grown, Selector};

impl Selector<'_> {
    /// Takes out, one after the other, causes that explain no more than chance when all others are in the model or the
    /// others' laws; what is left is credited with what it explains then.
    pub(crate) fn trim(&self, grown: &mut Grown) -> Result<(), DiagnosisError> {
        while grown.refit.model.causes.len() > 1 {
            let cost = self.cost(&grown.refit);
            let mut without: Vec<Refit> = Vec::new();
            grown.explained.clear();
            for index in 0..grown.refit.model.causes.len() {
                let mut model = grown.refit.model.clone();
                model.causes.remove(index);
                let refit = self.engine.refit(self.effects, &model)?;
                grown.explained.push((self.cost(&refit) - cost).max(0.0));
                without.push(refit);
            }
            let mut weakest: Option<(usize, f64)> = None;
            for index in 0..without.len() {
                // where the others found no minimum, nobody knows what they leave
                if without[index].has_converged() && self.is_superfluous(grown, index)? {
                    let explained = grown.explained[index];
                    if weakest.is_none_or(|(_, least)| explained < least) {
                        weakest = Some((index, explained));
                    }
                }
            }
            let Some((index, _)) = weakest else {
                break;
            };
            grown.refit = without.swap_remove(index);
            grown.explained.remove(index);
            grown.system = self.system_of(&grown.refit);
            grown.after = grown.system.slow_energy(&grown.system.residual);
        }
        Ok(())
    }

    /// Whether a cause explains no more than chance or than what the others' laws may get wrong.
    fn is_superfluous(&self, grown: &Grown, index: usize) -> Result<bool, DiagnosisError> {
        let causes = &grown.refit.model.causes;
        let pick = Score::of_cause(&causes[index], grown.explained[index]);
        let mut others = causes.clone();
        others.remove(index);
        let mut explained = grown.explained.clone();
        explained.remove(index);
        let within_laws = !self.is_elsewhere(&pick, &others)
            && pick.score <= self.law_errors(&others, &explained, &pick);
        Ok(within_laws || !self.is_more_than_chance(&pick, &grown.after)?)
    }
}
