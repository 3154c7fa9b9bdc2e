//! The answers of two views of one log, as one: of its chain (positions, encoders on links, torques), and of the loops that follow its
//! commands.

use std::cmp::Ordering;

use haptical_calibration::CalibrationError;
use haptical_servo::NAMES;

use crate::DiagnosisError;
use crate::answer::{
    CandidateAnswer, CauseAnswer, ChannelGap, Diagnosis, Gap, SecondAnswer, Untestable, Verdict,
};
use crate::thresholds::joined::MOST_OVER_NOISE;
use crate::thresholds::servo::ALL_CLOSED;

type Answered = Result<Diagnosis, DiagnosisError>;

/// The answer of both views; `of_loop`: none where the log has no commands. A view that has no rows to judge, or too few, leaves the word to
/// the other one, which says so.
///
/// # Errors
/// Those of the chain, else those of the loops, where neither view answers; any that says that the input is wrong.
pub(crate) fn joined(of_chain: Answered, of_loop: Option<Answered>) -> Answered {
    let has_nothing = |error: &DiagnosisError| {
        matches!(
            error,
            DiagnosisError::Calibration(CalibrationError::NoChannel)
        )
    };
    let Some(of_loop) = of_loop else {
        return of_chain;
    };
    match (of_chain, of_loop) {
        (Ok(of_chain), Ok(of_loop)) => Ok(of_both(of_chain, of_loop)),
        (Err(why), of_loop) if has_nothing(&why) => of_loop,
        (Ok(answer), Err(why)) | (Err(why), Ok(answer)) if why.is_unidentifiable() => {
            Ok(without_other(answer, &why))
        }
        (Err(why), _) | (_, Err(why)) => Err(why),
    }
}

/// One view's answer, with why the other one has none.
fn without_other(mut answer: Diagnosis, why: &DiagnosisError) -> Diagnosis {
    let words = match why {
        DiagnosisError::Torques { why } => format!("the torques were not tested: {why}"),
        DiagnosisError::Commands { why } => format!("the commands were not tested: {why}"),
        other => format!("the positions were not tested: {other}"),
    };
    answer.warnings.insert(0, words);
    answer
}

/// Two views, the one with the word first, each with its share of the squares beyond noise.
fn of_both(of_chain: Diagnosis, of_loop: Diagnosis) -> Diagnosis {
    let energies = [&of_chain, &of_loop].map(energy);
    let total = (energies[0] + energies[1]).max(f64::MIN_POSITIVE);
    let untestable = untestable(&of_chain, &of_loop);
    let (device, whiteness) = (of_chain.device.clone(), of_chain.whiteness.clone());
    let is_loop_first = is_second_first([of_chain.verdict, of_loop.verdict], energies);
    let of_chain = Weighed::new(of_chain, energies[0] / total);
    let of_loop = Weighed::new(of_loop, energies[1] / total);
    let answer = match is_loop_first {
        true => of_loop.followed_by(of_chain),
        false => of_chain.followed_by(of_loop),
    };
    Diagnosis {
        untestable,
        device,
        whiteness,
        ..answer
    }
}

/// Squares of a gap over those of noise, in all channels that have one.
fn energy(answer: &Diagnosis) -> f64 {
    let with_gap = answer.gap.channels.iter().filter(|gap| gap.has_gap);
    let ratios = with_gap.map(|gap| (gap.rms_before / gap.noise_floor).min(MOST_OVER_NOISE));
    ratios.map(|ratio| (ratio * ratio - 1.0).max(0.0)).sum()
}

/// Whether the second of two views has the word: its verdict says more of causes, or as much of a larger gap.
fn is_second_first(verdicts: [Verdict; 2], energies: [f64; 2]) -> bool {
    match rank(verdicts[1]).cmp(&rank(verdicts[0])) {
        Ordering::Equal => energies[1] > energies[0],
        order => order.is_gt(),
    }
}

/// A verdict that says more of causes comes before one that says less.
fn rank(verdict: Verdict) -> usize {
    match verdict {
        Verdict::Named => 3,
        Verdict::Ambiguous => 2,
        Verdict::Unknown => 1,
        Verdict::NoGap => 0,
    }
}

/// A view's answer, and its share of the squares beyond noise of all views.
struct Weighed {
    answer: Diagnosis,
    weight: f64,
}

impl Weighed {
    fn new(answer: Diagnosis, weight: f64) -> Self {
        Self { answer, weight }
    }

    fn unexplained(&self) -> f64 {
        self.weight
            * match self.answer.verdict {
                Verdict::NoGap => 0.0,
                Verdict::Unknown => 1.0,
                Verdict::Named | Verdict::Ambiguous => self.answer.unexplained_share,
            }
    }

    fn closed(&self) -> f64 {
        let closed = self.answer.closed_unseen_share.unwrap_or(1.0);
        self.weight * f64::from(u8::from(self.answer.verdict.has_causes())) * closed
    }

