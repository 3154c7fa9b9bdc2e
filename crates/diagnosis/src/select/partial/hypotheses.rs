//! Hypotheses of a partial explanation: an effect at a place, or one law at several places with a size at each
//! (docs/diagnosis.md, "Partial causes").

use haptical_effects::{Effect, Family, Shape};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::engine::model::Cause;
use crate::engine::segments::{Segments, Unseen};
use crate::engine::system::{ALWAYS, System, dot};
use crate::select::Selector;
use crate::select::scan::{Candidate, Score};
use crate::thresholds::partial::{
    DISTINCT, LEAST_MEMBER_GAIN_SD, LEAST_MEMBER_SD, LISTED, READINGS_PER_NUMBER,
};

/// Effects that are taken up together, with what they leave.
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    /// First sizes, from the linear model.
    pub(crate) causes: Vec<Cause>,
    pub(crate) unseen: Unseen,
}

/// An effect of a hypothesis, with its columns across all that is in the system.
struct Member<'c> {
    candidate: &'c Candidate,
    across: Vec<Vec<f64>>,
    /// First of its columns among those of [`Products`].
    first: usize,
}

/// Products of all members' columns with each other and with the residual: members are taken out one by one, and those
/// that stay keep theirs.
struct Products {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    rest: f64,
}

impl Hypothesis {
    /// Numbers that it adds to the model.
    pub(crate) fn numbers(&self) -> usize {
        self.causes.iter().map(|cause| cause.amplitudes.len()).sum()
    }

    /// Whether all its effects are among another one's.
    pub(crate) fn is_part_of(&self, other: &Self) -> bool {
        let is_in = |cause: &Cause| other.causes.iter().any(|own| own.effect == cause.effect);
        self.causes.iter().all(is_in)
    }
}

impl Selector<'_> {
    /// The effects that explain most alone, and every law that can act at several joints at once, but those that the system has
    /// already.
    pub(crate) fn hypotheses(
        &self,
        scan: &[Score],
        taken: &[Cause],
        system: &System,
        segments: &Segments,
    ) -> Vec<Hypothesis> {
        let is_steady = |score: &&Score| score.times.is_empty();
        let singles = scan.iter().filter(is_steady).take(LISTED);
        let mut found: Vec<Vec<&Candidate>> = singles
            .filter_map(|score| self.candidate(score.effect, Some(score.shape)))
            .map(|candidate| vec![candidate])
            .collect();
        found.extend(self.groups(taken));
        let found = found.into_par_iter();
        found
            .filter_map(|members| self.significant(&members, system, segments))
            .collect()
    }

    fn candidate(&self, effect: usize, shape: Option<f64>) -> Option<&Candidate> {
        self.base_candidates().find(|candidate| {
            candidate.effect == effect && shape.is_none_or(|shape| candidate.shape == shape)
        })
    }

    /// Laws that several joints may follow, each with a size of its own.
    fn groups(&self, taken: &[Cause]) -> Vec<Vec<&Candidate>> {
        let mut names: Vec<&str> = Vec::new();
        let mut groups: Vec<Vec<&Candidate>> = Vec::new();
        for &index in self.tested {
            let effect = self.effects[index].as_ref();
            let is_taken = taken.iter().any(|cause| cause.effect == index);
            let candidate = self.candidate(index, None);
            let Some(candidate) = candidate.filter(|_| is_of_a_group(effect) && !is_taken) else {
                continue;
            };
            match names.iter().position(|name| *name == effect.name()) {
                Some(group) => groups[group].push(candidate),
                None => {
                    names.push(effect.name());
                    groups.push(vec![candidate]);
                }
            }
        }
        groups.retain(|group| group.len() > 1);
        groups
    }

    /// The members that nature allows and that unseen rows support; none without any.
    fn significant(
        &self,
        members: &[&Candidate],
        system: &System,
        segments: &Segments,
    ) -> Option<Hypothesis> {
        let mut members = distinct(members, system);
        let products = Products::new(&members, system);
        let mut causes = self.settled(&mut members, &products, system)?;
        let mut unseen = segments.unseen(&with(system.clone(), &members));
        while members.len() > 1 {
            // those before the one that is left out are taken once for all that follow
            let mut before = system.clone();
            let gains = (0..members.len()).map(|index| {
                let without = segments.unseen(&with(before.clone(), &members[index + 1..]));
                for column in &members[index].across {
                    before.take(column.clone());
                }
                (index, unseen.gain_on(&without).deviations())
            });
            let (weakest, _) = gains
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, deviations)| *deviations < LEAST_MEMBER_GAIN_SD)
                .unzip();
            let Some(weakest) = weakest else { break };
            members.remove(weakest);
            causes = self.settled(&mut members, &products, system)?;
            unseen = segments.unseen(&with(system.clone(), &members));
        }
        Some(Hypothesis { causes, unseen })
    }

    /// Takes out members that nature does not allow, or that chance or the misfit explain, until none is left of these; the
    /// sizes of the others, the surest first.
    fn settled(
        &self,
        members: &mut Vec<Member<'_>>,
        products: &Products,
        system: &System,
    ) -> Option<Vec<Cause>> {
        loop {
            let numbers: usize = members.iter().map(|member| member.across.len()).sum();
            if members.is_empty() || system.layout.count() < READINGS_PER_NUMBER * numbers {
                return None;
            }
            let (causes, deviations) = products.sized(members, system)?;
            let may_be: Vec<bool> = causes.iter().map(|cause| self.may_be(cause)).collect();
            if may_be.contains(&false) {
                let mut may_be = may_be.into_iter();
                members.retain(|_| may_be.next().unwrap_or(false));
                continue;
            }
            let weakest = deviations
                .iter()
                .enumerate()
                .min_by(|a, b| a.1.total_cmp(b.1));
            match weakest {
                Some((index, deviations)) if *deviations < LEAST_MEMBER_SD => {
                    members.remove(index);
                }
                _ => {
                    let mut order: Vec<usize> = (0..causes.len()).collect();
                    order.sort_by(|a, b| deviations[*b].total_cmp(&deviations[*a]));
                    return Some(
                        order
                            .into_iter()
                            .map(|index| causes[index].clone())
                            .collect(),
                    );
                }
            }
        }
    }

    fn may_be(&self, cause: &Cause) -> bool {
        let effect = self.effects[cause.effect].as_ref();
        effect.is_possible(&self.engine.context, &cause.amplitudes)
    }
}

