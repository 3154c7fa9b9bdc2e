//! Numbers of effects in units for people: the unit stands at the end of the parameter's name.

use haptical_report::Cell;

use crate::units::decimals;

/// Endings of names: SI unit, unit for people, how many of it make one SI unit. Longer endings of
/// the same letters come first.
const ENDINGS: [(&str, &str, &str, f64); 16] = [
    ("nm_per_rad", "N m/rad", "N m/rad", 1.0),
    ("m_per_rad2", "m/rad²", "mm/rad²", 1e3),
    ("n_per_m_over_tension", "1/m", "1/m", 1.0),
    ("rad_per_degc", "rad/°C", "µrad/°C", 1e6),
    ("rad_per_nm", "rad/(N m)", "mrad/(N m)", 1e3),
    ("rad_per_s", "rad/s", "µrad/s", 1e6),
    ("m_per_degc", "m/°C", "µm/°C", 1e6),
    ("m_per_s", "m/s", "µm/s", 1e6),
    ("m_per_n", "m/N", "µm/N", 1e6),
    ("per_nm", "1/(N m)", "1/(N m)", 1.0),
    ("per_rad", "1/rad", "1/rad", 1.0),
    ("degc", "°C", "°C", 1.0),
    ("rad", "rad", "mrad", 1e3),
    ("nm", "N m", "N m", 1.0),
    ("m", "m", "mm", 1e3),
    ("n", "N", "N", 1.0),
];

/// Lengths below this are shown in µm, others in mm \[m\].
const SMALL_M: f64 = 1e-3;
/// Angles below this are shown in µrad, others in mrad \[rad\].
const SMALL_RAD: f64 = 1e-4;
/// Durations below these are shown in µs and ms, others in s \[s\].
const SHORT_S: [f64; 2] = [1e-4, 0.1];
/// Numbers outside this range get an exponent.
const PLAIN: std::ops::Range<f64> = 1e-3..1e7;

/// A parameter's name in words and its unit for people.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Quantity {
    pub(crate) words: String,
    pub(crate) unit: &'static str,
    per_si: f64,
}

impl Quantity {
    /// From a parameter's name in the contract and its size.
    pub(crate) fn new(name: &str, size: f64) -> Self {
        let plain = |unit, per_si, rest: &str| Self {
            words: words(rest, name),
            unit,
            per_si,
        };
        if name == "phase_rad" {
            return plain("rad", 1.0, "phase");
        }
        if let Some(rest) = ending(name, "s")
            && !name.contains("_per_s")
        {
            return match size.abs() {
                _ if rest == "time" => plain("s", 1.0, rest),
                short if short < SHORT_S[0] => plain("µs", 1e6, rest),
                short if short < SHORT_S[1] => plain("ms", 1e3, rest),
                _ => plain("s", 1.0, rest),
            };
        }
        for (letters, _, unit, per_si) in ENDINGS {
            if let Some(rest) = ending(name, letters) {
                return match letters {
                    "m" if size.abs() < SMALL_M => plain("µm", 1e6, rest),
                    "rad" if size.abs() < SMALL_RAD => plain("µrad", 1e6, rest),
                    _ => plain(unit, per_si, rest),
                };
            }
        }
        plain("", 1.0, name)
    }

    /// A value as a cell, with the digits that its interval leaves.
    pub(crate) fn cell(&self, value: f64, ci95: [f64; 2]) -> Cell {
        let shown = value * self.per_si;
        if is_plain(shown) {
            Cell::number(shown, self.decimals(value, ci95))
        } else {
            Cell::scientific(shown, 3)
        }
    }

    /// The interval as a cell; missing where it has no width.
    pub(crate) fn interval(&self, value: f64, ci95: [f64; 2]) -> Cell {
        if ci95[0] == ci95[1] {
            return Cell::Missing;
        }
        let [low, high] = ci95.map(|end| end * self.per_si);
        if is_plain(value * self.per_si) {
            Cell::interval(low, high, self.decimals(value, ci95))
        } else {
            Cell::Text(format!("{low:.2e} to {high:.2e}"))
        }
    }

    /// Value, interval and unit: `258 [243, 273] N m/rad`; without an interval of no width.
    pub(crate) fn text(&self, value: f64, ci95: [f64; 2]) -> String {
        if ci95[0] == ci95[1] {
            return match self.decimals(value, ci95) {
                0 => format!("{:.0} {}", value * self.per_si, self.unit)
                    .trim_end()
                    .to_owned(),
                _ => self.short(value),
            };
        }
        let [low, high] = ci95.map(|end| end * self.per_si);
        let shown = value * self.per_si;
        let text = if is_plain(shown) {
            let digits = self.decimals(value, ci95);
            format!(
                "{shown:.digits$} [{low:.digits$}, {high:.digits$}] {}",
                self.unit
            )
        } else {
            format!("{shown:.2e} [{low:.2e}, {high:.2e}] {}", self.unit)
        };
        text.trim_end().to_owned()
    }

