//! A parameter of a report, and the verdict of the data on it.

use serde::Serialize;

/// What a report needs to know of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterInfo {
    /// Short name, as in the paper's tables: `alpha4`, `ratio_deviation2`.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Size that a deviation of this parameter may plausibly have, in its unit.
    pub plausible_size: f64,
}

/// One term of a combination.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Term {
    /// Index of the parameter.
    pub parameter: usize,
    /// Name of the parameter.
    pub name: String,
    /// Change of that parameter which acts like a unit change of the dependent one.
    pub coefficient: f64,
}

/// What the data say of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
pub enum Status {
    /// The data fix it.
    Identifiable {
        /// Standard deviation for the stated noise.
        standard_deviation: f64,
    },
    /// Independent, but fixed no better than its plausible size.
    Weak {
        /// Standard deviation for the stated noise.
        standard_deviation: f64,
    },
    /// It has no effect on any measurement.
    Invisible,
    /// Its effect is a combination of others' effects.
    Dependent {
        /// The combination.
        combination: Vec<Term>,
    },
}

impl Status {
    /// Whether the parameter can be estimated (identifiable or weak).
    pub fn is_independent(&self) -> bool {
        matches!(self, Self::Identifiable { .. } | Self::Weak { .. })
    }

    /// Its name in result files: "identifiable", "weak", "invisible" or "dependent".
    pub fn name(&self) -> &'static str {
        match self {
            Self::Identifiable { .. } => "identifiable",
            Self::Weak { .. } => "weak",
            Self::Invisible => "invisible",
            Self::Dependent { .. } => "dependent",
        }
    }

    /// Standard deviation for the stated noise, in the parameter's unit; none for a parameter that is not independent.
    pub fn standard_deviation(&self) -> Option<f64> {
        match self {
            Self::Identifiable { standard_deviation } | Self::Weak { standard_deviation } => {
                Some(*standard_deviation)
            }
            Self::Invisible | Self::Dependent { .. } => None,
        }
    }
}

impl ParameterInfo {
    /// A parameter by name, unit and plausible size.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, plausible_size: f64) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            plausible_size,
        }
    }
}
