//! Units in which numbers are shown to people, and days as dates.

use haptical_report::Cell;

/// A unit for tables and axes: its name and how many of it make one SI unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Name.
    pub name: &'static str,
    /// How many make one SI unit.
    pub per_si: f64,
}

impl Shown {
    /// For residuals.
    pub fn fine(unit: &str) -> Self {
        match unit {
            "m" => Self::new("µm", 1e6),
            "N m" => Self::new("N m", 1.0),
            "N" => Self::new("N", 1.0),
            _ => Self::coarse(unit),
        }
    }

    /// For parameters.
    pub fn coarse(unit: &str) -> Self {
        match unit {
            "m" => Self::new("mm", 1e3),
            "rad" => Self::new("mrad", 1e3),
            _ => Self::new("", 1.0),
        }
    }

    /// For what a person measures with a ruler and a protractor.
    pub fn for_people(unit: &str) -> Self {
        match unit {
            "rad" => Self::new("°", 180.0 / std::f64::consts::PI),
            _ => Self::coarse(unit),
        }
    }

    fn new(name: &'static str, per_si: f64) -> Self {
        Self { name, per_si }
    }

    /// A value as a cell with four significant digits.
    pub fn cell(self, value: f64) -> Cell {
        let shown = value * self.per_si;
        Cell::number(shown, decimals(shown))
    }

    /// A value with four significant digits and the unit's name.
    pub fn text(self, value: f64) -> String {
        let shown = value * self.per_si;
        format!("{shown:.*} {}", decimals(shown), self.name)
    }
}

/// Digits after the point that show four significant ones, at most seven.
pub fn decimals(value: f64) -> usize {
    if value == 0.0 || !value.is_finite() {
        return 1;
    }
    (3.0 - value.abs().log10().floor()).clamp(0.0, 7.0) as usize
}
