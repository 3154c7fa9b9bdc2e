//! Which effects a recording shows beside the base model: one after the other, each where it explains most.

mod armatures;
mod exchanged;
mod fitted;
mod numbers;
mod refine;
mod rivals;
mod scaled;
mod scored;
mod shape;

use std::convert::Infallible;
use std::rc::Rc;

use haptical_judge::{
    Backward, Forward, Less, Needless, Proposal, Proposals, Ruled, Ruling, Without,
    without_needless,
};

pub(crate) use self::fitted::{Fitted, Frame, within_limits};
pub(crate) use self::numbers::numbers;
pub(crate) use self::rivals::Rival;
pub(crate) use self::scored::{Place, Pool};
use self::scored::{Scored, penalty};
use crate::effect::{Candidate, Context, Finer, is_constant, is_exact, is_zero, torque_gain};
use crate::examined::is_beyond_noise;
use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::thresholds::examine::LEFT_BY_LAW;
use crate::thresholds::plausible;
use crate::thresholds::select::{
    CORRECTIONS, DELAY_TOLERANCE, FITTED_IN_FULL, LEAST_LAST_NATS, LEAST_NATS, LEAST_OF_DELAYED,
    LEAST_OF_REST, LEAST_OF_WHOLE, LONGEST_DELAY_S, MOST_EFFECTS, MOST_OF_CORRECTED, MOST_PLACES,
    NEAR_STRONGEST,
};

/// What was found.
pub(crate) struct Selection {
    pub(crate) picks: Vec<Pick>,
    /// The base model alone, and with all picks.
    pub(crate) bare: Fitted,
    pub(crate) fitted: Fitted,
    /// How long the torques are before the positions, as picked.
    pub(crate) early_s: f64,
    /// Times that the noise's square is larger by what all picks leave.
    pub(crate) misfit: f64,
    /// Effects at places that were tried.
    pub(crate) tried: usize,
}

impl Selection {
    /// Puts what is left of torques in another scale, which is in the arm's, in that of the readings and their noise.
    pub(crate) fn put_in_readings(&self, problem: &Problem, rest: &mut [f64]) {
        let rows = problem.states.rows();
        for (channel, &joint) in problem.channels.iter().enumerate() {
            let of_joint = |own: &&Pick| own.joint.is_none_or(|own| own == joint);
            let scales = self.picks.iter().filter(of_joint);
            let scales =
                scales.filter_map(|own| match (own.numbers.first(), own.about.is_empty()) {
                    // by the nominal bodies, what is left is that of the readings
                    (_, true) => None,
                    (Some(("factor", factor, _)), _) => Some(*factor),
                    (Some(("gain", gain, _)), _) => Some(1.0 / (1.0 - gain)),
                    _ => None,
                });
            let scale: f64 = scales.product();
            let own = &mut rest[channel * rows..][..rows];
            own.iter_mut().for_each(|value| *value *= scale);
        }
    }
}

/// An effect that was taken.
pub(crate) struct Pick {
    pub(crate) effect: &'static str,
    pub(crate) joint: Option<usize>,
    /// What it explains beside the others, its numbers allowed for \[nats\].
    pub(crate) nats: f64,
    /// The others that explain nearly as much in its place.
    pub(crate) rivals: Vec<Rival>,
    /// Whether it explains something beside an inertia that the model lacks.
    pub(crate) is_told: bool,
    /// Numbers with standard deviations.
    pub(crate) numbers: Vec<(&'static str, f64, f64)>,
    pub(crate) columns: Vec<Rc<Column>>,
    pub(crate) coefficients: Vec<f64>,
    /// The coefficients that its numbers are read off.
    pub(crate) read_off: Vec<f64>,
    /// Which of its effect's laws it is, its shape, and what it is linear about.
    pub(crate) kind: usize,
    pub(crate) shape: Vec<f64>,
    pub(crate) about: Vec<f64>,
    /// Whether it belongs to its recording alone, and whether it is the delay of all positions.
    pub(crate) is_of_recording: bool,
    pub(crate) is_delay_of_all: bool,
}

impl Pick {
    /// The joint (from 0) whose zero it is.
    pub(crate) fn zero(&self) -> Option<usize> {
        self.joint.filter(|_| is_zero(self.effect))
    }
}

/// A fit with effects, and how long its torques are before the positions.
#[derive(Clone)]
struct State<'c> {
    taken: Vec<Candidate<'c>>,
    fitted: Fitted,
    early_s: Option<f64>,
}

