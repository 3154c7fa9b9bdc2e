//! Observability indices O1 to O5 of a set of poses.

use haptical_linalg::{Reduction, singular_values};
use serde::Serialize;

use crate::{IdentificationError, ParameterInfo};

/// Observability indices from the singular values s_1 >= ... >= s_L of the derivative matrix whose
/// columns are scaled by the parameters' plausible sizes; larger is better for each.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Observability {
    /// (s_1 ... s_L)^(1/L) / sqrt(m), m measurements (Borm & Menq 1991).
    pub o1: f64,
    /// s_L / s_1, the inverse condition number (Driels & Pathre 1990).
    pub o2: f64,
    /// s_L (Nahvi, Hollerbach & Hayward 1994).
    pub o3: f64,
    /// s_L^2 / s_1, the noise amplification index (Nahvi & Hollerbach 1996).
    pub o4: f64,
    /// 1 / (1/s_1 + ... + 1/s_L) (Sun & Hollerbach 2008).
    pub o5: f64,
}

impl Observability {
    pub(crate) fn new(
        reduction: &Reduction,
        columns: &[usize],
        parameters: &[ParameterInfo],
    ) -> Result<Option<Self>, IdentificationError> {
        let values = singular_values(&plausible_scaling(reduction, columns, parameters)?)?;
        Ok(Self::from_singular_values(&values, reduction.rows()))
    }

    /// The indices of given singular values (largest first) for `rows` measurements; none unless
    /// all values are finite, positive and in that order.
    ///
    /// ```
    /// use haptical_identification::Observability;
    /// let index = Observability::from_singular_values(&[4.0, 1.0], 4).unwrap();
    /// assert_eq!((index.o1, index.o2, index.o3, index.o4, index.o5), (1.0, 0.25, 1.0, 0.25, 0.8));
    /// ```
    pub fn from_singular_values(values: &[f64], rows: usize) -> Option<Self> {
        let (&largest, &smallest) = (values.first()?, values.last()?);
        let sound = values.iter().all(|value| value.is_finite() && *value > 0.0)
            && values.windows(2).all(|pair| pair[0] >= pair[1]);
        if !sound || rows == 0 {
            return None;
        }
        let logarithms: f64 = values.iter().map(|value| value.ln()).sum();
        Some(Self {
            o1: (logarithms / values.len() as f64).exp() / (rows as f64).sqrt(),
            o2: smallest / largest,
            o3: smallest,
            o4: smallest / largest * smallest,
            o5: 1.0 / values.iter().map(|value| 1.0 / value).sum::<f64>(),
        })
    }
}

/// Columns of a reduction's chosen factor scaled by plausible sizes instead of unit norms.
fn plausible_scaling(
    reduction: &Reduction,
    columns: &[usize],
    parameters: &[ParameterInfo],
) -> Result<haptical_linalg::Matrix, IdentificationError> {
    let sizes: Vec<f64> = columns
        .iter()
        .map(|&column| reduction.column_norms()[column] * parameters[column].plausible_size)
        .collect();
    Ok(reduction.scaled_factor(columns, &sizes)?)
}