/// The candidates that neither the system nor those before them have already.
fn distinct<'c>(candidates: &[&'c Candidate], system: &System) -> Vec<Member<'c>> {
    let mut known = system.clone();
    let mut members: Vec<Member<'_>> = Vec::new();
    let mut first = 0;
    for &candidate in candidates {
        let dense = candidate.columns.iter().map(|column| system.dense(column));
        let dense: Vec<Vec<f64>> = dense.collect();
        let is_new = dense.iter().all(|column| {
            let length = dot(column, column).sqrt();
            let products = known.take_again_below(ALWAYS, column.clone());
            products.is_some_and(|products| {
                products
                    .last()
                    .is_some_and(|left| *left > DISTINCT * length)
            })
        });
        if is_new {
            let across = dense.into_iter().map(|mut column| {
                for direction in &system.basis {
                    direction.take_off(&mut column);
                }
                column
            });
            let across: Vec<Vec<f64>> = across.collect();
            let count = across.len();
            members.push(Member {
                candidate,
                across,
                first,
            });
            first += count;
        }
    }
    members
}

/// Whether several joints of a device may have an effect at once, and its first size is that of a linear model.
fn is_of_a_group(effect: &dyn Effect) -> bool {
    let spec = effect.spec();
    let is_linear = match spec.family {
        Family::Load | Family::Shape => {
            spec.shape == Shape::NONE || spec.shape == Shape::Listed(&[1.0])
        }
        Family::Coupling => true,
        // play, driven by the motor
        Family::Loop => spec.shape == Shape::Sides,
        _ => false,
    };
    is_linear && effect.joint().is_some()
}

impl Products {
    fn new(members: &[Member<'_>], system: &System) -> Self {
        let columns: Vec<&Vec<f64>> = members.iter().flat_map(|member| &member.across).collect();
        let residual = &system.residual;
        let mut gram = DMatrix::zeros(columns.len(), columns.len());
        for (a, one) in columns.iter().enumerate() {
            for (b, other) in columns.iter().enumerate().take(a + 1) {
                let product = dot(one, other);
                gram[(a, b)] = product;
                gram[(b, a)] = product;
            }
        }
        Self {
            gram,
            right: DVector::from_fn(columns.len(), |k, _| dot(columns[k], residual)),
            rest: dot(residual, residual),
        }
    }

    /// Members with the sizes that fit best together, and how far each is from nothing, in standard deviations of what
    /// all leave; none where they cannot be told apart.
    fn sized(&self, members: &[Member<'_>], system: &System) -> Option<(Vec<Cause>, Vec<f64>)> {
        let own = members.iter();
        let own = own.flat_map(|member| member.first..member.first + member.across.len());
        let own: Vec<usize> = own.collect();
        let gram = DMatrix::from_fn(own.len(), own.len(), |a, b| self.gram[(own[a], own[b])]);
        let right = DVector::from_fn(own.len(), |k, _| self.right[own[k]]);
        let covariance = gram.cholesky()?.inverse();
        let sizes = &covariance * &right;
        let rest = self.rest - sizes.dot(&right);
        let misfit = (rest / system.layout.count() as f64).max(1.0);
        let mut first = 0;
        let mut causes = Vec::new();
        let mut deviations = Vec::new();
        for member in members {
            let count = member.across.len();
            let own = sizes.rows(first, count).into_owned();
            let block = covariance.view((first, first), (count, count)).into_owned();
            let square = own.dot(&block.cholesky()?.solve(&own));
            deviations.push((square / misfit / count as f64).sqrt());
            causes.push(Cause {
                effect: member.candidate.effect,
                amplitudes: own.iter().copied().collect(),
                shape: member.candidate.shape,
                times: Vec::new(),
            });
            first += count;
        }
        Some((causes, deviations))
    }
}

/// The system with members in it.
fn with(mut system: System, members: &[Member<'_>]) -> System {
    for column in members.iter().flat_map(|member| &member.across) {
        system.take(column.clone());
    }
    system
}
