//! The verdict: no gap, a name, several that cannot be distinguished, or a gap without a name.

use haptical_effects::{Family, Parameter};
use haptical_judge::Evidence;

use crate::answer::{CandidateAnswer, CauseAnswer, HeldOutAnswer, Verdict};
use crate::force::answer::ForceAnswer;
use crate::judge::Findings;
use crate::select::excess;
use crate::thresholds::chance::MOST_NAMES;
use crate::thresholds::partial::{LEAST_PROBABILITY, MOST_LEFT_OF_SECOND};
use crate::thresholds::rivals::LATER_PROBABILITY;

/// The verdict on the causes that positions show.
pub(crate) fn verdict(findings: &Findings<'_>, causes: &[CauseAnswer]) -> Verdict {
    let base_terms = &findings.base_terms;
    let first = causes.first();
    // where a tool was changed the rest may be as small as the tool's own law gets wrong
    if base_terms.accounts_for(excess(&findings.selection.after).0) {
        return judged(true, true, first);
    }
    if findings.selection.causes().is_empty() {
        let is_quiet = findings.is_quiet();
        return haptical_judge::verdict(Evidence {
            has_gap: !is_quiet || base_terms.is_unnamed || !causes.is_empty(),
            is_supported: is_quiet && !base_terms.is_partial,
            // a term of the base model that leaves no gap has no rivals
            probability: first.map(|_| 1.0),
        });
    }
    let is_hedged = first.is_some_and(|cause| kinds_beside(cause) >= MOST_NAMES);
    // next to numbers of the base model that changed a cause may have no size; unseen rows are not to speak against it
    let is_void = first.is_some_and(|own| !is_borne_out(own))
        || base_terms.terms.is_empty() && !first.is_some_and(is_credible)
        || contradicted(findings, causes).is_some();
    let is_of_cables = (findings.partial.as_ref()).is_some_and(|partial| partial.is_of_cables);
    let is_likely = first.is_some_and(|cause| {
        let probability = match is_of_cables {
            true => cause.class_probability,
            false => cause.probability,
        };
        probability >= LEAST_PROBABILITY
    });
    let is_supported = findings.adequacy.is_adequate || (findings.partial.is_some() && is_likely);
    judged(true, is_supported && !is_hedged && !is_void, first)
}

/// The verdict by torques: by their first finding, or by their gap without one.
pub(crate) fn by_torques(force: &ForceAnswer) -> Verdict {
    let first = force.findings.first();
    judged(
        first.is_some() || force.unexplained().is_some(),
        true,
        first,
    )
}

fn judged(has_gap: bool, is_supported: bool, first: Option<&CauseAnswer>) -> Verdict {
    haptical_judge::verdict(Evidence {
        has_gap,
        is_supported,
        probability: first.map(|cause| cause.probability),
    })
}

/// Whether a cause has a size, and makes predictions of what the fit did not see better.
fn is_credible(cause: &CauseAnswer) -> bool {
    has_size(cause) && is_borne_out(cause)
}

/// Whether an interval of its sizes excludes nothing, if it has sizes.
fn has_size(cause: &CauseAnswer) -> bool {
    let mut sizes = sizes(cause).peekable();
    sizes.peek().is_none() || sizes.any(|ci95| ci95[0] * ci95[1] > 0.0)
}

/// Whether a cause closes a share of its channel's gap that is above nothing beyond chance on rows that its fit did not see, or such a
/// share cannot be given (A246).
pub(crate) fn is_borne_out(cause: &CauseAnswer) -> bool {
    let is_above = |held_out: &HeldOutAnswer| match (held_out.no_reduction, held_out.reduction_ci95)
    {
        (None, Some([low, _])) => low > 0.0,
        (None, None) => held_out
            .reduction_percent
            .is_none_or(|percent| percent > 0.0),
        (Some(_), _) => true,
    };
    cause.held_out.as_ref().is_none_or(is_above)
}

