//! Parameters that the data fix only together with others, and what they fix of them.

use serde::Serialize;

use crate::ParameterFit;
use crate::fit::considered::Held;

/// A sum of parameters that the data fix, where they do not fix its first one alone.
///
/// The fit holds the other parameters at the device's values. If they are off by d, the fitted one is off by G d
/// ([`crate::Considered`]); the sum of the fitted one and -G times the others is not. The fitted parameter's own
/// interval counts the plausible errors of the others, this one does not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Combination {
    /// Position of the fitted parameter within the candidates.
    #[serde(skip)]
    pub parameter: usize,
    /// The fitted parameter with coefficient 1, then the held ones.
    pub terms: Vec<Summand>,
    /// SI unit of the sum, which is that of the fitted parameter.
    pub unit: String,
    /// Value of the sum.
    pub value: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// One parameter of a [`Combination`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summand {
    /// Name of the parameter.
    pub name: String,
    /// Its factor, in the unit of the sum over its own.
    pub coefficient: f64,
}

/// Share of a parameter's variance by noise from which on a held parameter is named in its combination.
const NAMED: f64 = 0.01;

impl ParameterFit {
    /// The combinations that are fixed where a single parameter is not: those whose held parameters may move the
    /// fitted one by more than the noise does.
    pub fn combinations(&self) -> Vec<Combination> {
        let half_widths = self.uncertainty.half_widths(self.noise);
        let considered = &self.considered;
        // what an earlier step held moves what it fitted, by about as much the other way: they are not taken apart
        let is_own = |parameter| self.parameters.contains(parameter);
        let each = considered.held.iter().zip(&considered.parameters);
        let is_held: Vec<bool> = each
            .map(|(held, parameter)| *held != Held::Fitted && is_own(parameter))
            .collect();
        let rows = self.fitted.iter().enumerate();
        let combined = rows.filter_map(|(row, &index)| {
            let estimate = &self.estimates[index];
            let (value, sd) = (estimate.value?, estimate.standard_deviation?);
            let by_noise = self.uncertainty.covariance[(row, row)];
            let beyond = considered.beyond_first_order.get(row).copied();
            if considered.leaked(row, &is_held) <= by_noise {
                return None;
            }
            let moved_by = |&k: &usize| {
                considered.sensitivity[(row, k)].powi(2) * considered.covariance[(k, k)]
            };
            let named: Vec<bool> = (0..is_held.len())
                .map(|k| is_held[k] && moved_by(&k) > NAMED * by_noise)
                .collect();
            let mut terms = vec![Summand {
                name: estimate.name.clone(),
                coefficient: 1.0,
            }];
            let mut value = value;
            for (k, parameter) in considered.parameters.iter().enumerate() {
                if named[k] {
                    let coefficient = -considered.sensitivity[(row, k)];
                    value += coefficient * parameter.value(&self.device);
                    terms.push(Summand {
                        name: parameter.name(&self.device),
                        coefficient,
                    });
                }
            }
            let rest: Vec<bool> = named.iter().map(|named| !named).collect();
            let variance = by_noise + beyond.unwrap_or(0.0) + considered.leaked(row, &rest);
            let deviation = variance.min(sd * sd).sqrt();
            let added = considered.added(row, deviation * deviation - by_noise);
            let reach = half_widths.of_parameter(row, added) * deviation;
            Some(Combination {
                parameter: index,
                terms,
                unit: estimate.unit.clone(),
                value,
                standard_deviation: deviation,
                ci95: [value - reach, value + reach],
            })
        });
        combined.collect()
    }
}
