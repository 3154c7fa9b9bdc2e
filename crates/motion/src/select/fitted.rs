//! The base model and effects that were taken, fitted together, with plausible limits kept.

use std::cell::RefCell;
use std::rc::Rc;

use haptical_linalg::dot;

use crate::fit::base::{Base, Term};
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::{Coefficients, Solved, System};
use crate::thresholds::examine::ALLOWED_REST;
use crate::thresholds::select::{LIMIT_ROUNDS, TARGETS};

/// The base model of a problem, ready to be fitted with effects.
pub(crate) struct Frame<'c> {
    pub(crate) problem: &'c Problem,
    pub(crate) base: &'c Base,
    system: System,
    nominal: Rc<Column>,
    /// Targets that were asked for last.
    targets: Rc<RefCell<Vec<Rc<Target>>>>,
}

/// Rows to be explained.
struct Target {
    /// How long their torques are before the positions \[s\].
    early_s: f64,
    rows: Vec<f64>,
    /// Their products with the columns of the base model.
    along: Vec<f64>,
}

/// A fit.
#[derive(Clone)]
pub(crate) struct Fitted {
    pub(crate) system: System,
    pub(crate) solved: Solved,
    /// Numbers of the base model that are at a limit, or not asked for.
    pub(crate) fixed: Vec<Option<f64>>,
    /// Columns of the base model, which are before those of the effects.
    pub(crate) base_columns: usize,
    /// Energy beyond noise of what is left \[nats\].
    pub(crate) excess: f64,
    /// Rows that a rest may have of noise.
    pub(crate) freedom: f64,
}

impl<'c> Frame<'c> {
    pub(crate) fn new(problem: &'c Problem, base: &'c Base) -> Self {
        Self {
            system: base.system(),
            nominal: Rc::new(problem.nominal_rows()),
            targets: Rc::default(),
            problem,
            base,
        }
    }

    fn target(&self, early_s: f64) -> Rc<Target> {
        let mut targets = self.targets.borrow_mut();
        if let Some(known) = targets.iter().find(|own| own.early_s == early_s) {
            return Rc::clone(known);
        }
        let rows = self.problem.recorded_less(&self.nominal, early_s);
        let along = self.system.along(&rows);
        let target = Rc::new(Target {
            early_s,
            rows,
            along,
        });
        if targets.len() == TARGETS {
            targets.remove(0);
        }
        targets.push(Rc::clone(&target));
        target
    }

    /// Times that what is known of the base model's numbers counts where an effect's own are read off the fit. A sound arm may leave
    /// a rest that is no gap, and that rest moves the numbers which the motion fixes badly: spread over all of them, it is worth so
    /// much to each (A202).
    pub(crate) fn times(&self) -> f64 {
        let known = self
            .base
            .columns
            .iter()
            .filter(|own| own.known_sd.is_some());
        let rows = self.problem.channel_rows() as f64;
        (ALLOWED_REST * rows / known.count().max(1) as f64).max(1.0)
    }

    /// The fit with what is known counted so many times.
    pub(crate) fn counting_known(&self, times: f64) -> Self {
        Self {
            system: self.system.clone().counting_known(times),
            nominal: Rc::clone(&self.nominal),
            targets: Rc::clone(&self.targets),
            ..*self
        }
    }

    /// The base model's columns with those of some effects.
    pub(crate) fn with(&self, effects: &[Rc<Column>]) -> System {
        self.system.with(effects, &vec![None; effects.len()])
    }

    /// The fit with some effects; `early_s`: how long the torques are before the positions, which is an effect then.
    pub(crate) fn fitted(&self, effects: &[Rc<Column>], early_s: Option<f64>) -> Fitted {
        self.fitted_with(self.with(effects), early_s)
    }

    /// The same by a system with the effects.
    pub(crate) fn fitted_with(&self, system: System, early_s: Option<f64>) -> Fitted {
        let target = self.target(early_s.unwrap_or(0.0));
        let (fixed, found) = self.found(&system, &target, early_s.is_some());
        let solved = found.solved(&system, &target.rows);
        let freedom = self.problem.channel_rows() as f64 - self.base.free() as f64;
        Fitted {
            excess: solved.energy - 0.5 * freedom,
            base_columns: self.base.columns.len(),
            system,
            solved,
            fixed,
            freedom,
        }
    }

    /// Coefficients alone of the effects of a system, one of them the delay.
    pub(crate) fn coefficients(&self, system: &System, early_s: f64) -> Vec<f64> {
        let (_, mut found) = self.found(system, &self.target(early_s), true);
        found.solution.split_off(self.base.columns.len())
    }

    fn found(
        &self,
        system: &System,
        target: &Target,
        has_delay: bool,
    ) -> (Vec<Option<f64>>, Coefficients) {
        let is_delay = |term: &Term| matches!(term, Term::Delay);
        let mut fixed: Vec<Option<f64>> = (self.base.columns.iter())
            .map(|own| (has_delay && is_delay(&own.term)).then_some(0.0))
            .collect();
        let effects = &system.columns[self.base.columns.len()..];
        let of_effects = effects.iter().map(|own| own.dot(&target.rows));
        let along: Vec<f64> = target.along.iter().copied().chain(of_effects).collect();
        let found = within_limits(system, self.base, &along, &mut fixed);
        (fixed, found)
    }
}

/// Least squares with the numbers of the base model kept within their limits, for a target whose products with the columns are given;
/// `fixed`: those that are at one, or not asked for.
pub(crate) fn within_limits(
    system: &System,
    base: &Base,
    along: &[f64],
    fixed: &mut [Option<f64>],
) -> Coefficients {
    let mut round = 0;
    loop {
        let found = system.coefficients(along, fixed);
        let mut is_settled = true;
        for (index, own) in base.columns.iter().enumerate() {
            let Some([least, most]) = own.limits() else {
                continue;
            };
            let within = found.solution[index].clamp(least, most);
            if within != found.solution[index] {
                fixed[index] = Some(within);
                is_settled = false;
            }
        }
        round += 1;
        if is_settled || round > LIMIT_ROUNDS {
            return found;
        }
    }
}

impl Fitted {
    /// How far its rows are behind those of another fit, without what is known of the base model's numbers \[nats\].
    pub(crate) fn behind(&self, other: &Self) -> f64 {
        let nats = |fitted: &Self| 0.5 * dot(&fitted.solved.rest, &fitted.solved.rest);
        nats(self) - nats(other)
    }

    /// Coefficients of the effects' columns.
    pub(crate) fn effects(&self) -> &[f64] {
        &self.solved.solution[self.base_columns..]
    }
}
