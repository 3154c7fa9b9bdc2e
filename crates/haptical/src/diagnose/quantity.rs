//! Numbers of effects in units for people.

use haptical_effects::{Role, Unit, parameter};
use haptical_report::earned_decimals;

use crate::units::decimals;

/// Lengths below this are shown in µm, others in mm \[m\].
const SMALL_M: f64 = 1e-3;
/// Angles below this are shown in µrad, others in mrad \[rad\].
const SMALL_RAD: f64 = 1e-4;
/// Durations below these are shown in µs and ms, others in s \[s\].
const SHORT_S: [f64; 2] = [1e-4, 0.1];
/// Speeds below this are shown in µrad/s, others in rad/s \[rad/s\].
const SLOW_RAD_PER_S: f64 = 1e-3;
/// Numbers outside this range get an exponent.
const PLAIN: std::ops::Range<f64> = 1e-3..1e7;

/// A parameter's name in words and its unit for people.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Quantity {
    pub(crate) words: String,
    unit: &'static str,
    per_si: f64,
}

impl Quantity {
    /// Of an effect's parameter with its size. A number of the base model has the unit that its name ends with.
    pub(crate) fn new(effect: &str, name: &str, size: f64) -> Self {
        let (rest, by_name) = Unit::split(name);
        let (unit, role) = match parameter(effect, name) {
            Some(parameter) => (parameter.unit, parameter.role),
            None => (by_name, Role::Size),
        };
        let (unit, per_si) = match role {
            Role::Phase | Role::Instant => (unit.symbol(), 1.0),
            _ => for_people(unit, size),
        };
        Self {
            words: words(rest, name),
            unit,
            per_si,
        }
    }

    /// Of a number of the base model by its unit, `m`, `rad` or another one, with its size.
    pub(crate) fn of_unit(unit: &str, size: f64) -> Self {
        let (_, unit) = Unit::split(&format!("number_{unit}"));
        let (unit, per_si) = for_people(unit, size);
        Self {
            words: String::new(),
            unit,
            per_si,
        }
    }

    /// Value, interval and unit: `258 [243, 273] N m/rad`; without an interval of no width.
    pub(crate) fn text(&self, value: f64, ci95: [f64; 2]) -> String {
        let digits = self.decimals(value, ci95);
        let [low, high] = ci95.map(|end| end * self.per_si);
        let shown = value * self.per_si;
        if ci95[0] == ci95[1] {
            return match digits {
                0 => self.with_unit(format!("{shown:.0}")),
                _ => self.short(value),
            };
        }
        self.with_unit(if is_plain(shown) {
            format!("{shown:.digits$} [{low:.digits$}, {high:.digits$}]")
        } else {
            format!("{shown:.2e} [{low:.2e}, {high:.2e}]")
        })
    }

    /// A value alone, with three significant digits.
    pub(crate) fn short(&self, value: f64) -> String {
        let shown = value * self.per_si;
        self.with_unit(if is_plain(shown) {
            format!("{shown:.*}", decimals(shown).saturating_sub(1))
        } else {
            format!("{shown:.2e}")
        })
    }

    fn with_unit(&self, mut text: String) -> String {
        if !self.unit.is_empty() {
            text = text + " " + self.unit;
        }
        text
    }

    /// Digits after the point that show two digits of the interval's half width.
    fn decimals(&self, value: f64, [low, high]: [f64; 2]) -> usize {
        if let Some(earned) = earned_decimals(0.5 * (high - low) * self.per_si) {
            earned
        } else if (value * self.per_si).fract() == 0.0 {
            0
        } else {
            decimals(value * self.per_si)
        }
    }
}

/// Unit for people, and how many of it make one SI unit.
fn for_people(unit: Unit, size: f64) -> (&'static str, f64) {
    let size = size.abs();
    match unit {
        Unit::Metre if size < SMALL_M => ("µm", 1e6),
        Unit::Metre => ("mm", 1e3),
        Unit::Radian if size < SMALL_RAD => ("µrad", 1e6),
        Unit::Radian => ("mrad", 1e3),
        Unit::Second if size < SHORT_S[0] => ("µs", 1e6),
        Unit::Second if size < SHORT_S[1] => ("ms", 1e3),
        Unit::MetrePerSquareRadian => ("mm/rad²", 1e3),
        Unit::RadianPerKelvin => ("µrad/°C", 1e6),
        Unit::RadianPerNewtonMetre => ("mrad/(N m)", 1e3),
        Unit::RadianPerSecond if size < SLOW_RAD_PER_S => ("µrad/s", 1e6),
        Unit::MetrePerKelvin => ("µm/°C", 1e6),
        Unit::MetrePerSecond => ("µm/s", 1e6),
        Unit::MetrePerNewton => ("µm/N", 1e6),
        plain => (plain.symbol(), 1.0),
    }
}

