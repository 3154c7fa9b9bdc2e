//! Small problems given as functions, and reductions of given matrices.

use haptical_identification::{
    Identifiability, IdentifiabilityRules, IdentificationError, Matrix, ParameterInfo, Problem,
    Reduction, analyse,
};

/// Residuals and derivatives (row by row) of a point.
pub(crate) type Evaluation = (Vec<f64>, Vec<Vec<f64>>);

/// A problem whose evaluation is a closure.
pub(crate) struct Closure<F> {
    pub(crate) parameters: usize,
    pub(crate) rows: usize,
    pub(crate) evaluate: F,
}

impl<F: Fn(&[f64]) -> Result<Evaluation, IdentificationError>> Problem for Closure<F> {
    fn parameter_count(&self) -> usize {
        self.parameters
    }

    fn residual_count(&self) -> usize {
        self.rows
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let (values, slopes) = (self.evaluate)(parameters)?;
        residuals.copy_from_slice(&values);
        if let Some((free, matrix)) = jacobian {
            for (row, slopes) in slopes.iter().enumerate() {
                for (column, &parameter) in free.iter().enumerate() {
                    matrix[(row, column)] = slopes[parameter];
                }
            }
        }
        Ok(())
    }
}

/// y = a exp(-b t) + c, residuals divided by `sigma`; parameters a, b, c.
pub(crate) fn decay(
    t: &[f64],
    y: &[f64],
    sigma: f64,
) -> Closure<impl Fn(&[f64]) -> Result<Evaluation, IdentificationError>> {
    let data: Vec<(f64, f64)> = t.iter().copied().zip(y.iter().copied()).collect();
    Closure {
        parameters: 3,
        rows: t.len(),
        evaluate: move |p: &[f64]| {
            Ok(data
                .iter()
                .map(|(t, y)| {
                    let fall = (-p[1] * t).exp();
                    let slopes = vec![fall / sigma, -p[0] * t * fall / sigma, 1.0 / sigma];
                    ((p[0] * fall + p[2] - y) / sigma, slopes)
                })
                .unzip())
        },
    }
}

pub(crate) fn named(sizes: &[f64]) -> Vec<ParameterInfo> {
    sizes
        .iter()
        .enumerate()
        .map(|(index, &size)| ParameterInfo::new(format!("p{index}"), "1", size))
        .collect()
}

pub(crate) fn reduce(matrix: &Matrix) -> Reduction {
    Reduction::new(matrix, &vec![0.0; matrix.rows()]).unwrap()
}

/// The analysis with default rules.
pub(crate) fn judge(matrix: &Matrix, sizes: &[f64], order: &[usize]) -> Identifiability {
    let rules = IdentifiabilityRules::default();
    analyse(&reduce(matrix), &named(sizes), order, &rules).unwrap()
}

/// That many cases, and an end to shrinking: filtered strategies could go on for minutes.
pub(crate) fn cases(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases,
        max_shrink_iters: 500,
        ..proptest::test_runner::Config::default()
    }
}
