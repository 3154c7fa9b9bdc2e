//! Values with their intervals, for what the data fix, and a refusal for what they do not.

use haptical_linalg::{Matrix, Reduction};
use serde::Serialize;

use crate::component::{Component, pooled, quantile};
use crate::{Identifiability, IdentificationError, ParameterInfo, Status};

/// How large the noise is taken to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseScale {
    /// As stated in the weights.
    Stated,
    /// The stated one times the residuals' own size, sqrt(S / (m - n)).
    Estimated,
}

/// Covariance of a fit.
#[derive(Debug, Clone)]
pub struct Uncertainty {
    /// Indices (into the reduction's columns) that the rows and columns belong to.
    pub columns: Vec<usize>,
    /// Covariance matrix.
    pub covariance: Matrix,
    /// Residuals less parameters.
    pub degrees_of_freedom: usize,
    /// Factor that the stated noise was multiplied by.
    pub noise_factor: f64,
    /// Parts of the covariance, each in proportion to one level of noise that was estimated by itself; empty where the
    /// whole is in proportion to one.
    pub components: Vec<Component>,
    /// Correlations, which exist even where the estimated noise is zero.
    correlations: Matrix,
}

/// Pivot of unit-norm columns below which a variance would be rounding: [`uncertainty`] has no
/// opinion on weak directions, which [`crate::analyse`] has judged before.
const ROUNDING_PIVOT: f64 = 1e-13;

impl Uncertainty {
    /// That of a fit without parameters, at the stated noise.
    pub fn none(residuals: usize) -> Self {
        Self {
            columns: Vec::new(),
            covariance: Matrix::zeros(0, 0),
            degrees_of_freedom: residuals,
            noise_factor: 1.0,
            components: Vec::new(),
            correlations: Matrix::zeros(0, 0),
        }
    }

    /// Standard deviation of the parameter at a position of [`Uncertainty::columns`].
    pub fn standard_deviation(&self, position: usize) -> f64 {
        self.covariance[(position, position)].sqrt()
    }

    /// Correlation of two parameters by position.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        self.correlations[(a, b)]
    }

    /// The same with a covariance that is the sum of some parts, in the order of [`Uncertainty::columns`].
    #[must_use]
    pub fn with_components(mut self, components: Vec<Component>) -> Self {
        let count = self.columns.len();
        let sum = |a: usize, b: usize| components.iter().map(|part| part.covariance[(a, b)]).sum();
        self.covariance = Matrix::from_fn(count, count, sum);
        self.correlations = correlations(&self.covariance);
        self.components = components;
        self
    }

    /// Half width of the 95 % interval in standard deviations: Student's t with the fit's degrees
    /// of freedom where the noise was estimated from the residuals, the normal value otherwise.
    pub fn half_width_95(&self, noise: NoiseScale) -> f64 {
        match noise {
            NoiseScale::Stated => quantile(f64::INFINITY),
            NoiseScale::Estimated => quantile(self.degrees_of_freedom as f64),
        }
    }

    /// The same for linear functions of the parameters.
    pub fn half_widths(&self, noise: NoiseScale) -> HalfWidths<'_> {
        HalfWidths {
            spread: self,
            noise,
            usual: self.half_width_95(noise),
        }
    }
}

/// Variance that is added to a linear function's own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Added {
    /// Variance.
    pub variance: f64,
    /// Sum of the squares of its parts over their degrees of freedom; zero where they are known.
    pub scatter: f64,
}

/// Half widths of 95 % intervals in standard deviations ([`Uncertainty::half_widths`]).
#[derive(Debug, Clone, Copy)]
pub struct HalfWidths<'u> {
    spread: &'u Uncertainty,
    noise: NoiseScale,
    usual: f64,
}