    /// The answer, which has the word, with what another view adds: channels, causes, and a gap that it does not explain.
    fn followed_by(self, other: Self) -> Diagnosis {
        let (left, closed) = (
            self.unexplained() + other.unexplained(),
            self.closed() + other.closed(),
        );
        let (weights, mut answer, other) = ([self.weight, other.weight], self.answer, other.answer);
        let verdict = answer.verdict;
        if other.verdict != Verdict::NoGap {
            answer.unexplained_share = left;
            answer.closed_unseen_share =
                Some(closed).filter(|closed| verdict.has_causes() && *closed < ALL_CLOSED);
            for cause in &mut answer.causes {
                cause.share *= weights[0];
            }
        }
        if verdict.has_causes() && other.verdict == Verdict::Unknown {
            let open = other.gap.channels.iter().filter(|gap| gap.has_gap);
            answer.warnings.extend(open.map(unexplained_gap));
        }
        let is_new = |cause: &CauseAnswer| {
            let is_it =
                |known: &CauseAnswer| known.effect == cause.effect && known.joint == cause.joint;
            !answer.causes.iter().any(is_it)
        };
        let causes: Vec<CauseAnswer> = other.causes.into_iter().filter(is_new).collect();
        for mut cause in causes {
            if verdict.has_causes() && other.verdict == Verdict::Unknown {
                let candidate = CandidateAnswer::of_cause(&cause, None);
                answer.candidates.push(candidate);
                continue;
            }
            cause.share *= weights[1];
            answer.causes.push(cause);
        }
        answer.place = answer.place.or(other.place);
        let located = answer.place.as_ref().map(|place| place.channel.as_str());
        let of_view = |(channels, weight): (Vec<ChannelGap>, f64)| {
            channels.into_iter().map(move |gap| ChannelGap {
                share_of_gap: weight * gap.share_of_gap,
                ..gap
            })
        };
        let channels = [
            (answer.gap.channels, weights[0]),
            (other.gap.channels, weights[1]),
        ];
        let channels = channels.into_iter().flat_map(of_view).collect();
        answer.gap = Gap::new(verdict, located, channels);
        answer.second = match (answer.second, other.second) {
            (Some(first), Some(other)) => Some(SecondAnswer {
                channels: [first.channels, other.channels].concat(),
                not_predicted: [first.not_predicted, other.not_predicted].concat(),
                is_gap_of_it_alone: false,
            }),
            (first, other) => first.or(other),
        };
        answer.not_in_file.extend(other.not_in_file);
        answer.warnings.extend(other.warnings);
        answer.traces.extend(other.traces);
        answer.noise.extend(other.noise);
        answer.invisible.extend(other.invisible);
        answer.detectable.extend(other.detectable);
        answer.plausibility.extend(other.plausibility);
        answer.steps.extend(other.steps);
        answer.predictions.extend(other.predictions);
        answer.provenance.tested += other.provenance.tested;
        Diagnosis {
            absorbed: answer.absorbed.or(other.absorbed),
            own_effects_leave: answer.own_effects_leave.or(other.own_effects_leave),
            correction: answer.correction.or(other.correction),
            correction_refused: answer.correction_refused.or(other.correction_refused),
            next_experiment: answer.next_experiment.or(other.next_experiment),
            corrected: answer.corrected.or(other.corrected),
            ..answer
        }
    }
}

fn unexplained_gap(gap: &ChannelGap) -> String {
    format!(
        "{} shows a gap that no cause explains: {:.3e} {unit}, noise {:.3e} {unit}",
        gap.channel,
        gap.rms_before,
        gap.noise_floor,
        unit = gap.unit
    )
}

/// What neither view can test: the chain has nothing to say of how a loop follows its commands, nor the loops of the chain.
fn untestable(of_chain: &Diagnosis, of_loop: &Diagnosis) -> Vec<Untestable> {
    let is_of_loop = |entry: &&Untestable| NAMES.contains(&entry.effect.as_str());
    let of_chain = of_chain
        .untestable
        .iter()
        .filter(|entry| !is_of_loop(entry));
    let of_loop = of_loop.untestable.iter().filter(is_of_loop);
    of_chain.chain(of_loop).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_that_names_has_the_word_and_of_two_the_larger_gap() {
        let (named, unknown, none) = (Verdict::Named, Verdict::Unknown, Verdict::NoGap);
        assert!(is_second_first([unknown, named], [1e6, 1.0]));
        assert!(!is_second_first([named, unknown], [1.0, 1e6]));
        assert!(is_second_first([none, unknown], [0.0, 1.0]));
        assert!(is_second_first([named, named], [1.0, 2.0]));
        assert!(!is_second_first([named, named], [2.0, 1.0]));
    }
}
