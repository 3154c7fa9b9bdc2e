//! Verdict, sentence and table agree, whatever the numbers are.

use haptical_diagnosis::{
    ChannelGap, Diagnosis, Gap, HeldOutAnswer, NoReduction, NoiseSource, Place, Verdict,
};
use proptest::prelude::*;

use crate::diagnose::example_tests::named;
use crate::diagnose::summary::{Room, text};
use crate::diagnose::words::verdict_sentence;

const NAMES: [&str; 8] = [
    "out1", "out2", "out3", "out4", "out5", "out6", "out7", "contact",
];

fn size() -> impl Strategy<Value = f64> {
    (-7.0..-1.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))
}

fn reason() -> impl Strategy<Value = Option<NoReduction>> {
    prop_oneof![
        Just(None),
        Just(Some(NoReduction::NoGap)),
        Just(Some(NoReduction::WithinNoise)),
        Just(Some(NoReduction::FloorContradicted)),
        Just(Some(NoReduction::NoiseUnknown)),
        Just(Some(NoReduction::Undetermined)),
    ]
}

fn channel(index: usize) -> impl Strategy<Value = ChannelGap> {
    let sizes = (size(), size(), size(), 0.0..1e3_f64);
    let share = (
        proptest::option::of(-300.0..100.0_f64),
        any::<bool>(),
        reason(),
    );
    (sizes, share).prop_map(
        move |((before, after, floor, energy), (percent, has_gap, why))| ChannelGap {
            channel: NAMES[index].to_owned(),
            joint: (index < 7).then_some(index + 1),
            has_gap,
            held_out: percent.is_some(),
            rms_before: before,
            rms_after: after,
            rms_fit: Some(after),
            noise_floor: floor,
            noise_floor_ci95: [0.9 * floor, 1.1 * floor],
            noise_source: NoiseSource::Stated,
            unit: if index < 7 { "rad" } else { "m" }.to_owned(),
            share_of_gap: if energy < 300.0 { 0.0 } else { energy },
            reduction_percent: percent,
            reduction_ci95: percent.map(|percent| [percent - 50.0, percent + 3.0]),
            no_reduction: why,
        },
    )
}

fn verdict() -> impl Strategy<Value = Verdict> {
    prop_oneof![
        Just(Verdict::NoGap),
        Just(Verdict::Named),
        Just(Verdict::Ambiguous),
        Just(Verdict::Unknown),
    ]
}

/// An answer as the diagnosis puts it together, of any numbers.
fn answer() -> impl Strategy<Value = Diagnosis> {
    let channels: [_; 8] = std::array::from_fn(channel);
    let place = proptest::option::of(0..8_usize);
    let held_out = (
        proptest::option::of(0..8_usize),
        -300.0..100.0_f64,
        1..9_usize,
    );
    (verdict(), channels, place, held_out).prop_map(
        |(verdict, channels, place, (held_out, percent, count))| {
            let channels: Vec<ChannelGap> = channels.into_iter().take(count).collect();
            let mut answer = named();
            let example = answer.place.take().unwrap();
            let place = place.filter(|_| verdict != Verdict::NoGap);
            answer.place = place.map(|index| Place {
                channel: NAMES[index].to_owned(),
                ..example
            });
            answer.verdict = verdict;
            answer.gap = Gap::new(verdict, place.map(|index| NAMES[index]), channels);
            let cause = &mut answer.causes[0];
            cause.held_out = held_out.map(|index| HeldOutAnswer {
                channel: NAMES[index].to_owned(),
                reduction_percent: Some(percent),
                ..cause.held_out.take().unwrap()
            });
            if verdict == Verdict::NoGap {
                answer.causes.clear();
            }
            answer
        },
    )
}

proptest! {
    /// Real: "There is a gap in contact", and "no gap" in every row of the table; "100 %" beside a floor above the gap.
    #[test]
    fn verdict_sentence_and_table_agree(answer in answer()) {
        let sentence = verdict_sentence(&answer);
        let said = text(&answer, None, Room::Terminal);
        let channels = &answer.gap.channels;
        let row = |name: &str| said.lines().find(|line| line.starts_with(&format!("{name:<12} ")));
        let shares: f64 = channels.iter().map(|channel| channel.share_of_gap).sum();
        prop_assert!(shares == 0.0 || (shares - 1.0).abs() < 1e-9);
        for channel in channels {
            prop_assert_eq!(channel.reduction_percent.is_none(), channel.no_reduction.is_some());
            prop_assert_eq!(!channel.has_gap, channel.no_reduction == Some(NoReduction::NoGap));
            if let Some(row) = row(&channel.channel) {
                prop_assert_eq!(row.ends_with("   no gap"), !channel.has_gap, "{}", row);
                let prints_a_share = row.ends_with(" %)");
                prop_assert!(!prints_a_share || channel.rms_before > channel.noise_floor, "{}", row);
            }
            let is_said = |words: &str| sentence.contains(&format!("{words} {}", channel.channel));
            let is_named = is_said("There is a gap in") || is_said("of the gap of");
            prop_assert!(!is_named || channel.has_gap, "{}", said);
        }
        let is_without = answer.verdict == Verdict::NoGap;
        prop_assert_eq!(channels.iter().all(|channel| !channel.has_gap), is_without, "{}", said);
        prop_assert_eq!(sentence.contains("no larger than noise"), is_without);
        let is_beyond = |gap: &ChannelGap| gap.held_out && gap.rms_before > gap.noise_floor_ci95[1];
        let is_told = sentence.contains("it leaves more than noise in");
        prop_assert_eq!(is_told, is_without && channels.iter().any(is_beyond), "{}", said);
        if let Some(at) = sentence.find("of the gap of ") {
            let name = sentence[at + 14..].split(' ').next().unwrap();
            let own = channels.iter().find(|channel| channel.channel == name).unwrap();
            prop_assert!(own.reduction_percent.is_some(), "{}", said);
        }
    }
}