impl State<'_> {
    /// What the last effect explains of what a fit without it leaves, its numbers allowed for \[nats\].
    fn last_nats(&self, frame: &Frame<'_>, before: &Fitted) -> f64 {
        let last = self.taken.last().map_or(0.0, |own| penalty(frame, own));
        before.excess - self.fitted.excess - last
    }
}

/// Selects effects; `without`: names that are left out, `refuted`: effects that are not at a joint.
pub(crate) fn select(
    problem: &Problem,
    base: &Base,
    without: &[String],
    refuted: &[Place],
) -> Selection {
    let frame = Frame::new(problem, base);
    let bare = frame.fitted(&[], None);
    let torque = base.torque(problem, &bare.solved.solution);
    let context = Context {
        problem,
        base,
        torque: &torque,
    };
    let pool = Pool::new(context, without, refuted);
    let mut state = searched(&frame, &pool, &bare);
    let misfit = (1.0 + 2.0 * state.fitted.excess / state.fitted.freedom.max(1.0)).max(1.0);
    let mut shape_sds = Vec::new();
    for index in 0..state.taken.len() {
        let (nearer, sd) = shape::settled(&frame, state, index, misfit);
        state = nearer;
        shape_sds.push(sd);
    }
    let times = frame.times();
    let columns = columns_of(&state.taken);
    let known = frame.counting_known(times).fitted(&columns, state.early_s);
    let mut first = 0;
    let mut picks = Vec::new();
    let mut search = Search::new(&frame, &pool, &bare);
    for (index, candidate) in state.taken.iter().enumerate() {
        let columns = first..first + candidate.columns.len();
        first = columns.end;
        let coefficients = state.fitted.effects()[columns.clone()].to_vec();
        let beside = search.compared(&state, index, misfit);
        let widened = ((misfit, times), shape_sds[index]);
        let read_off = known.effects()[columns.clone()].to_vec();
        let mut numbers = numbers(&known, columns, candidate, widened);
        for own in numbers.iter_mut().filter(|own| own.0 == "delay_s") {
            own.2 = own.2.hypot(plausible::OF_STEP * problem.samples.step_s);
        }
        if candidate.is_delay_of_all() {
            numbers
                .iter_mut()
                .for_each(|own| own.1 += state.early_s.unwrap_or(0.0));
        }
        picks.push(Pick {
            effect: candidate.effect,
            joint: candidate.joint,
            nats: beside.nats,
            rivals: beside.rivals,
            is_told: beside.is_told,
            numbers,
            coefficients,
            read_off,
            columns: candidate.columns.clone(),
            kind: candidate.kind,
            shape: candidate.shape.iter().map(|own| own.1).collect(),
            about: candidate.about.clone(),
            is_of_recording: candidate.is_of_recording,
            is_delay_of_all: candidate.is_delay_of_all(),
        });
    }
    // strongest first
    picks.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    Selection {
        picks,
        bare,
        fitted: state.fitted,
        early_s: state.early_s.unwrap_or(0.0),
        misfit,
        tried: pool.places(),
    }
}

/// Effects one by one, each the best with those before; armatures together where that leaves a gap; less those that later ones make needless.
fn searched<'c>(frame: &Frame<'_>, pool: &Pool<'c>, bare: &Fitted) -> State<'c> {
    let mut search = Search::new(frame, pool, bare);
    let start = State {
        taken: Vec::new(),
        fitted: bare.clone(),
        early_s: None,
    };
    let Ok(mut state) = haptical_judge::select(&mut search, start.clone());
    search.way.push(state.clone());
    if !is_quiet(frame.problem, &state.fitted)
        && let Some(other) = armatures::together(&mut search)
    {
        state = other;
    }
    let Ok(kept) = without_needless(&mut search, state, 1);
    let Ok(scaled) = scaled::scaled(&mut search, &start, &kept.state);
    exchanged::exchanged(&mut search, scaled.unwrap_or(kept.state))
}

