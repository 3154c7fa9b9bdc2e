//! Hypotheses of a partial explanation: an effect at a place, or one law at several places with a size at each
//! (docs/diagnosis.md, "Partial causes").

use haptical_effects::{Effect, Family, Shape};
use haptical_judge::{Backward, Less, Needless, Without, nearest};
use haptical_linalg::Direction;
use nalgebra::{DMatrix, DVector};

use crate::engine::{ALWAYS, Cause, Segments, System, Unseen, across, dot, take_off};
use crate::judge::listed;
use crate::select::{Candidate, Rival, Score, Selector};
use crate::thresholds::partial::{
    DISTINCT, LEAD_NATS, LEAST_MEMBER_GAIN_SD, LEAST_MEMBER_SD, LISTED, READINGS_PER_NUMBER,
    SEGMENTS,
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
        let found = haptical_parallel::map(found, |members| {
            self.significant(&members, system, segments)
        });
        found.into_iter().flatten().collect()
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
        let members = distinct(members, system)?;
        let mut group = Group {
            selector: self,
            members: &members,
            products: Products::new(&members, system),
            alone: Added::nothing(system, segments),
            before: Added::nothing(system, segments),
            system,
            segments,
        };
        let start = group.allowed(group.members.iter().collect()).ok()?;
        let kept = haptical_judge::without_needless(&mut group, start, 1).ok()?;
        let Allowed { causes, unseen, .. } = kept.state;
        Some(Hypothesis { causes, unseen })
    }

    /// Takes out members that nature does not allow, or that chance or the misfit explain, until none is left of these; the
    /// sizes of the others, the surest first.
    fn sized(
        &self,
        members: &mut Vec<&Member<'_>>,
        products: &Products,
        system: &System,
    ) -> Option<Vec<Cause>> {
        loop {
            let numbers: usize = members.iter().map(|member| member.across.len()).sum();
            if members.is_empty() || !is_enough(system, numbers) {
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
                    let sorted = order.into_iter().map(|index| causes[index].clone());
                    return Some(sorted.collect());
                }
            }
        }
    }

    fn may_be(&self, cause: &Cause) -> bool {
        let effect = self.effects[cause.effect].as_ref();
        effect.is_possible(&self.engine.context, &cause.amplitudes)
    }
}

/// Members that nature allows, with their sizes and what they leave of unseen rows.
struct Allowed<'g> {
    members: Vec<&'g Member<'g>>,
    /// Unknown until the members are allowed.
    causes: Vec<Cause>,
    unseen: Unseen,
}

/// No member of a group is allowed.
struct NoneAllowed;

/// Members of a hypothesis, of which those are taken out that gain nothing on unseen rows.
struct Group<'g> {
    selector: &'g Selector<'g>,
    members: &'g [Member<'g>],
    products: Products,
    system: &'g System,
    segments: &'g Segments,
    alone: Added,
    /// With the members before the one that is left out, which are taken once for all that follow.
    before: Added,
}

impl<'g> Group<'g> {
    fn allowed(&self, mut members: Vec<&'g Member<'g>>) -> Result<Allowed<'g>, NoneAllowed> {
        let causes = (self.selector)
            .sized(&mut members, &self.products, self.system)
            .ok_or(NoneAllowed)?;
        Ok(Allowed {
            unseen: self.alone.with(&members).unseen(self.segments),
            causes,
            members,
        })
    }
}

impl<'g> Backward for Group<'g> {
    type State = Allowed<'g>;
    type Error = NoneAllowed;

    fn effects(&self, allowed: &Allowed<'g>) -> usize {
        allowed.members.len()
    }

    fn without(&mut self, allowed: &Allowed<'g>, index: usize) -> Less<Self> {
        if index == 0 {
            self.before = self.alone.clone();
        }
        let mut members = allowed.members.clone();
        let member = members.remove(index);
        let unseen = self.before.with(&members[index..]).unseen(self.segments);
        self.before.take(member);
        let worth = allowed.unseen.gain_on(&unseen).deviations();
        let state = Allowed {
            members,
            causes: Vec::new(),
            unseen,
        };
        Ok(Without { state, worth })
    }
}

