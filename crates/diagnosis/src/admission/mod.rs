//! Whether a log may be answered: four questions of each view, and what becomes of an answer that one of them refuses.

mod positions;

pub(crate) use self::positions::of_positions;
use crate::answer::{CandidateAnswer, Diagnosis, NoReduction, Verdict};

/// The answer as far as it is admitted. Without it there is neither a name nor "no gap": causes are candidates then, and nothing is
/// written with them.
pub(crate) fn admitted(found: Diagnosis) -> Diagnosis {
    let Some(refusal) = found.admission.refusal() else {
        return found;
    };
    let (why, next) = (refusal.why.clone(), refusal.next.clone());
    let mut found = found;
    if found.verdict == Verdict::NoGap {
        for gap in &mut found.gap.channels {
            gap.no_reduction = Some(NoReduction::NotJudged);
        }
    }
    let mut candidates = found.candidates;
    candidates.retain(|entry| {
        let mut causes = found.causes.iter();
        !causes.any(|cause| entry.effect == cause.effect && entry.joint == cause.joint)
    });
    let refused = found.causes.iter();
    candidates.extend(refused.map(|cause| CandidateAnswer::of_cause(cause, Some(why.clone()))));
    let channels = found.gap.channels.into_iter().map(|gap| match gap.has_gap {
        true => gap.without_causes(),
        false => gap,
    });
    found.gap.channels = channels.collect();
    Diagnosis {
        verdict: Verdict::Unknown,
        causes: Vec::new(),
        candidates,
        absorbed: None,
        unexplained_share: 1.0,
        closed_unseen_share: None,
        probability_unknown: 1.0,
        corrected: None,
        correction: None,
        correction_refused: None,
        not_in_file: Vec::new(),
        steps: Vec::new(),
        held_out: String::new(),
        next_experiment: next.or(found.next_experiment),
        ..found
    }
}

#[cfg(test)]
mod tests {
    use haptical_judge::{Admission, Check};
    use haptical_model::Device;

    use super::*;
    use crate::answer::{CauseAnswer, Gap, Provenance};

    fn answer(verdict: Verdict, causes: Vec<CauseAnswer>, admission: Admission) -> Diagnosis {
        let device = Device::from_toml("[[joint]]\n", "device.toml").unwrap();
        let gap = Gap::new(verdict, None, Vec::new());
        let provenance = Provenance::default();
        Diagnosis {
            admission,
            ..Diagnosis::of_causes(verdict, gap, causes, device.device, provenance)
        }
    }

    #[test]
    fn an_answer_that_may_not_be_given_names_nothing_and_is_no_all_clear() {
        let refused = Admission {
            belongs: Check::no("another arm's log", "take its device file"),
            ..Admission::default()
        };
        let cause = CauseAnswer::named("payload", None, 0.97);
        for (verdict, causes) in [
            (Verdict::NoGap, Vec::new()),
            (Verdict::Named, vec![cause.clone()]),
            (Verdict::Unknown, vec![cause.clone()]),
        ] {
            let count = causes.len();
            let found = admitted(answer(verdict, causes, refused.clone()));
            assert_eq!(found.verdict, Verdict::Unknown);
            assert_eq!((found.causes.len(), found.candidates.len()), (0, count));
            assert_eq!(
                found.next_experiment.as_deref(),
                Some("take its device file")
            );
        }
        let unasked = admitted(answer(Verdict::Named, vec![cause], Admission::default()));
        assert_eq!((unasked.verdict, unasked.causes.len()), (Verdict::Named, 1));
    }
}
