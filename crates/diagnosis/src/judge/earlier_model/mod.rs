//! A model identified earlier: which terms of the base model it lacks or has wrong (docs/diagnosis.md,
//! "Earlier model").

use std::collections::BTreeMap;

use haptical_effects::base_model::{JOINT_OFFSET, LINK_GEOMETRY, PARALLELOGRAM_ERROR};
use haptical_effects::structure::{JOINT_COMPLIANCE, TOOL_CHANGED};
use haptical_effects::transmission::{DRUM_ECCENTRICITY, RATIO_ERROR};
use haptical_model::kinematics::Parameter;
use haptical_model::{
    Device, JointType, ParameterId, SurroundingParameter, TransmissionError, TransmissionKind,
};

use crate::answer::{MovedNumber, ParameterAnswer};
use crate::engine::Engine;
use crate::engine::least::Columns;
use crate::engine::system::compress_rows;
use crate::judge::displaced::{Displaced, displaced};
use crate::judge::earlier_value::earlier_value;
use crate::judge::resized::{Resized, resized};
use crate::judge::tool;
use crate::thresholds::earlier_model::{
    AS_WELL, BEYOND_CHANCE, MOVED_SD, NEARLY_ALL, TERM_SHARE, TWO_FITS, WRONG_RATHER_THAN_CHANGED,
};

/// A base term that differs from the earlier model.
#[derive(Debug, Clone)]
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

/// What a model differs in.
#[derive(Debug, Clone, Default)]
pub(crate) struct Difference {
    pub(crate) terms: Vec<BaseTerm>,
    /// Squared whitened residual of the earlier model beyond that of the refitted one.
    pub(crate) total: f64,
    /// Whether a term was left out on request: there is a difference that bears no name.
    pub(crate) is_unnamed: bool,
    /// Standard deviation of each free column's number.
    pub(crate) deviations: Vec<f64>,
}

impl Difference {
    /// The difference without the terms of these names.
    pub(crate) fn without(mut self, names: &[String]) -> Self {
        let found = self.terms.len();
        self.terms
            .retain(|term| !names.iter().any(|name| name == term.name));
        self.is_unnamed = self.terms.len() < found;
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
        self.terms
            .first()
            .is_some_and(|term| term.name == TOOL_CHANGED.name)
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
    let target = compress_rows(&engine.system.layout, residual);
    if target.iter().any(|value| !value.is_finite()) {
        return Difference::default();
    }
    let tool = tool::columns(engine, model).unwrap_or_default();
    let displaced = displaced(engine);
    let fitted: Vec<Vec<f64>> = (0..count).map(|column| free.dense(column)).collect();
    let mut all: Vec<&[f64]> = fitted.iter().map(Vec::as_slice).collect();
    all.extend(tool.iter().map(Vec::as_slice));
    let mut sensors = Vec::new();
    for sensor in &displaced {
        sensors.push((all.len()..all.len() + sensor.columns.len()).collect());
        all.extend(sensor.columns.iter().map(Vec::as_slice));
    }
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

    fn difference(&self) -> Difference {
        let others: Vec<usize> = (0..self.count)
            .filter(|column| !self.nuisances.contains(column))
            .collect();
        let total = self.explained(&others);
        let tool = self.other_tool(total, &others);
        let only = tool.or_else(|| self.other_place(total, &others));
        if let Some(only) = only {
            return Difference {
                terms: vec![only],
                total,
                is_unnamed: false,
                deviations: self.deviations.clone(),
            };
        }
        let links: Vec<usize> = self
            .groups
            .iter()
            .filter(|group| !group.in_drive)
            .flat_map(|group| group.columns.clone())
            .collect();
        let sensors = self.sensors.iter();
        let places = sensors.flat_map(|(_, columns)| columns.iter().copied());
        let distant: Vec<usize> = links.into_iter().chain(places).collect();
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
            let without: Vec<usize> = others
                .iter()
                .filter(|k| !group.columns.contains(k))
                .copied()
                .collect();
            let lost = total - self.explained(&without);
            if lost > chance(group.columns.len()) {
                terms.push(self.term(group, lost));
            }
        }
        // what a law's curvature leaves of an effect's growth is no change of the numbers beside it
        if terms.iter().any(|term| !term.earlier.is_empty()) {
            terms.retain(|term| !term.earlier.is_empty() || self.has_moved(term));
        }
        terms.sort_by(|a, b| b.explained.total_cmp(&a.explained));
        self.say_changes(&mut terms, &beside, &others);
        Difference {
            terms,
            total,
            is_unnamed: false,
            deviations: self.deviations.clone(),
        }
    }

