//! What alone explains nearly all of a difference: a zero, a tool, the place of a sensor.

use std::collections::BTreeMap;

use haptical_effects::base_model::JOINT_OFFSET;
use haptical_effects::structure::TOOL_CHANGED;
use haptical_model::ParameterId;

use super::displaced::Displaced;
use super::groups::{Group, chance, is_zero};
use super::value::earlier_value;
use super::{BaseTerm, Earlier, tool};
use crate::answer::{MovedNumber, ParameterAnswer};
use crate::thresholds::earlier_model::{AS_WELL, NEARLY_ALL, WRONG_RATHER_THAN_CHANGED};

impl Earlier<'_, '_> {
    /// The zero of one joint, where it alone explains nearly all of the difference: one number, where a tool that was shifted or a
    /// sensor that was moved has three or six.
    pub(super) fn other_zero(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
        let of_group = |group: &Group| {
            let is_zero = is_zero(group.name) && group.resized.is_none();
            let &[column] = group.columns.as_slice() else {
                return None;
            };
            let parameter = self.engine.base.parameters[self.engine.base.free[column]];
            is_zero.then_some((group.joint?, parameter, column, group.in_drive))
        };
        let free = self.groups.iter().filter_map(of_group);
        let dependent = self.zeros.iter();
        let dependent =
            dependent.map(|(zero, column)| (zero.joint, zero.parameter, *column, false));
        let all = free.chain(dependent);
        let mut all: Vec<_> = all.map(|zero| (self.explained(&[zero.2]), zero)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let &(explained, (joint, parameter, column, in_drive)) = all.first()?;
        if explained < NEARLY_ALL * total || explained < chance(1) {
            return None;
        }
        let other_joint = all[1..].iter().find(|other| other.0 > explained - AS_WELL);
        let other_joint = other_joint.map(|_| JOINT_OFFSET.name.to_owned());
        let rivals = other_joint.into_iter().chain(self.of_the_rig(explained));
        Some(BaseTerm {
            in_drive,
            confusable_with: rivals.collect(),
            is_all: true,
            ..self.zero_term(joint, (parameter, column), explained, others)?
        })
    }

    /// A zero that is another one.
    pub(super) fn zero_term(
        &self,
        joint: usize,
        zero: (ParameterId, usize),
        explained: f64,
        others: &[usize],
    ) -> Option<BaseTerm> {
        let (value, number) = self.changed_zero(zero, others)?;
        let column = Some(zero.1).filter(|column| *column < self.count);
        Some(BaseTerm {
            name: JOINT_OFFSET.name,
            joint: Some(joint),
            explained,
            parameters: BTreeMap::from([(number.parameter.clone(), value)]),
            in_drive: false,
            confusable_with: Vec::new(),
            is_all: false,
            columns: column.into_iter().collect(),
            earlier: BTreeMap::new(),
            changed: vec![number],
        })
    }

    /// What of the rig explains as much as a zero: a tool that was shifted, a sensor at another place.
    pub(super) fn of_the_rig(&self, explained: f64) -> Vec<String> {
        let as_well = |columns: &[usize]| {
            !columns.is_empty() && self.explained(columns) > explained - AS_WELL
        };
        let tool = as_well(&self.tool).then(|| TOOL_CHANGED.name.to_owned());
        let places = self.sensors.iter();
        let places = places.filter(|(_, columns)| as_well(columns));
        let places = places.map(|(sensor, _)| sensor.effect.name().to_owned());
        tool.into_iter().chain(places).collect()
    }

    /// What a zero is and changed by if nothing else did; the interval counts that `others` may differ too.
    fn changed_zero(
        &self,
        (parameter, column): (ParameterId, usize),
        others: &[usize],
    ) -> Option<(ParameterAnswer, MovedNumber)> {
        let chosen: Vec<usize> = self.nuisances.iter().copied().chain([column]).collect();
        let (values, covariance) = self.columns.solution(&chosen);
        let mut others: Vec<usize> = (others.iter().copied())
            .filter(|other| *other != column)
            .collect();
        if column >= self.count {
            // a sum of the others is known where the one that most of it is made of is held: what that one is, its rivals tell
            let held = self.columns.largest_part(column, &others);
            others.retain(|other| Some(*other) != held);
        }
        let covariance = covariance + self.columns.covariance_given(&chosen, &others);
        let last = chosen.len() - 1;
        let device = self.engine.context.device;
        let earlier = earlier_value(parameter, self.model, device)?;
        let value = ParameterAnswer::normal(
            earlier + values[last],
            covariance[(last, last)].max(0.0).sqrt(),
        );
        let number = MovedNumber {
            parameter: parameter.name(device),
            unit: parameter.unit(device).to_owned(),
            earlier,
            value,
        };
        Some((value, number))
    }

    /// Another tool, where it alone explains nearly all of the difference.
    pub(super) fn other_tool(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
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
    pub(super) fn other_place(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
        let explains = |(_, columns): &&(&Displaced, Vec<usize>)| {
            let explained = self.explained(columns);
            explained >= NEARLY_ALL * total && explained >= chance(columns.len())
        };
        let (sensor, columns) = self.sensors.iter().find(explains)?;
        let explained = self.explained(columns);
        Some(BaseTerm {
            confusable_with: self.as_good(explained, |_| true),
            is_all: true,
            ..self.place_of(sensor, (columns, &[]), explained, others)
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
        let (values, _) = self.columns.solution(&chosen);
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
}
