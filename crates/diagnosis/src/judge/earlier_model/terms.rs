//! Terms of a difference: one that explains nearly all of it alone, or one by one.

use std::collections::BTreeMap;
use std::convert::Infallible;

use haptical_effects::base_model::JOINT_OFFSET;
use haptical_effects::structure::TOOL_CHANGED;
use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};
use haptical_model::ParameterId;

use super::groups::{Group, chance, earlier_value, is_zero};
use super::rig::Displaced;
use super::zeros::Zero;
use super::{BaseTerm, Earlier, rig};
use crate::answer::{MovedNumber, ParameterAnswer};
use crate::thresholds::earlier_model::{
    AS_WELL, NEARLY_ALL, TERM_SHARE, WRONG_RATHER_THAN_CHANGED,
};

impl Earlier<'_, '_> {
    /// A sensor at another place, by its columns `with` others that were chosen; its interval counts that `others` may differ too.
    pub(super) fn place_of(
        &self,
        sensor: &Displaced,
        (columns, with): (&[usize], &[usize]),
        explained: f64,
        others: &[usize],
    ) -> BaseTerm {
        let chosen: Vec<usize> = (self.nuisances.iter().chain(columns).chain(with))
            .copied()
            .collect();
        let (values, covariance) = self.columns.solution(&chosen, others);
        let first = self.nuisances.len();
        let own = covariance.view((first, first), (columns.len(), columns.len()));
        BaseTerm {
            name: sensor.effect.name(),
            explained,
            parameters: sensor.parameters(
                self.engine,
                &values[first..first + columns.len()],
                &own.into_owned(),
            ),
            ..BaseTerm::default()
        }
    }

    /// Terms one by one, each time the one that explains most of the rest; sensors at another place are terms beside the links.
    pub(super) fn forward(&self, in_drive: bool, given: &[usize], total: f64) -> Vec<BaseTerm> {
        let own = self
            .groups
            .iter()
            .filter(|group| group.in_drive == in_drive);
        let mut open: Vec<Term<'_>> = own.map(Term::Group).collect();
        if !in_drive {
            let sensors = self.sensors.iter();
            open.extend(sensors.map(|(sensor, columns)| Term::Place(sensor, columns)));
            let zeros = self.zeros.iter();
            open.extend(zeros.map(|(zero, column)| Term::Zero(zero, [*column])));
        }
        let mut search = Search {
            earlier: self,
            open,
            total,
        };
        let start = Picked {
            chosen: given.to_vec(),
            have: self.explained(given),
            terms: Vec::new(),
        };
        let Ok(Picked {
            chosen,
            terms: picked,
            ..
        }) = haptical_judge::select(&mut search, start);
        let terms = picked.into_iter().filter_map(|(term, gain)| match term {
            Term::Group(group) => Some(self.term(group, gain)),
            Term::Place(sensor, columns) => {
                let is_other = |column: &&usize| !columns.contains(column);
                let with: Vec<usize> = chosen.iter().filter(is_other).copied().collect();
                Some(self.place_of(sensor, (columns, &with), gain, &[]))
            }
            Term::Zero(zero, [column]) => {
                self.zero_term(zero.joint, (zero.parameter, column), gain, &self.others())
            }
        });
        terms.collect()
    }

    pub(super) fn term(&self, group: &Group, explained: f64) -> BaseTerm {
        BaseTerm {
            name: group.name,
            joint: group.joint,
            explained,
            parameters: match &group.resized {
                Some(resized) => resized.parameters.clone(),
                None => self.parameters(group),
            },
            in_drive: group.in_drive,
            columns: group.columns.clone(),
            earlier: (group.resized.as_ref())
                .map_or_else(BTreeMap::new, |resized| resized.earlier.clone()),
            ..BaseTerm::default()
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

/// Terms that were picked so far.
struct Picked<'t> {
    /// Columns of the model.
    chosen: Vec<usize>,
    /// What these explain.
    have: f64,
    /// Each term with what it explained when it was picked.
    terms: Vec<(Term<'t>, f64)>,
}

struct Search<'t, 'a, 'b> {
    earlier: &'t Earlier<'a, 'b>,
    open: Vec<Term<'t>>,
    total: f64,
}

impl<'t> Forward for Search<'t, '_, '_> {
    type State = Picked<'t>;
    type Further = Term<'t>;
    type Error = Infallible;

    fn proposals(&mut self, state: &Picked<'t>) -> Proposals<Self> {
        let proposal = |term: &Term<'t>| {
            let with: Vec<usize> = (state.chosen.iter().chain(term.columns()))
                .copied()
                .collect();
            Proposal {
                merit: self.earlier.explained(&with) - state.have,
                further: *term,
            }
        };
        Ok(self.open.iter().map(proposal).collect())
    }

    fn rule(&mut self, state: &Picked<'t>, best: Proposal<Term<'t>>) -> Ruled<Self> {
        let Proposal { further, merit } = best;
        let columns = further.columns();
        if merit < chance(columns.len()) || merit < TERM_SHARE * self.total {
            return Ok(Ruling::Ended);
        }
        self.open.retain(|term| term.columns() != columns);
        Ok(Ruling::Taken(Picked {
            chosen: [state.chosen.as_slice(), columns].concat(),
            have: state.have + merit,
            terms: [state.terms.as_slice(), &[(further, merit)]].concat(),
        }))
    }
}

/// What a step of a search may take.
#[derive(Debug, Clone, Copy)]
enum Term<'t> {
    Group(&'t Group),
    Place(&'t Displaced, &'t [usize]),
    Zero(&'t Zero, [usize; 1]),
}

impl Term<'_> {
    fn columns(&self) -> &[usize] {
        match self {
            Self::Group(group) => &group.columns,
            Self::Place(_, columns) => columns,
            Self::Zero(_, column) => column,
        }
    }
}

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
            columns: column.into_iter().collect(),
            changed: vec![number],
            ..BaseTerm::default()
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
        let mut others: Vec<usize> = (others.iter().copied())
            .filter(|other| *other != column)
            .collect();
        if column >= self.count {
            // a sum of the others is known where the one that most of it is made of is held: what that one is, its rivals tell
            let held = self.columns.largest_part(column, &others);
            others.retain(|other| Some(*other) != held);
        }
        let (values, covariance) = self.columns.solution(&chosen, &others);
        let last = chosen.len() - 1;
        let device = self.engine.context.device;
        let earlier = earlier_value(parameter, self.model, device)?;
        let sd = covariance[(last, last)].max(0.0).sqrt();
        let value = ParameterAnswer::normal(earlier + values[last], sd);
        Some((value, MovedNumber::new(parameter, device, earlier, value)))
    }

    /// Another tool, where it alone explains nearly all of the difference.
    pub(super) fn other_tool(&self, total: f64, others: &[usize]) -> Option<BaseTerm> {
        let explained = self.explained(&self.tool);
        if self.tool.is_empty() || explained < NEARLY_ALL * total || explained < chance(3) {
            return None;
        }
        let shift = rig::shift(&self.columns, &self.nuisances, &self.tool, others)?;
        // the last link carries the tool: its own numbers are another word for it
        let last = self.engine.context.device.joints.len().checked_sub(1);
        let is_other = |group: &Group| group.joint != last || group.in_drive;
        Some(BaseTerm {
            name: TOOL_CHANGED.name,
            explained,
            parameters: shift,
            confusable_with: self.as_good(explained, is_other),
            is_all: true,
            ..BaseTerm::default()
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
        let (values, _) = self.columns.solution(&chosen, &[]);
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
