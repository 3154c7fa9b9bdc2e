//! What causes leave, in words: channels that keep a gap of their own, and what the runs of a log share.

use haptical_diagnosis::{ChannelGap, Diagnosis, HeldOutAnswer};
use haptical_metrics::gap_reduction_percent;

use crate::diagnose::words::{held_out_sizes, listed};
use crate::units::Shown;

/// A further sentence on channels that keep a gap next to the causes; empty without any.
pub(super) fn kept_by_channels(diagnosis: &Diagnosis) -> String {
    let words = |gap: &ChannelGap| {
        let times = gap.keeps()?;
        let left = Shown::fine(&gap.unit).text(gap.rms_after);
        Some(format!(
            "{} keeps {left}, {times:.1} times its noise",
            gap.channel
        ))
    };
    let kept: Vec<String> = diagnosis.gap.channels.iter().filter_map(words).collect();
    match kept.is_empty() {
        true => String::new(),
        false => format!(
            " {}: no effect of the catalogue explains that.",
            listed(&kept)
        ),
    }
}

/// How much of a change between runs closes; what the runs share is no part of it.
pub(super) fn of_change(held_out: &HeldOutAnswer) -> String {
    let [before, after, noise] = [
        held_out.rms_before,
        held_out.rms_after,
        held_out.noise_floor,
    ];
    let share = gap_reduction_percent(before, after, noise);
    let share = share.map_or_else(String::new, |percent| {
        format!("{percent:.1} % of it closes: ")
    });
    format!(
        "On data that the fit did not see, {share}{}. No effect of the catalogue explains the gap that the runs share.",
        held_out_sizes(held_out)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn a_large_effect_excuses_no_gap_of_another_channel() {
        let mut found = named();
        assert_eq!(kept_by_channels(&found), "");
        let mut other = found.gap.channels[0].clone();
        other.channel = "out3".to_owned();
        (other.has_gap, other.no_reduction) = (true, None);
        (other.rms_before, other.rms_after, other.noise_floor) = (8e-4, 3.4e-4, 1e-4);
        found.gap.channels.push(other);
        let words = kept_by_channels(&found);
        assert!(
            words.contains("out3 keeps 0.3400 mrad, 3.4 times its noise"),
            "{words}"
        );
    }
}
