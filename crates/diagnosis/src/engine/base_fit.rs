//! The base model's own fit to a recording, by Gauss-Newton.

use super::prepared::{BaseFit, Prepared};
use crate::DiagnosisError;
use crate::engine::blocks::Blocks;
use crate::engine::part::{Part, root_mean_square, square};
use crate::engine::refit::longest_falling;
use crate::noise::measured::{KnownNoise, estimate_noise};
use crate::thresholds::fit::{BASE_PASSES, SMALL_STEP};

impl Prepared<'_> {
    /// Fits the base model by Gauss-Newton; the noise is estimated anew when the first steps were large.
    pub(super) fn base_fit(
        &self,
        mut residual: Vec<Vec<f64>>,
        known: Option<&KnownNoise>,
    ) -> Result<BaseFit, DiagnosisError> {
        let mut values = self.problem.start();
        let mut pass = 0;
        loop {
            let (noise, scale) = match known {
                Some(known) => (known.noise.clone(), known.scale.clone()),
                None => estimate_noise(
                    &self.context,
                    &self.problem,
                    &residual,
                    &self.usable,
                    &self.own,
                    self.base.free.len(),
                ),
            };
            let blocks = Blocks::new(&self.context, &self.usable, &scale, &self.own, &noise);
            let derivatives = self.derivatives.as_ref();
            let whole = Part::new(&self.context, &self.problem, blocks, derivatives, self.base)?;
            let mut last_step: f64 = 0.0;
            // several steps with one decomposition
            for _ in 0..BASE_PASSES {
                let pull = self.base.pull(&values);
                let Some(step) = whole.base_step(&residual, &pull)? else {
                    break;
                };
                last_step = root_mean_square(&whole.free.times(&step)?);
                if last_step < SMALL_STEP {
                    break;
                }
                let cost = square(&whole, &residual, &pull);
                match self.base_step(&whole, &values, &step, cost) {
                    Some((next, rest)) => (values, residual) = (next, rest),
                    None => break,
                }
            }
            pass += 1;
            // a start far away has shown noise that is partly the step's
            if pass > 1 || last_step < 10.0 * SMALL_STEP {
                return Ok(BaseFit {
                    noise,
                    scale,
                    whole,
                    values,
                    residual,
                    last_step,
                });
            }
        }
    }

    /// Values and residuals after a step of the base model, shortened until the cost falls; none where it
    /// never does.
    fn base_step(
        &self,
        part: &Part,
        values: &[f64],
        step: &[f64],
        cost: f64,
    ) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        longest_falling(|share| {
            let mut next = values.to_vec();
            for (&parameter, change) in self.base.free.iter().zip(step) {
                next[parameter] += share * change;
            }
            let evaluated = self.problem.evaluate(&next, false).ok()?;
            let square = square(part, &evaluated.residual, &self.base.pull(&next));
            (square < cost).then_some((next, evaluated.residual))
        })
    }
}