    /// What the numbers of the terms changed by if nothing else did but those `beside` them, with which they were found: of each
    /// term those that did beyond chance, or all; the intervals count that `others` may differ too.
    fn say_changes(
        &self,
        terms: &mut [BaseTerm],
        beside: &[usize],
        others: &[usize],
    ) -> Option<()> {
        let is_displaced = |own: &&(&Displaced, Vec<usize>)| {
            terms.iter().any(|term| term.name == own.0.effect.name())
        };
        let sensors = self.sensors.iter().filter(is_displaced);
        let mut chosen: Vec<usize> = (self.nuisances.iter())
            .chain(terms.iter().flat_map(|term| &term.columns))
            .chain(sensors.flat_map(|(_, columns)| columns))
            .copied()
            .collect();
        let is_new = |column: &&usize| !chosen.contains(column);
        let beside: Vec<usize> = beside.iter().filter(is_new).copied().collect();
        chosen.extend(beside);
        let (values, covariance) = self.columns.solution(&chosen)?;
        let covariance = covariance + self.columns.covariance_given(&chosen, others)?;
        let (engine, device) = (self.engine, self.engine.context.device);
        let mut index = self.nuisances.len();
        for term in terms {
            let first = index;
            index += term.columns.len();
            if !term.earlier.is_empty() {
                continue;
            }
            let numbers = term.columns.iter().zip(first..);
            let of_term = numbers.filter_map(|(&column, index)| {
                let (step, sd) = (values[index], covariance[(index, index)].sqrt());
                let parameter = engine.base.parameters[engine.base.free[column]];
                let earlier = earlier_value(parameter, self.model, device)?;
                let number = MovedNumber {
                    parameter: parameter.name(device),
                    unit: parameter.unit(device).to_owned(),
                    earlier,
                    value: ParameterAnswer::normal(earlier + step, sd),
                };
                Some((step.abs() > MOVED_SD * sd, number))
            });
            let (sure, unsure): (Vec<_>, Vec<_>) = of_term.partition(|(is_sure, _)| *is_sure);
            // together they moved: which of them did may be open
            let told = if sure.is_empty() { unsure } else { sure };
            term.changed = told.into_iter().map(|(_, number)| number).collect();
        }
        Some(())
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

    /// Another tool, where it alone explains nearly all of the difference.
    fn other_tool(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
        let explained = self.explained(&self.tool);
        if self.tool.is_empty() || explained < NEARLY_ALL * total || explained < chance(3) {
            return None;
        }
        let shift = tool::shift(&self.columns, &self.nuisances, &self.tool, others)?;
        // the last link carries the tool: its own numbers are another word for it
        let last = self.engine.context.device.joints.len().checked_sub(1);
        let is_other = |group: &Group| group.joint != last || group.in_drive;
        Some(BaseTerm {
            name: TOOL_CHANGED.name,
            joint: None,
            explained,
            parameters: shift.parameters,
            in_drive: false,
            confusable_with: self.as_good(explained, is_other),
            is_all: true,
            columns: Vec::new(),
            earlier: BTreeMap::new(),
            changed: Vec::new(),
        })
    }

    /// Another place of a sensor, where it alone explains nearly all of the difference.
    fn other_place(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
        let explains = |(_, columns): &&(&Displaced, Vec<usize>)| {
            let explained = self.explained(columns);
            explained >= NEARLY_ALL * total && explained >= chance(columns.len())
        };
        let (sensor, columns) = self.sensors.iter().find(explains)?;
        let explained = self.explained(columns);
        Some(BaseTerm {
            confusable_with: self.as_good(explained, |_| true),
            is_all: true,
            ..self.place_of(sensor, (columns, &[]), explained, others)?
        })
    }

    /// A sensor at another place, by its columns `with` others that were chosen; its interval counts that `others` may differ too.
    fn place_of(
        &self,
        sensor: &Displaced,
        (columns, with): (&[usize], &[usize]),
        explained: f64,
        others: &[usize],
    ) -> Option<BaseTerm> {
        let chosen: Vec<usize> = (self.nuisances.iter().chain(columns).chain(with))
            .copied()
            .collect();
        let (values, covariance) = self.columns.solution(&chosen)?;
        let covariance = covariance + self.columns.covariance_given(&chosen, others)?;
        let first = self.nuisances.len();
        let own = covariance.view((first, first), (columns.len(), columns.len()));
        Some(BaseTerm {
            name: sensor.effect.name(),
            joint: None,
            explained,
            parameters: sensor.parameters(
                self.engine,
                &values[first..first + columns.len()],
                &own.into_owned(),
            ),
            in_drive: false,
            confusable_with: Vec::new(),
            is_all: false,
            columns: Vec::new(),
            earlier: BTreeMap::new(),
            changed: Vec::new(),
        })
    }

    /// Names of groups that explain the difference as well, by changes that a sound device can show.
    fn as_good(&self, explained: f64, is_other: impl Fn(&Group) -> bool) -> Vec<String> {
        let groups = self.groups.iter().filter(|group| is_other(group));
        let mut names: Vec<String> = groups
            .filter(|group| self.explained(&group.columns) > explained - AS_WELL)
            .filter(|group| self.is_believable(group))
            .map(|group| group.name.to_owned())
            .collect();
        names.dedup();
        names
    }

    /// Whether a group that explains the difference does so by changes that a sound device can show.
    fn is_believable(&self, group: &Group) -> bool {
        let chosen: Vec<usize> = self
            .nuisances
            .iter()
            .chain(&group.columns)
            .copied()
            .collect();
        let Some((values, _)) = self.columns.solution(&chosen) else {
            return false;
        };
        if group.resized.is_some() {
            return true;
        }
        let device = self.engine.context.device;
        let changes = group.columns.iter().zip(&values[self.nuisances.len()..]);
        let mut sizes = changes.map(|(&column, change)| {
            let parameter = self.engine.base.parameters[self.engine.base.free[column]];
            change.abs() / parameter.plausible_size(device).max(1e-300)
        });
        sizes.all(|size| size < WRONG_RATHER_THAN_CHANGED)
    }

    /// Terms one by one, each time the one that explains most of the rest; sensors at another place are terms beside the links.
    fn forward(&self, in_drive: bool, given: &[usize], total: f64) -> Vec<BaseTerm> {
        let mut chosen = given.to_vec();
        let mut have = self.explained(&chosen);
        let own = self
            .groups
            .iter()
            .filter(|group| group.in_drive == in_drive);
        let mut left: Vec<Term<'_>> = own.map(Term::Group).collect();
        if !in_drive {
            let sensors = self.sensors.iter();
            left.extend(sensors.map(|(sensor, columns)| Term::Place(sensor, columns)));
        }
        let mut picked = Vec::new();
        while !left.is_empty() {
            let gains: Vec<f64> = left
                .iter()
                .map(|term| {
                    let with: Vec<usize> = chosen.iter().chain(term.columns()).copied().collect();
                    self.explained(&with) - have
                })
                .collect();
            let best = (0..left.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]));
            let Some(best) = best else {
                break;
            };
            let rank = left[best].columns().len();
            if gains[best] < chance(rank) || gains[best] < TERM_SHARE * total {
                break;
            }
            let term = left.remove(best);
            chosen.extend(term.columns());
            have += gains[best];
            picked.push((term, gains[best]));
        }
        let terms = picked.into_iter().filter_map(|(term, gain)| match term {
            Term::Group(group) => Some(self.term(group, gain)),
            Term::Place(sensor, columns) => {
                let is_other = |column: &&usize| !columns.contains(column);
                let with: Vec<usize> = chosen.iter().filter(is_other).copied().collect();
                self.place_of(sensor, (columns, &with), gain, &[])
            }
        });
        terms.collect()
    }

    fn term(&self, group: &Group, explained: f64) -> BaseTerm {
        BaseTerm {
            name: group.name,
            joint: group.joint,
            explained,
            parameters: match &group.resized {
                Some(resized) => resized.parameters.clone(),
                None => self.parameters(group),
            },
            in_drive: group.in_drive,
            confusable_with: Vec::new(),
            is_all: false,
            columns: group.columns.clone(),
            earlier: (group.resized.as_ref())
                .map_or_else(BTreeMap::new, |resized| resized.earlier.clone()),
            changed: Vec::new(),
        }
    }

    /// The refitted values with intervals; of a polynomial its root mean square.
    fn parameters(&self, group: &Group) -> BTreeMap<String, ParameterAnswer> {
        let engine = self.engine;
        let device = engine.context.device;
        let mut answers = BTreeMap::new();
        for &column in &group.columns {
            let position = engine.base.free[column];
            let value = engine.start.model.values[position];
            let answer = ParameterAnswer::normal(value, self.deviations[column]);
            answers.insert(engine.base.parameters[position].name(device), answer);
        }
        answers
    }
}

