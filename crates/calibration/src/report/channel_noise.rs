//! Noise that is not independent and of one size, channel by channel.

use haptical_identification::{CorrelatedNoise, Signal};
use serde::Serialize;

use crate::Channel;

/// What a channel's residuals say of its noise, where it is not independent and of one size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelNoise {
    /// Channel.
    pub channel: String,
    /// Whether it has memory along the log: then intervals follow from its spectrum.
    pub has_memory: bool,
    /// Change over the log by a line in time that was fitted besides, axis by axis \[stated standard deviations\].
    pub drift_sd: Vec<f64>,
    /// Joints in a part of whose range it is larger; rows are weighted by that.
    pub uneven: Vec<UnevenNoise>,
    /// Whether lines and weights are in the intervals alone: the step to them leaves the range in which the problem is straight, so the
    /// values are those without them.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_in_intervals_alone: bool,
}

/// Noise that is larger in a part of a joint's range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnevenNoise {
    /// Joint, from 1.
    pub joint: usize,
    /// Largest standard deviation over the smallest.
    pub ratio: f64,
}

impl ChannelNoise {
    /// The channels of which there is something to say.
    pub(crate) fn list(
        found: &CorrelatedNoise,
        signals: &[Signal],
        channels: &[Channel],
        is_taken: bool,
    ) -> Vec<Self> {
        let of_channel = |(group, channel): (usize, &Channel)| {
            let drift = signals.iter().zip(&found.drift);
            let own = found.uneven.iter().filter(|uneven| uneven.group == group);
            Self {
                channel: channel.name(),
                has_memory: found.correlated.contains(&group),
                drift_sd: drift
                    .filter(|(signal, _)| signal.group == group)
                    .map(|(_, change)| *change)
                    .collect(),
                uneven: own
                    .map(|uneven| UnevenNoise {
                        joint: uneven.covariate + 1,
                        ratio: uneven.ratio,
                    })
                    .collect(),
                is_in_intervals_alone: !is_taken,
            }
        };
        channels.iter().enumerate().map(of_channel).collect()
    }
}
