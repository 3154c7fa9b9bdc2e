//! The measured channels of a recording that a device can predict.

use haptical_model::{Device, ParameterId, Recording};

use crate::CalibrationError;
use crate::problem::measurement::kind::Measurement;

/// Runs an expression with the [`Measurement`] of a channel.
macro_rules! with_kind {
    ($channel:expr, $kind:ident => $body:expr) => {
        match $channel {
            $crate::Channel::Output { joint } => {
                let $kind = $crate::problem::measurement::output::Output { joint };
                $body
            }
            $crate::Channel::Cable { index } => {
                let $kind = $crate::problem::measurement::cable::Cable { index };
                $body
            }
            $crate::Channel::Position => {
                let $kind = $crate::problem::measurement::position::Position;
                $body
            }
            $crate::Channel::Orientation => {
                let $kind = $crate::problem::measurement::orientation::Orientation;
                $body
            }
            $crate::Channel::Contact => {
                let $kind = $crate::problem::measurement::contact::Contact;
                $body
            }
            $crate::Channel::ContactPair { index } => {
                let $kind = $crate::problem::measurement::contact_pair::ContactPair { index };
                $body
            }
            $crate::Channel::Plane => {
                let $kind = $crate::problem::measurement::plane::Plane;
                $body
            }
            $crate::Channel::PlanePair { index } => {
                let $kind = $crate::problem::measurement::plane_pair::PlanePair { index };
                $body
            }
            $crate::Channel::Fixture { joint } => {
                let $kind = $crate::problem::measurement::fixture::Fixture { joint };
                $body
            }
        }
    };
}
pub(crate) use with_kind;

/// A measured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// External encoder of a joint (from 0).
    Output {
        /// Joint, from 0.
        joint: usize,
    },
    /// Distance of a cable encoder (from 0).
    Cable {
        /// Cable, from 0.
        index: usize,
    },
    /// Handle position, three residuals a row.
    Position,
    /// Handle orientation, three residuals a row.
    Orientation,
    /// Touches of points, three residuals a row.
    Contact,
    /// Known distance between two touched points; its reading is with the first row.
    ContactPair {
        /// Position in `[[contact_pair]]`, from 0.
        index: usize,
    },
    /// Touches of planes.
    Plane,
    /// Known angle between two touched planes; its reading is with the first row.
    PlanePair {
        /// Position in `[[plane_pair]]`, from 0.
        index: usize,
    },
    /// Known angles at which a homing fixture holds a joint (from 0).
    Fixture {
        /// Joint, from 0.
        joint: usize,
    },
}

impl Channel {
    /// Column name without its unit: `out2`, `cable`, `cable2`, `position`, `orientation`, `contact`, `plane`,
    /// `fixture2`; `contact-pair` and `plane-pair`, the second one `contact-pair2`.
    pub fn name(self) -> String {
        match self {
            Self::Output { joint } => format!("out{}", joint + 1),
            Self::Cable { index: 0 } => "cable".to_owned(),
            Self::Cable { index } => format!("cable{}", index + 1),
            Self::Position => "position".to_owned(),
            Self::Orientation => "orientation".to_owned(),
            Self::Contact => "contact".to_owned(),
            Self::ContactPair { index: 0 } => "contact-pair".to_owned(),
            Self::ContactPair { index } => format!("contact-pair{}", index + 1),
            Self::Plane => "plane".to_owned(),
            Self::PlanePair { index: 0 } => "plane-pair".to_owned(),
            Self::PlanePair { index } => format!("plane-pair{}", index + 1),
            Self::Fixture { joint } => format!("fixture{}", joint + 1),
        }
    }

    /// Unit of its residuals.
    pub fn unit(self, device: &Device) -> &'static str {
        with_kind!(self, kind => kind.unit(device))
    }

    /// Residuals that one row gives.
    pub fn width(self) -> usize {
        fn width<M: Measurement>(_: &M) -> usize {
            M::WIDTH
        }
        with_kind!(self, kind => width(&kind))
    }

    /// Whether it sees the chain (all but the external encoders do).
    pub fn sees_chain(self) -> bool {
        with_kind!(self, kind => kind.sees_chain())
    }

    /// Whether a row of the recording has a reading of this channel.
    pub fn has_reading(self, recording: &Recording, row: usize) -> bool {
        with_kind!(self, kind => kind.has_reading(recording, row))
    }

    /// Whether the residuals can depend on a parameter at all: an external encoder sees its own transmission, a
    /// touched point is seen by its touches, and everything behind the handle sees the whole chain.
    pub(crate) fn can_see(self, parameter: ParameterId) -> bool {
        with_kind!(self, kind => kind.sees(parameter))
    }

    /// Whether the device has everything that the channel is about: both members of a pair.
    pub(crate) fn is_placed(self, device: &Device) -> bool {
        with_kind!(self, kind => kind.is_placed(device))
    }

    /// Index of the touched point or plane of a row, or the id that the device does not have; none for other kinds.
    pub(crate) fn subject(
        self,
        device: &Device,
        recording: &Recording,
        row: usize,
    ) -> Option<Result<usize, String>> {
        with_kind!(self, kind => kind.subject(device, recording, row))
    }

    /// Whether readings hang on where the tracker stood or on what was on the hand.
    pub(crate) fn is_mounted(self) -> bool {
        self.is_touch() || matches!(self, Self::Position | Self::Orientation)
    }

    /// Whether residuals of this kind shrink with the device: touches of points and planes.
    pub(crate) fn is_touch(self) -> bool {
        matches!(self, Self::Contact | Self::Plane)
    }

    /// Standard deviation of a reading, as the device file states it.
    pub(crate) fn stated_sd(self, device: &Device) -> Option<f64> {
        with_kind!(self, kind => kind.stated_sd(device))
    }
}

/// The channels that a recording has readings of and the device can predict, outputs first.
///
/// # Errors
/// [`CalibrationError::NoChannel`].
pub fn channels(device: &Device, recording: &Recording) -> Result<Vec<Channel>, CalibrationError> {
    let mut found: Vec<Channel> = (0..device.joints.len())
        .map(|joint| Channel::Output { joint })
        .collect();
    if device.has_links() {
        found.extend((0..recording.cable_m.len()).map(|index| Channel::Cable { index }));
        if recording.position_m.is_some() || recording.orientation_wxyz.is_some() {
            found.extend([Channel::Position, Channel::Orientation]);
        }
        found.extend(touches(device, recording));
    }
    found.retain(|channel| (0..recording.len()).any(|row| channel.has_reading(recording, row)));
    if found.is_empty() {
        Err(CalibrationError::NoChannel)
    } else {
        Ok(found)
    }
}

/// Touches and fixtures, and the pairs of which the recording has both.
fn touches(device: &Device, recording: &Recording) -> Vec<Channel> {
    let are_touched = |ids: &Option<Vec<String>>, a: &String, b: &String| {
        ids.as_ref()
            .is_some_and(|ids| ids.contains(a) && ids.contains(b))
    };
    let mut found = vec![Channel::Contact];
    for (index, pair) in device.contact_pairs.iter().enumerate() {
        if are_touched(&recording.contact, &pair.a, &pair.b) {
            found.push(Channel::ContactPair { index });
        }
    }
    found.push(Channel::Plane);
    for (index, pair) in device.surroundings.plane_pairs.iter().enumerate() {
        if are_touched(&recording.plane, &pair.a, &pair.b) {
            found.push(Channel::PlanePair { index });
        }
    }
    found.extend((0..device.joints.len()).map(|joint| Channel::Fixture { joint }));
    found
}