/// The search of effects for a recording.
struct Search<'s, 'f, 'c> {
    frame: &'s Frame<'f>,
    pool: &'s Pool<'c>,
    /// What the base model leaves \[nats\], and its squares of each channel.
    bare_excess: f64,
    bare_squares: Vec<f64>,
    /// States before each effect that was taken.
    way: Vec<State<'c>>,
}

impl<'s, 'f, 'c> Search<'s, 'f, 'c> {
    fn new(frame: &'s Frame<'f>, pool: &'s Pool<'c>, bare: &Fitted) -> Self {
        Self {
            frame,
            pool,
            bare_excess: bare.excess,
            bare_squares: squares(frame.problem, bare),
            way: Vec::new(),
        }
    }

    /// Whether a further effect explains more of a channel than the law of those before may be off by there. A constant that is no
    /// body's and leaves noise alone next to bodies is no such rest.
    fn is_beyond_law(&self, state: &State<'c>, further: &State<'c>) -> bool {
        let problem = self.frame.problem;
        let [before, after] =
            [&state.fitted, &further.fitted].map(|fitted| squares(problem, fitted));
        let mut channels = before.iter().zip(&after).zip(&self.bare_squares);
        let is_constant = state.taken.iter().all(|taken| is_exact(taken.effect))
            && further
                .taken
                .last()
                .is_some_and(|last| is_constant(last.effect));
        state.taken.is_empty()
            || channels.any(|((before, after), bare)| before - after > LEFT_BY_LAW * bare)
            || (is_constant && is_quiet(problem, &further.fitted))
    }

    /// What a further effect has to explain.
    fn least(&self, state: &State<'c>) -> LeastNats {
        let of_whole = LEAST_OF_WHOLE * self.bare_excess;
        let of_delayed = match state.taken.iter().any(Candidate::is_delay_of_all) {
            true => LEAST_OF_DELAYED * self.bare_excess,
            false => 0.0,
        };
        let of_rest = of_whole.min(LEAST_OF_REST * state.fitted.excess);
        LeastNats {
            of_law: LEAST_NATS.max(of_rest).max(of_delayed),
            of_recording: match state.taken.is_empty() {
                true => LEAST_NATS,
                false => LEAST_NATS.max(of_whole),
            },
        }
    }
}

impl<'c> Forward for Search<'_, '_, 'c> {
    type State = State<'c>;
    type Further = State<'c>;
    type Error = Infallible;

    fn proposals(&mut self, state: &State<'c>) -> Proposals<Self> {
        let is_full = kinds(&state.taken) > MOST_EFFECTS || state.taken.len() >= MOST_PLACES;
        let has_enough = !state.taken.is_empty() && is_quiet(self.frame.problem, &state.fitted);
        if is_full || has_enough {
            return Ok(Vec::new());
        }
        let least = self.least(state);
        let near = nearest(self.frame, self.pool, state).into_iter();
        let proposals = near.map(|further| Proposal {
            merit: further.last_nats(self.frame, &state.fitted),
            further,
        });
        let mut proposals: Vec<_> = proposals.collect();
        scale_by_rows(&mut proposals);
        proposals.retain(|own| {
            own.merit > least.of(&own.further) && self.is_beyond_law(state, &own.further)
        });
        Ok(proposals)
    }

    fn rule(&mut self, state: &State<'c>, best: Proposal<State<'c>>) -> Ruled<Self> {
        if kinds(&best.further.taken) > MOST_EFFECTS {
            return Ok(Ruling::Ended);
        }
        self.way.push(state.clone());
        Ok(Ruling::Taken(best.further))
    }
}

impl<'c> Backward for Search<'_, '_, 'c> {
    type State = State<'c>;
    type Error = Infallible;

    fn effects(&self, state: &State<'c>) -> usize {
        state.taken.len()
    }

