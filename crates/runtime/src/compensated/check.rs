//! Which numbers effects may have.

use haptical_transmission::spline::LEAST_COEFFICIENTS;

use super::{Effect, Turnover};
use crate::error::{DeviceError, is_bounded};

/// Why an effect is refused.
struct Wrong {
    quantity: &'static str,
    value: f64,
    allowed: &'static str,
}

const ANY: &str = "up to 1e6 in size";
const ABOVE: &str = "1e-12 to 1e6";
const GAIN: &str = "between -0.9 and 0.9";

impl Effect {
    /// Refuses numbers that a step cannot hold, and joints and rows that are not there; `index` from 0.
    pub(super) const fn check(
        &self,
        index: usize,
        joints: usize,
        rows: usize,
    ) -> Result<(), DeviceError> {
        let (joint, from) = self.joints();
        if joint >= joints || from >= joints {
            let missing = if joint >= joints { joint } else { from };
            return Err(DeviceError::EffectPlace {
                effect: index + 1,
                what: "joint",
                number: missing + 1,
                count: joints,
            });
        }
        if let Self::Weight { row, .. } = *self
            && row >= rows
        {
            return Err(DeviceError::EffectPlace {
                effect: index + 1,
                what: "moving row",
                number: row + 1,
                count: rows,
            });
        }
        match self.wrong() {
            None => Ok(()),
            Some(wrong) => Err(DeviceError::Effect {
                effect: index + 1,
                quantity: wrong.quantity,
                value: wrong.value,
                allowed: wrong.allowed,
            }),
        }
    }

    /// The joint and the other joint; 0 where there is none.
    const fn joints(&self) -> (usize, usize) {
        match *self {
            Self::Coupling { joint, from, .. } | Self::CoupledBacklash { joint, from, .. } => {
                (joint, from)
            }
            Self::CapstanCompliance { joint, .. }
            | Self::JointCompliance { joint, .. }
            | Self::Backlash { joint, .. }
            | Self::Hysteresis { joint, .. }
            | Self::CapstanCreep { joint, .. }
            | Self::ViscousLag { joint, .. }
            | Self::Harmonic { joint, .. }
            | Self::CablePitch { joint, .. }
            | Self::Drift { joint, .. }
            | Self::SettlingDrift { joint, .. }
            | Self::WarmDrift { joint, .. }
            | Self::Curve { joint, .. }
            | Self::LateralCompliance { joint, .. }
            | Self::AxisWobble { joint, .. }
            | Self::TorqueGain { joint, .. }
            | Self::Friction { joint, .. }
            | Self::MotorCogging { joint, .. } => (joint, 0),
            _ => (0, 0),
        }
    }

    const fn wrong(&self) -> Option<Wrong> {
        match *self {
            Self::None => None,
            Self::CapstanCompliance { rad_per_nm, .. }
            | Self::JointCompliance { rad_per_nm, .. } => any("rad_per_nm", &[rad_per_nm]),
            Self::Backlash { width_rad, .. } => within("width_rad", width_rad, 0.0, ANY),
            Self::Hysteresis {
                amplitude_rad,
                transition_rad,
                ..
            } => first(
                any("amplitude_rad", &[amplitude_rad]),
                above("transition_rad", transition_rad),
            ),
            Self::CapstanCreep { creep_per_nm, .. } => any("creep_per_nm", &[creep_per_nm]),
            Self::ViscousLag { delay_s, .. } | Self::EncoderLatency { delay_s } => {
                any("delay_s", &[delay_s])
            }
            Self::Harmonic {
                periods,
                cosine_rad: cosine,
                sine_rad: sine,
                ..
            }
            | Self::MotorCogging {
                periods,
                cosine_nm: cosine,
                sine_nm: sine,
                ..
            } => any("periods, cosine or sine", &[periods, cosine, sine]),
            Self::CablePitch {
                quadratic_per_rad,
                cubic_per_rad2,
                ..
            } => any(
                "quadratic_per_rad or cubic_per_rad2",
                &[quadratic_per_rad, cubic_per_rad2],
            ),
            Self::Coupling { gain, .. } => any("gain", &[gain]),
            Self::CoupledBacklash {
                width_rad,
                play_rad,
                ..
            } => first(any("width_rad", &[width_rad]), above("play_rad", play_rad)),
            Self::Drift { rad_per_s, .. } => any("rad_per_s", &[rad_per_s]),
            Self::SettlingDrift {
                end_rad,
                time_constant_s,
                ..
            } => first(
                any("end_rad", &[end_rad]),
                above("time_constant_s", time_constant_s),
            ),
            Self::WarmDrift {
                rad_per_degc,
                reference_degc,
                ..
            } => any(
                "rad_per_degc or reference_degc",
                &[rad_per_degc, reference_degc],
            ),
            Self::Curve {
                lower,
                upper,
                coefficients,
                ..
            } => {
                let ends = first(
                    any("lower or upper", &[lower, upper]),
                    above("upper less lower", upper - lower),
                );
                let count = within(
                    "the number of coefficients",
                    coefficients.len() as f64,
                    LEAST_COEFFICIENTS as f64,
                    "at least 4",
                );
                first(ends, first(count, any("coefficients", coefficients)))
            }
            _ => self.wrong_beyond_drives(),
        }
    }

