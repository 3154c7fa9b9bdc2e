//! The gap that a second recording keeps, which is not that of the first.

use haptical_diagnosis::{Diagnosis, NoReduction, SECOND_RECORDING, SecondAnswer, Verdict};

use crate::units::Shown;

/// Share of a second recording's gap that has to close for the causes to be those of both \[%\].
const CLOSED_IN_BOTH_PERCENT: f64 = 50.0;

/// What the causes leave of a second recording is a gap of its own where it is this many times what they leave of the log, or noise, and
/// less than this share closes \[%\]: a base model that the log does not fix everywhere leaves some of a strong cause's rows.
const BEYOND_THE_LOG: f64 = 2.0;
const CLOSED_BUT_FOR_THE_BASE_PERCENT: f64 = 95.0;

/// Channels of a second recording of whose gap the causes close less than that, or leave far more than of the log, and what they leave.
pub(super) fn kept_by_second(diagnosis: &Diagnosis) -> Vec<String> {
    if !diagnosis.held_out.starts_with(SECOND_RECORDING) {
        return Vec::new();
    }
    let leaves_more = |name: &str| {
        let second = diagnosis.second.iter().flat_map(|own| &own.channels);
        let mut beyond = second.filter(|own| {
            own.has_gap && own.rms > BEYOND_THE_LOG * own.rms_of_log.max(own.noise_floor)
        });
        beyond.any(|own| own.channel == name)
    };
    // one rule says what a gap of a second recording is
    let is_gap_of_second = |name: &str| {
        let mut second = diagnosis.second.iter().flat_map(|own| &own.channels);
        let found = second.find(|own| own.channel == name);
        found.is_none_or(|own| own.has_gap)
    };
    let channels = diagnosis.gap.channels.iter();
    let kept = channels.filter(|gap| {
        // where nothing says how large the noise is, nothing says that a gap is left
        let is_open = match gap.reduction_percent {
            Some(closed) => closed < CLOSED_IN_BOTH_PERCENT,
            None => gap.no_reduction == Some(NoReduction::NoGap),
        };
        let is_in_part =
            (gap.reduction_percent).is_some_and(|closed| closed < CLOSED_BUT_FOR_THE_BASE_PERCENT);
        let is_open = is_open || is_in_part && leaves_more(&gap.channel);
        let is_beyond = gap.rms_after > gap.noise_floor_ci95[1] && is_gap_of_second(&gap.channel);
        gap.held_out && is_beyond && is_open
    });
    let said = kept.map(|gap| left(&gap.channel, &gap.unit, [gap.rms_after, gap.noise_floor]));
    said.collect()
}

/// `out2: 0.265 mrad left, noise 0.078 mrad`.
fn left(channel: &str, unit: &str, [rms, noise]: [f64; 2]) -> String {
    let [rms, noise] = [rms, noise].map(|size| Shown::fine(unit).text(size));
    format!("{channel}: {rms} left, noise {noise}")
}

/// Whether the log has no gap, and the second recording has one.
pub(super) fn is_of_second_alone(diagnosis: &Diagnosis) -> bool {
    let second = diagnosis.second.as_ref();
    second.is_some_and(|second| second.is_gap_of_it_alone)
}

/// The sentence of a gap that the second recording alone has.
pub(super) fn of_second_alone(second: &SecondAnswer) -> String {
    let channels = second.channels.iter().filter(|own| own.has_gap);
    let said = channels.map(|own| left(&own.channel, &own.unit, [own.rms, own.noise_floor]));
    format!(
        "The log has no gap, but its model does not hold for the second recording ({}): something changed between the two, or they are \
         of two devices.",
        said.collect::<Vec<_>>().join("; ")
    )
}

/// A sentence, after a blank, on a second recording of which nothing was judged; empty otherwise.
pub(super) fn not_judged(diagnosis: &Diagnosis) -> String {
    let second = diagnosis.second.as_ref();
    let none = second.filter(|second| second.channels.is_empty());
    none.map_or_else(String::new, |second| {
        let why = second.not_predicted.first();
        let why = why.map_or("it has no channel of the log", String::as_str);
        format!(" The second recording was not judged: {why}.")
    })
}

/// A further sentence of it, after a blank; empty where the causes are those of both.
pub(super) fn said_of_second(diagnosis: &Diagnosis) -> String {
    let kept = kept_by_second(diagnosis);
    if diagnosis.verdict == Verdict::NoGap || is_of_second_alone(diagnosis) || kept.is_empty() {
        return String::new();
    }
    format!(
        " The second recording keeps a gap ({}): something changed between the two, or it is of another device. Identify the \
         device with the one that is to count, and give the other to `diagnose --model`.",
        kept.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use haptical_diagnosis::SecondChannel;

    use super::*;
    use crate::diagnose::example_tests::named;
    use crate::diagnose::words::verdict_sentence;

    #[test]
    fn a_second_recording_that_keeps_its_gap_is_said_to_be_of_another_device() {
        let mut diagnosis = named();
        let out2 = &mut diagnosis.gap.channels[1];
        out2.held_out = true;
        out2.reduction_percent = Some(7.9);
        out2.rms_after = 1.1e-3;
        assert!(!verdict_sentence(&diagnosis).contains("keeps a gap"));
        SECOND_RECORDING.clone_into(&mut diagnosis.held_out);
        let said = verdict_sentence(&diagnosis);
        assert!(
            said.contains("explains the gap of the log alone."),
            "{said}"
        );
        assert!(
            said.contains("keeps a gap (out2: 1.100 mrad left, noise "),
            "{said}"
        );
        diagnosis.gap.channels[1].reduction_percent = None;
        for (why, is_kept) in [
            (NoReduction::NoGap, true),
            (NoReduction::NoiseUnknown, false),
        ] {
            diagnosis.gap.channels[1].no_reduction = Some(why);
            let said = verdict_sentence(&diagnosis);
            assert_eq!(said.contains("keeps a gap"), is_kept, "{said}");
        }
        diagnosis.gap.channels[1].reduction_percent = Some(97.0);
        assert!(!verdict_sentence(&diagnosis).contains("keeps a gap"));
        // most closes, and yet far more is left than of the log itself
        for (percent, rms_of_log, has_gap, is_kept) in [
            (81.0, 1.1e-4, true, true),
            (81.0, 9e-4, true, false),
            (97.0, 1.1e-4, true, false),
            // hardly anything closes, and what is left is no gap by the rule for second recordings
            (7.9, 1.1e-4, true, true),
            (7.9, 1.1e-4, false, false),
        ] {
            diagnosis.gap.channels[1].reduction_percent = Some(percent);
            let channel = SecondChannel {
                channel: "out2".to_owned(),
                joint: Some(2),
                rms: 1.1e-3,
                noise_floor: 1e-4,
                rms_of_log,
                unit: "rad".to_owned(),
                has_gap,
                is_extrapolated: false,
                left_out: 0,
            };
            diagnosis.second = Some(SecondAnswer {
                channels: vec![channel],
                ..SecondAnswer::default()
            });
            let said = verdict_sentence(&diagnosis);
            assert_eq!(said.contains("keeps a gap"), is_kept, "{said}");
        }
    }
}
