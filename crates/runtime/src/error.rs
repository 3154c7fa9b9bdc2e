//! Why a device is no model, and why a step has no answer.

/// A device that the runtime cannot hold; each says what, where, and what to do. Joints count from 1,
/// rows from 0, as in texts for people.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A number of a row is not finite or above 1e6 in size.
    #[error("row {row}: {quantity} is {value}; a number of at most 1e6 in size is needed")]
    Row {
        /// Row, from 0.
        row: usize,
        /// Key of the device file.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// The constant transform before a row is not one.
    #[error(
        "the constant transform before row {row} is no rotation with a position of at most 1e6 in size"
    )]
    Origin {
        /// Row, from 0; the number behind the last row's for the transform before the handle.
        row: usize,
    },
    /// A row is driven by a joint that the device does not have.
    #[error("row {row} is driven by joint {joint}; the device has {joints} joints")]
    Drive {
        /// Row, from 1.
        row: usize,
        /// Joint, from 1.
        joint: usize,
        /// Joints of the device.
        joints: usize,
    },
    /// A number of a joint is out of its range.
    #[error("joint {joint}: {quantity} is {value}; allowed: {allowed}")]
    Joint {
        /// Joint, from 1.
        joint: usize,
        /// Key of the device file.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        allowed: &'static str,
    },
    /// A number of an effect is out of its range.
    #[error("effect {effect}: {quantity} is {value}; allowed: {allowed}")]
    Effect {
        /// Position in the list, from 1.
        effect: usize,
        /// Field.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        allowed: &'static str,
    },
    /// An effect is of a joint or a row that the device does not have.
    #[error("effect {effect} is of {what} {number}; the device has {count}")]
    EffectPlace {
        /// Position in the list, from 1.
        effect: usize,
        /// `"joint"` or `"moving row"`.
        what: &'static str,
        /// Its number, from 1.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// An effect of a joint's axis, of a joint that has none of its own: it slides, or moves several rows.
    #[error(
        "effect {effect} is of the axis of joint {joint}, which slides or moves several rows: leave the effect out"
    )]
    EffectAxis {
        /// Position in the list, from 1.
        effect: usize,
        /// Joint, from 1.
        joint: usize,
    },
}

