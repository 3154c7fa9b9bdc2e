//! Where the truth lies in the intervals of a fit.

use anyhow::Result;
use haptical_calibration::ParameterFit;
use haptical_model::{Device, TransmissionError};
use xtask_paper::chebyshev;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A parameter that the data fix alone.
    Alone,
    /// A parameter that they fix only in a combination.
    Member,
    Combination,
}

impl Kind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Alone => "parameter fixed alone",
            Self::Member => "parameter fixed only in a combination",
            Self::Combination => "combination",
        }
    }
}

pub(super) struct Interval {
    /// Name of the parameter, or of the first of a combination.
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Middle less truth over half the width.
    pub(super) error_over_half_width: f64,
    /// In the parameter's unit.
    pub(super) half_width: f64,
}

impl Interval {
    pub(super) fn label(&self) -> String {
        match self.kind {
            Kind::Alone => self.name.clone(),
            Kind::Member => format!("{} in a combination", self.name),
            Kind::Combination => format!("combination of {}", self.name),
        }
    }
}

/// How many intervals of one quantity hold the truth.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Held {
    pub(super) held: usize,
    pub(super) all: usize,
}

impl Held {
    pub(super) fn count(&mut self, held: bool) {
        self.held += usize::from(held);
        self.all += 1;
    }

    pub(super) fn percent(self) -> f64 {
        100.0 * self.held as f64 / self.all as f64
    }

    /// Whether as many devices as a fifth have it: a quantity of a handful proves nothing either way.
    pub(super) fn is_often(self, devices: usize) -> bool {
        5 * self.all >= devices
    }
}

/// Every interval of a fit, parameters first.
pub(super) fn intervals(fit: &ParameterFit, truth: &Device) -> Result<Vec<Interval>> {
    let truth = &in_the_form_of(truth, &fit.device)?;
    let miss =
        |[low, high]: [f64; 2], actual: f64| ((low + high) / 2.0 - actual) / ((high - low) / 2.0);
    let combinations = fit.combinations();
    let mut found = Vec::new();
    for (index, (parameter, estimate)) in fit.parameters.iter().zip(&fit.estimates).enumerate() {
        if let Some(ci95) = estimate.ci95 {
            let is_member = combinations.iter().any(|sum| sum.parameter == index);
            found.push(Interval {
                name: estimate.name.clone(),
                kind: if is_member { Kind::Member } else { Kind::Alone },
                error_over_half_width: miss(ci95, parameter.value(truth)),
                half_width: (ci95[1] - ci95[0]) / 2.0,
            });
        }
    }
    for sum in combinations {
        let mut actual = 0.0;
        for term in &sum.terms {
            actual += term.coefficient * truth.parameter(&term.name)?.value(truth);
        }
        found.push(Interval {
            name: sum.terms[0].name.clone(),
            kind: Kind::Combination,
            error_over_half_width: miss(sum.ci95, actual),
            half_width: (sum.ci95[1] - sum.ci95[0]) / 2.0,
        });
    }
    Ok(found)
}

/// The truth with its polynomials on the ranges of the fit's, of which they are other coefficients.
fn in_the_form_of(truth: &Device, fitted: &Device) -> Result<Device> {
    let mut truth = truth.clone();
    for (joint, own) in fitted.joints.iter().enumerate() {
        let TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } = &own.transmission_error
        else {
            continue;
        };
        let actual = &truth.joints[joint];
        let count = actual.error_parameter_count();
        let error = |reading| Ok(actual.evaluate_error(reading, &mut vec![0.0; count])?.0);
        let coefficients = chebyshev(*range_rad, coefficients.len(), error)?;
        truth.joints[joint].transmission_error = TransmissionError::Chebyshev {
            range_rad: *range_rad,
            coefficients,
        };
    }
    Ok(truth)
}
