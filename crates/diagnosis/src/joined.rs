//! The answers of several views of one log, as one: of its chain (positions, encoders on links, torques), of the loops that follow its
//! commands, of its motors' currents.

use std::cmp::Ordering;

use haptical_calibration::CalibrationError;

use crate::answer::TORQUES_NOT_TESTED;
use crate::answer::{
    CandidateAnswer, CauseAnswer, ChannelGap, Diagnosis, Gap, Untestable, Verdict,
};
use crate::thresholds::joined::MOST_OVER_NOISE;
use crate::thresholds::servo::ALL_CLOSED;
use crate::{DiagnosisError, Result};

/// What one view of a log says.
pub(crate) struct View {
    pub(crate) answer: Result<Diagnosis>,
    /// Effects of which it says alone why they cannot be tested.
    pub(crate) names: &'static [&'static str],
}

/// The answer of all views. One that has no rows to judge, or too few, leaves the word to the others, which say so.
pub(crate) fn joined(
    of_chain: Result<Diagnosis>,
    others: impl IntoIterator<Item = View>,
) -> Result<Diagnosis> {
    others.into_iter().fold(of_chain, of_two)
}

fn of_two(first: Result<Diagnosis>, other: View) -> Result<Diagnosis> {
    match (first, other.answer) {
        (Ok(first), Ok(answer)) => Ok(of_both(first, answer, other.names)),
        (Err(DiagnosisError::Calibration(CalibrationError::NoChannel)), answer) => answer,
        (Ok(answer), Err(why)) | (Err(why), Ok(answer)) if why.is_unidentifiable() => {
            Ok(without_other(answer, &why))
        }
        (Err(why), _) | (_, Err(why)) => Err(why),
    }
}

/// One view's answer, with why the other one has none.
fn without_other(mut answer: Diagnosis, why: &DiagnosisError) -> Diagnosis {
    let words = match why {
        DiagnosisError::Torques { why } => format!("{TORQUES_NOT_TESTED}: {why}"),
        DiagnosisError::Commands { why } => format!("the commands were not tested: {why}"),
        DiagnosisError::Currents { why } => format!("the currents were not tested: {why}"),
        other => format!("the positions were not tested: {other}"),
    };
    answer.warnings.insert(0, words);
    answer
}

/// Two views, the one with the word first, each with its share of the squares beyond noise; `names` are those of the second.
fn of_both(first: Diagnosis, second: Diagnosis, names: &[&str]) -> Diagnosis {
    let energies = [&first, &second].map(|own| energy(&own.gap.channels));
    let total = (energies[0] + energies[1]).max(f64::MIN_POSITIVE);
    let untestable = untestable(&first, &second, names);
    let (device, whiteness) = (first.device.clone(), first.whiteness.clone());
    let is_second_first = is_second_first([first.verdict, second.verdict], energies);
    let [first, second] = [(first, energies[0]), (second, energies[1])].map(|(answer, energy)| {
        let weight = energy / total;
        Weighed { answer, weight }
    });
    let answer = match is_second_first {
        true => second.followed_by(first),
        false => first.followed_by(second),
    };
    Diagnosis {
        untestable,
        device,
        whiteness,
        ..answer
    }
}

/// Squares of a gap over those of noise, in all channels that have one.
pub(crate) fn energy(channels: &[ChannelGap]) -> f64 {
    let with_gap = channels.iter().filter(|gap| gap.has_gap);
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
        answer.admission = match verdict.has_causes() {
            // what another view may not say bars no name of this one
            true => {
                let refusal = other.admission.refusal();
                let said = refusal
                    .map(|refusal| format!("no verdict on the rest of the log: {}", refusal.why));
                answer.warnings.extend(said);
                answer.admission
            }
            false => answer.admission.with(other.admission),
        };
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
            (Some(mut first), Some(other)) => {
                first.extend(other);
                first.is_gap_of_it_alone = false;
                Some(first)
            }
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
            silent: [answer.silent, other.silent].concat(),
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

/// What neither view can test: of its `names` the second one says it, of all others the first; of a cause neither does.
fn untestable(first: &Diagnosis, second: &Diagnosis, names: &[&str]) -> Vec<Untestable> {
    let is_of_second = |entry: &&Untestable| names.contains(&entry.effect.as_str());
    let of_first = first.untestable.iter().filter(|own| !is_of_second(own));
    let of_second = second.untestable.iter().filter(is_of_second);
    let is_cause = |own: &&Untestable| second.causes.iter().any(|cause| cause.effect == own.effect);
    let all = of_first.chain(of_second).filter(|own| !is_cause(own));
    all.cloned().collect()
}

#[cfg(test)]
mod tests {
    use haptical_judge::Check;
    use haptical_model::Device;

    use super::*;
    use crate::answer::Provenance;

    /// An answer with effects that it cannot test, and with causes.
    fn answer(untestable: &[&str], causes: &[&str]) -> Diagnosis {
        let untestable = untestable.iter().map(|name| Untestable {
            effect: (*name).to_owned(),
            joints: Vec::new(),
            why: String::new(),
        });
        let provenance = Provenance::default();
        let device = Device::from_toml("[[joint]]\n", "device.toml")
            .unwrap()
            .device;
        let gap = Gap::new(Verdict::NoGap, None, Vec::new());
        let causes = causes
            .iter()
            .map(|name| CauseAnswer::named(name, None, 1.0));
        Diagnosis {
            untestable: untestable.collect(),
            causes: causes.collect(),
            ..Diagnosis::of_causes(Verdict::NoGap, gap, Vec::new(), device, provenance)
        }
    }

    #[test]
    fn of_its_names_a_view_says_alone_why_they_are_untestable() {
        let first = answer(&["backlash", "dead-zone", "torque-offset"], &[]);
        let second = answer(&["dead-zone", "payload"], &["torque-offset"]);
        let both = untestable(&first, &second, &["dead-zone"]);
        let names: Vec<&str> = both.iter().map(|own| own.effect.as_str()).collect();
        assert_eq!(names, ["backlash", "dead-zone"]);
    }

    #[test]
    fn the_view_that_names_has_the_word_and_of_two_the_larger_gap() {
        let (named, unknown, none) = (Verdict::Named, Verdict::Unknown, Verdict::NoGap);
        assert!(is_second_first([unknown, named], [1e6, 1.0]));
        assert!(!is_second_first([named, unknown], [1.0, 1e6]));
        assert!(is_second_first([none, unknown], [0.0, 1.0]));
        assert!(is_second_first([named, named], [1.0, 2.0]));
        assert!(!is_second_first([named, named], [2.0, 1.0]));
    }

    #[test]
    fn what_another_view_may_not_say_is_said_and_bars_no_name() {
        let named = answer(&[], &["command-latency"]);
        let named = Diagnosis {
            verdict: Verdict::Named,
            ..named
        };
        let mut barred = answer(&[], &[]);
        barred.verdict = Verdict::Unknown;
        barred.admission.belongs = Check::no("mixed rows", "take the rows as measured");
        let both = of_both(named, barred.clone(), &[]);
        assert_eq!(
            (both.verdict, both.admission.refusal()),
            (Verdict::Named, None)
        );
        assert!(both.warnings.iter().any(|said| said.contains("mixed rows")));
        let clear = of_both(answer(&[], &[]), barred, &[]);
        assert!(clear.admission.refusal().is_some());
    }
}
