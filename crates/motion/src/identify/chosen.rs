//! Least squares or instruments.

use std::rc::Rc;

use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::identify::bias::Known;
use crate::identify::combinations::Combinations;
use crate::identify::estimate::{Estimate, instrumented};
use crate::identify::instruments::{self, Instruments};
use crate::identify::numbers::Number;
use crate::thresholds::identify::{MOST_WIDENING, WORTHWHILE_BIAS};

/// The fit with instruments, where there are some that span the motion.
pub(crate) fn with_instruments(
    known: &Known<'_>,
    problem: &Problem,
    base: &Combinations,
    (columns, target): (&[Rc<Column>], &[f64]),
) -> Option<(Estimate, Instruments)> {
    let (twin, instruments) = instruments::twin(known.recording, &problem.samples)?;
    let twin = known.problem(&twin).ok()?;
    if twin.states.rows() != problem.states.rows() {
        return None;
    }
    let pick = |own: &[Rc<Column>]| -> Vec<Rc<Column>> {
        base.kept()
            .iter()
            .map(|column| Rc::clone(&own[*column]))
            .collect()
    };
    let mut of_twin = known.columns(&twin);
    // the slope of the torques in time is no regressor of positions
    let delay = known.numbers.iter().position(|own| *own == Number::Delay)?;
    of_twin[delay] = Rc::clone(&columns[delay]);
    let rows = problem.states.rows();
    let found = instrumented(&pick(columns), &pick(&of_twin), target, rows).ok()?;
    Some((found, instruments))
}

/// Standard deviations by instruments over those by least squares: the median.
fn wider(with: &Estimate, plain: &Estimate) -> f64 {
    let mut ratios: Vec<f64> = (with.sd.iter().zip(&plain.sd))
        .map(|(with, plain)| with / plain)
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
        .get(ratios.len() / 2)
        .copied()
        .unwrap_or(f64::INFINITY)
}

/// Least squares, or instruments where the noise of the positions matters and they say enough.
pub(crate) struct Chosen {
    pub(crate) estimate: Estimate,
    pub(crate) instruments: Option<Instruments>,
    /// What the noise is taken to have changed; none with instruments.
    pub(crate) bias: Option<Vec<f64>>,
    /// Why there are no instruments.
    why: &'static str,
}

impl Chosen {
    pub(crate) fn new(
        plain: Estimate,
        bias: Option<Vec<f64>>,
        with: Option<(Estimate, Instruments)>,
    ) -> Self {
        let share = |(bias, sd): (&f64, &f64)| bias.abs() / sd;
        let matters = bias.as_ref().is_none_or(|own| {
            let mut shares = own.iter().zip(&plain.sd).map(share);
            shares.any(|own| own > WORTHWHILE_BIAS)
        });
        let why = match &with {
            None => "the log neither repeats its motion nor has commands",
            Some(_) if !matters => "it is too small for instruments to help",
            Some((own, _)) if wider(own, &plain) > MOST_WIDENING => {
                "the motion repeats itself, or follows its commands, too loosely to keep it out"
            }
            Some(_) => "",
        };
        match with {
            Some((estimate, instruments)) if why.is_empty() => Self {
                estimate,
                instruments: Some(instruments),
                bias: None,
                why,
            },
            _ => Self {
                estimate: plain,
                instruments: None,
                bias,
                why,
            },
        }
    }

    /// What is said where nothing keeps the noise of the positions out.
    pub(crate) fn warning(
        &self,
        problem: &Problem,
        (numbers, base): (&[Number], &Combinations),
    ) -> Option<String> {
        if self.instruments.is_some() {
            return None;
        }
        let without = format!("the bias of noisy positions is not excluded: {}", self.why);
        let Some(bias) = &self.bias else {
            return Some(format!("{without}; its size could not be estimated"));
        };
        let share = |k: usize| bias[k].abs() / self.estimate.sd[k];
        let largest = (0..bias.len()).max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
        Some(format!(
            "{without}; by the encoders' noise it is about {:.2} standard deviations at most (of {})",
            share(largest),
            numbers[base.kept()[largest]].name(problem)
        ))
    }
}
