//! What the model of a log leaves of a second recording: one rule for every kind of log.

use haptical_motion::Unseen;
use serde::Serialize;

use super::{ChannelGap, Diagnosis, Gap, HeldOutAnswer, NoReduction, Place, Prediction, Verdict};
use crate::noise::NoiseSource;
use crate::thresholds::second::{ALLOWED, SDS};

/// What the model of the log leaves of a second recording.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SecondAnswer {
    /// One entry per channel that was predicted.
    pub channels: Vec<SecondChannel>,
    /// What was not predicted, and why.
    pub not_predicted: Vec<String>,
    /// Whether the log itself has no gap, and the second recording has one.
    pub is_gap_of_it_alone: bool,
}

impl SecondAnswer {
    /// An answer that says only why something was not predicted.
    pub(crate) fn not_predicted(why: String) -> Self {
        Self {
            not_predicted: vec![why],
            ..Self::default()
        }
    }

    /// Adds what another view of the same recording says.
    pub(crate) fn extend(&mut self, other: Self) {
        self.channels.extend(other.channels);
        self.not_predicted.extend(other.not_predicted);
    }
}

/// What a second recording shows of torques, or of encoders on links.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct OnSecond {
    /// Gap of each channel, without the named effects and with them.
    pub(crate) held_out: Vec<HeldOutAnswer>,
    /// Block means, each at the row in the middle of its block.
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) warnings: Vec<String>,
    pub(crate) second: SecondAnswer,
}

impl OnSecond {
    /// An answer that says only why the torques are not judged.
    pub(crate) fn not_predicted(why: &str) -> Self {
        Self {
            second: SecondAnswer::not_predicted(not_predicted(why)),
            ..Self::default()
        }
    }

    /// Adds a joint's rows, whose gap is `answer`. `of_log` is the root mean square that the model leaves of the log
    /// itself, over that many readings. An effect that is not named predicts nothing.
    pub(crate) fn add(
        &mut self,
        answer: HeldOutAnswer,
        unseen: &Unseen,
        (of_log, readings): (f64, usize),
        is_named: bool,
    ) {
        let left = |rms: f64, readings: usize| Left {
            rms,
            noise: unseen.noise,
            readings: readings as f64,
            error_of_fit: 0.0,
        };
        let beyond = |rms: f64, readings: usize| Left {
            error_of_fit: unseen.error_of_fit,
            ..left(rms, readings)
        };
        let rows = [readings, unseen.rows_in_all()];
        let of_both = unseen.of_both;
        let of_both = of_both.map(|both| [0, 1].map(|of| left(both[of] * unseen.noise, rows[of])));
        let name = (
            answer.channel.clone(),
            Some(unseen.joint + 1),
            &*answer.unit,
        );
        let rest = (beyond(answer.rms_after, rows[1]), of_log);
        let mut channel = SecondChannel::new(name, rest, ALLOWED, of_both);
        channel.left_out = unseen.left_out.0;
        self.second.channels.push(channel);
        let of_row = |(row, [measured, before, after]): &(usize, [f64; 3])| Prediction {
            row: *row,
            channel: answer.channel.clone(),
            measured: *measured,
            before: *before,
            after: if is_named { *after } else { *before },
        };
        self.predictions
            .extend(unseen.predictions.iter().map(of_row));
        self.held_out.push(answer);
    }

    /// Adds what another view of the same recording says.
    pub(crate) fn extend(&mut self, other: Self) {
        self.held_out.extend(other.held_out);
        self.predictions.extend(other.predictions);
        self.warnings.extend(other.warnings);
        self.second.extend(other.second);
    }
}

/// Why the torques of a second recording are not judged.
pub(crate) fn not_predicted(why: &str) -> String {
    format!("the torques of the second recording were not predicted: {why}")
}

/// One channel of a second recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SecondChannel {
    /// `out2`, `torque1`.
    pub channel: String,
    /// Joint (from 1), where it is of one.
    pub joint: Option<usize>,
    /// Root mean square that the model of the log leaves, its causes included.
    pub rms: f64,
    /// Root mean square of the noise.
    pub noise_floor: f64,
    /// What the model leaves of the log itself: that is no gap of the second recording alone.
    pub rms_of_log: f64,
    /// Unit of all three.
    pub unit: String,
    /// Whether that is more than noise, and no fit of both recordings was made that does away with it; where causes are named of positions
    /// none is made.
    pub has_gap: bool,
    /// Whether it is more than noise, and one fit of both recordings does away with it.
    pub is_extrapolated: bool,
    /// Readings that the log does not determine, and that are left out of these figures. Those of torques are means over time.
    #[serde(skip_serializing_if = "is_zero")]
    pub left_out: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// What is left of readings, and their noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Left {
    pub(crate) rms: f64,
    pub(crate) noise: f64,
    /// Independent readings.
    pub(crate) readings: f64,
    /// Variance that the error of the fit adds to the predictions, over that of noise.
    pub(crate) error_of_fit: f64,
}