impl<'g> Needless for Group<'g> {
    fn is_needless(
        &mut self,
        _: &Allowed<'g>,
        index: usize,
        all: &[Without<Allowed<'g>>],
    ) -> Result<bool, NoneAllowed> {
        Ok(all[index].worth < LEAST_MEMBER_GAIN_SD)
    }

    fn refitted(&mut self, state: Allowed<'g>) -> Result<Allowed<'g>, NoneAllowed> {
        self.allowed(state.members)
    }
}

/// Whether the log is long enough for so many numbers.
fn is_enough(system: &System, numbers: usize) -> bool {
    system.layout.count() >= READINGS_PER_NUMBER * numbers
}

/// The candidates that neither the system nor those before them have already; none where they are too many for the log.
fn distinct<'c>(candidates: &[&'c Candidate], system: &System) -> Option<Vec<Member<'c>>> {
    let mut known: Vec<Direction> = Vec::new();
    let mut members: Vec<Member<'_>> = Vec::new();
    let mut first = 0;
    for &candidate in candidates {
        let mut columns = Vec::new();
        for column in &candidate.columns {
            let dense = system.dense(column);
            let length = dot(&dense, &dense).sqrt();
            let Some(own) = beyond(dense, &system.basis) else {
                break;
            };
            let Some(new) = across(own.clone(), ALWAYS, || known.iter()) else {
                break;
            };
            let left = new.products.last().copied().unwrap_or(0.0);
            known.push(Direction::new(new.direction));
            if left <= DISTINCT * length {
                break;
            }
            columns.push(own);
        }
        if columns.len() == candidate.columns.len() {
            let count = columns.len();
            members.push(Member {
                candidate,
                across: columns,
                first,
            });
            first += count;
            // a coupling of every joint with every other is thousands: not worth their products
            if !is_enough(system, first) {
                return None;
            }
        }
    }
    Some(members)
}

