//! The trait of a kind of measurement.

use haptical_model::kinematics::Twist;
use haptical_model::{
    Device, Evaluation, ModelError, Mount, ParameterId, Recording, SurroundingParameter,
};

use super::tracked::Mountings;

/// One kind of measurement: what a row shows of it, and how that changes with every parameter.
///
/// To add a kind: a file here, a variant of [`crate::Channel`] with its name, an arm of `with_kind`, and where it
/// has unknowns of its own a parameter in the model and a start value in [`crate::prepare_device`].
pub(crate) trait Measurement {
    /// Residuals of one row, at most three.
    const WIDTH: usize = 1;

    /// Whether the parameters of the chain change the residuals by moving the handle, and in no other way.
    const IS_OF_HANDLE: bool = false;

    /// What is worked out once at a row for all derivatives.
    type Seen;

    /// Unit of the residuals.
    fn unit(&self, _: &Device) -> &'static str {
        "m"
    }

    /// Whether the chain's pose is needed.
    fn sees_chain(&self) -> bool {
        true
    }

    /// Whether a row of the recording has a reading.
    fn has_reading(&self, recording: &Recording, row: usize) -> bool;

    /// Whether the device has everything that the kind is about: both members of a pair.
    fn is_placed(&self, _: &Device) -> bool {
        true
    }

    /// Index of the touched point or plane of a row, or the id that the device does not have; none for other kinds.
    fn subject(&self, _: &Device, _: &Recording, _row: usize) -> Option<Result<usize, String>> {
        None
    }

    /// Standard deviation of a reading, as the device file states it.
    fn stated_sd(&self, device: &Device) -> Option<f64>;

    /// Whether the residuals can depend on a parameter at all: of a kind behind the handle on everything of the chain,
    /// and on its own unknowns.
    fn sees(&self, parameter: ParameterId) -> bool {
        match parameter {
            ParameterId::Surrounding(parameter) => self.owns(parameter),
            _ => true,
        }
    }

    /// Whether a number of the surroundings is one of the kind's own unknowns.
    fn owns(&self, _: SurroundingParameter) -> bool {
        false
    }

    /// Model minus measurement, times `weight`.
    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Self::Seen), ModelError>;

    /// Derivatives of the residuals by a parameter that the kind sees, times the weight that they were seen with.
    fn derivative(&self, seen: &Self::Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3];

    /// Derivatives of the residuals along a twist of the handle in frame (-1), times the weight; of a kind of the handle
    /// ([`Measurement::IS_OF_HANDLE`]).
    fn by_twist(&self, _: &Self::Seen, _: &Twist) -> [f64; 3] {
        [0.0; 3]
    }

    /// The same where the twist is that of the robot's base, which the handle follows: a parameter of row 0.
    fn by_base_twist(&self, seen: &Self::Seen, twist: &Twist) -> [f64; 3] {
        self.by_twist(seen, twist)
    }

    /// Square of the residual's derivative along a twist of the handle, the mean over the residuals.
    fn sensitivity_square(&self, _: &Posture<'_>, _: &Twist) -> Result<f64, ModelError> {
        Ok(0.0)
    }
}

/// [`Measurement::IS_OF_HANDLE`] of a value.
pub(crate) fn is_of_handle<M: Measurement>(_: &M) -> bool {
    M::IS_OF_HANDLE
}

/// A device moved to a row of a recording.
pub(crate) struct Posture<'e> {
    pub(crate) device: &'e Device,
    pub(crate) evaluation: &'e Evaluation<'e>,
    pub(crate) recording: &'e Recording,
    pub(crate) row: usize,
    /// Which of the device's touched points or planes the row is about; 0 for other kinds.
    pub(crate) subject: usize,
    /// Where the tracker stood, and what was on the hand.
    pub(crate) mount: Mount,
    /// Bases and tools of all rows.
    pub(crate) mountings: &'e Mountings,
}

/// Whether a column has a number at a row.
pub(crate) fn is_known(column: Option<&Vec<f64>>, row: usize) -> bool {
    column.is_some_and(|column| column[row].is_finite())
}

/// A reading; kinds are only asked for rows that have one.
pub(crate) fn reading(column: Option<&Vec<f64>>, row: usize) -> f64 {
    column.map_or(f64::NAN, |column| column[row])
}

/// Index of the id of a row, or the id itself where the device does not have it.
pub(crate) fn subject_of(
    ids: Option<&Vec<String>>,
    row: usize,
    index: impl Fn(&str) -> Option<usize>,
) -> Option<Result<usize, String>> {
    let id = ids.and_then(|ids| ids.get(row)).cloned();
    let id = id.unwrap_or_default();
    Some(index(&id).ok_or(id))
}