/// What a step of a search may take.
#[derive(Debug)]
enum Term<'t> {
    Group(&'t Group),
    Place(&'t Displaced, &'t [usize]),
}

impl Term<'_> {
    fn columns(&self) -> &[usize] {
        match self {
            Self::Group(group) => &group.columns,
            Self::Place(_, columns) => columns,
        }
    }
}

/// Free columns of what was touched.
fn places(engine: &Engine<'_>) -> Vec<usize> {
    let free = engine.base.free.iter().enumerate();
    free.filter(|(_, position)| {
        matches!(
            engine.base.parameters[**position],
            ParameterId::Surrounding(
                SurroundingParameter::Contact { .. } | SurroundingParameter::Plane { .. }
            )
        )
    })
    .map(|(column, _)| column)
    .collect()
}

/// Squared standard deviations that chance and the earlier model's own errors give a group.
fn chance(rank: usize) -> f64 {
    let rank = rank as f64;
    TWO_FITS * (rank + BEYOND_CHANCE * rank.sqrt())
}

/// Parameters that belong to one name at one place.
#[derive(Debug)]
struct Group {
    name: &'static str,
    joint: Option<usize>,
    /// Among the free columns.
    columns: Vec<usize>,
    in_drive: bool,
    /// Of an effect of the device.
    resized: Option<Resized>,
}

