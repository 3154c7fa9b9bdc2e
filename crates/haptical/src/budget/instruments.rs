//! The file of instruments: certificates, what they are known to, and which readings they act on.

use std::path::Path;

use chrono::{NaiveDate, Utc};
use haptical_metrics::budget::{Distribution, Input};
use serde::{Deserialize, Serialize};

use crate::error::Error;

/// The file of instruments.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instruments {
    /// `[[instrument]]`.
    #[serde(default)]
    pub instrument: Vec<Instrument>,
}

/// An instrument.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    /// Name, as in the laboratory's list.
    pub name: String,
    /// Number of its certificate.
    #[serde(default)]
    pub certificate: Option<String>,
    /// Date of the certificate, year-month-day.
    #[serde(default)]
    pub date: Option<String>,
    /// Date of the next calibration, year-month-day.
    #[serde(default)]
    pub due: Option<String>,
    /// Readings that it makes: `out2`, `cable`, `position` while the device is calibrated, `theta3` while it is used.
    pub acts_on: String,
    /// How it is off.
    #[serde(rename = "as")]
    pub acts_as: ActsAs,
    /// From its certificate.
    #[serde(default)]
    pub calibration: Option<Known>,
    /// Since its certificate.
    #[serde(default)]
    pub drift: Option<Known>,
    /// Anything else, such as the temperature at which it is used.
    #[serde(default)]
    pub conditions: Option<Known>,
}

/// How an instrument is off: by the same amount in every reading, or by the same share of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActsAs {
    /// The same amount, in the unit of the reading.
    Offset,
    /// The same share of the reading.
    Scale,
}

/// What is known of how far an instrument is off.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Standard uncertainty.
    #[serde(default)]
    pub standard: Option<f64>,
    /// Expanded uncertainty; with `k`.
    #[serde(default)]
    pub expanded: Option<f64>,
    /// Coverage factor of the expanded uncertainty, the divisor.
    #[serde(default)]
    pub k: Option<f64>,
    /// Half width of a limit; with `distribution`.
    #[serde(default)]
    pub half_width: Option<f64>,
    /// Distribution within the limit.
    #[serde(default)]
    pub distribution: Option<Shape>,
    /// Degrees of freedom; infinitely many unless stated.
    #[serde(default)]
    pub degrees_of_freedom: Option<f64>,
}

/// Distribution within a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Equally likely everywhere; divisor sqrt(3).
    Rectangular,
    /// Divisor sqrt(6).
    Triangular,
    /// U-shaped; divisor sqrt(2).
    Arcsine,
}

impl Instruments {
    /// Reads the text of a file of instruments.
    ///
    /// # Errors
    /// What is wrong, with the line.
    pub fn from_toml(text: &str, file: &Path) -> Result<Self, Error> {
        let read: Self = toml::from_str(text).map_err(|error| {
            let before = error
                .span()
                .map_or("", |span| text.get(..span.start).unwrap_or(""));
            let line = before.matches('\n').count() as u64 + 1;
            let what = error.message().trim().replace('\n', "; ");
            let next = "docs/guides/uncertainty-budget.md shows such a file";
            Error::log_line("instruments", what, file, Some(line), next)
        })?;
        for own in &read.instrument {
            own.check_dates(file)?;
            let parts = own.parts();
            if parts.is_empty() {
                let what = format!("`{}` has no calibration, drift or conditions", own.name);
                let next = "say how far it may be off";
                return Err(Error::in_file("instruments", what, file, next));
            }
            for (part, known) in parts {
                known.input().map_err(|why| {
                    let what = format!("{part} of `{}`: {why}", own.name);
                    let next = "give `standard`, or `expanded` with `k`, or `half_width` with `distribution`";
                    Error::in_file("instruments", what, file, next)
                })?;
            }
        }
        Ok(read)
    }

    /// What is said of certificates that are past their day.
    pub(super) fn overdue(&self) -> Vec<String> {
        let today = Utc::now().date_naive();
        let all = self.instrument.iter();
        all.filter_map(|own| own.overdue(today)).collect()
    }
}

/// The day of a text as 2026-02-03; none of another.
fn day(text: &str) -> Option<NaiveDate> {
    let day = NaiveDate::parse_from_str(text, "%Y-%m-%d").ok()?;
    (day.to_string() == text).then_some(day)
}