impl Left {
    /// Whether readings are no more than noise: beyond a share of its square that a sound model may leave, and beyond chance, they are (A241).
    pub(crate) fn is_quiet(self, allowed: f64) -> bool {
        let beyond = (self.rms / self.noise.max(f64::MIN_POSITIVE)).powi(2) - 1.0;
        // the error may be of one number of the fit
        let of_fit = self.error_of_fit * (1.0 + SDS * std::f64::consts::SQRT_2);
        // what is not a number is not quiet
        beyond <= allowed + SDS * (2.0 / self.readings.max(1.0)).sqrt() + of_fit
    }
}

impl SecondChannel {
    /// A channel with what the model of the log leaves of it, and `of_log` of the log itself; `allowed`: the share of the noise's square that
    /// a sound model may leave; `of_both`: what one fit of both recordings leaves, in the first and in the second.
    pub(crate) fn new(
        (channel, joint, unit): (String, Option<usize>, &str),
        (left, of_log): (Left, f64),
        allowed: f64,
        of_both: Option<[Left; 2]>,
    ) -> Self {
        let is_quiet = |own: Left| {
            let noise = own.noise.max(of_log);
            Left { noise, ..own }.is_quiet(allowed)
        };
        let is_noise = is_quiet(left);
        let is_extrapolated =
            !is_noise && of_both.is_some_and(|both| both.into_iter().all(is_quiet));
        Self {
            channel,
            joint,
            rms: left.rms,
            noise_floor: left.noise,
            rms_of_log: of_log,
            unit: unit.to_owned(),
            has_gap: !is_noise && !is_extrapolated,
            is_extrapolated,
            left_out: 0,
        }
    }

    /// Its squares beyond noise, in the unit's square.
    pub(crate) fn square_beyond_noise(&self) -> f64 {
        (self.rms.powi(2) - self.noise_floor.powi(2)).max(0.0)
    }

    /// One fit of both recordings leaves noise.
    pub(crate) fn explain_by_both(&mut self) {
        self.is_extrapolated |= self.has_gap;
        self.has_gap = false;
    }

    /// Nothing is said of a gap in it.
    pub(crate) fn quieten(&mut self) {
        (self.has_gap, self.is_extrapolated) = (false, false);
    }

    fn share(&self) -> f64 {
        ((self.rms / self.noise_floor.max(f64::MIN_POSITIVE)).powi(2) - 1.0).max(0.0)
    }

    fn sizes(&self) -> String {
        format!(
            "{:.3e} {unit} left, noise {:.3e} {unit}",
            self.rms,
            self.noise_floor,
            unit = self.unit
        )
    }

    fn gap(&self) -> ChannelGap {
        ChannelGap {
            channel: self.channel.clone(),
            joint: self.joint,
            has_gap: self.has_gap,
            held_out: true,
            rms_before: self.rms,
            rms_after: self.rms,
            rms_fit: None,
            noise_floor: self.noise_floor,
            noise_floor_ci95: [self.noise_floor; 2],
            noise_source: NoiseSource::Motion,
            unit: self.unit.clone(),
            share_of_gap: self.share(),
            reduction_percent: self.has_gap.then_some(0.0),
            reduction_ci95: None,
            no_reduction: (!self.has_gap).then_some(NoReduction::NoGap),
        }
    }
}

