//! Units of numbers, with the suffix that their names end with.

/// Unit of a number, SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say the unit")]
pub enum Unit {
    One,
    Radian,
    Metre,
    Second,
    Newton,
    NewtonMetre,
    Kilogram,
    Celsius,
    Hertz,
    PerRadian,
    PerMetre,
    PerNewtonMetre,
    RadianPerSecond,
    RadianPerKelvin,
    RadianPerNewtonMetre,
    MetrePerSecond,
    MetrePerKelvin,
    MetrePerNewton,
    MetrePerSquareRadian,
    NewtonPerKelvin,
    NewtonMetrePerRadian,
    NewtonMetreSecondPerRadian,
}

/// Suffix of names and symbol; a suffix comes before those that end it.
const UNITS: [(Unit, &str, &str); 21] = [
    (
        Unit::NewtonMetreSecondPerRadian,
        "nm_s_per_rad",
        "N m s/rad",
    ),
    (Unit::NewtonMetrePerRadian, "nm_per_rad", "N m/rad"),
    (Unit::MetrePerSquareRadian, "m_per_rad2", "m/rad²"),
    // weight per length over a force: one over a length
    (Unit::PerMetre, "n_per_m_over_tension", "1/m"),
    (Unit::RadianPerKelvin, "rad_per_degc", "rad/°C"),
    (Unit::RadianPerNewtonMetre, "rad_per_nm", "rad/(N m)"),
    (Unit::RadianPerSecond, "rad_per_s", "rad/s"),
    (Unit::MetrePerKelvin, "m_per_degc", "m/°C"),
    (Unit::MetrePerSecond, "m_per_s", "m/s"),
    (Unit::MetrePerNewton, "m_per_n", "m/N"),
    (Unit::NewtonPerKelvin, "n_per_k", "N/K"),
    (Unit::PerNewtonMetre, "per_nm", "1/(N m)"),
    (Unit::PerRadian, "per_rad", "1/rad"),
    (Unit::Celsius, "degc", "°C"),
    (Unit::Hertz, "hz", "Hz"),
    (Unit::Radian, "rad", "rad"),
    (Unit::Kilogram, "kg", "kg"),
    (Unit::NewtonMetre, "nm", "N m"),
    (Unit::Metre, "m", "m"),
    (Unit::Newton, "n", "N"),
    (Unit::Second, "s", "s"),
];

impl Unit {
    /// `N m/rad`; empty for a bare number.
    pub fn symbol(self) -> &'static str {
        let mut units = UNITS.iter();
        units
            .find(|(unit, ..)| *unit == self)
            .map_or("", |(_, _, symbol)| symbol)
    }

    /// The unit that a name ends with, and what of the name comes before it.
    ///
    /// ```
    /// use haptical_effects::Unit;
    /// assert_eq!(Unit::split("stiffness_nm_per_rad"), ("stiffness", Unit::NewtonMetrePerRadian));
    /// assert_eq!(Unit::split("rad_per_s"), ("", Unit::RadianPerSecond));
    /// assert_eq!(Unit::split("counts"), ("counts", Unit::One));
    /// ```
    pub fn split(name: &str) -> (&str, Self) {
        let before = |suffix: &str| {
            let rest = name.strip_suffix(suffix)?;
            if rest.is_empty() {
                Some(rest)
            } else {
                rest.strip_suffix('_')
            }
        };
        let mut units = UNITS.iter();
        units
            .find_map(|(unit, suffix, _)| Some((before(suffix)?, *unit)))
            .unwrap_or((name, Self::One))
    }
}
