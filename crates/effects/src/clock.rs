//! Sensors whose clock may be another one than that of the motor encoders: encoders that are ahead of such a one are as often a
//! sensor that is late.

use haptical_calibration::Channel;

/// Name of the effect of motor encoders that are late.
pub(crate) const ENCODER_LATENCY: &str = "encoder-latency";

/// A kind of sensor with a clock that may be another one than that of the motor encoders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OtherClock {
    /// Positions and orientations.
    Tracker,
    /// All cable encoders.
    Cables,
    /// All external encoders.
    ExternalEncoders,
}

impl OtherClock {
    const ALL: [Self; 3] = [Self::Tracker, Self::Cables, Self::ExternalEncoders];

    /// That of a channel; none of what has no clock: touches, known distances, fixtures.
    pub fn of(channel: Channel) -> Option<Self> {
        match channel {
            Channel::Position | Channel::Orientation => Some(Self::Tracker),
            Channel::Cable { .. } => Some(Self::Cables),
            Channel::Output { .. } => Some(Self::ExternalEncoders),
            Channel::Contact
            | Channel::ContactPair { .. }
            | Channel::Plane
            | Channel::PlanePair { .. }
            | Channel::Fixture { .. } => None,
        }
    }

    /// The one kind among channels; none where there are several, which tell encoders that are early from a sensor that is late,
    /// or none.
    pub fn only(channels: impl Iterator<Item = Channel>) -> Option<Self> {
        let mut clocks = channels.filter_map(Self::of);
        let first = clocks.next()?;
        clocks.all(|own| own == first).then_some(first)
    }

    /// That whose lateness is an effect of this name.
    pub fn of_latency(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|own| own.latency() == name)
    }

    /// Name of the effect that it is late by.
    pub const fn latency(self) -> &'static str {
        match self {
            Self::Tracker => "tracker-latency",
            Self::Cables => "cable-latency",
            Self::ExternalEncoders => "external-encoder-latency",
        }
    }

    /// `the tracker is`, `the external encoders are`.
    fn words(self) -> &'static str {
        match self {
            Self::Tracker => "the tracker is",
            Self::Cables => "the cable encoder is",
            Self::ExternalEncoders => "the external encoders are",
        }
    }
}

/// Motor encoders that are ahead of the rest, as one effect of a device or a cause says: how far \[s\], and the one kind of sensor
/// that they are compared with, if it is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead {
    by_s: f64,
    of: Option<OtherClock>,
}

impl Ahead {
    /// Of an effect's name, its number `delay_s` and what it is confusable with; none of another effect, or one of encoders
    /// that are late.
    ///
    /// ```
    /// use haptical_effects::Ahead;
    /// let twins = ["tracker-latency".to_owned()];
    /// let ahead = Ahead::of("encoder-latency", Some(-0.014), &twins).ok_or("not ahead")?;
    /// assert!(ahead.words().contains("the tracker is late by 14 ms"));
    /// assert!(Ahead::of("encoder-latency", Some(0.014), &twins).is_none());
    /// # Ok::<(), &str>(())
    /// ```
    pub fn of(effect: &str, delay_s: Option<f64>, confusable_with: &[String]) -> Option<Self> {
        let by_s = -delay_s.filter(|delay_s| *delay_s < 0.0)?;
        let clocks = || confusable_with.iter();
        (effect == ENCODER_LATENCY).then(|| Self {
            by_s,
            of: clocks().find_map(|name| OtherClock::of_latency(name)),
        })
    }

    /// The one kind of sensor that is late, if they are not ahead.
    pub fn late(self) -> Option<OtherClock> {
        self.of
    }

    /// What it means, a clause without a full stop.
    pub fn words(self) -> String {
        let by = format!("{} ms", rounded(1e3 * self.by_s));
        match self.of {
            Some(clock) => format!(
                "motor encoders that are ahead of all else by {by} usually mean that {} late by {by}: the log cannot tell \
                 the two apart, so check its time stamps first",
                clock.words()
            ),
            None => format!(
                "motor encoders that are ahead of all else by {by} usually mean that the other sensors are late by {by}: check \
                 their time stamps first"
            ),
        }
    }
}

/// Three digits, without zeros at their end.
fn rounded(value: f64) -> String {
    let digits = match value.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_kind_of_sensor_is_the_only_clock_and_two_are_none() {
        let out = |joint| Channel::Output { joint };
        let only = |channels: &[Channel]| OtherClock::only(channels.iter().copied());
        let tracker = [Channel::Position, Channel::Orientation, Channel::Contact];
        assert_eq!(only(&tracker), Some(OtherClock::Tracker));
        assert_eq!(only(&[out(0), out(3)]), Some(OtherClock::ExternalEncoders));
        assert_eq!(only(&[out(0), Channel::Position]), None);
        assert_eq!(only(&[Channel::Contact]), None);
    }

    #[test]
    fn milliseconds_are_said_in_three_digits() {
        let said = [14.0, 14.26, 3.0, 2.345, 0.12, 120.4].map(rounded);
        assert_eq!(said, ["14", "14.3", "3", "2.35", "0.12", "120"]);
    }
}