impl Instrument {
    fn check_dates(&self, file: &Path) -> Result<(), Error> {
        let refuse = |said: String| Error::of_file("instruments", said, file);
        let name = &self.name;
        for (key, text) in [("date", &self.date), ("due", &self.due)] {
            if let Some(text) = text.as_ref().filter(|text| day(text).is_none()) {
                return Err(refuse(format!(
                    "`{key}` of `{name}` is `{text}`, which is no day; write year-month-day, as 2026-02-03"
                )));
            }
        }
        let day_of = |text: &Option<String>| day(text.as_deref()?);
        if let (Some(date), Some(due)) = (day_of(&self.date), day_of(&self.due))
            && due < date
        {
            return Err(refuse(format!(
                "`{name}` was due before the date of its certificate; correct `date` or `due`"
            )));
        }
        Ok(())
    }

    /// Said of a certificate whose day of the next calibration is over.
    fn overdue(&self, today: NaiveDate) -> Option<String> {
        let due = self.due.as_deref()?;
        (day(due)? < today).then(|| {
            format!(
                "`{}` was due for calibration on {due}: what its certificate says may no longer hold",
                self.name
            )
        })
    }

    /// What is known of it, with the names in the file.
    pub(super) fn parts(&self) -> Vec<(&'static str, Known)> {
        let parts = [
            ("calibration", self.calibration),
            ("drift", self.drift),
            ("conditions", self.conditions),
        ];
        let parts = parts.into_iter();
        let known = parts.filter_map(|(name, known)| Some((name, known?)));
        known.collect()
    }
}

impl Known {
    /// As an input of a budget.
    pub(super) fn input(&self) -> Result<Input, &'static str> {
        let distribution = match (
            self.standard,
            self.expanded,
            self.k,
            self.half_width,
            self.distribution,
        ) {
            (Some(standard_uncertainty), None, None, None, None) => Distribution::Normal {
                standard_uncertainty,
            },
            (None, Some(expanded), Some(k), None, None) if k > 0.0 => Distribution::Normal {
                standard_uncertainty: expanded / k,
            },
            (None, None, None, Some(half_width), Some(shape)) => match shape {
                Shape::Rectangular => Distribution::Rectangular { half_width },
                Shape::Triangular => Distribution::Triangular { half_width },
                Shape::Arcsine => Distribution::Arcsine { half_width },
            },
            _ => return Err("not one of the three ways to say how far it may be off"),
        };
        let degrees = self.degrees_of_freedom.unwrap_or(f64::INFINITY);
        let input = Input::new(distribution, degrees);
        let size = input.standard_uncertainty();
        match size.is_finite() && size > 0.0 && degrees > 0.0 {
            true => Ok(input),
            false => Err("uncertainties and degrees of freedom are above 0"),
        }
    }

    /// In words: the kind of its distribution.
    pub(super) fn words(&self) -> &'static str {
        match self.distribution {
            None => "normal",
            Some(Shape::Rectangular) => "rectangular",
            Some(Shape::Triangular) => "triangular",
            Some(Shape::Arcsine) => "arcsine",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_written_year_month_day() {
        assert_eq!(day("2026-02-03"), NaiveDate::from_ymd_opt(2026, 2, 3));
        for text in [
            "2026-2-3",
            "2026- 2- 3",
            "03.02.2026",
            "2026-13-01",
            "2026-02-00",
            "2026-02-29",
            "soon",
        ] {
            assert_eq!(day(text), None, "{text}");
        }
    }

    #[test]
    fn a_certificate_past_its_day_is_said_and_one_that_ended_before_it_began_is_refused() {
        let text = |date: &str, due: &str| {
            format!(
                "[[instrument]]\nname = \"laser\"\ndate = \"{date}\"\ndue = \"{due}\"\nacts_on = \"position\"\nas = \"scale\"\n\
                 drift = {{ standard = 1e-5 }}\n"
            )
        };
        let read = |date, due| Instruments::from_toml(&text(date, due), Path::new("i.toml"));
        let own = read("2026-02-03", "2027-02-03")
            .unwrap()
            .instrument
            .remove(0);
        let due = NaiveDate::from_ymd_opt(2027, 2, 3).unwrap();
        assert_eq!(own.overdue(due), None);
        assert!(own.overdue(due.succ_opt().unwrap()).is_some());
        assert!(read("2027-02-03", "2026-02-03").is_err());
        assert!(read("yesterday", "2026-02-03").is_err());
    }
}