/// The verdict on causes that are judged without positions, where they have a size and unseen rows bear them out: others are taken off
/// `causes`, and with the first of them the name. They are among the candidates then, with what is said of them.
pub(crate) fn on_unseen(
    verdict: Verdict,
    causes: &mut Vec<CauseAnswer>,
) -> (Verdict, Vec<CandidateAnswer>, Vec<String>) {
    let (mut candidates, mut said) = (Vec::new(), Vec::new());
    if !verdict.has_causes() {
        return (verdict, candidates, said);
    }
    let is_first_credible = causes.first().is_some_and(is_credible);
    causes.retain(|cause| {
        let is_kept = is_first_credible && is_credible(cause);
        if !is_kept {
            let why = without_size(cause).or_else(|| why_not(cause));
            said.extend(why.clone());
            candidates.push(CandidateAnswer::of_cause(cause, why));
        }
        is_kept
    });
    let verdict = match is_first_credible {
        true => verdict,
        false => Verdict::Unknown,
    };
    (verdict, candidates, said)
}

/// Why a cause is not named that has no size.
fn without_size(cause: &CauseAnswer) -> Option<String> {
    (!has_size(cause)).then(|| {
        format!(
            "{} at {} would fit the log, but the interval of each of its sizes has zero in it: not named",
            cause.effect,
            cause.place()
        )
    })
}

/// Why a cause is not named that unseen rows do not bear out.
pub(crate) fn why_not(cause: &CauseAnswer) -> Option<String> {
    let held_out = cause.held_out.as_ref().filter(|_| !is_borne_out(cause))?;
    let interval = held_out
        .reduction_ci95
        .map_or_else(String::new, |[low, high]| {
            format!(" (95 % interval {low:.1} to {high:.1} %)")
        });
    Some(format!(
        "{} at {} would fit the log, but on rows that its fit did not see it closes {:.1} %{interval} of the gap of {}, which is not above \
         nothing beyond chance: not named",
        cause.effect,
        cause.place(),
        held_out.reduction_percent.unwrap_or_default(),
        held_out.channel
    ))
}

/// Share of the squares beyond noise that a moving arm's first cause leaves of a second recording, where that is more than it
/// may (A201).
pub(crate) fn contradicted(findings: &Findings<'_>, causes: &[CauseAnswer]) -> Option<f64> {
    let inputs = &findings.inputs;
    if inputs.moving.is_none() || inputs.options.validation.is_none() {
        return None;
    }
    let left = causes.first()?.held_out.as_ref()?.left()?;
    (left > MOST_LEFT_OF_SECOND).then_some(left)
}

/// Whether a later cause is more than what an earlier one's law gets wrong: its class is likely and
/// small, and its size is not zero.
pub(crate) fn is_reported(cause: &CauseAnswer) -> bool {
    cause.class_probability >= LATER_PROBABILITY
        && kinds_beside(cause) < MOST_NAMES
        && sizes(cause).all(|ci95| ci95[0] * ci95[1] > 0.0)
}

/// Kinds of effects that a cause is confusable with: whatever yields to a load is one.
fn kinds_beside(cause: &CauseAnswer) -> usize {
    let yields = |name: &str| {
        let spec = haptical_effects::spec(name);
        spec.is_some_and(|spec| spec.family == Family::Load)
    };
    let rivals = cause.confusable_with.iter();
    let springs = rivals.clone().filter(|name| yields(name)).count();
    let others = rivals.count() - springs;
    others + usize::from(springs > 0 && !yields(&cause.effect))
}

