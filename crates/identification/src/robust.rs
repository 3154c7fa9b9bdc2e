//! Fits that gross outliers do not move: reweighted least squares, with the noise's size from the residuals.

use haptical_linalg::Matrix;

use crate::{Fit, IdentificationError, Loss, Problem, Settings, robust_scale, solve};

/// The outcome of a robust fit.
#[derive(Debug, Clone)]
pub struct RobustFit {
    /// The last reweighted fit: residuals and reduction are those of the weighted rows.
    pub fit: Fit,
    /// Standard deviation of the good residuals, in the problem's own scale (1 if its weights are right).
    pub scale: f64,
    /// Weight of each residual, 0 to 1.
    pub weights: Vec<f64>,
    /// Variances are those of the weighted rows at noise `scale`, times this ([`Loss::variance_factor`]).
    pub variance_factor: f64,
    /// Reweightings until the weights stood still.
    pub rounds: usize,
    /// Whether they did within the limit.
    pub settled: bool,
}

/// Reweightings of Huber's loss before a redescending one, and of the loss itself.
const ROUNDS: usize = 50;
/// Change of a weight's root that is too small to matter: a thousandth of a residual.
const SETTLED: f64 = 1e-3;

/// Minimises sum rho(r / scale) over `free`, the scale being the median size of the residuals (MAD) in each
/// round. A redescending loss begins where Huber's ended.
///
/// Half of the residuals may be anything, as long as those rows do not carry the geometry alone (a row that
/// fixes a parameter by itself is fitted, whatever it says).
///
/// # Errors
/// As [`solve`], and [`IdentificationError::Evaluation`] for a [`crate::TriangleProblem`].
///
/// # Examples
/// ```
/// use haptical_identification::{IdentificationError, Loss, Matrix, Problem, Settings, solve_robust};
/// /// A constant and ten readings of it, two of them wild.
/// struct Constant([f64; 10]);
/// impl Problem for Constant {
///     fn parameter_count(&self) -> usize { 1 }
///     fn residual_count(&self) -> usize { 10 }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<(&[usize], &mut Matrix)>)
///         -> Result<(), IdentificationError> {
///         for (residual, reading) in residuals.iter_mut().zip(self.0) { *residual = p[0] - reading; }
///         if let Some((_, matrix)) = jacobian { matrix.column_mut(0).fill(1.0); }
///         Ok(())
///     }
/// }
/// let readings = Constant([2.01, 1.99, 2.02, 1.98, 2.0, 2.01, 1.99, 2.0, 90.0, 70.0]);
/// let robust = solve_robust(&readings, &[0.0], &[0], &Settings::default(), Loss::Tukey)?;
/// assert!((robust.fit.parameters[0] - 2.0).abs() < 0.01);
/// assert_eq!(robust.weights[8..], [0.0, 0.0]);
/// # Ok::<(), IdentificationError>(())
/// ```
pub fn solve_robust<P: Problem + ?Sized>(
    problem: &P,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
    loss: Loss,
) -> Result<RobustFit, IdentificationError> {
    if problem.as_triangle().is_some() {
        let reason = "a robust loss needs every residual by itself, not a triangle".to_owned();
        return Err(IdentificationError::Evaluation { reason });
    }
    let mut state = State {
        weighted: Weighted {
            problem,
            roots: vec![1.0; problem.residual_count()],
        },
        values: start.to_vec(),
        rounds: 0,
    };
    let mut residuals = vec![0.0; problem.residual_count()];
    if loss.is_redescending() {
        state.settle(Loss::Huber, free, settings, &mut residuals)?;
    }
    let (fit, settled) = state.settle(loss, free, settings, &mut residuals)?;
    let scale = robust_scale(&residuals, free.len() as f64);
    let sizes: Vec<f64> = sizes(&residuals, scale).collect();
    Ok(RobustFit {
        weights: state
            .weighted
            .roots
            .iter()
            .map(|root| root * root)
            .collect(),
        variance_factor: loss.variance_factor(&sizes)?,
        fit,
        scale,
        rounds: state.rounds,
        settled,
    })
}

struct State<'p, P: ?Sized> {
    weighted: Weighted<'p, P>,
    values: Vec<f64>,
    rounds: usize,
}

impl<P: Problem + ?Sized> State<'_, P> {
    /// Reweights and fits until the weights stand still; `residuals` are left unweighted.
    fn settle(
        &mut self,
        loss: Loss,
        free: &[usize],
        settings: &Settings,
        residuals: &mut [f64],
    ) -> Result<(Fit, bool), IdentificationError> {
        let mut round = 0;
        loop {
            let fit = solve(&self.weighted, &self.values, free, settings)?;
            self.values.clone_from(&fit.parameters);
            self.rounds += 1;
            round += 1;
            self.weighted
                .problem
                .evaluate(&self.values, residuals, None)?;
            let scale = robust_scale(residuals, free.len() as f64);
            let mut change: f64 = 0.0;
            let roots = self.weighted.roots.iter_mut();
            for (root, size) in roots.zip(sizes(residuals, scale)) {
                let wanted = loss.weight(size).sqrt();
                change = change.max((wanted - *root).abs());
                *root = wanted;
            }
            if change < SETTLED || round == ROUNDS {
                return Ok((fit, change < SETTLED));
            }
        }
    }
}

/// Residuals in standard deviations; more than half of them zero is an exact fit of those.
fn sizes(residuals: &[f64], scale: f64) -> impl Iterator<Item = f64> {
    residuals.iter().map(move |&residual| {
        if residual == 0.0 {
            0.0
        } else {
            residual / scale.max(f64::MIN_POSITIVE)
        }
    })
}

/// A problem whose residuals count less, row by row.
struct Weighted<'p, P: ?Sized> {
    problem: &'p P,
    /// Roots of the weights.
    roots: Vec<f64>,
}

impl<P: Problem + ?Sized> Problem for Weighted<'_, P> {
    fn parameter_count(&self) -> usize {
        self.problem.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.problem.residual_count()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let Some((free, matrix)) = jacobian else {
            self.problem.evaluate(parameters, residuals, None)?;
            scale_rows(residuals, &self.roots);
            return Ok(());
        };
        self.problem
            .evaluate(parameters, residuals, Some((free, &mut *matrix)))?;
        scale_rows(residuals, &self.roots);
        for column in 0..matrix.columns() {
            scale_rows(matrix.column_mut(column), &self.roots);
        }
        Ok(())
    }
}

fn scale_rows(values: &mut [f64], roots: &[f64]) {
    for (value, root) in values.iter_mut().zip(roots) {
        *value *= root;
    }
}