/// The free numbers by name and place, and the device's own effects that have other sizes.
fn groups(engine: &Engine<'_>, resized: Vec<Resized>) -> Vec<Group> {
    let device = engine.context.device;
    let own = resized.into_iter().map(|own| Group {
        name: own.name,
        joint: own.joint,
        columns: own.columns.clone(),
        in_drive: own.in_drive,
        resized: Some(own),
    });
    let mut groups: Vec<Group> = own.collect();
    for (column, &position) in engine.base.free.iter().enumerate() {
        let (name, joint, in_drive) = match engine.base.parameters[position] {
            ParameterId::Link { row, parameter } => {
                let joint = row.checked_sub(1);
                match joint.is_some_and(|joint| is_zero(device, joint, parameter)) {
                    true => (JOINT_OFFSET.name, joint, false),
                    false => (LINK_GEOMETRY.name, joint, false),
                }
            }
            ParameterId::Compliance { joint } => (JOINT_COMPLIANCE.name, Some(joint), false),
            // the place of a rig is no effect of the device, and an effect of its own size is no deviation from it
            ParameterId::Surrounding(_) | ParameterId::Effect { .. } => continue,
            ParameterId::Transmission { joint, index } => {
                (term_name(device, joint, index), Some(joint), true)
            }
        };
        match groups.iter_mut().find(|group| {
            let is_place = group.joint == joint && group.in_drive == in_drive;
            group.resized.is_none() && group.name == name && is_place
        }) {
            Some(group) => group.columns.push(column),
            None => groups.push(Group {
                name,
                joint,
                columns: vec![column],
                in_drive,
                resized: None,
            }),
        }
    }
    groups
}

/// Whether a number of a joint's own row is the joint's zero.
fn is_zero(device: &Device, joint: usize, parameter: Parameter) -> bool {
    let joint = device.joints.get(joint).map(|joint| joint.joint_type);
    matches!(
        (joint, parameter),
        (Some(JointType::Revolute), Parameter::Theta) | (Some(JointType::Prismatic), Parameter::D)
    )
}

fn term_name(device: &Device, joint: usize, index: usize) -> &'static str {
    let is_capstan = matches!(
        device.joints[joint].transmission_error,
        TransmissionError::Capstan(_)
    );
    match (device.joints[joint].transmission, is_capstan, index) {
        (TransmissionKind::Parallelogram, _, _) => PARALLELOGRAM_ERROR.name,
        (_, _, 0) => JOINT_OFFSET.name,
        (_, true, 1) => RATIO_ERROR.name,
        (_, true, _) => DRUM_ECCENTRICITY.name,
        (_, false, 1) => RATIO_ERROR.name,
        (_, false, _) => DRUM_ECCENTRICITY.name,
    }
}
