//! What a diagnosis leaves open: candidates that the next recording is to tell apart.

use std::collections::BTreeMap;

use crate::answer::{Diagnosis, Verdict};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::settle::MOST_CANDIDATES;

/// A candidate for a cause, with the size that the diagnosis found.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Name of the effect.
    pub effect: String,
    /// Joint (from 1), where it has one.
    pub joint: Option<usize>,
    /// Its numbers by name, in the units of their names.
    pub numbers: BTreeMap<String, f64>,
    /// How far behind the best candidate it is \[nats\].
    pub nats_behind: f64,
}

impl Candidate {
    /// `backlash at joint 3`.
    pub fn label(&self) -> String {
        match self.joint {
            Some(joint) => format!("{} at joint {joint}", self.effect),
            None => self.effect.clone(),
        }
    }
}

/// What is to be settled.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Question {
    /// Candidates for the first cause, best first: two at least.
    pub candidates: Vec<Candidate>,
    /// Causes that are in the model whichever of them is true.
    pub beside: Vec<Candidate>,
}

impl Question {
    /// What a diagnosis leaves open; none where it is settled, or where fewer than two candidates have a size.
    pub fn of(diagnosis: &Diagnosis) -> Option<Self> {
        let is_open = matches!(diagnosis.verdict, Verdict::Ambiguous | Verdict::Unknown);
        let candidates = diagnosis.candidates.iter().map(|candidate| Candidate {
            effect: candidate.effect.clone(),
            joint: candidate.joint,
            numbers: candidate.parameters.clone(),
            nats_behind: candidate.nats_behind,
        });
        let beside = diagnosis.causes.iter().skip(1).map(|cause| Candidate {
            effect: cause.effect.clone(),
            joint: cause.joint,
            numbers: (cause.parameters.iter())
                .map(|(name, number)| (name.clone(), number.value))
                .collect(),
            nats_behind: 0.0,
        });
        Self::new(candidates.collect(), beside.collect()).filter(|_| is_open)
    }

    /// The same of candidates in any order: those with a size that are confusable with the best, and the two best at least;
    /// none where there are not two.
    pub fn new(candidates: Vec<Candidate>, beside: Vec<Candidate>) -> Option<Self> {
        let mut sized: Vec<Candidate> = candidates;
        sized.retain(|candidate| !candidate.numbers.is_empty());
        sized.sort_by(|a, b| a.nats_behind.total_cmp(&b.nats_behind));
        let near = sized
            .iter()
            .filter(|own| own.nats_behind <= CONFUSABLE_NATS);
        let kept = near.count().clamp(2, MOST_CANDIDATES);
        sized.truncate(kept);
        (sized.len() >= 2).then_some(Self {
            candidates: sized,
            beside,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(effect: &str, nats_behind: f64, has_size: bool) -> Candidate {
        let size = has_size.then(|| ("size".to_owned(), 1.0));
        Candidate {
            effect: effect.to_owned(),
            joint: Some(2),
            numbers: size.into_iter().collect(),
            nats_behind,
        }
    }

    #[test]
    fn what_is_confusable_is_asked_and_the_two_best_at_least() {
        let all = vec![
            candidate("d", 9.0, true),
            candidate("b", 1.0, true),
            candidate("a", 0.0, true),
            candidate("c", 2.0, false),
        ];
        let names = |question: Question| -> Vec<String> {
            let kept = question.candidates.iter();
            kept.map(|candidate| candidate.effect.clone()).collect()
        };
        let asked = Question::new(all.clone(), Vec::new()).unwrap();
        assert_eq!(names(asked), ["a", "b"]);
        let far = vec![all[0].clone(), all[2].clone(), all[3].clone()];
        assert_eq!(names(Question::new(far, Vec::new()).unwrap()), ["a", "d"]);
        assert_eq!(
            Question::new(vec![all[0].clone(), all[3].clone()], Vec::new()),
            None
        );
        assert_eq!(all[0].label(), "d at joint 2");
    }
}