    /// The same of links and torques.
    const fn wrong_beyond_drives(&self) -> Option<Wrong> {
        match self {
            Self::LateralCompliance {
                rad_per_nm,
                origin_m,
                ..
            } => first(any("rad_per_nm", &[*rad_per_nm]), any("origin_m", origin_m)),
            Self::BaseCompliance { rad_per_nm, base_m } => {
                first(any("rad_per_nm", &[*rad_per_nm]), any("base_m", base_m))
            }
            Self::ToolCompliance { m_per_n } => any("m_per_n", &[*m_per_n]),
            Self::AxisWobble {
                order,
                cosine_rad: [a, b],
                sine_rad: [c, d],
                origin_m,
                ..
            } => first(
                any("order, cosine_rad or sine_rad", &[*order, *a, *b, *c, *d]),
                any("origin_m", origin_m),
            ),
            Self::ThermalGrowth {
                per_degc,
                reference_degc,
                base_m,
            } => first(
                any("per_degc or reference_degc", &[*per_degc, *reference_degc]),
                any("base_m", base_m),
            ),
            Self::ToolChanged { shift_m } => any("shift_m", shift_m),
            Self::Weight {
                place_m, force_n, ..
            } => first(any("place_m", place_m), any("force_n", force_n)),
            Self::TorqueGain { gain, .. } => proper("gain", &[*gain]),
            Self::Friction {
                coulomb_nm,
                viscous_nm_s_per_rad,
                stribeck_nm,
                stribeck_rad_per_s,
                side,
                ..
            } => {
                let (Turnover::Travel(over) | Turnover::Rate(over)) = *side;
                let sizes = [*coulomb_nm, *viscous_nm_s_per_rad, *stribeck_nm];
                let divisors = first(
                    above("stribeck_rad_per_s", *stribeck_rad_per_s),
                    above("the travel or rate of side", over),
                );
                first(any("coulomb, viscous or stribeck", &sizes), divisors)
            }
            Self::Payload {
                mass_kg,
                gravity_mps2,
            } => first(
                any("mass_kg", &[*mass_kg]),
                any("gravity_mps2", gravity_mps2),
            ),
            Self::ForceBias { bias_n } => any("bias_n", bias_n),
            Self::ForceWarmBias {
                n_per_degc,
                reference_degc,
            } => first(
                any("n_per_degc", n_per_degc),
                any("reference_degc", &[*reference_degc]),
            ),
            Self::ForceGain { gain } => proper("gain", gain),
            Self::ForceCrosstalk { parts } => any("parts", parts),
            Self::ForceHysteresis {
                size_n,
                transition_n,
            } => first(any("size_n", size_n), above("transition_n", *transition_n)),
            _ => None,
        }
    }
}

const fn first(one: Option<Wrong>, other: Option<Wrong>) -> Option<Wrong> {
    match one {
        None => other,
        wrong => wrong,
    }
}

const fn any(quantity: &'static str, values: &[f64]) -> Option<Wrong> {
    let mut index = 0;
    while index < values.len() {
        if !is_bounded(values[index]) {
            return Some(Wrong {
                quantity,
                value: values[index],
                allowed: ANY,
            });
        }
        index += 1;
    }
    None
}

/// At least so large; NaN is not.
const fn within(
    quantity: &'static str,
    value: f64,
    least: f64,
    allowed: &'static str,
) -> Option<Wrong> {
    if value >= least && is_bounded(value) {
        return None;
    }
    Some(Wrong {
        quantity,
        value,
        allowed,
    })
}

const fn above(quantity: &'static str, value: f64) -> Option<Wrong> {
    within(quantity, value, 1e-12, ABOVE)
}

/// Gains by which torques and forces are divided.
const fn proper(quantity: &'static str, values: &[f64]) -> Option<Wrong> {
    let mut index = 0;
    while index < values.len() {
        let is_proper = values[index].abs() <= 0.9;
        if !is_proper {
            return Some(Wrong {
                quantity,
                value: values[index],
                allowed: GAIN,
            });
        }
        index += 1;
    }
    None
}
