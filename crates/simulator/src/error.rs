//! Says why a recording cannot be simulated.

use haptical_model::ModelError;

use crate::EffectError;

/// The part of a device that an error is about; numbers count from 1, as in the device file's errors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// A `[[joint]]`.
    Joint {
        /// Which, from 1.
        number: usize,
        /// Its name.
        name: String,
    },
    /// `[cable_encoder]` (1) or a `[[cable]]`.
    Cable {
        /// Which, from 1.
        number: usize,
    },
}

impl std::fmt::Display for Part {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Joint { number, name } => write!(formatter, "joint {number} (`{name}`)"),
            Self::Cable { number } => write!(formatter, "cable {number}"),
        }
    }
}

/// Every reason for which this crate refuses to answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// A setting outside its domain.
    #[error("setting `{setting}` is {value}; allowed: {allowed}")]
    Setting {
        /// Which setting or argument.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// The domain.
        allowed: &'static str,
    },
    /// A joint that the device does not have.
    #[error("joint index {joint} (from 0), but the device has {joints} joints")]
    NoJoint {
        /// Index asked for, from 0.
        joint: usize,
        /// Joints of the device.
        joints: usize,
    },
    /// The device does not say a number that the settings need.
    #[error("{part} has no `{key}`, which {purpose} needs")]
    MissingKey {
        /// Joint or cable.
        part: Part,
        /// Key of the device file.
        key: &'static str,
        /// What needs it.
        purpose: &'static str,
    },
    /// A number of the device that cannot be used.
    #[error("{part}: `{key}` is {value}; {allowed} is needed")]
    Value {
        /// Joint or cable.
        part: Part,
        /// Key of the device file.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What may be there.
        allowed: &'static str,
    },
    /// No reading can be drawn between the limits.
    #[error(
        "{part}: no reading between {low} and {high} (the limits, and 3 sampling_sd_rad about \
         home) in {attempts} draws"
    )]
    NoRoom {
        /// Joint.
        part: Part,
        /// Larger of the lower limit and -3 sd.
        low: f64,
        /// Smaller of the upper limit and 3 sd.
        high: f64,
        /// Draws made; 0 where the interval is empty.
        attempts: usize,
    },
    /// Every pose drawn for a row was too near a cable exit.
    #[error(
        "row {row}: {attempts} poses drawn, each nearer than {minimum_distance_m} m to a cable exit"
    )]
    TooNearCableExit {
        /// Row, from 0.
        row: usize,
        /// Poses drawn.
        attempts: usize,
        /// The setting.
        minimum_distance_m: f64,
    },
    /// The true device has no value at a row's readings.
    #[error("row {row}: {source}")]
    Row {
        /// Row, from 0.
        row: usize,
        /// What the model says.
        source: ModelError,
    },
    /// Springs that give way without end under the row's load.
    #[error(
        "row {row}: the springs of the effects are too weak for weights and hand; raise the \
         stiffness, or lower force_rms_n"
    )]
    NoBalance {
        /// Row, from 0.
        row: usize,
    },
    /// A handle within the guide over which its cable bends.
    #[error(
        "row {row}: the handle is {distance_m} m from the cable's exit, inside the guide of \
         `cable-exit-geometry`; take a smaller radius_m, or another seed"
    )]
    InsideGuide {
        /// Row, from 0.
        row: usize,
        /// Distance between exit and handle \[m\].
        distance_m: f64,
    },
    /// A thing that the handle is to touch and reaches at none of its postures.
    #[error(
        "{what}: the true device reaches it at none of its {postures} postures within the limits of the joints"
    )]
    OutOfReach {
        /// `contact` or `plane` with its name.
        what: String,
        /// Postures that were to touch it.
        postures: usize,
    },
    /// A plane that is known by too few postures.
    #[error(
        "plane `{id}` has {postures} postures, or all in one line: nobody can tell where it lies"
    )]
    NoPlane {
        /// As in the log's column `plane`.
        id: String,
        /// Postures that touch it.
        postures: usize,
    },
    /// A touch or a held angle that the joints do not get to with what effects do to it.
    #[error("row {row}: the joints do not get to where {what}")]
    NotMet {
        /// Row, from 0.
        row: usize,
        /// What was to be met.
        what: String,
    },
    /// Two demands on the joints of one posture.
    #[error("row {row}: a fixture holds a link while the handle touches something")]
    HeldTouch {
        /// Row, from 0.
        row: usize,
    },
    /// Postures of a device without the links or the numbers of joints that they need.
    #[error("{what}")]
    NoPosture {
        /// What is missing.
        what: String,
    },
    /// Effects that cannot be simulated.
    #[error(transparent)]
    Effects(#[from] EffectError),
    /// A reading came out infinite or not a number.
    #[error("row {row}: `{channel}` is {value}; the device's numbers are out of range")]
    NonFinite {
        /// Row, from 0.
        row: usize,
        /// Column, as in a log.
        channel: String,
        /// What came out.
        value: f64,
    },
    /// The columns of a recording differ in length.
    #[error("joint column {joint} (from 1) has {got} rows, the first has {expected}")]
    ColumnLength {
        /// Joint, from 1.
        joint: usize,
        /// Rows of joint 1.
        expected: usize,
        /// Rows of this joint.
        got: usize,
    },
    /// A deviation whose sum with the nominal value is infinite or not a number.
    #[error("deviation {deviation} of `{name}` on {nominal}: the sum must be finite")]
    Deviation {
        /// Parameter.
        name: String,
        /// Value before.
        nominal: f64,
        /// What was to be added.
        deviation: f64,
    },
    /// What the model says of the device itself.
    #[error(transparent)]
    Model(#[from] ModelError),
}
