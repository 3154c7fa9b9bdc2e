//! Names and holds the six parameters of a chain's row, and says in which order they act.

use core::fmt;

/// The order in which the six elementary motions of a row act.
///
/// Each row's transform leads from the frame before it to its own frame; the chain is the product
/// of its rows' transforms, the first row starting in frame (-1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Convention {
    /// Distal (standard) convention, `A = Rz(theta) T(a, b, d) Rx(alpha) Ry(beta)`:
    /// Baser & Konukseven eq. (3), with Hayati's `beta` and the slide `b` of a general row.
    Standard,
    /// Proximal (modified, Craig's) convention, `A = T(a, b, 0) Rx(alpha) Ry(beta) Rz(theta) Tz(d)`:
    /// Craig, *Introduction to Robotics*, chapter 3, with Hayati's `beta` and the slide `b`.
    Modified,
}

impl Convention {
    /// The parameters in the order in which their elementary motions are multiplied, left to right.
    ///
    /// ```
    /// use haptical_kinematics::{Convention, Parameter};
    /// assert_eq!(Convention::Standard.order()[0], Parameter::Theta);
    /// assert_eq!(Convention::Modified.order()[5], Parameter::D);
    /// ```
    pub const fn order(self) -> [Parameter; 6] {
        use Parameter::{A, Alpha, B, Beta, D, Theta};
        match self {
            Self::Standard => [Theta, A, B, D, Alpha, Beta],
            Self::Modified => [A, B, Alpha, Beta, Theta, D],
        }
    }
}

/// What the joint variable of a row does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Motion {
    /// The row has no joint variable.
    Fixed,
    /// The joint variable, in rad, is added to the row's `theta_rad`.
    Revolute,
    /// The joint variable, in m, is added to the row's `d_m`.
    Prismatic,
}

impl Motion {
    /// The parameter to which the joint variable is added; `None` for a fixed row.
    pub const fn variable(self) -> Option<Parameter> {
        match self {
            Self::Fixed => None,
            Self::Revolute => Some(Parameter::Theta),
            Self::Prismatic => Some(Parameter::D),
        }
    }
}

/// One row of a Denavit-Hartenberg table, with Hayati's `beta` as fifth parameter and `b` as sixth.
///
/// Every parameter is one elementary motion: `a` slides along x, `alpha` turns about x, `d` slides
/// along z, `theta` turns about z, `beta` turns about y, `b` slides along y. Their order is the
/// [`Convention`]'s.
/// `beta` is meant for rows whose successive axes are (nearly) parallel, where `d` and `alpha`
/// alone would have to jump for a small tilt; elsewhere it stays 0. `b` stays 0 in every
/// Denavit-Hartenberg table. With it a row whose numbers are all near 0 reaches every small rigid
/// displacement: to first order the six are the local coordinates of a product of exponentials,
/// which have no singular arrangement of axes (Brockett 1984; Okamura & Park 1996). Such a row is
/// behind a constant origin: [`Chain::with_origins`](crate::Chain::with_origins).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// Length along the common normal, x.
    pub a_m: f64,
    /// Twist about x.
    pub alpha_rad: f64,
    /// Offset along the joint axis, z.
    pub d_m: f64,
    /// Angle about the joint axis, z.
    pub theta_rad: f64,
    /// Tilt about y (Hayati).
    pub beta_rad: f64,
    /// Length along y, of a general row.
    pub b_m: f64,
}

impl Link {
    /// The row that does nothing: all six are 0. Usable in a constant.
    pub const IDENTITY: Self = Self {
        a_m: 0.0,
        alpha_rad: 0.0,
        d_m: 0.0,
        theta_rad: 0.0,
        beta_rad: 0.0,
        b_m: 0.0,
    };

    /// The value of one parameter, in the unit of [`Parameter::unit`].
    pub const fn get(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::A => self.a_m,
            Parameter::Alpha => self.alpha_rad,
            Parameter::D => self.d_m,
            Parameter::Theta => self.theta_rad,
            Parameter::Beta => self.beta_rad,
            Parameter::B => self.b_m,
        }
    }

    /// Replaces the value of one parameter, in the unit of [`Parameter::unit`].
    ///
    /// ```
    /// use haptical_kinematics::{Link, Parameter};
    /// let mut link = Link { a_m: 0.2, ..Link::default() };
    /// link.set(Parameter::Beta, 0.01);
    /// assert_eq!((link.get(Parameter::A), link.beta_rad), (0.2, 0.01));
    /// ```
    pub const fn set(&mut self, parameter: Parameter, value: f64) {
        match parameter {
            Parameter::A => self.a_m = value,
            Parameter::Alpha => self.alpha_rad = value,
            Parameter::D => self.d_m = value,
            Parameter::Theta => self.theta_rad = value,
            Parameter::Beta => self.beta_rad = value,
            Parameter::B => self.b_m = value,
        }
    }
}

/// Names one of the six parameters of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// `a`: slide along x, in m.
    A,
    /// `alpha`: turn about x, in rad.
    Alpha,
    /// `d`: slide along z, in m.
    D,
    /// `theta`: turn about z, in rad.
    Theta,
    /// `beta`: turn about y, in rad.
    Beta,
    /// `b`: slide along y, in m.
    B,
}

impl Parameter {
    /// All six, in the order of [`Link`]'s fields.
    pub const ALL: [Self; 6] = [
        Self::A,
        Self::Alpha,
        Self::D,
        Self::Theta,
        Self::Beta,
        Self::B,
    ];

    /// The parameter's name: `a`, `alpha`, `d`, `theta`, `beta` or `b`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::Alpha => "alpha",
            Self::D => "d",
            Self::Theta => "theta",
            Self::Beta => "beta",
            Self::B => "b",
        }
    }

    /// The parameter's unit: `m` for the three slides, `rad` for the three turns.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::A | Self::B | Self::D => "m",
            Self::Alpha | Self::Theta | Self::Beta => "rad",
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}
