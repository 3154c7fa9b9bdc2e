//! Every number of a device that a calibration may change, by a stable name.

pub(crate) mod surrounding;
pub(crate) mod unknown;

use std::f64::consts::TAU;

use haptical_kinematics::Parameter;
use haptical_transmission::CapstanError;

use crate::{Device, ModelError, TransmissionError};
use crate::{JointCompliance, SurroundingParameter};

/// One parameter of a device.
///
/// Its methods take the device that it belongs to ([`Device::link_parameters`],
/// [`Device::transmission_parameters`] and [`Device::parameter`] make only such): they panic with the
/// index where that device has no such row, joint or coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ParameterId {
    /// A Denavit-Hartenberg parameter of a row (0 is the base row).
    Link {
        /// Row.
        row: usize,
        /// Which of the six.
        parameter: Parameter,
    },
    /// A parameter of a joint's transmission error.
    Transmission {
        /// Joint, from 0.
        joint: usize,
        /// Position within the error's parameters.
        index: usize,
    },
    /// What a joint yields behind its external encoder, per torque.
    Compliance {
        /// Joint, from 0.
        joint: usize,
    },
    /// A number of a cable, the tracker, a touched point or plane.
    Surrounding(SurroundingParameter),
    /// A number of an effect ([`Device::effects`]), in the form in which it is fitted.
    Effect {
        /// Position of the effect.
        effect: usize,
        /// Position of the number within [`crate::DeviceEffect::fitted`].
        number: usize,
    },
}

/// Keys of a `[[link]]` for its numbers, in the order in which they are written.
pub(crate) const LINK_KEYS: [(Parameter, &str); 6] = [
    (Parameter::A, "a_m"),
    (Parameter::Alpha, "alpha_rad"),
    (Parameter::D, "d_m"),
    (Parameter::Theta, "theta_offset_rad"),
    (Parameter::Beta, "beta_rad"),
    (Parameter::B, "b_m"),
];

/// Plausible size of a length deviation \[m\]: the largest of the paper's Table 5 is 4.2 mm.
const PLAUSIBLE_LENGTH_M: f64 = 5e-3;
/// Plausible size of an angle deviation \[rad\]: Table 5 has 27 mrad, once 52 mrad.
const PLAUSIBLE_ANGLE_RAD: f64 = 2e-2;
/// Plausible output drum eccentricity \[m\]: Table 4 reaches 1.5 mm.
const PLAUSIBLE_OUTPUT_ECCENTRICITY_M: f64 = 1e-3;
/// Plausible input drum eccentricity \[m\]: Table 4 reaches 0.02 mm; the drum is an eighth in size.
const PLAUSIBLE_INPUT_ECCENTRICITY_M: f64 = 1e-4;
/// Plausible compliance of a joint \[rad/(N m)\]: a capstan's cable yields 4e-3, a harmonic drive 1e-4.
const PLAUSIBLE_COMPLIANCE: f64 = 1e-3;
/// Plausible ratio deviation as a share of the ratio: Table 4 reaches 4 % of 8.
const PLAUSIBLE_RATIO_SHARE: f64 = 0.05;

impl ParameterId {
    /// A value as the angle \[rad\] of a link that is at most half a turn away from another one, where a search may end whole turns away
    /// from its start and the device is the same there. Values of other parameters are returned as they are.
    ///
    /// ```
    /// use haptical_model::{Parameter, ParameterId};
    /// let [theta, length] = [Parameter::Theta, Parameter::A].map(|parameter| ParameterId::Link { row: 1, parameter });
    /// assert!((theta.in_nearest_turn(6.3, 0.02) - 0.0168).abs() < 1e-4);
    /// assert_eq!(length.in_nearest_turn(6.3, 0.02), 6.3);
    /// ```
    pub fn in_nearest_turn(self, value: f64, from: f64) -> f64 {
        match self {
            Self::Link { parameter, .. } if !is_length(parameter) => {
                value - TAU * ((value - from) / TAU).round()
            }
            _ => value,
        }
    }