/// Intervals of a cause's sizes, not of their places.
fn sizes(cause: &CauseAnswer) -> impl Iterator<Item = [f64; 2]> {
    let is_size = |name: &str| {
        haptical_effects::parameter(&cause.effect, name).is_none_or(Parameter::is_size)
    };
    let sizes = cause.parameters.iter();
    sizes
        .filter(move |(name, _)| is_size(name))
        .map(|(_, size)| size.ci95)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::{NoReduction, ParameterAnswer};

    fn closing(
        effect: &str,
        percent: f64,
        ci95: [f64; 2],
        why: Option<NoReduction>,
    ) -> CauseAnswer {
        CauseAnswer {
            held_out: Some(HeldOutAnswer {
                channel: "torque2".to_owned(),
                rms_before: 1.0,
                rms_after: 1.0,
                noise_floor: 0.1,
                unit: "N m".to_owned(),
                reduction_percent: Some(percent),
                reduction_ci95: Some(ci95),
                no_reduction: why,
            }),
            ..CauseAnswer::named(effect, Some(1), 0.97)
        }
    }

    /// Real: "Named. sampling explains the gap, 0.0 % closes", and "-20418909534770.5 %".
    #[test]
    fn a_cause_that_closes_nothing_on_unseen_rows_is_no_name_but_a_candidate() {
        for (percent, ci95) in [
            (0.0, [0.0, 0.0]),
            (12.0, [-3.0, 27.0]),
            (-2e13, [-4e13, -2e11]),
        ] {
            let mut causes = vec![closing("torque-saturation", percent, ci95, None)];
            let (verdict, candidates, said) = on_unseen(Verdict::Named, &mut causes);
            assert_eq!((verdict, causes.len()), (Verdict::Unknown, 0), "{percent}");
            assert_eq!(candidates[0].effect, "torque-saturation");
            assert!(said[0].contains("at joint 2 would fit the log"), "{said:?}");
        }
    }

    /// Of a joint whose torque was read with another sign: "Named. payload", of -0.02 [-0.18, 0.13] kg.
    #[test]
    fn a_cause_whose_sizes_may_all_be_zero_is_no_name() {
        let payload = |mass_kg: [f64; 2]| {
            let size = |ci95: [f64; 2]| ParameterAnswer {
                value: 0.5 * (ci95[0] + ci95[1]),
                ci95,
            };
            let mut cause = closing("payload", 80.0, [70.0, 90.0], None);
            cause.parameters.insert("mass_kg".to_owned(), size(mass_kg));
            let moment = size([-0.01, 0.02]);
            cause.parameters.insert("moment_x_kg_m".to_owned(), moment);
            cause
        };
        for (mass_kg, verdict) in [
            ([-0.18, 0.13], Verdict::Unknown),
            ([0.01, 0.13], Verdict::Named),
        ] {
            let mut causes = vec![payload(mass_kg)];
            let (found, candidates, said) = on_unseen(Verdict::Named, &mut causes);
            assert_eq!(found, verdict, "{mass_kg:?}");
            assert_eq!(candidates.len() + causes.len(), 1);
            let is_said = said.iter().any(|own| own.contains("has zero in it"));
            assert_eq!(is_said, verdict == Verdict::Unknown);
        }
    }

    #[test]
    fn a_cause_of_which_no_share_can_be_given_keeps_its_name() {
        let why = Some(NoReduction::Undetermined);
        let mut causes = vec![
            closing("contact", -50.0, [-90.0, -10.0], why),
            closing("motor-cogging", 3.0, [-5.0, 11.0], None),
            CauseAnswer::named("torque-gain", Some(0), 0.97),
        ];
        let (verdict, candidates, _) = on_unseen(Verdict::Named, &mut causes);
        assert_eq!(verdict, Verdict::Named);
        let names: Vec<&str> = causes.iter().map(|own| own.effect.as_str()).collect();
        assert_eq!(names, ["contact", "torque-gain"]);
        assert_eq!(candidates[0].effect, "motor-cogging");
        // a gap without a name, and none, stay what they are
        let (verdict, ..) = on_unseen(Verdict::NoGap, &mut Vec::new());
        assert_eq!(verdict, Verdict::NoGap);
    }
}
