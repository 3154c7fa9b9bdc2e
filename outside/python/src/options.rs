//! Keyword arguments of `identify` as options of a calibration; names and defaults are the command's.

use std::collections::BTreeMap;
use std::path::Path;

use haptical::Identify;
use haptical::calibration::{CalibrationMethod, Degree, HeldOut, LossChoice, Options, Weighting};
use haptical::files::Source;
use haptical::identification::Loss;
use pyo3::prelude::*;

use crate::failure::Failure;

/// Highest degree of a polynomial, as the command has it.
const HIGHEST_DEGREE: usize = 24;
/// Degrees that the evidence chooses from.
const CHOSEN_DEGREE: usize = 14;

/// Numbers of folds, as the command has them.
const FOLDS: std::ops::RangeInclusive<usize> = 2..=100;
/// The one effect that the base model of `diagnose` can have besides.
const COMPLIANCE: &str = haptical::effects::structure::JOINT_COMPLIANCE.name;

/// Whether what is to be fitted is named by a gap.json.
fn is_gap(word: &str) -> bool {
    word.to_ascii_lowercase().ends_with(".json")
}

/// Options of `identify`: all but device and log.
#[derive(Debug)]
pub(crate) struct Keywords<'k, 'py> {
    pub(crate) method: &'k str,
    pub(crate) held_out: f64,
    pub(crate) folds: Option<&'k Bound<'py, PyAny>>,
    pub(crate) with: &'k [String],
    pub(crate) hold: &'k [String],
    pub(crate) deviation: &'k BTreeMap<String, f64>,
    pub(crate) degree: Option<&'k Bound<'py, PyAny>>,
    pub(crate) noise: &'k str,
    pub(crate) loss: &'k str,
}

impl Keywords<'_, '_> {
    pub(crate) fn request(&self) -> Result<Identify, Failure> {
        let method = match self.method {
            "joint" => CalibrationMethod::Joint,
            "two-step" => CalibrationMethod::TwoStep,
            other => return Err(unknown("method", other, "joint, two-step")),
        };
        let weighting = match self.noise {
            "estimated" => Weighting::Estimated,
            "stated" => Weighting::Stated,
            other => return Err(unknown("noise", other, "estimated, stated")),
        };
        if !(0.0..=0.5).contains(&self.held_out) {
            let text = format!(
                "held_out is {}; a share from 0 to 0.5 is expected",
                self.held_out
            );
            return Err(Failure::value(text));
        }
        let options = Options {
            method,
            degree: self.degree()?,
            weighting,
            loss: loss_of(self.loss)?,
            held_out: match self.folds()? {
                Some(folds) => HeldOut::Folds(folds),
                None if self.held_out > 0.0 => HeldOut::Share(self.held_out),
                None => HeldOut::None,
            },
            ..Options::default()
        };
        Ok(Identify {
            options,
            with: self
                .with
                .iter()
                .filter(|word| !is_gap(word))
                .cloned()
                .collect(),
            with_causes: (self.with.iter().find(|word| is_gap(word)))
                .map(|word| Source::given(Path::new(word))),
            hold: self.hold.to_vec(),
            deviations: deviations_of(self.deviation)?,
        })
    }

    fn folds(&self) -> Result<Option<usize>, Failure> {
        let Some(folds) = self.folds else {
            return Ok(None);
        };
        match folds.extract::<usize>() {
            Ok(count) if FOLDS.contains(&count) => Ok(Some(count)),
            _ => Err(Failure::value(format!(
                "folds is {folds}; a whole number from {} to {} is expected",
                FOLDS.start(),
                FOLDS.end()
            ))),
        }
    }

    fn degree(&self) -> Result<Degree, Failure> {
        let Some(degree) = self.degree else {
            return Ok(Degree::UpTo(CHOSEN_DEGREE));
        };
        if degree
            .extract::<String>()
            .is_ok_and(|word| word == "evidence")
        {
            return Ok(Degree::UpTo(CHOSEN_DEGREE));
        }
        match degree.extract::<usize>() {
            Ok(degree) if (1..=HIGHEST_DEGREE).contains(&degree) => Ok(Degree::Fixed(degree)),
            _ => Err(Failure::value(format!(
                "degree is {degree}; a whole number from 1 to {HIGHEST_DEGREE}, or \"evidence\", is expected"
            ))),
        }
    }
}

/// Whether what joints yield to their torque is fitted too.
pub(crate) fn fits_compliance(with: &[String]) -> Result<bool, Failure> {
    match with.iter().find(|effect| *effect != COMPLIANCE) {
        Some(other) => Err(unknown("with_", other, COMPLIANCE)),
        None => Ok(!with.is_empty()),
    }
}

/// What large residuals cost.
pub(crate) fn loss_of(word: &str) -> Result<LossChoice, Failure> {
    Ok(match word {
        "auto" => LossChoice::Auto,
        "squares" => LossChoice::Fixed(Loss::Squares),
        "huber" => LossChoice::Fixed(Loss::Huber),
        "cauchy" => LossChoice::Fixed(Loss::Cauchy),
        "tukey" => LossChoice::Fixed(Loss::Tukey),
        "student-t" => LossChoice::Fixed(Loss::StudentT),
        other => {
            let known = "auto, squares, huber, cauchy, tukey, student-t";
            return Err(unknown("loss", other, known));
        }
    })
}

/// How far numbers of links may plausibly be off \[m\] or \[rad\].
pub(crate) fn deviations_of(sizes: &BTreeMap<String, f64>) -> Result<Vec<(String, f64)>, Failure> {
    let size = |(word, &size): (&String, &f64)| {
        if size > 0.0 && size.is_finite() {
            Ok((word.clone(), size))
        } else {
            Err(Failure::value(format!(
                "deviation[\"{word}\"] is {size}; a size above 0 in m or rad is expected"
            )))
        }
    };
    sizes.iter().map(size).collect()
}

/// A word that a keyword does not know.
pub(crate) fn unknown(keyword: &str, found: &str, known: &str) -> Failure {
    Failure::value(format!(
        "{keyword} is \"{found}\"; one of these is expected: {known}"
    ))
}
