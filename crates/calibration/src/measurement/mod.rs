//! What a rig measures of a device: one file for each kind, all behind one trait.

mod cable;
mod contact;
mod contact_pair;
mod fixture;
mod orientation;
mod output;
mod plane;
mod plane_pair;
mod position;
pub(crate) mod tracked;

use haptical_model::kinematics::Twist;
use haptical_model::{Device, Evaluation, ModelError, ParameterId, Recording};

pub(crate) use cable::Cable;
pub(crate) use contact::Contact;
pub(crate) use contact_pair::ContactPair;
pub(crate) use fixture::Fixture;
pub(crate) use orientation::Orientation;
pub(crate) use output::Output;
pub(crate) use plane::Plane;
pub(crate) use plane_pair::PlanePair;
pub(crate) use position::Position;

/// One kind of measurement: what a row shows of it, and how that changes with every parameter.
///
/// To add a kind: a file here, a variant of [`crate::Channel`] with its name, an arm of [`with_kind`], and where it
/// has unknowns of its own a parameter in the model and a start value in [`crate::prepare_device`].
pub(crate) trait Measurement {
    /// Residuals of one row, at most three.
    const WIDTH: usize;

    /// What is worked out once at a row for all derivatives.
    type Seen;

    /// Unit of the residuals.
    fn unit(&self, device: &Device) -> &'static str;

    /// Whether the chain's pose is needed.
    fn sees_chain(&self) -> bool {
        true
    }

    /// Whether a row of the recording has a reading.
    fn has_reading(&self, recording: &Recording, row: usize) -> bool;

    /// Standard deviation of a reading, as the device file states it.
    fn stated_sd(&self, device: &Device) -> Option<f64>;

    /// Whether the residuals can depend on a parameter at all.
    fn sees(&self, parameter: ParameterId) -> bool;

    /// Model minus measurement, times `weight`.
    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Self::Seen), ModelError>;

    /// Derivatives of the residuals, times the weight that they were seen with.
    fn derivative(&self, seen: &Self::Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3];

    /// Square of the residual's derivative along a twist of the handle, the mean over the residuals.
    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError>;
}

/// A device moved to a row of a recording.
pub(crate) struct Posture<'e> {
    pub(crate) device: &'e Device,
    pub(crate) evaluation: &'e Evaluation<'e>,
    pub(crate) recording: &'e Recording,
    pub(crate) row: usize,
    /// Which of the device's touched points or planes the row is about; 0 for other kinds.
    pub(crate) subject: usize,
}

/// Runs an expression with the [`Measurement`] of a channel.
macro_rules! with_kind {
    ($channel:expr, $kind:ident => $body:expr) => {
        match $channel {
            $crate::Channel::Output { joint } => {
                let $kind = $crate::measurement::Output { joint };
                $body
            }
            $crate::Channel::Cable { index } => {
                let $kind = $crate::measurement::Cable { index };
                $body
            }
            $crate::Channel::Position => {
                let $kind = $crate::measurement::Position;
                $body
            }
            $crate::Channel::Orientation => {
                let $kind = $crate::measurement::Orientation;
                $body
            }
            $crate::Channel::Contact => {
                let $kind = $crate::measurement::Contact;
                $body
            }
            $crate::Channel::ContactPair { index } => {
                let $kind = $crate::measurement::ContactPair { index };
                $body
            }
            $crate::Channel::Plane => {
                let $kind = $crate::measurement::Plane;
                $body
            }
            $crate::Channel::PlanePair { index } => {
                let $kind = $crate::measurement::PlanePair { index };
                $body
            }
            $crate::Channel::Fixture { joint } => {
                let $kind = $crate::measurement::Fixture { joint };
                $body
            }
        }
    };
}
pub(crate) use with_kind;

/// Whether a column has a number at a row.
pub(crate) fn is_known(column: Option<&Vec<f64>>, row: usize) -> bool {
    column.is_some_and(|column| column[row].is_finite())
}

/// A reading; kinds are only asked for rows that have one.
pub(crate) fn reading(column: Option<&Vec<f64>>, row: usize) -> f64 {
    column.map_or(f64::NAN, |column| column[row])
}

/// Whether a parameter is one of the chain: what every kind behind the handle sees.
pub(crate) fn is_of_chain(parameter: ParameterId) -> bool {
    match parameter {
        ParameterId::Link { .. } | ParameterId::Transmission { .. } => true,
        ParameterId::Compliance { .. } => true,
        ParameterId::Surrounding(_) => false,
    }
}

/// Whether the device has what a channel is about: both members of a pair.
pub(crate) fn is_placed(device: &Device, channel: crate::Channel) -> bool {
    {
        let surroundings = &device.surroundings;
        match channel {
            crate::Channel::ContactPair { index } => {
                let has = |id: &str| surroundings.contact_index(id).is_some();
                let pair = device.contact_pairs.get(index);
                return pair.is_some_and(|pair| has(&pair.a) && has(&pair.b));
            }
            crate::Channel::PlanePair { index } => {
                let has = |id: &str| surroundings.plane_index(id).is_some();
                let pair = surroundings.plane_pairs.get(index);
                return pair.is_some_and(|pair| has(&pair.a) && has(&pair.b));
            }
            _ => {}
        }
    }
    true
}

/// Which of the device's touched points or planes a row is about, or the id that the device does not have; none
/// for other kinds.
pub(crate) fn subject(
    device: &Device,
    recording: &Recording,
    channel: crate::Channel,
    row: usize,
) -> Option<Result<usize, String>> {
    {
        let surroundings = &device.surroundings;
        let id = |ids: &Option<Vec<String>>| {
            let id = ids.as_ref().and_then(|ids| ids.get(row));
            id.cloned().unwrap_or_default()
        };
        match channel {
            crate::Channel::Contact => {
                let id = id(&recording.contact);
                return Some(surroundings.contact_index(&id).ok_or(id));
            }
            crate::Channel::Plane => {
                let id = id(&recording.plane);
                return Some(surroundings.plane_index(&id).ok_or(id));
            }
            _ => {}
        }
    }
    None
}