    /// Unit.
    pub fn unit(self, device: &Device) -> &'static str {
        match self {
            Self::Link { parameter, .. } if is_length(parameter) => "m",
            Self::Compliance { joint } => match device.joints[joint].joint_type {
                crate::JointType::Revolute => "rad/(N m)",
                crate::JointType::Prismatic => "m/N",
            },
            Self::Surrounding(parameter) => parameter.unit(),
            Self::Effect { effect, number } => device.effects[effect].fitted[number].unit,
            Self::Link { .. } => "rad",
            Self::Transmission { joint, index } => {
                let joint = &device.joints[joint];
                match (&joint.transmission_error, index) {
                    (TransmissionError::Chebyshev { .. }, _) | (_, 0) => joint.unit(),
                    (_, 1) => "1",
                    // Without drums the eccentricity's denominator is 1 m: the number is an angle.
                    (_, 2..6) if joint.drum_distance_m.is_none() => "rad",
                    _ => "m",
                }
            }
        }
    }

    /// Short name, as in the paper's tables: `alpha4`, `d0`, `ratio_deviation2`.
    pub fn name(self, device: &Device) -> String {
        match self {
            Self::Compliance { joint } => format!("joint_compliance{}", joint + 1),
            Self::Surrounding(parameter) => parameter.name(device),
            Self::Effect { effect, number } => device.effects[effect].fitted[number].name.clone(),
            Self::Link { row, parameter } => format!("{}{row}", parameter.name()),
            Self::Transmission { joint, index } => {
                let number = joint + 1;
                match &device.joints[joint].transmission_error {
                    TransmissionError::Chebyshev { .. } => format!("chebyshev{number}[{index}]"),
                    _ => match CapstanError::PARAMETER_NAMES.get(index) {
                        Some(name) => format!("{name}{number}"),
                        None => format!("length_deviation{number}[{}]", index - 5),
                    },
                }
            }
        }
    }

    /// Key in the device file: `link[4].alpha_rad`, `joint[2].transmission_error.ratio_deviation`.
    pub fn key(self, device: &Device) -> String {
        match self {
            Self::Compliance { joint } => {
                let key = compliance_key(device.joints[joint].joint_type);
                format!("joint[{}].{key}", joint + 1)
            }
            Self::Surrounding(parameter) => parameter.key(device),
            Self::Effect { effect, number } => {
                let effect = &device.effects[effect];
                format!("effect.{}", effect.fitted[number].name)
            }
            Self::Link { row, parameter } => {
                let mut keys = LINK_KEYS.iter();
                let key = keys.find(|(number, _)| *number == parameter);
                format!("link[{row}].{}", key.map_or("", |(_, key)| key))
            }
            Self::Transmission { joint, index } => {
                let number = joint + 1;
                let key = match (&device.joints[joint].transmission_error, index) {
                    (TransmissionError::Chebyshev { .. }, _) => format!("chebyshev[{index}]"),
                    (_, 0) => format!("offset_{}", device.joints[joint].unit()),
                    (_, 1) => "ratio_deviation".to_owned(),
                    (_, 2 | 3) => format!("output_drum_xy_m[{}]", index - 2),
                    (_, 4 | 5) => format!("input_drum_xy_m[{}]", index - 4),
                    _ => format!("length_deviations_m[{}]", index - 6),
                };
                format!("joint[{number}].transmission_error.{key}")
            }
        }
    }

    /// Size that a deviation of this parameter may plausibly have, in its unit; the paper's Tables 4
    /// and 5 are the source (docs/assumptions.md, "Plausible sizes").
    pub fn plausible_size(self, device: &Device) -> f64 {
        match self {
            Self::Link { row, parameter }
                if let Some(size) = device.deviation(row, parameter)
                    && size > 0.0 =>
            {
                size
            }
            Self::Link { parameter, .. } if is_length(parameter) => PLAUSIBLE_LENGTH_M,
            Self::Link { .. } => PLAUSIBLE_ANGLE_RAD,
            Self::Compliance { .. } => PLAUSIBLE_COMPLIANCE,
            Self::Surrounding(parameter) => parameter.plausible_size(),
            Self::Effect { effect, number } => device.effects[effect].fitted[number].plausible_size,
            Self::Transmission { joint, index } => {
                let joint = &device.joints[joint];
                let drum = joint.drum_distance_m.is_some();
                match (&joint.transmission_error, index) {
                    (TransmissionError::Chebyshev { .. }, _) | (_, 0) => PLAUSIBLE_ANGLE_RAD,
                    (_, 1) => PLAUSIBLE_RATIO_SHARE * joint.transmission_ratio.abs(),
                    (_, 2 | 3) if drum => PLAUSIBLE_OUTPUT_ECCENTRICITY_M,
                    (_, 4 | 5) if drum => PLAUSIBLE_INPUT_ECCENTRICITY_M,
                    (_, 2..=5) => PLAUSIBLE_ANGLE_RAD,
                    _ => PLAUSIBLE_OUTPUT_ECCENTRICITY_M,
                }
            }
        }
    }

    /// Value in a device.
    pub fn value(self, device: &Device) -> f64 {
        match self {
            Self::Compliance { joint } => device.compliance_rad_per_nm(joint),
            Self::Surrounding(parameter) => parameter.value(device),
            Self::Effect { effect, number } => device.effects[effect].fitted[number].value,
            Self::Link { row, parameter } => device.links[row].get(parameter),
            Self::Transmission { joint, index } => match &device.joints[joint].transmission_error {
                TransmissionError::Capstan(error) => error.to_array()[index],
                TransmissionError::Chebyshev { coefficients, .. } => coefficients[index],
                TransmissionError::Parallelogram {
                    capstan,
                    length_deviations_m,
                } => match index.checked_sub(6) {
                    None => capstan.to_array()[index],
                    Some(length) => length_deviations_m[length],
                },
            },
        }
    }

    /// Sets the value in a device.
    pub fn set(self, device: &mut Device, value: f64) {
        match self {
            Self::Compliance { joint } => {
                let joints = device.joints.len();
                let compliance = &mut device.surroundings.compliance;
                compliance.resize(joints, JointCompliance::default());
                compliance[joint].rad_per_nm = value;
            }
            Self::Surrounding(parameter) => parameter.set(device, value),
            Self::Effect { effect, number } => device.effects[effect].fitted[number].value = value,
            Self::Link { row, parameter } => device.links[row].set(parameter, value),
            Self::Transmission { joint, index } => {
                match &mut device.joints[joint].transmission_error {
                    TransmissionError::Capstan(error) => set_capstan(error, index, value),
                    TransmissionError::Chebyshev { coefficients, .. } => {
                        coefficients[index] = value;
                    }
                    TransmissionError::Parallelogram {
                        capstan,
                        length_deviations_m,
                    } => match index.checked_sub(6) {
                        None => set_capstan(capstan, index, value),
                        Some(length) => length_deviations_m[length] = value,
                    },
                }
            }
        }
    }
}

