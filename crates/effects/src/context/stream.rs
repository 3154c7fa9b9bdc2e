//! Measured streams, one for each axis of a channel.

use haptical_calibration::Channel;
use haptical_model::Device;

/// One measured quantity, an axis of a channel.
#[derive(Debug, Clone)]
pub struct Stream {
    /// Channel.
    pub channel: Channel,
    /// Axis of a position or orientation.
    pub axis: usize,
    /// Unit of its readings.
    pub unit: &'static str,
}

impl Stream {
    /// `out2`, `cable`, `position.x`.
    pub fn name(&self) -> String {
        if self.channel.width() == 1 {
            self.channel.name()
        } else {
            format!("{}.{}", self.channel.name(), ["x", "y", "z"][self.axis])
        }
    }

    /// Joint of an external encoder, from 0.
    pub fn joint(&self) -> Option<usize> {
        match self.channel {
            Channel::Output { joint } => Some(joint),
            _ => None,
        }
    }

    /// Whether it moves with the handle. Known distances and angles between touched places do not, nor do
    /// encoders and fixtures.
    pub fn shows_handle(&self) -> bool {
        match self.channel {
            Channel::Cable { .. }
            | Channel::Position
            | Channel::Orientation
            | Channel::Contact
            | Channel::Plane => true,
            Channel::Output { .. }
            | Channel::ContactPair { .. }
            | Channel::PlanePair { .. }
            | Channel::Fixture { .. } => false,
        }
    }

    /// Whether its readings are touches: of a posture each, however close the postures are.
    pub fn is_touch(&self) -> bool {
        matches!(self.channel, Channel::Contact | Channel::Plane)
    }
}

/// The streams of channels, axis by axis.
pub fn streams(device: &Device, channels: &[Channel]) -> Vec<Stream> {
    channels
        .iter()
        .flat_map(|&channel| {
            (0..channel.width()).map(move |axis| Stream {
                channel,
                axis,
                unit: channel.unit(device),
            })
        })
        .collect()
}

/// The first stream of a channel.
pub(super) fn stream_of(streams: &[Stream], channel: Channel) -> Option<usize> {
    streams.iter().position(|stream| stream.channel == channel)
}
