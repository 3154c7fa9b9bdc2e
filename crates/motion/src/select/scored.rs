//! Candidates with what they explain.

use super::{Fitted, Frame, Pick};
use crate::effect::{Candidate, Candidates, Context, EFFECTS};
use crate::thresholds::select::LEAST_LAST_NATS;

/// A candidate and what it explains.
#[derive(Clone)]
pub(crate) struct Scored<'c> {
    pub(crate) candidate: Candidate<'c>,
    /// Less what its numbers would explain of noise \[nats\].
    pub(crate) nats: f64,
    pub(crate) coefficients: Vec<f64>,
}

/// An effect, and the joint that it is at (from 0).
pub(crate) type Place = (&'static str, Option<usize>);

fn is_refuted(refuted: &[Place], own: &Candidate<'_>) -> bool {
    refuted.contains(&(own.effect, own.joint))
}

/// All candidates.
pub(crate) struct Pool<'c> {
    context: Context<'c>,
    without: &'c [String],
    refuted: &'c [Place],
    given: Vec<Candidate<'c>>,
}

impl<'c> Pool<'c> {
    pub(crate) fn new(context: Context<'c>, without: &'c [String], refuted: &'c [Place]) -> Self {
        let given = EFFECTS
            .iter()
            .filter(|own| !without.iter().any(|name| name == own.name));
        let given = given.flat_map(|own| match own.candidates {
            Candidates::Given(make) => make(context),
            Candidates::ByRest(_) => Vec::new(),
        });
        Self {
            given: given.filter(|own| !is_refuted(refuted, own)).collect(),
            context,
            without,
            refuted,
        }
    }

    /// Candidates of an effect that do not depend on a rest.
    pub(crate) fn given_of(&self, effect: &str) -> impl Iterator<Item = &Candidate<'c>> {
        self.given.iter().filter(move |own| own.effect == effect)
    }

    /// Candidates that are of no joint and of no single recording, and do not depend on a rest.
    pub(crate) fn of_arm(&self) -> impl Iterator<Item = &Candidate<'c>> {
        let is_of_arm = |own: &&Candidate<'c>| own.joint.is_none() && !own.is_of_recording;
        self.given.iter().filter(is_of_arm)
    }

    /// Effects at places.
    pub(crate) fn places(&self) -> usize {
        let mut places: Vec<_> = self
            .given
            .iter()
            .map(|own| (own.effect, own.joint))
            .collect();
        places.sort_unstable();
        places.dedup();
        places.len()
    }

    /// A candidate of the same law at the same place, whatever its shape; none of a law that belongs to one recording.
    pub(crate) fn like(&self, frame: &Frame<'_>, pick: &Pick) -> Option<Candidate<'c>> {
        let is_like = |own: &Candidate<'_>| {
            own.effect == pick.effect && own.joint == pick.joint && own.kind == pick.kind
        };
        if let Some(own) = self.given.iter().find(|own| is_like(own)) {
            return (!own.is_of_recording).then(|| own.clone());
        }
        let rest = vec![0.0; frame.problem.channel_rows()];
        let effects = EFFECTS.iter().filter(|own| own.name == pick.effect);
        let mut by_rest = effects.filter_map(|own| match own.candidates {
            Candidates::ByRest(make) => make(self.context, &rest).into_iter().find(is_like),
            Candidates::Given(_) => None,
        });
        by_rest.next()
    }

    /// What each of them explains of what a fit leaves; those that are not sound left out.
    pub(crate) fn scored(&self, frame: &Frame<'_>, fitted: &Fitted) -> Vec<Scored<'c>> {
        let given = self.given.iter();
        let mut found: Vec<Scored<'c>> =
            given.filter_map(|own| score(frame, fitted, own)).collect();
        for effect in EFFECTS
            .iter()
            .filter(|own| !self.without.iter().any(|name| name == own.name))
        {
            if let Candidates::ByRest(make) = effect.candidates {
                let candidates = make(self.context, &fitted.solved.rest).into_iter();
                let candidates = candidates.filter(|own| !is_refuted(self.refuted, own));
                found.extend(candidates.filter_map(|own| score(frame, fitted, &own)));
            }
        }
        found
    }
}

/// What a candidate explains of what a fit leaves; none where its coefficients are not those of such an effect.
pub(crate) fn score<'c>(
    frame: &Frame<'_>,
    fitted: &Fitted,
    candidate: &Candidate<'c>,
) -> Option<Scored<'c>> {
    let across = fitted.system.across(&candidate.columns);
    let gain = fitted.solved.gain(&candidate.columns, &across);
    let is_empty = candidate.needs_last && gain.last_nats < LEAST_LAST_NATS;
    if gain.rank == 0 || is_empty || !candidate.is_possible(&gain.coefficients) {
        return None;
    }
    Some(Scored {
        nats: gain.nats - penalty(frame, candidate),
        coefficients: gain.coefficients,
        candidate: candidate.clone(),
    })
}

/// What a candidate's numbers would explain of noise (Schwarz 1978) \[nats\].
pub(crate) fn penalty(frame: &Frame<'_>, candidate: &Candidate<'_>) -> f64 {
    let numbers = candidate.felt + candidate.shape.len();
    0.5 * numbers as f64 * (frame.problem.channel_rows() as f64).ln() + candidate.of_noise
}
