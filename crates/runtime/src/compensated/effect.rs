//! Effects of a device as the runtime takes them: plain numbers, checked when the model is made.

use crate::error::{DeviceError, is_bounded};

/// Which side of a play or of a loop drives the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The motor: the joint stays behind.
    Motor,
    /// The hand on the joint: the joint is ahead of its motor.
    Hand,
}

/// Over what Coulomb's friction changes sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turnover {
    /// A travel \[rad\], \[m\] (Dahl's friction).
    Travel(f64),
    /// A rate \[rad/s\], \[m/s\] (a hyperbolic tangent).
    Rate(f64),
}

/// An effect of a device. Joints and rows count from 0; q is a joint's reading, v its rate, a its acceleration, tau its
/// torque, T the temperature, F the force of the hand on the handle in frame (-1), R the handle's axes. Formulas and their
/// names in the catalogue: docs/equations.md, Effects in a control loop.
///
/// For a joint that slides read m for rad and N for Nm.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(
    missing_docs,
    reason = "the fields are the parameters of the formulas, each with its unit in its name"
)]
pub enum Effect {
    /// Nothing: fills a list.
    None,
    /// The joint's angle is less by `rad_per_nm tau`.
    CapstanCompliance { joint: usize, rad_per_nm: f64 },
    /// The link behind the joint's external encoder is turned back by `rad_per_nm tau`.
    JointCompliance { joint: usize, rad_per_nm: f64 },
    /// A play of the width.
    Backlash {
        joint: usize,
        width_rad: f64,
        driven_by: Side,
    },
    /// Dahl's loop.
    Hysteresis {
        joint: usize,
        amplitude_rad: f64,
        transition_rad: f64,
        driven_by: Side,
    },
    /// `-creep_per_nm` times the sum of tau |dq|.
    CapstanCreep { joint: usize, creep_per_nm: f64 },
    /// q(t - delay) - q(t), to second order.
    ViscousLag { joint: usize, delay_s: f64 },
    /// q(t + delay) - q(t) of all joints, to second order.
    EncoderLatency { delay_s: f64 },
    /// `cosine_rad cos(periods q) + sine_rad sin(periods q)`.
    Harmonic {
        joint: usize,
        periods: f64,
        cosine_rad: f64,
        sine_rad: f64,
    },
    /// `quadratic q^2 + cubic q^3`.
    CablePitch {
        joint: usize,
        quadratic_per_rad: f64,
        cubic_per_rad2: f64,
    },
    /// `gain` times the reading of joint `from`, which may be the joint itself.
    Coupling {
        joint: usize,
        from: usize,
        gain: f64,
    },
    /// `width / play` times the output of a play of joint `from` less its input, over half the play.
    CoupledBacklash {
        joint: usize,
        from: usize,
        width_rad: f64,
        play_rad: f64,
    },
    /// `rad_per_s t`.
    Drift { joint: usize, rad_per_s: f64 },
    /// `end_rad (1 - exp(-t / time_constant_s))`.
    SettlingDrift {
        joint: usize,
        end_rad: f64,
        time_constant_s: f64,
    },
    /// `rad_per_degc (T - reference_degc)`.
    WarmDrift {
        joint: usize,
        rad_per_degc: f64,
        reference_degc: f64,
    },
    /// The link turns by `rad_per_nm M`, M the part across the joint's axis of the moment of hand and weights beyond the
    /// joint about its origin. `origin_m` is the joint's origin in frame (-1) when all joint values are 0.
    LateralCompliance {
        joint: usize,
        rad_per_nm: f64,
        origin_m: [f64; 3],
    },
    /// The device turns about its base (`base_m`, frame (-1)) by `rad_per_nm M`, M the moment of hand and weights about it.
    BaseCompliance { rad_per_nm: f64, base_m: [f64; 3] },
    /// The handle shifts by `m_per_n F`.
    ToolCompliance { m_per_n: f64 },
    /// The joint's axis tilts about two axes across it, e_1 along its cross product with the axis before and e_2 along its
    /// cross product with e_1, by `cosine_rad cos(order theta) + sine_rad sin(order theta)`, theta the link's angle, at the
    /// joint's origin: `origin_m` as of the lateral compliance.
    AxisWobble {
        joint: usize,
        order: f64,
        cosine_rad: [f64; 2],
        sine_rad: [f64; 2],
        origin_m: [f64; 3],
    },
    /// The way from the base to the handle grows by the part `per_degc (T - reference_degc)`.
    ThermalGrowth {
        per_degc: f64,
        reference_degc: f64,
        base_m: [f64; 3],
    },
    /// The handle is shifted by `shift_m`, in its own axes.
    ToolChanged { shift_m: [f64; 3] },
    /// What pulls at the link behind a moving row, beside the hand: no effect of its own, but a load of those above.
    /// `place_m` is where it pulls, in frame (-1) when all joint values are 0; `force_n` in frame (-1).
    Weight {
        row: usize,
        place_m: [f64; 3],
        force_n: [f64; 3],
    },
    /// The drive's torque reads `gain` of itself too much.
    TorqueGain { joint: usize, gain: f64 },
    /// Friction that the drive overcomes: `side (coulomb + stribeck exp(-(v / stribeck_rad_per_s)^2)) + viscous v`.
    Friction {
        joint: usize,
        coulomb_nm: f64,
        viscous_nm_s_per_rad: f64,
        stribeck_nm: f64,
        stribeck_rad_per_s: f64,
        side: Turnover,
    },
    /// `cosine_nm cos(periods q) + sine_nm sin(periods q)`.
    MotorCogging {
        joint: usize,
        periods: f64,
        cosine_nm: f64,
        sine_nm: f64,
    },
    /// A mass at the handle: drives hold it against gravity and speed it up.
    Payload {
        mass_kg: f64,
        gravity_mps2: [f64; 3],
    },
    /// The force sensor reads a constant too much; handle's axes, as all of the sensor.
    ForceBias { bias_n: [f64; 3] },
    /// The constant grows with the temperature.
    ForceWarmBias {
        n_per_degc: [f64; 3],
        reference_degc: f64,
    },
    /// Each axis reads `1 + gain` of what acts.
    ForceGain { gain: [f64; 3] },
    /// Axes read a part of the force along others: of y and z on x, of x and z on y, of x and y on z.
    ForceCrosstalk { parts: [f64; 6] },
    /// Dahl's state of each axis, of the force as read.
    ForceHysteresis { size_n: [f64; 3], transition_n: f64 },
}

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

    /// Whether it displaces the handle beyond the joints.
    pub(super) const fn is_of_structure(&self) -> bool {
        matches!(
            self,
            Self::LateralCompliance { .. }
                | Self::BaseCompliance { .. }
                | Self::ToolCompliance { .. }
                | Self::AxisWobble { .. }
                | Self::ThermalGrowth { .. }
                | Self::ToolChanged { .. }
        )
    }

    /// Whether it is one of the drives' torques.
    pub(super) const fn is_of_torques(&self) -> bool {
        matches!(
            self,
            Self::TorqueGain { .. }
                | Self::Friction { .. }
                | Self::MotorCogging { .. }
                | Self::Payload { .. }
        )
    }

    /// Whether it is one of the force sensor.
    pub(super) const fn is_of_sensor(&self) -> bool {
        matches!(
            self,
            Self::ForceBias { .. }
                | Self::ForceWarmBias { .. }
                | Self::ForceGain { .. }
                | Self::ForceCrosstalk { .. }
                | Self::ForceHysteresis { .. }
        )
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