/// A step that has no answer. Joints count from 1, as in texts for people.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuntimeError {
    /// A reading is infinite or not a number.
    #[error("joint {joint}: the reading is {reading}; check its encoder")]
    NonFiniteReading {
        /// Joint, from 1.
        joint: usize,
        /// The reading.
        reading: f64,
    },
    /// A reading lies where nothing is known of the transmission.
    #[error(
        "joint {joint}: the reading {reading} is outside {lower} to {upper}, where the model holds; \
         move the joint back, or identify it over a larger range"
    )]
    ReadingOutOfRange {
        /// Joint, from 1.
        joint: usize,
        /// The reading \[rad\] or \[m\].
        reading: f64,
        /// Lowest reading allowed.
        lower: f64,
        /// Highest reading allowed.
        upper: f64,
    },
    /// A reading lies beyond the device's joint limits; a step may still have an answer there.
    #[error(
        "joint {joint}: the reading {reading} is beyond the joint's limits, {lower} to {upper}; move the joint back, or \
         check its encoder and its home"
    )]
    BeyondLimit {
        /// Joint, from 1.
        joint: usize,
        /// The reading \[rad\] or \[m\].
        reading: f64,
        /// Lower limit; infinite where there is none.
        lower: f64,
        /// Upper limit; infinite where there is none.
        upper: f64,
    },
    /// The bars of a parallelogram do not close, or lie in a line.
    #[error("joint {joint}: the parallelogram is open or stretched at the reading {reading}")]
    OpenLoop {
        /// Joint, from 1.
        joint: usize,
        /// The reading \[rad\].
        reading: f64,
    },
    /// The corrected joint value is too large for the chain.
    #[error(
        "joint {joint}: the reading {reading} gives the joint value {output}, above 1e6 in size"
    )]
    OutputOutOfRange {
        /// Joint, from 1.
        joint: usize,
        /// The reading \[rad\] or \[m\].
        reading: f64,
        /// The corrected value.
        output: f64,
    },
    /// A wanted force or moment is infinite or not a number.
    #[error("the wanted {quantity} has the component {value}; finite components are needed")]
    NonFiniteWrench {
        /// `"force"` or `"moment"`.
        quantity: &'static str,
        /// The component.
        value: f64,
    },
    /// An input beside the readings is not a number, or above 1e12 in size.
    #[error("{quantity} {number} is {value}; a number of at most 1e12 in size is needed")]
    Input {
        /// What it is.
        quantity: &'static str,
        /// Joint or axis, from 1.
        number: usize,
        /// Its value.
        value: f64,
    },
    /// The state of the effects is that of another model.
    #[error(
        "the state is of another model: it does not fit effect {effect}; start with the model's own"
    )]
    ForeignState {
        /// Position of the effect in the list, from 1.
        effect: usize,
    },
    /// Effects displace the handle by more than 1e6.
    #[error("the effects displace the handle by more than 1e6 m or rad; check the inputs")]
    DisplacementOutOfRange,
    /// No reading gives a wanted joint value.
    #[error(
        "joint {joint}: no reading within the model's range gives the value {output}; ask for another"
    )]
    NotReached {
        /// Joint, from 1.
        joint: usize,
        /// The wanted value.
        output: f64,
    },
    /// A wanted pose is none.
    #[error(
        "the wanted pose has a position above 1e6 m in size, or its matrix is no rotation to 1e-6"
    )]
    NotAPose,
    /// No joint values near the start give a wanted pose.
    #[error(
        "the pose was not reached: {position_m} m and {rotation_rad} rad are left; start nearer, or ask for a pose within \
         reach"
    )]
    PoseNotReached {
        /// What is left of the position \[m\].
        position_m: f64,
        /// What is left of the orientation \[rad\].
        rotation_rad: f64,
    },
    /// A wanted force or moment is finite, the torque for it is not.
    #[error("joint {joint}: the torque for the wanted wrench is too large; ask for less")]
    TorqueOverflow {
        /// Joint, from 1.
        joint: usize,
    },
}

/// The `?` of constant functions.
macro_rules! attempt {
    ($outcome:expr) => {
        match $outcome {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}
pub(crate) use attempt;

/// The refusal of a transmission, before it is known which joint it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Refusal {
    pub(crate) quantity: &'static str,
    pub(crate) value: f64,
    pub(crate) allowed: &'static str,
}

impl Refusal {
    pub(crate) const fn for_joint(self, joint: usize) -> DeviceError {
        DeviceError::Joint {
            joint,
            quantity: self.quantity,
            value: self.value,
            allowed: self.allowed,
        }
    }
}

/// Largest magnitude of a number that describes a device: sums and products of a few stay finite.
pub(crate) const LARGEST_NUMBER: f64 = 1e6;
/// Smallest length or width that something is divided by.
pub(crate) const SMALLEST_LENGTH: f64 = 1e-9;

/// Whether a number is of bounded size; NaN is not.
pub(crate) const fn is_bounded(value: f64) -> bool {
    value.abs() <= LARGEST_NUMBER
}

/// Passes on a number of bounded size.
pub(crate) const fn bounded(quantity: &'static str, value: f64) -> Result<f64, Refusal> {
    if is_bounded(value) {
        Ok(value)
    } else {
        Err(Refusal {
            quantity,
            value,
            allowed: "up to 1e6 in size",
        })
    }
}

/// Passes on a length that can be divided by.
pub(crate) const fn length(quantity: &'static str, value: f64) -> Result<f64, Refusal> {
    if SMALLEST_LENGTH <= value && value <= LARGEST_NUMBER {
        Ok(value)
    } else {
        Err(Refusal {
            quantity,
            value,
            allowed: "1e-9 m to 1e6 m",
        })
    }
}