impl HalfWidths<'_> {
    /// That of a linear function of the parameters, whose variance `part` works out from a covariance of theirs, with what
    /// is added to it. Where a variance has parts, the degrees of freedom are Satterthwaite's.
    pub fn of_function(&self, part: &dyn Fn(&Matrix) -> f64, added: Added) -> f64 {
        let has_parts = !self.spread.components.is_empty();
        if !has_parts && added.scatter == 0.0 {
            return self.usual;
        }
        let (own, freedom) = match has_parts {
            true => pooled(&self.spread.components, part),
            false => (part(&self.spread.covariance), self.usual_freedom()),
        };
        let variance = own + added.variance.max(0.0);
        let scatter = own * own / freedom + added.scatter;
        match scatter > 0.0 {
            true => quantile(variance * variance / scatter),
            false => quantile(f64::INFINITY),
        }
    }

    /// That of the parameter at a position.
    pub fn of_parameter(&self, position: usize, added: Added) -> f64 {
        self.of_function(&|covariance| covariance[(position, position)], added)
    }

    fn usual_freedom(&self) -> f64 {
        match self.noise {
            NoiseScale::Stated => f64::INFINITY,
            NoiseScale::Estimated => self.spread.degrees_of_freedom as f64,
        }
    }
}

fn correlations(covariance: &Matrix) -> Matrix {
    let count = covariance.columns();
    let deviations: Vec<f64> = (0..count).map(|k| covariance[(k, k)].sqrt()).collect();
    Matrix::from_fn(count, count, |a, b| {
        if a == b {
            1.0
        } else {
            (covariance[(a, b)] / deviations[a] / deviations[b]).clamp(-1.0, 1.0)
        }
    })
}

/// Covariance of the chosen columns at a solution of cost `cost`.
///
/// # Errors
/// [`IdentificationError::RankDeficient`] where the data do not fix the columns,
/// [`IdentificationError::TooFewRows`] where noise is to be estimated without degrees of freedom and
/// [`IdentificationError::Setting`] for a cost that is negative or not finite.
pub fn uncertainty(
    reduction: &Reduction,
    columns: &[usize],
    cost: f64,
    noise: NoiseScale,
) -> Result<Uncertainty, IdentificationError> {
    let is_allowed = cost.is_finite() && cost >= 0.0;
    IdentificationError::unless(is_allowed, "cost", cost, "finite and at least 0")?;
    let mut covariance = reduction.covariance(columns, ROUNDING_PIVOT)?;
    let correlations = correlations(&covariance);
    let degrees_of_freedom = reduction.rows().saturating_sub(columns.len());
    let noise_factor = match noise {
        NoiseScale::Stated => 1.0,
        NoiseScale::Estimated if degrees_of_freedom == 0 => {
            return Err(IdentificationError::TooFewRows {
                rows: reduction.rows(),
                parameters: columns.len(),
            });
        }
        NoiseScale::Estimated => (cost / degrees_of_freedom as f64).sqrt(),
    };
    for column in 0..columns.len() {
        let scale = noise_factor * noise_factor;
        covariance
            .column_mut(column)
            .iter_mut()
            .for_each(|entry| *entry *= scale);
    }
    Ok(Uncertainty {
        columns: columns.to_vec(),
        covariance,
        degrees_of_freedom,
        noise_factor,
        components: Vec::new(),
        correlations,
    })
}

/// One parameter in a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Estimate, or none where the data do not fix it.
    pub value: Option<f64>,
    /// Standard deviation.
    pub standard_deviation: Option<f64>,
    /// 95 % interval.
    pub ci95: Option<[f64; 2]>,
    /// What the data say of it.
    #[serde(flatten)]
    pub status: Status,
}

/// Puts values, intervals and refusals together; `values` has one entry per parameter.
pub fn estimates(
    parameters: &[ParameterInfo],
    values: &[f64],
    identifiability: &Identifiability,
    uncertainty: &Uncertainty,
    noise: NoiseScale,
) -> Vec<Estimate> {
    let half_width = uncertainty.half_width_95(noise);
    parameters
        .iter()
        .zip(values)
        .zip(&identifiability.statuses)
        .enumerate()
        .map(|(index, ((parameter, &value), status))| {
            let position = uncertainty
                .columns
                .iter()
                .position(|&column| column == index);
            let deviation = position
                .filter(|_| status.is_independent())
                .map(|position| uncertainty.standard_deviation(position));
            Estimate {
                name: parameter.name.clone(),
                unit: parameter.unit.clone(),
                value: deviation.map(|_| value),
                standard_deviation: deviation,
                ci95: deviation.map(|sd| [value - half_width * sd, value + half_width * sd]),
                status: status.clone(),
            }
        })
        .collect()
}