    fn without(&mut self, state: &State<'c>, effect: usize) -> Less<Self> {
        let mut taken = state.taken.clone();
        let gone = taken.remove(effect);
        // a delay that was taken is in the recorded rows: what is in its place has to do without
        let early_s = state.early_s.filter(|_| !gone.is_delay_of_all());
        let fitted = self.frame.fitted(&columns_of(&taken), early_s);
        let worth = fitted.excess - state.fitted.excess - penalty(self.frame, &gone);
        let state = State {
            taken,
            fitted,
            early_s,
        };
        Ok(Without { state, worth })
    }
}

impl<'c> Needless for Search<'_, '_, 'c> {
    fn is_needless(
        &mut self,
        _: &State<'c>,
        effect: usize,
        all: &[Without<State<'c>>],
    ) -> Result<bool, Infallible> {
        Ok(all[effect].worth < LEAST_NATS)
    }
}

/// One factor on all torques is what they all are in, or none of them: beside another effect it is none. Against others the rows alone
/// tell, as for the places of one law (docs/assumptions.md, A308): in another unit all bodies are off in proportion, which is no less likely
/// than one body that is off.
fn scale_by_rows(proposals: &mut Vec<Proposal<State<'_>>>) {
    let is_scale = |proposal: &Proposal<State<'_>>| {
        let last = proposal.further.taken.last();
        last.is_some_and(is_scale_of_all)
    };
    proposals.retain(|proposal| !is_scale(proposal) || proposal.further.taken.len() == 1);
    let Some(scale) = proposals.iter().position(is_scale) else {
        return;
    };
    let others = proposals.iter().filter(|proposal| !is_scale(proposal));
    let Some(best) = others.max_by(|a, b| a.merit.total_cmp(&b.merit)) else {
        return;
    };
    let State { taken, fitted, .. } = &proposals[scale].further;
    let of_noise = taken.last().map_or(0.0, |last| last.of_noise);
    let by_rows = best.merit - fitted.behind(&best.further.fitted) - of_noise;
    proposals[scale].merit = proposals[scale].merit.max(by_rows);
}

fn is_scale_of_all(own: &Candidate<'_>) -> bool {
    own.effect == torque_gain::EFFECT.name && own.joint.is_none()
}

/// What a further effect has to explain \[nats\].
#[derive(Clone, Copy)]
struct LeastNats {
    of_law: f64,
    /// One that belongs to its recording alone, as a push does, is free in time: it explains its share of the whole, since a part of what is
    /// left of another law it explains always.
    of_recording: f64,
}

impl LeastNats {
    fn of(self, state: &State<'_>) -> f64 {
        match state.taken.last() {
            Some(own) if own.is_of_recording => self.of_recording,
            _ => self.of_law,
        }
    }
}

/// Different effects among them.
fn kinds(taken: &[Candidate<'_>]) -> usize {
    let mut names: Vec<&str> = taken.iter().map(|own| own.effect).collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}

/// Squares of each channel's rest, in squares of noise.
fn squares(problem: &Problem, fitted: &Fitted) -> Vec<f64> {
    let channels = fitted.solved.rest.chunks(problem.states.rows());
    channels.map(|own| haptical_linalg::dot(own, own)).collect()
}

/// Whether no channel's rest is larger than its noise: what would be no gap by itself needs no further effect.
fn is_quiet(problem: &Problem, fitted: &Fitted) -> bool {
    let rows = problem.states.rows();
    let mut channels = squares(problem, fitted).into_iter();
    !channels.any(|square| is_beyond_noise((square / rows as f64).sqrt(), rows))
}

/// States with each of the effects that explain most of what a fit leaves, strongest candidates first.
fn nearest<'c>(frame: &Frame<'_>, pool: &Pool<'c>, state: &State<'c>) -> Vec<State<'c>> {
    let mut all: Vec<Scored<'c>> = pool.scored(frame, &state.fitted);
    all.retain(|own| own.nats > 0.0 && !is_taken(&state.taken, &own.candidate));
    all.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    let mut near: Vec<Scored<'c>> = Vec::new();
    for own in all {
        let is_there = |other: &Scored<'_>| {
            other.candidate.effect == own.candidate.effect
                && other.candidate.joint == own.candidate.joint
        };
        // an effect whose shapes differ in kind may be there twice
        let copies = near.iter().filter(|other| is_there(other)).count();
        let is_near = near
            .first()
            .is_none_or(|first| own.nats > NEAR_STRONGEST * first.nats);
        // one factor on all torques is like many bodies, and its first order says little of it
        let is_asked = near.len() < FITTED_IN_FULL && is_near || is_scale_of_all(&own.candidate);
        if is_asked && copies < 1 {
            near.push(own);
        }
    }
    near.into_iter()
        .filter_map(|own| {
            with(
                frame,
                state,
                refine::refined(frame, &state.fitted, own).candidate,
            )
        })
        .map(|next| corrected(frame, state, next))
        .collect()
}

