//! Which effects a recording shows beside the base model: one after the other, each where it explains most.

mod fitted;
mod numbers;
mod refine;
mod rivals;
mod scored;

pub(crate) use self::fitted::Fitted;
use self::numbers::numbers;
pub(crate) use self::rivals::Rival;
use self::scored::{Pool, Scored};
use crate::base::Base;
use crate::effect::{Candidate, Context};
use crate::problem::Problem;
use crate::span::Column;

/// Most effects at once.
const MOST: usize = 4;
/// What an effect explains beyond its numbers, at least \[nats\].
const LEAST_NATS: f64 = 12.0;
/// And of what all rows hold beyond noise.
const LEAST_SHARE: f64 = 0.03;
/// Delays are settled to this share of a step.
const DELAY_STEPS: f64 = 0.01;
/// Longest delay that is tried \[s\].
const LONGEST_S: f64 = 0.1;
/// The effect whose size is settled by shifting the torques.
const DELAY: &str = "encoder-latency";

/// What was found.
pub(crate) struct Selection {
    pub(crate) picks: Vec<Pick>,
    /// Energy of the base model's rest beyond noise, and of what all picks leave \[nats\].
    pub(crate) before: f64,
    pub(crate) after: f64,
    /// Rows that a rest may have of noise.
    pub(crate) freedom: f64,
    /// Rests, row by row, known numbers last.
    pub(crate) rest_before: Vec<f64>,
    pub(crate) rest_after: Vec<f64>,
    /// How long the torques are before the positions, as picked.
    pub(crate) early_s: f64,
    /// Coefficients of the base model's columns without picks.
    pub(crate) base_solution: Vec<f64>,
}

/// An effect that was taken.
pub(crate) struct Pick {
    pub(crate) effect: &'static str,
    pub(crate) joint: Option<usize>,
    /// What it explains beside the others, its numbers allowed for \[nats\].
    pub(crate) nats: f64,
    /// The others that explain nearly as much in its place.
    pub(crate) rivals: Vec<Rival>,
    /// Numbers with standard deviations.
    pub(crate) numbers: Vec<(&'static str, f64, f64)>,
    /// Numbers of its shape, first ones first, for another recording.
    pub(crate) shape: Vec<f64>,
}

/// Selects effects; `without`: names that are left out.
pub(crate) fn select(problem: &Problem, base: &Base, without: &[String]) -> Selection {
    let bare = Fitted::new(problem, base, &[], None);
    let torque = base.torque(problem, &bare.base_solution);
    let context = Context {
        problem,
        base,
        torque: &torque,
    };
    let pool = Pool::new(context, without);
    let before = bare.excess();
    let least = LEAST_NATS.max(LEAST_SHARE * before);
    let mut picks: Vec<Scored<'_>> = Vec::new();
    let mut early_s = None;
    let mut fitted = None;
    while picks.len() < MOST {
        let at = fitted.as_ref().unwrap_or(&bare);
        let best = (pool.scored(at).into_iter())
            .filter(|scored| scored.nats > least && !is_taken(&picks, &scored.candidate))
            .reduce(|best, other| if other.nats > best.nats { other } else { best });
        let Some(best) = best else {
            break;
        };
        picks.push(refine::refined(at, best));
        if picks.iter().any(|own| own.candidate.effect == DELAY) {
            early_s = Some(delay(problem, base, &picks, early_s.unwrap_or(0.0)));
        }
        fitted = Some(Fitted::new(
            problem,
            base,
            &columns_of(&picks, None),
            early_s,
        ));
    }
    let rest_before = bare.rest.clone();
    let base_solution = bare.base_solution.clone();
    let fitted = fitted.unwrap_or(bare);
    let after = fitted.excess();
    let misfit = (1.0 + 2.0 * after / fitted.freedom.max(1.0)).max(1.0);
    let mut first = 0;
    let mut found = Vec::new();
    for (index, scored) in picks.iter().enumerate() {
        let columns = first..first + scored.candidate.columns.len();
        first = columns.end;
        let mut numbers = numbers(&fitted, columns, &scored.candidate, misfit);
        if scored.candidate.effect == DELAY {
            numbers
                .iter_mut()
                .for_each(|own| own.1 += early_s.unwrap_or(0.0));
        }
        let (nats, rivals) = rivals::rivals(&fitted, &pool, &picks, index, early_s, misfit);
        found.push(Pick {
            effect: scored.candidate.effect,
            joint: scored.candidate.joint,
            nats,
            rivals,
            numbers,
            shape: scored.candidate.shape.iter().map(|own| own.1).collect(),
        });
    }
    Selection {
        picks: found,
        before,
        after,
        freedom: fitted.freedom,
        rest_before,
        rest_after: fitted.rest,
        early_s: early_s.unwrap_or(0.0),
        base_solution,
    }
}

/// Columns of all picks, but for one that may be left out.
fn columns_of(picks: &[Scored<'_>], without: Option<usize>) -> Vec<Column> {
    let all = picks
        .iter()
        .enumerate()
        .filter(|(index, _)| Some(*index) != without);
    all.flat_map(|(_, own)| own.candidate.columns.iter().cloned())
        .collect()
}

fn is_taken(picks: &[Scored<'_>], candidate: &Candidate<'_>) -> bool {
    let same = |own: &Scored<'_>| {
        own.candidate.effect == candidate.effect && own.candidate.joint == candidate.joint
    };
    picks.iter().any(same)
}

/// The delay that leaves least beside the base model and the other picks: Newton's steps, each from torques shifted by it.
fn delay(problem: &Problem, base: &Base, picks: &[Scored<'_>], start_s: f64) -> f64 {
    let columns = columns_of(picks, None);
    let mut first = 0;
    for own in picks.iter().take_while(|own| own.candidate.effect != DELAY) {
        first += own.candidate.columns.len();
    }
    let mut at = start_s;
    for _ in 0..8 {
        let fitted = Fitted::new(problem, base, &columns, Some(at));
        let step = fitted.effect_solution[first];
        at = (at + step).clamp(-LONGEST_S, LONGEST_S);
        if step.abs() < DELAY_STEPS * problem.samples.step_s {
            break;
        }
    }
    at
}