/// The part of a column across a system's directions, with its length; none where nothing is left.
fn beyond(column: Vec<f64>, basis: &[Direction]) -> Option<Vec<f64>> {
    let mut own = across(column, ALWAYS, || basis.iter())?;
    let left = own.products.last().copied()?;
    own.direction.iter_mut().for_each(|entry| *entry *= left);
    Some(own.direction)
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
    fn sized(&self, members: &[&Member<'_>], system: &System) -> Option<(Vec<Cause>, Vec<f64>)> {
        let own = members.iter();
        let own = own.flat_map(|member| member.first..member.first + member.across.len());
        let own: Vec<usize> = own.collect();
        let gram = DMatrix::from_fn(own.len(), own.len(), |a, b| self.gram[(own[a], own[b])]);
        let right = DVector::from_fn(own.len(), |k, _| self.right[own[k]]);
        let inverse = lower_inverse(&gram.cholesky()?.l());
        let along = &inverse * &right;
        let sizes = inverse.tr_mul(&along);
        let rest = self.rest - along.norm_squared();
        let misfit = (rest / system.layout.count() as f64).max(1.0);
        let mut first = 0;
        let mut causes = Vec::new();
        let mut deviations = Vec::new();
        for member in members {
            let count = member.across.len();
            let own = sizes.rows(first, count).into_owned();
            let columns = inverse.columns(first, count);
            let block = columns.tr_mul(&columns);
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

/// The inverse of a lower triangle, a column at a time: a third of what the inverse of the product takes, of which the
/// blocks on the diagonal are needed alone.
fn lower_inverse(lower: &DMatrix<f64>) -> DMatrix<f64> {
    let count = lower.nrows();
    let mut inverse = DMatrix::identity(count, count);
    for column in 0..count {
        let mut own = inverse.column_mut(column);
        for pivot in column..count {
            let value: f64 = own[pivot] / lower[(pivot, pivot)];
            own[pivot] = value;
            own.rows_range_mut(pivot + 1..).axpy(
                -value,
                &lower.column(pivot).rows_range(pivot + 1..),
                1.0,
            );
        }
    }
    inverse
}

/// A system with members in it: what they leave, and the directions beside the base model's.
#[derive(Clone)]
struct Added {
    residual: Vec<f64>,
    added: Vec<Direction>,
    /// The first of them that is a member's: the members' columns are across those before it.
    first: usize,
}

impl Added {
    fn nothing(system: &System, segments: &Segments) -> Self {
        let added = segments.added(system).to_vec();
        Self {
            residual: system.residual.clone(),
            first: added.len(),
            added,
        }
    }

    fn with(&self, members: &[&Member<'_>]) -> Self {
        let mut own = self.clone();
        members.iter().for_each(|member| own.take(member));
        own
    }

    fn take(&mut self, member: &Member<'_>) {
        for column in &member.across {
            let before = || self.added[self.first..].iter();
            if let Some(own) = across(column.clone(), ALWAYS, before) {
                take_off(&mut self.residual, &own.direction);
                self.added.push(Direction::new(own.direction));
            }
        }
    }

    fn unseen(&self, segments: &Segments) -> Unseen {
        segments.unseen_with(&self.residual, &self.added)
    }
}

impl Selector<'_> {
    /// Each cause of a hypothesis with the hypotheses that could be in its place: a normal lead on unseen rows, and what
    /// each number costs (Schwarz 1978).
    pub(super) fn rivals_of(
        &self,
        best: &Hypothesis,
        found: &[Hypothesis],
        before: &Unseen,
    ) -> Vec<Vec<Rival>> {
        let gained = best.unseen.gain_on(before).sum;
        let share = |hypothesis: &Hypothesis| hypothesis.unseen.gain_on(before).sum / gained;
        let others = found
            .iter()
            .filter(|other| !other.is_part_of(best) && !best.is_part_of(other));
        let others = others.filter_map(|other| {
            let lead = best.unseen.gain_on(&other.unseen).deviations_by_sign();
            let first = other.causes.first()?;
            let more = other.numbers() as f64 - best.numbers() as f64;
            let nats_behind = LEAD_NATS * (lead.max(0.0).powi(2) + more * (SEGMENTS as f64).ln());
            let effect = self.effects[first.effect].as_ref();
            Some(Rival::new(effect, share(other), nats_behind.max(0.0)))
        });
        let others = others.chain(self.loops_between_postures(best));
        let others = nearest(others.map(|rival| haptical_judge::Rival {
            name: rival.name,
            behind: rival.nats_behind,
            fit: rival,
        }));
        let lists = best.causes.iter().map(|cause| {
            let effect = self.effects[cause.effect].as_ref();
            let others = others.iter().map(|other| other.fit.clone());
            listed(Rival::new(effect, share(best), 0.0), others, 0.0)
        });
        lists.collect()
    }
}

impl Selector<'_> {
    /// Other loops at the joint of a loop: between single postures all are at one end or the other, so that nothing but their
    /// prior odds and the shapes that were tried tells them apart.
    fn loops_between_postures(&self, best: &Hypothesis) -> Vec<Rival> {
        let Some(first) = best.causes.first() else {
            return Vec::new();
        };
        let effect = self.effects[first.effect].as_ref();
        if self.engine.context.ordered || effect.spec().family != Family::Loop {
            return Vec::new();
        }
        let cost = |effect: &dyn Effect| self.shapes_tried(effect).ln() - effect.spec().log_prior;
        let others = self
            .tested
            .iter()
            .map(|&index| self.effects[index].as_ref());
        let twins = others.filter(|other| {
            let (own, spec) = (effect.spec(), other.spec());
            spec.family == Family::Loop
                && (spec.hook, other.joint()) == (own.hook, effect.joint())
                && spec.name != own.name
        });
        twins
            .map(|other| Rival::new(other, 1.0, (cost(other) - cost(effect)).max(0.0)))
            .collect()
    }
}
