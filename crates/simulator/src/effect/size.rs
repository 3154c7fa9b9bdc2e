//! Numbers of effects, and the domains that they must be in.

use crate::effect::Driver;

/// A number of an effect.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) key: &'static str,
    /// None where it was left out, and of what is no number.
    pub(super) value: Option<f64>,
    pub(super) domain: Domain,
}

/// Numbers that a parameter can have, all of them finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Domain {
    Any,
    Joint,
    NotNegative,
    Positive,
    Whole,
}

impl Size {
    /// Refuses a number outside its domain.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { key, value, domain } = *self;
        let Some(value) = value else {
            return Ok(());
        };
        let (is_good, allowed) = match domain {
            Domain::Any => (true, "a finite number"),
            Domain::Joint => (value > 0.0, "the joint's number, from 1"),
            Domain::NotNegative => (value >= 0.0, "a finite number, 0 or more"),
            Domain::Positive => (value > 0.0, "a finite number above 0"),
            Domain::Whole => (value == libm::trunc(value), "a whole number of counts"),
        };
        if is_good && value.is_finite() {
            return Ok(());
        }
        Err(format!("`{key}` is {value}; {allowed} is needed"))
    }
}

/// What the value of a key is as a number.
pub(super) trait Number {
    fn number(self) -> Option<f64>;
}

impl Number for f64 {
    fn number(self) -> Option<f64> {
        Some(self)
    }
}

impl Number for Option<f64> {
    fn number(self) -> Option<f64> {
        self
    }
}

impl Number for usize {
    fn number(self) -> Option<f64> {
        Some(self as f64)
    }
}

impl Number for Driver {
    fn number(self) -> Option<f64> {
        None
    }
}