/// The state with its last effect's law corrected by where the whole fit has it, if it has a correction, or linear about there: where numbers of
/// the base model were at their limits, what a law explains beside them says little of it.
fn corrected<'c>(frame: &Frame<'_>, before: &State<'c>, next: State<'c>) -> State<'c> {
    // noise that its columns share with the rows is no reason against the better law
    let gross = |own: &State<'c>| before.fitted.excess - own.fitted.excess;
    let of_correction = gross(&next) / MOST_OF_CORRECTED;
    let mut best = next;
    for _ in 0..CORRECTIONS {
        let last = best.taken.last();
        let (make, most) = match last.map(|own| own.finer.clone()) {
            Some(Finer::Correction(make)) => (make, of_correction),
            Some(Finer::About(make)) => (make, f64::INFINITY),
            _ => break,
        };
        let count = last.map_or(0, |own| own.columns.len());
        let effects = best.fitted.effects();
        let nearer = make(&effects[effects.len() - count..]);
        match nearer.and_then(|own| with(frame, before, own)) {
            Some(nearer) if (gross(&best) - 1.0..most).contains(&gross(&nearer)) => best = nearer,
            _ => break,
        }
    }
    best
}

/// The state with a further effect; none where its coefficients in the whole fit are not those of one.
fn with<'c>(frame: &Frame<'_>, state: &State<'c>, further: Candidate<'c>) -> Option<State<'c>> {
    let mut taken = state.taken.clone();
    taken.push(further);
    let system = frame.with(&columns_of(&taken));
    let mut early_s = state.early_s;
    if taken.iter().any(Candidate::is_delay_of_all) {
        early_s = Some(delay(frame, &taken, &system, early_s.unwrap_or(0.0)));
    }
    let fitted = frame.fitted_with(system, early_s);
    let mut first = 0;
    for own in &taken {
        let coefficients = &fitted.effects()[first..first + own.columns.len()];
        first += own.columns.len();
        if !own.is_delay_of_all() && !own.is_possible(coefficients) {
            return None;
        }
        let last = fitted.base_columns + first - 1;
        let variance = fitted.solved.covariance(&[last])[(0, 0)];
        let last_nats = 0.5 * fitted.solved.solution[last].powi(2) / variance.max(1e-300);
        if own.needs_last && last_nats < LEAST_LAST_NATS {
            return None;
        }
    }
    Some(State {
        taken,
        fitted,
        early_s,
    })
}

/// Columns of all effects.
fn columns_of(taken: &[Candidate<'_>]) -> Vec<Rc<Column>> {
    let all = taken.iter().flat_map(|own| own.columns.iter().cloned());
    all.collect()
}

fn is_taken(taken: &[Candidate<'_>], candidate: &Candidate<'_>) -> bool {
    let same = |own: &Candidate<'_>| own.effect == candidate.effect && own.joint == candidate.joint;
    taken.iter().any(same)
}

/// The delay that leaves least beside the base model and the other effects: Newton's steps, each from torques shifted by it.
fn delay(frame: &Frame<'_>, taken: &[Candidate<'_>], system: &System, start_s: f64) -> f64 {
    let before = taken.iter().take_while(|own| !own.is_delay_of_all());
    let first: usize = before.map(|own| own.columns.len()).sum();
    let mut at = start_s;
    for _ in 0..8 {
        let step = frame.coefficients(system, at)[first];
        at = (at + step).clamp(-LONGEST_DELAY_S, LONGEST_DELAY_S);
        if step.abs() < DELAY_TOLERANCE * frame.problem.samples.step_s {
            break;
        }
    }
    at
}
