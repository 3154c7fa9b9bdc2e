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
    KilogramMetre,
    KilogramSquareMetre,
    Celsius,
    Hertz,
    PerRadian,
    PerMetre,
    PerNewtonMetre,
    PerAmpere,
    PerSecond,
    PerKelvin,
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
    NewtonSecondPerMetre,
}

/// Suffix of names and symbol; a suffix comes before those that end it.
const UNITS: [(Unit, &str, &str); 27] = [
    (
        Unit::NewtonMetreSecondPerRadian,
        "nm_s_per_rad",
        "N m s/rad",
    ),
    (Unit::NewtonMetrePerRadian, "nm_per_rad", "N m/rad"),
    (Unit::NewtonSecondPerMetre, "n_s_per_m", "N s/m"),
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
    (Unit::PerAmpere, "per_a", "1/A"),
    (Unit::PerSecond, "per_s", "1/s"),
    (Unit::PerKelvin, "per_degc", "1/°C"),
    (Unit::Celsius, "degc", "°C"),
    (Unit::Hertz, "hz", "Hz"),
    (Unit::Radian, "rad", "rad"),
    (Unit::KilogramSquareMetre, "kgm2", "kg m²"),
    (Unit::KilogramMetre, "kg_m", "kg m"),
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

    /// The unit that a name ends with; [`Unit::One`] for a name without one.
    pub const fn by_name(name: &str) -> Self {
        let mut row = 0;
        while row < UNITS.len() {
            let (unit, suffix, _) = UNITS[row];
            if ends_with(name.as_bytes(), suffix.as_bytes()) {
                return unit;
            }
            row += 1;
        }
        Self::One
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
        let unit = Self::by_name(name);
        let mut units = UNITS.iter();
        let suffix = units.find(|(other, ..)| *other == unit);
        let before = suffix.and_then(|(_, suffix, _)| name.strip_suffix(suffix));
        let before = before.map(|before| before.strip_suffix('_').unwrap_or(before));
        (before.unwrap_or(name), unit)
    }
}

/// Whether a name is a suffix, or has it behind an underscore. A loop, because a constant is made with it.
const fn ends_with(name: &[u8], suffix: &[u8]) -> bool {
    let Some(before) = name.len().checked_sub(suffix.len()) else {
        return false;
    };
    let mut byte = 0;
    while byte < suffix.len() && name[before + byte] == suffix[byte] {
        byte += 1;
    }
    byte == suffix.len() && (before == 0 || name[before - 1] == b'_')
}
