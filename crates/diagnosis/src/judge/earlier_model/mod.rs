//! A model identified earlier: which terms of the base model it lacks or has wrong (docs/diagnosis.md,
//! "Earlier model").

pub(crate) mod absorbed;
mod groups;
pub(crate) mod rig;
mod terms;
mod zeros;

use std::collections::BTreeMap;

use haptical_effects::structure::TOOL_CHANGED;
use haptical_model::Device;

use crate::answer::{MovedNumber, ParameterAnswer};
use crate::engine::{Columns, Engine};
use crate::thresholds::earlier_model::{MOST, MOVED_SD, NEARLY_ALL};
use groups::{Group, chance, earlier_value, groups, is_zero, places, resized};
use rig::{Displaced, displaced};
use zeros::{Zero, zeros};

/// A base term that differs from the earlier model.
#[derive(Debug, Clone, Default)]
pub(crate) struct BaseTerm {
    pub(crate) name: &'static str,
    pub(crate) joint: Option<usize>,
    /// Squared whitened residual that it explains.
    pub(crate) explained: f64,
    pub(crate) parameters: BTreeMap<String, ParameterAnswer>,
    /// It enters in front of the external encoder.
    pub(crate) in_drive: bool,
    /// Names that explain the difference as well.
    pub(crate) confusable_with: Vec<String>,
    /// It explains the difference alone.
    pub(crate) is_all: bool,
    /// Its free columns; none where it is no number of the base model.
    pub(crate) columns: Vec<usize>,
    /// Of an effect of the device: the numbers that the earlier model has.
    pub(crate) earlier: BTreeMap<String, f64>,
    /// Of the base model: what its numbers changed by.
    pub(crate) changed: Vec<MovedNumber>,
}

impl BaseTerm {
    /// Whether it is another tool.
    pub(crate) fn is_tool(&self) -> bool {
        self.name == TOOL_CHANGED.name
    }
}

/// What a model differs in.
#[derive(Debug, Clone, Default)]
pub(crate) struct Difference {
    pub(crate) terms: Vec<BaseTerm>,
    /// Squared whitened residual of the earlier model beyond that of the refitted one.
    pub(crate) total: f64,
    /// Whether a term was left out on request: there is a difference that bears no name.
    pub(crate) is_unnamed: bool,
    /// Whether its terms leave a large part of it without a name.
    pub(crate) is_partial: bool,
    /// Standard deviation of each free column's number.
    pub(crate) deviations: Vec<f64>,
}

impl Difference {
    /// The difference without the terms of these names.
    pub(crate) fn without(mut self, names: &[String]) -> Self {
        let found = self.terms.len();
        self.terms
            .retain(|term| !names.iter().any(|name| name == term.name));
        self.is_unnamed |= self.terms.len() < found;
        self
    }

    /// Whether one name accounts for the difference and for the gap that is left, whose squared
    /// residual is given.
    pub(crate) fn accounts_for(&self, left: f64) -> bool {
        let only = self.terms.first().filter(|term| term.is_all);
        only.is_some_and(|only| only.explained >= NEARLY_ALL * (self.total + left.max(0.0)))
    }

    /// Whether the difference is another tool.
    pub(crate) fn is_tool(&self) -> bool {
        self.terms.first().is_some_and(BaseTerm::is_tool)
    }
}

/// Compares residuals of an earlier model with the base model refitted to the recording. `causes` are whitened columns of the
/// effects that the refitted model lacks: what they explain is no change of the base model, which took up a part of them.
pub(crate) fn difference(
    engine: &Engine<'_>,
    model: &Device,
    residual: &[Vec<f64>],
    causes: &[Vec<f64>],
) -> Difference {
    let free = engine.free();
    let count = free.columns();
    if count == 0 {
        return Difference::default();
    }
    let target = engine.system.layout.compress_rows(residual);
    if target.iter().any(|value| !value.is_finite()) {
        return Difference::default();
    }
    let tool = rig::tool_columns(engine, model).unwrap_or_default();
    let displaced = displaced(engine);
    let zeros = zeros(engine);
    let fitted: Vec<Vec<f64>> = (0..count).map(|column| free.dense(column)).collect();
    let mut all: Vec<&[f64]> = fitted.iter().map(Vec::as_slice).collect();
    all.extend(tool.iter().map(Vec::as_slice));
    let mut sensors = Vec::new();
    for sensor in &displaced {
        sensors.push((all.len()..all.len() + sensor.columns.len()).collect());
        all.extend(sensor.columns.iter().map(Vec::as_slice));
    }
    let first_zero = all.len();
    all.extend(zeros.iter().map(|zero| zero.column.as_slice()));
    let mut nuisances = places(engine);
    nuisances.extend(all.len()..all.len() + causes.len());
    all.extend(causes.iter().map(Vec::as_slice));
    let columns = Columns::new(&all, &target);
    let deviations = columns.deviations(count);
    let resized = resized(engine, model, &deviations);
    let earlier = Earlier {
        engine,
        model,
        deviations,
        nuisances,
        tool: (count..count + tool.len()).collect(),
        sensors: displaced.iter().zip(sensors).collect(),
        zeros: zeros.iter().zip(first_zero..).collect(),
        groups: groups(engine, resized),
        columns,
        count,
    };
    earlier.difference()
}