/// A column of a log as the label of an axis, in its own unit: `torque2 [N m]`.
pub(crate) fn axis_label(column: &str) -> String {
    match Unit::split(column) {
        (_, Unit::One) | ("", _) => column.replace('_', " "),
        (rest, unit) => format!("{} [{}]", rest.replace('_', " "), unit.symbol()),
    }
}

fn words(rest: &str, name: &str) -> String {
    if rest.is_empty() {
        let rate = name.contains("_per_");
        return if rate { "rate" } else { "size" }.to_owned();
    }
    rest.replace('_', " ")
}

fn is_plain(shown: f64) -> bool {
    shown == 0.0 || PLAIN.contains(&shown.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_units_for_people() {
        for (effect, name, size, words, unit, shown) in [
            (
                "capstan-compliance",
                "stiffness_nm_per_rad",
                258.0,
                "stiffness",
                "N m/rad",
                258.0,
            ),
            ("capstan-slip", "slip_rad", 0.002, "slip", "mrad", 2.0),
            ("backlash", "width_rad", 2e-5, "width", "µrad", 20.0),
            ("cable-latency", "delay_s", 2e-5, "delay", "µs", 20.0),
            ("capstan-slip", "time_s", 0.05, "time", "s", 0.05),
            ("cable-latency", "delay_s", 0.002, "delay", "ms", 2.0),
            ("cable-zero-offset", "offset_m", 2e-4, "offset", "µm", 200.0),
            (
                "cable-exit-geometry",
                "radius_m",
                0.006,
                "radius",
                "mm",
                6.0,
            ),
            ("drum-out-of-round", "phase_rad", 1.5, "phase", "rad", 1.5),
            ("joint-drift", "rad_per_degc", 2e-5, "rate", "µrad/°C", 20.0),
            ("cable-drift", "m_per_s", 2e-6, "rate", "µm/s", 2.0),
            ("joint-drift", "rad_per_s", 2e-6, "rate", "µrad/s", 2.0),
            (
                "speed-saturation",
                "limit_rad_per_s",
                2.03,
                "limit",
                "rad/s",
                2.03,
            ),
            ("tool-compliance", "m_per_n", 2e-6, "rate", "µm/N", 2.0),
            (
                "capstan-creep",
                "creep_per_nm",
                0.5,
                "creep",
                "1/(N m)",
                0.5,
            ),
            (
                "cable-twist",
                "twist_m_per_rad2",
                0.001,
                "twist",
                "mm/rad²",
                1.0,
            ),
            (
                "cable-sag",
                "weight_n_per_m_over_tension",
                0.5,
                "weight",
                "1/m",
                0.5,
            ),
            ("cable-count-loss", "counts", 12.0, "counts", "", 12.0),
            ("cross-coupling", "from_joint", 3.0, "from joint", "", 3.0),
            ("cross-coupling", "gain", 0.5, "gain", "", 0.5),
            (
                "joint-friction",
                "viscous_nm_s_per_rad",
                0.5,
                "viscous",
                "N m s/rad",
                0.5,
            ),
            ("joint-offset", "home_rad", 0.5, "home", "mrad", 500.0),
        ] {
            let quantity = Quantity::new(effect, name, size);
            assert_eq!(
                (quantity.words.as_str(), quantity.unit),
                (words, unit),
                "{name}"
            );
            assert!((size * quantity.per_si - shown).abs() < 1e-12, "{name}");
        }
    }

    #[test]
    fn the_interval_decides_the_digits() {
        let stiffness = Quantity::new("capstan-compliance", "stiffness_nm_per_rad", 258.04);
        assert_eq!(
            stiffness.text(258.04, [243.1, 273.2]),
            "258 [243, 273] N m/rad"
        );
        let slip = Quantity::new("capstan-slip", "slip_rad", 0.002);
        assert_eq!(slip.text(0.002, [0.0019, 0.0021]), "2.00 [1.90, 2.10] mrad");
        let order = Quantity::new("axis-wobble", "order", 2.0);
        assert_eq!(order.text(2.0, [2.0, 2.0]), "2");
        let creep = Quantity::new("capstan-creep", "creep_per_nm", 2e-5);
        assert_eq!(
            creep.text(2e-5, [1e-5, 3e-5]),
            "2.00e-5 [1.00e-5, 3.00e-5] 1/(N m)"
        );
        assert_eq!(
            Quantity::new("backlash", "width_rad", 1.23456e-4).short(1.23456e-4),
            "0.123 mrad"
        );
    }

    #[test]
    fn columns_become_labels() {
        assert_eq!(axis_label("torque2_nm"), "torque2 [N m]");
        assert_eq!(axis_label("theta4_rad"), "theta4 [rad]");
        assert_eq!(axis_label("speed2_rad_per_s"), "speed2 [rad/s]");
        assert_eq!(axis_label("t_s"), "t [s]");
        assert_eq!(axis_label("temp_degc"), "temp [°C]");
        assert_eq!(axis_label("cable_m"), "cable [m]");
        assert_eq!(axis_label("row"), "row");
        assert_eq!(axis_label("columns"), "columns");
    }
}