/// The answer with what the second recording shows: where the log has no gap and that recording has one, there is a gap that nothing
/// explains.
pub(crate) fn judged(found: Diagnosis) -> Diagnosis {
    let mut found = found;
    let Some(mut second) = found.second.take() else {
        return found;
    };
    for why in &second.not_predicted {
        // a view may have said it in its own words
        if !found.warnings.iter().any(|said| said.contains(why)) {
            found.warnings.push(format!(
                "the second recording was not judged in full: {why}"
            ));
        }
    }
    let of = |is_wanted: fn(&SecondChannel) -> bool| -> Vec<String> {
        let channels = second.channels.iter().filter(|own| is_wanted(own));
        channels
            .map(|own| format!("{} ({})", own.channel, own.sizes()))
            .collect()
    };
    let (with_gap, extrapolated) = (of(|own| own.has_gap), of(|own| own.is_extrapolated));
    if found.verdict == Verdict::NoGap && !extrapolated.is_empty() {
        found.warnings.push(format!(
            "the model of the log alone leaves more than noise of the second recording in {}, and one fit of both leaves noise: the log \
             fixes the model only where it went; `--log A --log B` diagnoses both together",
            extrapolated.join(", ")
        ));
    }
    if found.verdict == Verdict::NoGap && !with_gap.is_empty() {
        found.warnings.push(format!(
            "the log has no gap, but its model does not hold for the second recording: {}. Something changed between the two, or they are \
             of two devices",
            with_gap.join(", ")
        ));
        second.is_gap_of_it_alone = true;
        found = of_second_alone(found, &second);
    }
    found.second = Some(second);
    found
}

fn of_second_alone(found: Diagnosis, second: &SecondAnswer) -> Diagnosis {
    let largest = second.channels.iter().filter(|own| own.has_gap);
    let largest = largest.max_by(|a, b| a.share().total_cmp(&b.share()));
    let place = largest.map(|own| Place {
        channel: own.channel.clone(),
        joint: own.joint,
        region: "in the second recording alone".to_owned(),
        ..Place::default()
    });
    let mut channels: Vec<ChannelGap> = second.channels.iter().map(SecondChannel::gap).collect();
    for other in found.gap.channels {
        if !channels.iter().any(|own| own.channel == other.channel) {
            channels.push(other);
        }
    }
    let located = place.as_ref().map(|place| place.channel.as_str());
    Diagnosis {
        verdict: Verdict::Unknown,
        gap: Gap::new(Verdict::Unknown, located, channels),
        place,
        unexplained_share: 1.0,
        probability_unknown: 1.0,
        own_effects_leave: None,
        next_experiment: Some(
            "diagnose the second recording by itself, which names a cause that it holds throughout, then both with \
             `--log A --log B`; undo what changed between them, or identify the device from the one that is to count"
                .to_owned(),
        ),
        ..found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(rms: f64, readings: f64) -> Left {
        Left {
            rms,
            noise: 1.0,
            readings,
            error_of_fit: 0.0,
        }
    }

    fn channel(rms: f64, of_both: Option<[f64; 2]>) -> SecondChannel {
        let of_both = of_both.map(|both| both.map(|rms| left(rms, 800.0)));
        let name = ("torque1".to_owned(), Some(1), "N m");
        SecondChannel::new(name, (left(rms, 800.0), 0.9), 0.2, of_both)
    }

    #[test]
    fn more_than_noise_is_a_gap_unless_one_fit_of_both_does_away_with_it() {
        assert!(!channel(1.15, None).has_gap);
        let beyond = channel(2.5, None);
        assert!(beyond.has_gap && !beyond.is_extrapolated);
        let extrapolated = channel(2.5, Some([0.9, 1.1]));
        assert!(!extrapolated.has_gap && extrapolated.is_extrapolated);
        // a fit of both that takes from the first what it gives to the second
        assert!(channel(2.5, Some([2.0, 1.1])).has_gap);
        assert!(channel(2.5, Some([1.0, 2.0])).has_gap);
        assert!(channel(f64::NAN, None).has_gap);
    }

    #[test]
    fn what_the_log_keeps_itself_is_no_gap_of_the_second_alone() {
        let beside = |of_log: f64| {
            let name = ("out2".to_owned(), Some(2), "rad");
            SecondChannel::new(name, (left(1.3, 800.0), of_log), 0.2, None).has_gap
        };
        assert!(beside(1.0) && !beside(1.25));
    }

    #[test]
    fn few_readings_say_little() {
        assert!(left(1.4, 20.0).is_quiet(0.2));
        assert!(!left(1.4, 2000.0).is_quiet(0.2));
        // the fit that predicts them may be wrong by as much
        let by_fit = |rms: f64| Left {
            error_of_fit: 0.3,
            ..left(rms, 2000.0)
        };
        assert!(by_fit(1.4).is_quiet(0.2) && !by_fit(2.0).is_quiet(0.2));
    }
}