/// An earlier model's residuals and everything that may explain them.
struct Earlier<'e, 'a> {
    engine: &'e Engine<'a>,
    model: &'e Device,
    columns: Columns,
    /// Of the free columns' coefficients.
    deviations: Vec<f64>,
    /// Columns of what was touched, whose place says nothing of the device, and of the effects that the base model lacks.
    nuisances: Vec<usize>,
    /// Columns of another tool.
    tool: Vec<usize>,
    /// Sensors at another place, with their columns.
    sensors: Vec<(&'e Displaced, Vec<usize>)>,
    /// Zeros that are no free numbers, with their columns.
    zeros: Vec<(&'e Zero, usize)>,
    groups: Vec<Group>,
    /// Free columns.
    count: usize,
}

impl Earlier<'_, '_> {
    /// Squared residual that columns explain, the nuisances free.
    fn explained(&self, chosen: &[usize]) -> f64 {
        let with: Vec<usize> = self.nuisances.iter().chain(chosen).copied().collect();
        self.columns.explained(&with) - self.columns.explained(&self.nuisances)
    }

    /// Free columns that are no nuisances.
    fn others(&self) -> Vec<usize> {
        let free = 0..self.count;
        free.filter(|column| !self.nuisances.contains(column))
            .collect()
    }

    fn difference(&self) -> Difference {
        let others = self.others();
        let total = self.explained(&others);
        let only = (self.other_zero(total, &others))
            .or_else(|| self.other_tool(total, &others))
            .or_else(|| self.other_place(total, &others));
        if let Some(only) = only {
            return Difference {
                terms: vec![only],
                total,
                is_unnamed: false,
                is_partial: false,
                deviations: self.deviations.clone(),
            };
        }
        let links = self.groups.iter().filter(|group| !group.in_drive);
        let links = links.flat_map(|group| &group.columns);
        let places = self.sensors.iter().flat_map(|(_, columns)| columns);
        let distant: Vec<usize> = links.chain(places).copied().collect();
        // The lengths of a model without transmission errors have taken part of those up: with the
        // transmissions in question the links are free, and so is where a sensor stands.
        let mut terms = self.forward(true, &distant, total);
        let beside = match terms.is_empty() {
            true => Vec::new(),
            false => distant,
        };
        if terms.is_empty() {
            terms = self.forward(false, &[], total);
        }
        // A ratio and an eccentricity resemble each other over a small range: whatever cannot be dropped
        // without loss differs too.
        let in_drive = terms.first().is_some_and(|term| term.in_drive);
        for group in self.groups.iter().filter(|g| g.in_drive && in_drive) {
            let named = |term: &BaseTerm| term.name == group.name && term.joint == group.joint;
            if terms.iter().any(named) {
                continue;
            }
            let without = others.iter().filter(|k| !group.columns.contains(k));
            let lost = total - self.explained(&without.copied().collect::<Vec<_>>());
            if lost > chance(group.columns.len()) {
                terms.push(self.term(group, lost));
            }
        }
        // what a law's curvature leaves of an effect's growth is no change of the numbers beside it
        if terms.iter().any(|term| !term.earlier.is_empty()) {
            terms.retain(|term| !term.earlier.is_empty() || self.has_moved(term));
        }
        terms.sort_by(|a, b| b.explained.total_cmp(&a.explained));
        if let [only] = terms.as_mut_slice()
            && is_zero(only.name)
            && !only.in_drive
        {
            only.confusable_with = self.of_the_rig(only.explained);
        }
        let is_partial = self.is_partial(&terms, &beside, total);
        self.say_changes(&mut terms, &beside, &others);
        Difference {
            is_unnamed: is_partial && terms.is_empty(),
            terms,
            total,
            is_partial,
            deviations: self.deviations.clone(),
        }
    }

    /// What the numbers of the terms changed by if nothing else did but those `beside` them, with which they were found: of each
    /// term those that did beyond chance, or all; the intervals count that `others` may differ too.
    fn say_changes(&self, terms: &mut [BaseTerm], beside: &[usize], others: &[usize]) {
        let mut chosen: Vec<usize> = (self.nuisances.iter().copied())
            .chain(self.columns_of(terms))
            .collect();
        let is_new = |column: &&usize| !chosen.contains(column);
        let beside: Vec<usize> = beside.iter().filter(is_new).copied().collect();
        chosen.extend(beside);
        let (values, covariance) = self.columns.solution(&chosen, others);
        let (engine, device) = (self.engine, self.engine.context.device);
        let mut index = self.nuisances.len();
        for term in terms {
            let first = index;
            index += term.columns.len();
            if !term.earlier.is_empty() || term.columns.is_empty() {
                continue;
            }
            let numbers = term.columns.iter().zip(first..);
            let of_term = numbers.filter_map(|(&column, index)| {
                let (step, sd) = (values[index], covariance[(index, index)].sqrt());
                let parameter = engine.base.parameters[engine.base.free[column]];
                let earlier = earlier_value(parameter, self.model, device)?;
                let value = ParameterAnswer::normal(earlier + step, sd);
                let number = MovedNumber::new(parameter, device, earlier, value);
                Some((step.abs() > MOVED_SD * sd, number))
            });
            let (sure, unsure): (Vec<_>, Vec<_>) = of_term.partition(|(is_sure, _)| *is_sure);
            // together they moved: which of them did may be open
            let told = if sure.is_empty() { unsure } else { sure };
            term.changed = told.into_iter().map(|(_, number)| number).collect();
        }
    }

    /// Columns of terms: of free numbers first, term by term, then of sensors at another place, then of zeros that are no free
    /// numbers.
    fn columns_of(&self, terms: &[BaseTerm]) -> Vec<usize> {
        let is_displaced = |sensor: &Displaced| {
            let name = sensor.effect.name();
            terms.iter().any(|term| term.name == name)
        };
        let is_own = |zero: &Zero| {
            let is_of = |term: &BaseTerm| {
                term.columns.is_empty() && is_zero(term.name) && term.joint == Some(zero.joint)
            };
            terms.iter().any(is_of)
        };
        let sensors = self.sensors.iter();
        let sensors = sensors.filter(|(sensor, _)| is_displaced(sensor));
        let zeros = self.zeros.iter().filter(|(zero, _)| is_own(zero));
        (terms.iter().flat_map(|term| &term.columns))
            .chain(sensors.flat_map(|(_, columns)| columns))
            .chain(zeros.map(|(_, column)| column))
            .copied()
            .collect()
    }

    /// Whether terms, with what was free `beside` them, leave a part of the difference that has no name.
    fn is_partial(&self, terms: &[BaseTerm], beside: &[usize], total: f64) -> bool {
        let mut named = self.columns_of(terms);
        named.extend(beside);
        named.sort_unstable();
        named.dedup();
        let left = total - self.explained(&named);
        left > (1.0 - MOST) * total && left > chance(self.count)
    }

    /// Whether a number of a term differs from the earlier model's beyond chance; one that is no number of the base model does.
    fn has_moved(&self, term: &BaseTerm) -> bool {
        let (engine, device) = (self.engine, self.engine.context.device);
        let mut columns = term.columns.iter();
        let is_far = |&column: &usize| {
            let position = engine.base.free[column];
            let value = engine.start.model.values[position];
            let earlier = earlier_value(engine.base.parameters[position], self.model, device);
            let step = |earlier: f64| (value - earlier).abs();
            earlier.is_none_or(|earlier| step(earlier) > MOVED_SD * self.deviations[column])
        };
        term.columns.is_empty() || columns.any(is_far)
    }
}
