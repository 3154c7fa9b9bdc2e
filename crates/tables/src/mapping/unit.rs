//! Units of tables, and what the name of a log's column measures.

use std::f64::consts::{PI, TAU};

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Angles, in a log \[rad\].
    Angle,
    /// Lengths \[m\].
    Length,
    /// Times \[s\].
    Time,
    /// Torques \[N m\].
    Torque,
    /// Forces \[N\].
    Force,
    /// Temperatures \[°C\].
    Temperature,
    /// Angular velocities \[rad/s\].
    AngularVelocity,
    /// Velocities \[m/s\].
    Velocity,
}

/// A unit: `factor * number + zero` is in a log's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub dimension: Dimension,
    /// The unit in a log's unit.
    pub factor: f64,
    /// Its zero in a log's unit.
    pub zero: f64,
}

impl Unit {
    /// The unit of a word, in capitals as well; none that is not known. `nm` is none: it may be nanometres or newton metres.
    ///
    /// ```
    /// use haptical_tables::{Dimension, Unit};
    ///
    /// let inch = Unit::parse("in").unwrap();
    /// assert_eq!((inch.dimension, inch.factor), (Dimension::Length, 0.0254));
    /// assert!(Unit::parse("nm").is_none());
    /// ```
    pub fn parse(word: &str) -> Option<Self> {
        use Dimension::{
            Angle, AngularVelocity, Force, Length, Temperature, Time, Torque, Velocity,
        };
        let degree = PI / 180.0;
        let word = word.trim_end_matches('.');
        let (dimension, factor) = match word {
            "rad" | "radian" | "radians" => (Angle, 1.0),
            "mrad" => (Angle, 1e-3),
            "urad" | "µrad" => (Angle, 1e-6),
            "deg" | "degs" | "degree" | "degrees" | "°" | "º" => (Angle, degree),
            "arcmin" => (Angle, degree / 60.0),
            "arcsec" => (Angle, degree / 3600.0),
            "turn" | "turns" | "rev" => (Angle, TAU),
            "m" | "metre" | "metres" | "meter" | "meters" => (Length, 1.0),
            "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => (Length, 1e-2),
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => (Length, 1e-3),
            "um" | "µm" | "μm" | "micrometre" | "micrometres" | "micrometer" | "micrometers" => {
                (Length, 1e-6)
            }
            "in" | "inch" | "inches" | "zoll" => (Length, 0.0254),
            "ft" => (Length, 0.3048),
            "s" | "sec" | "secs" | "second" | "seconds" => (Time, 1.0),
            "ms" | "msec" | "millisecond" | "milliseconds" => (Time, 1e-3),
            "us" | "µs" | "μs" | "usec" | "microsecond" | "microseconds" => (Time, 1e-6),
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => (Time, 1e-9),
            "min" => (Time, 60.0),
            "Nm" | "N m" | "N.m" | "N·m" | "N*m" => (Torque, 1.0),
            "mNm" => (Torque, 1e-3),
            "kNm" => (Torque, 1e3),
            "Ncm" => (Torque, 1e-2),
            "N" => (Force, 1.0),
            "mN" => (Force, 1e-3),
            "kN" => (Force, 1e3),
            "degC" | "°C" | "C" => (Temperature, 1.0),
            "K" => {
                return Some(Self {
                    dimension: Temperature,
                    factor: 1.0,
                    zero: -273.15,
                });
            }
            "degF" | "°F" => {
                return Some(Self {
                    dimension: Temperature,
                    factor: 5.0 / 9.0,
                    zero: -160.0 / 9.0,
                });
            }
            "rad/s" => (AngularVelocity, 1.0),
            "deg/s" | "°/s" => (AngularVelocity, degree),
            "rpm" => (AngularVelocity, TAU / 60.0),
            "m/s" => (Velocity, 1.0),
            "mm/s" => (Velocity, 1e-3),
            // `Deg`, `MM`, `Millimeters`: no two units here differ in their capitals alone
            _ => {
                let small = word.to_lowercase();
                return (small != word).then(|| Self::parse(&small)).flatten();
            }
        };
        Some(Self {
            dimension,
            factor,
            zero: 0.0,
        })
    }
}

/// What a column of a log measures, by the unit at its name's end; none of others.
pub fn dimension_of(log: &str) -> Option<Dimension> {
    const ENDS: [(&str, Dimension); 8] = [
        ("_rad_per_s", Dimension::AngularVelocity),
        ("_m_per_s", Dimension::Velocity),
        ("_rad", Dimension::Angle),
        ("_m", Dimension::Length),
        ("_s", Dimension::Time),
        ("_nm", Dimension::Torque),
        ("_n", Dimension::Force),
        ("_degc", Dimension::Temperature),
    ];
    ENDS.iter()
        .find(|(end, _)| log.ends_with(end))
        .map(|(_, dimension)| *dimension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_their_sizes() {
        let size = |word: &str, number: f64| {
            let unit = Unit::parse(word).unwrap();
            unit.factor * number + unit.zero
        };
        let cases = [
            ("deg", 180.0, PI),
            ("arcsec", 3600.0 * 180.0, PI),
            ("mm", 25.4, 0.0254),
            ("in", 1.0, 0.0254),
            ("ns", 1e9, 1.0),
            ("K", 293.15, 20.0),
            ("degF", 68.0, 20.0),
            ("rpm", 60.0, TAU),
        ];
        for (word, number, wanted) in cases {
            assert!(
                (size(word, number) - wanted).abs() < 1e-12 * wanted.abs(),
                "{word}"
            );
        }
    }

    #[test]
    fn a_name_s_end_says_what_it_measures() {
        assert_eq!(
            dimension_of("velocity1_rad_per_s"),
            Some(Dimension::AngularVelocity)
        );
        assert_eq!(dimension_of("theta3_m"), Some(Dimension::Length));
        assert_eq!(dimension_of("torque1_nm"), Some(Dimension::Torque));
        assert_eq!(dimension_of("qw"), None);
    }
}
