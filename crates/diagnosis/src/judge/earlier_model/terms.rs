//! Terms one by one.

use std::collections::BTreeMap;
use std::convert::Infallible;

use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};

use super::displaced::Displaced;
use super::groups::{Group, chance};
use super::zeros::Zero;
use super::{BaseTerm, Earlier};
use crate::answer::ParameterAnswer;
use crate::thresholds::earlier_model::TERM_SHARE;

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
        let (values, covariance) = self.columns.solution(&chosen);
        let covariance = covariance + self.columns.covariance_given(&chosen, others);
        let first = self.nuisances.len();
        let own = covariance.view((first, first), (columns.len(), columns.len()));
        BaseTerm {
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

/// Terms that were picked so far.
struct Picked<'t> {
    /// Columns of the model.
    chosen: Vec<usize>,
    /// What these explain.
    have: f64,
    /// Each term with what it explained when it was picked.
    terms: Vec<(Term<'t>, f64)>,
}

/// The search of terms.
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
