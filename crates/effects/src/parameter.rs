//! Numbers of an effect, as they are reported.

use crate::Unit;

/// What a parameter says of its effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// How large the effect is.
    Size,
    /// How large one over the effect is: a stiffness.
    Inverse,
    /// Where in a period it is.
    Phase,
    /// When it happened.
    Instant,
    /// How many periods a turn or a second has, or which joint drives it.
    Number,
    /// The travel over which it turns over.
    Transition,
}

/// A number that a law has beside those that are reported: with them it is whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Further {
    /// Name, which ends with its unit.
    pub name: &'static str,
    /// What it is where nobody says; none where it must be said.
    pub default: Option<f64>,
}

impl Further {
    /// A number that has a usual value.
    pub const fn usually(name: &'static str, default: f64) -> Self {
        Self {
            name,
            default: Some(default),
        }
    }

    /// A number that must be said.
    pub const fn needed(name: &'static str) -> Self {
        Self {
            name,
            default: None,
        }
    }
}

/// A number of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, which ends with its unit.
    pub name: &'static str,
    /// Unit.
    pub unit: Unit,
    /// What it says.
    pub role: Role,
    /// Smallest and largest magnitude that a sound device can show; outside the effect is called implausible.
    pub plausible: [f64; 2],
    /// Whether the largest magnitude is meant at the motor: at the joint it is larger by the ratio.
    pub times_ratio: bool,
}

impl Parameter {
    /// A size from `low` to `high`, in the unit that its name ends with.
    pub const fn size(name: &'static str, low: f64, high: f64) -> Self {
        Self {
            name,
            unit: Unit::by_name(name),
            role: Role::Size,
            plausible: [low, high],
            times_ratio: false,
        }
    }

    /// A number of a law as it is reported, and back: of a compliance the stiffness.
    pub(crate) fn turned(&self, number: f64) -> f64 {
        match self.role {
            Role::Inverse => 1.0 / number,
            _ => number,
        }
    }

    /// A stiffness and the like.
    pub const fn inverse(name: &'static str, low: f64, high: f64) -> Self {
        Self {
            role: Role::Inverse,
            ..Self::size(name, low, high)
        }
    }

    /// An angle within a period.
    pub const fn phase() -> Self {
        Self {
            role: Role::Phase,
            ..Self::size("phase_rad", 0.0, 10.0)
        }
    }

    /// An instant of the recording.
    pub const fn instant() -> Self {
        Self {
            role: Role::Instant,
            ..Self::size("time_s", 0.0, f64::MAX)
        }
    }

    /// A count of periods, a frequency, or the number of a joint.
    pub const fn number(name: &'static str, high: f64) -> Self {
        Self {
            role: Role::Number,
            ..Self::size(name, 0.0, high)
        }
    }

    /// A travel of a loop.
    pub const fn transition(name: &'static str, high: f64) -> Self {
        Self {
            role: Role::Transition,
            ..Self::size(name, 0.0, high)
        }
    }

    /// The same with a largest magnitude at the motor.
    pub const fn times_ratio(self) -> Self {
        Self {
            times_ratio: true,
            ..self
        }
    }

    /// Whether it is a size, not a place.
    pub const fn is_size(&self) -> bool {
        matches!(self.role, Role::Size | Role::Inverse)
    }

    /// Whether a magnitude is one that a sound device can show at a joint with this transmission ratio.
    pub fn is_plausible(&self, value: f64, ratio: f64) -> bool {
        let [low, high] = self.plausible;
        let high = if self.times_ratio {
            high * ratio.abs().max(1.0)
        } else {
            high
        };
        (low..=high).contains(&value.abs())
    }
}
