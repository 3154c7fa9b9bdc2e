//! Says why effects cannot be simulated.

/// Why a list of effects, or `effects.toml`, is refused. Effects count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// Text that is no TOML.
    #[error("{file}: {what}")]
    Syntax {
        /// File.
        file: String,
        /// What the reader says, with line and column.
        what: String,
    },
    /// Something other than `[[effect]]` tables.
    #[error("{file}: `{key}` is not known; write each effect as a table [[effect]]")]
    Key {
        /// File.
        file: String,
        /// Key that is there.
        key: String,
    },
    /// An effect without a name.
    #[error("{file}, effect {number}: `name` is missing; the names are: {names}")]
    NoName {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// All names.
        names: String,
    },
    /// A name that is not known.
    #[error(
        "{file}, effect {number}: `{name}` cannot be simulated; {nearest}the names are: {names}"
    )]
    Unknown {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Name that is there.
        name: String,
        /// Nearest name as a question, or nothing.
        nearest: String,
        /// All names.
        names: String,
    },
    /// A parameter that the effect does not have.
    #[error(
        "{file}, effect {number} (`{name}`): no parameter `{parameter}`; {nearest}its parameters \
         are: {parameters}"
    )]
    Parameter {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Its name.
        name: &'static str,
        /// Parameter that is there.
        parameter: String,
        /// Nearest one as a question, or nothing.
        nearest: String,
        /// All of the effect.
        parameters: String,
    },
    /// A parameter that is missing, or whose value is of another type.
    #[error("{file}, effect {number} (`{name}`): {what}; its parameters are: {parameters}")]
    Shape {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Its name.
        name: &'static str,
        /// What is wrong.
        what: String,
        /// All of the effect.
        parameters: String,
    },
    /// A size outside its domain.
    #[error("{file}, effect {number} (`{name}`): `{parameter}` is {value}; {allowed} is needed")]
    Value {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Its name.
        name: &'static str,
        /// Parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What may stand there.
        allowed: &'static str,
    },
    /// Both or neither of two parameters that exclude each other.
    #[error(
        "{file}, effect {number} (`{name}`): give `{}` or `{}`, one of the two",
        .parameters[0],
        .parameters[1]
    )]
    OneOfTwo {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Its name.
        name: &'static str,
        /// The two.
        parameters: [&'static str; 2],
    },
    /// An effect that is there twice at one place.
    #[error("{file}, effect {number}: `{name}` is there already at this place; give it once")]
    Twice {
        /// File.
        file: String,
        /// Effect.
        number: usize,
        /// Its name.
        name: &'static str,
    },
    /// A joint that the device does not have.
    #[error("effect `{name}`: joint {joint}, but the device has joints 1 to {joints}")]
    NoJoint {
        /// Effect.
        name: &'static str,
        /// Joint, from 1.
        joint: usize,
        /// Joints of the device.
        joints: usize,
    },
    /// Something that the device or the settings lack.
    #[error("effect `{name}`{}: it needs {needs}", .joint.map_or_else(String::new, |joint| format!(" of joint {joint}")))]
    Device {
        /// Effect.
        name: &'static str,
        /// Joint, from 1.
        joint: Option<usize>,
        /// What is lacking.
        needs: &'static str,
    },
}
