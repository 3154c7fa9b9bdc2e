//! Effects of a device as the runtime takes them: plain numbers, checked when the model is made.

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

/// What a curve is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// The joint's own reading \[rad\], \[m\].
    Angle,
    /// The torque of its drive \[Nm\], \[N\].
    Torque,
    /// The temperature \[degC\].
    Temperature,
    /// The time since the start \[s\].
    Time,
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
    /// A curve of uniform cubic B-splines between two ends of what it is drawn over, in its unit; beyond them it keeps the
    /// value of its end ([`haptical_transmission::spline`]). A loop over many curves reads their coefficients from where the
    /// program has them.
    Curve {
        joint: usize,
        over: Over,
        lower: f64,
        upper: f64,
        coefficients: &'static [f64],
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

impl Effect {
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
}