    /// A value alone, with three significant digits.
    pub(crate) fn short(&self, value: f64) -> String {
        let shown = value * self.per_si;
        let text = if is_plain(shown) {
            format!(
                "{shown:.*} {}",
                decimals(shown).saturating_sub(1),
                self.unit
            )
        } else {
            format!("{shown:.2e} {}", self.unit)
        };
        text.trim_end().to_owned()
    }

    /// Digits after the point that show two digits of the interval's half width.
    fn decimals(&self, value: f64, [low, high]: [f64; 2]) -> usize {
        // A hair more, so that a half of 0.1 that rounding makes 0.09999 has no digit more.
        let half = 0.5 * (high - low) * self.per_si * (1.0 + 1e-9);
        if half > 0.0 && half.is_finite() {
            (1.0 - half.log10().floor()).clamp(0.0, 7.0) as usize
        } else if (value * self.per_si).fract() == 0.0 {
            0
        } else {
            decimals(value * self.per_si)
        }
    }
}

/// A column of a log as the label of an axis, in its own unit: `torque2 [N m]`.
pub(crate) fn axis_label(column: &str) -> String {
    let seconds = ("s", "s", "s", 1.0);
    let found = ENDINGS
        .into_iter()
        .chain([seconds])
        .find_map(|(letters, unit, ..)| Some((column.strip_suffix(letters)?, unit)));
    match found.map(|(rest, unit)| (rest.strip_suffix('_'), unit)) {
        Some((Some(rest), unit)) => format!("{} [{unit}]", rest.replace('_', " ")),
        _ => column.replace('_', " "),
    }
}

/// What stands before an ending, or nothing where the name is the ending alone.
fn ending<'a>(name: &'a str, letters: &str) -> Option<&'a str> {
    let rest = name.strip_suffix(letters)?;
    if rest.is_empty() {
        Some(rest)
    } else {
        rest.strip_suffix('_')
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
    fn contract_names_have_units_for_people() {
        for (name, size, words, unit, shown) in [
            ("stiffness_nm_per_rad", 258.0, "stiffness", "N m/rad", 258.0),
            ("slip_rad", 0.002, "slip", "mrad", 2.0),
            ("width_rad", 2e-5, "width", "µrad", 20.0),
            ("delay_s", 2e-5, "delay", "µs", 20.0),
            ("time_s", 0.05, "time", "s", 0.05),
            ("delay_s", 0.002, "delay", "ms", 2.0),
            ("offset_m", 2e-4, "offset", "µm", 200.0),
            ("radius_m", 0.006, "radius", "mm", 6.0),
            ("phase_rad", 1.5, "phase", "rad", 1.5),
            ("rad_per_degc", 2e-5, "rate", "µrad/°C", 20.0),
            ("m_per_s", 2e-6, "rate", "µm/s", 2.0),
            ("rad_per_s", 2e-6, "rate", "µrad/s", 2.0),
            ("m_per_n", 2e-6, "rate", "µm/N", 2.0),
            ("creep_per_nm", 0.5, "creep", "1/(N m)", 0.5),
            ("twist_m_per_rad2", 0.001, "twist", "mm/rad²", 1.0),
            ("weight_n_per_m_over_tension", 0.5, "weight", "1/m", 0.5),
            ("counts", 12.0, "counts", "", 12.0),
            ("from_joint", 3.0, "from joint", "", 3.0),
            ("gain", 0.5, "gain", "", 0.5),
        ] {
            let quantity = Quantity::new(name, size);
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
        let stiffness = Quantity::new("stiffness_nm_per_rad", 258.04);
        assert_eq!(
            stiffness.text(258.04, [243.1, 273.2]),
            "258 [243, 273] N m/rad"
        );
        let slip = Quantity::new("slip_rad", 0.002);
        assert_eq!(slip.text(0.002, [0.0019, 0.0021]), "2.00 [1.90, 2.10] mrad");
        let order = Quantity::new("order", 2.0);
        assert_eq!(order.text(2.0, [2.0, 2.0]), "2");
        let creep = Quantity::new("creep_per_nm", 2e-5);
        assert_eq!(
            creep.text(2e-5, [1e-5, 3e-5]),
            "2.00e-5 [1.00e-5, 3.00e-5] 1/(N m)"
        );
        assert_eq!(
            Quantity::new("width_rad", 1.23456e-4).short(1.23456e-4),
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