fn is_length(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::A | Parameter::B | Parameter::D)
}

/// Key of `[[joint]]` for what the joint yields.
pub(crate) fn compliance_key(joint_type: crate::JointType) -> &'static str {
    match joint_type {
        crate::JointType::Revolute => "compliance_rad_per_nm",
        crate::JointType::Prismatic => "compliance_m_per_n",
    }
}

fn set_capstan(error: &mut CapstanError, index: usize, value: f64) {
    let mut values = error.to_array();
    values[index] = value;
    *error = CapstanError::from_array(values);
}

impl Device {
    /// The 4 (n + 1) Denavit-Hartenberg parameters, row by row; Hayati's angle only where
    /// `with_beta`. A general row ([`Device::is_general_row`]) has all six either way.
    pub fn link_parameters(&self, with_beta: bool) -> Vec<ParameterId> {
        (0..self.links.len())
            .flat_map(|row| {
                Parameter::ALL
                    .into_iter()
                    .filter(move |parameter| match parameter {
                        Parameter::Beta => with_beta || self.is_general_row(row),
                        Parameter::B => self.is_general_row(row),
                        _ => true,
                    })
                    .map(move |parameter| ParameterId::Link { row, parameter })
            })
            .collect()
    }

    /// The parameters of one joint's transmission error (joint from 0).
    pub fn transmission_parameters(&self, joint: usize) -> Vec<ParameterId> {
        (0..self.joints[joint].error_parameter_count())
            .map(|index| ParameterId::Transmission { joint, index })
            .collect()
    }

    /// What may be fitted with links and transmissions: what cables, tracker, touched points and planes
    /// leave open, and compliances and effects that are to be found.
    pub fn further_parameters(&self) -> Vec<ParameterId> {
        let open = self.surrounding_parameters().into_iter();
        let yielding = self.surroundings.compliance.iter().enumerate();
        let yielding = yielding.filter(|(_, joint)| joint.fit);
        let yielding = yielding.map(|(joint, _)| ParameterId::Compliance { joint });
        let effects = self.effects.iter().enumerate();
        let numbers = effects.flat_map(|(effect, own)| {
            let numbers = 0..own.fitted.len();
            numbers.map(move |number| ParameterId::Effect { effect, number })
        });
        let open = open.map(ParameterId::Surrounding);
        open.chain(yielding).chain(numbers).collect()
    }

    /// Finds a parameter by its short name.
    ///
    /// # Errors
    /// [`ModelError::NoParameter`].
    pub fn parameter(&self, name: &str) -> Result<ParameterId, ModelError> {
        let mut parameters = self.every_parameter();
        let found = parameters.find(|id| id.name(self) == name);
        found.ok_or_else(|| ModelError::NoParameter {
            name: name.to_owned(),
        })
    }

    pub(crate) fn every_parameter(&self) -> impl Iterator<Item = ParameterId> {
        let joints = 0..self.joints.len();
        let transmissions = joints.flat_map(|joint| self.transmission_parameters(joint));
        let links = self.link_parameters(true).into_iter();
        links.chain(transmissions).chain(self.further_parameters())
    }
}
