//! The eighteen least-squares problems of Moré, Garbow & Hillstrom (1981), ACM TOMS 7(1), 17-41, as in MINPACK's tests.
//!
//! Shared by the tests of this crate and `cargo xtask evidence`, which includes it by path.

mod algebraic;
mod exponential;
pub(crate) mod judge;
mod tables;

use std::path::Path;

use haptical_identification::{IdentificationError, Matrix, Problem};

pub(crate) use tables::{Known, Tables};

/// Writes residuals and derivatives (residuals x parameters) at a point; `observed` holds pairs x, y.
type Function =
    fn(point: &[f64], observed: &[[f64; 2]], residuals: &mut [f64], derivatives: &mut Matrix);

/// Name, function, number of residuals, standard start.
type Entry = (&'static str, Function, usize, Vec<f64>);

/// One problem of one size.
pub(crate) struct Instance {
    /// As in fixtures/mgh.
    pub(crate) name: &'static str,
    /// The standard start.
    pub(crate) start: Vec<f64>,
    residuals: usize,
    observed: Vec<[f64; 2]>,
    function: Function,
}

/// Factors of the standard start (section 2 of the paper).
pub(crate) const START_FACTORS: [f64; 3] = [1.0, 10.0, 100.0];

impl Instance {
    /// `factor` times the standard start; where that start is all zeros, a vector of `factor`s.
    pub(crate) fn start_at(&self, factor: f64) -> Vec<f64> {
        let is_zero = self.start.iter().all(|value| *value == 0.0);
        let from = |value: &f64| match is_zero && factor != 1.0 {
            true => factor,
            false => factor * value,
        };
        self.start.iter().map(from).collect()
    }
}

/// All problems in the sizes of MINPACK's tests, with what is known of them.
///
/// # Errors
/// A text that names the file that is absent or has a row that cannot be read.
pub(crate) fn read(folder: &Path) -> Result<(Vec<Instance>, Tables), String> {
    let tables = Tables::read(folder)?;
    let entries = algebraic::entries()
        .into_iter()
        .chain(exponential::entries());
    let instances = entries
        .map(|(name, function, residuals, start)| Instance {
            name,
            start,
            residuals,
            observed: tables.observed(name),
            function,
        })
        .collect();
    Ok((instances, tables))
}

impl Problem for Instance {
    fn parameter_count(&self) -> usize {
        self.start.len()
    }

    fn residual_count(&self) -> usize {
        self.residuals
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let mut all = Matrix::zeros(self.residuals, self.start.len());
        (self.function)(parameters, &self.observed, residuals, &mut all);
        if let Some((free, matrix)) = jacobian {
            for (column, &parameter) in free.iter().enumerate() {
                matrix
                    .column_mut(column)
                    .copy_from_slice(all.column(parameter));
            }
        }
        Ok(())
    }
}
