//! Parameters that a fit took as given although they are uncertain, and what that does to the fitted ones.

use haptical_identification::{
    Estimate, Identifiability, IdentificationError, Matrix, NoiseScale, Reduction, Status,
    Uncertainty,
};
use haptical_model::{Device, ParameterId};

/// Parameters that a fit held and that are not known exactly: "consider" parameters.
///
/// With d their errors of covariance S, the fitted ones err by G d besides the noise, G = -(J^T J)^-1 J^T J_d, so
/// the covariance of their errors is C + G S G^T (Tapley, Schutz & Born, *Statistical Orbit Determination*, 2004,
/// section 6.4). Held are parameters that the data fix worse than their plausible size, which S takes for their
/// deviation, and in two steps the transmissions, with the covariance of step 1.
#[derive(Debug, Clone)]
pub struct Considered {
    /// The parameters.
    pub parameters: Vec<ParameterId>,
    /// S, in their units.
    pub covariance: Matrix,
    /// G: change of each fitted parameter (row) with a unit error of each considered one (column).
    pub sensitivity: Matrix,
    /// Fall of the sum of squared weighted residuals that the linearised problem promises if the weak parameters
    /// were fitted too: large where one of them deviates by far more than is plausible.
    pub promised_fall: f64,
}

impl Considered {
    /// None at all.
    pub(crate) fn none(fitted: usize) -> Self {
        Self {
            parameters: Vec::new(),
            covariance: Matrix::zeros(0, 0),
            sensitivity: Matrix::zeros(fitted, 0),
            promised_fall: 0.0,
        }
    }

    /// The weak parameters of a fit, each with its plausible size for a standard deviation.
    pub(crate) fn weak(
        device: &Device,
        parameters: &[ParameterId],
        judged: &Identifiability,
        reduction: &Reduction,
        fitted: &[usize],
    ) -> Result<Self, IdentificationError> {
        let weak: Vec<usize> = (0..parameters.len())
            .filter(|index| matches!(judged.statuses[*index], Status::Weak { .. }))
            .filter(|index| !fitted.contains(index))
            .collect();
        if weak.is_empty() {
            return Ok(Self::none(fitted.len()));
        }
        let (sensitivity, _) = sensitivity(reduction, fitted, &weak)?;
        let both = [fitted, &weak].concat();
        let promised = reduction.solve(&both, 0.0, SMALLEST_PIVOT)?;
        let size = |index: usize| parameters[index].plausible_size(device);
        Ok(Self {
            parameters: weak.iter().map(|&index| parameters[index]).collect(),
            covariance: Matrix::from_fn(weak.len(), weak.len(), |a, b| {
                if a == b { size(weak[a]).powi(2) } else { 0.0 }
            }),
            sensitivity,
            promised_fall: promised.explained_square,
        })
    }

    /// These and others.
    pub(crate) fn with(&self, other: &Self) -> Self {
        let (first, second) = (self.parameters.len(), other.parameters.len());
        let covariance = Matrix::from_fn(first + second, first + second, |a, b| {
            match (a.checked_sub(first), b.checked_sub(first)) {
                (None, None) => self.covariance[(a, b)],
                (Some(a), Some(b)) => other.covariance[(a, b)],
                _ => 0.0,
            }
        });
        let sensitivity = Matrix::from_fn(
            self.sensitivity.rows(),
            first + second,
            |row, column| match column.checked_sub(first) {
                None => self.sensitivity[(row, column)],
                Some(column) => other.sensitivity[(row, column)],
            },
        );
        Self {
            parameters: [self.parameters.clone(), other.parameters.clone()].concat(),
            covariance,
            sensitivity,
            promised_fall: self.promised_fall,
        }
    }

    /// S g, per considered parameter, for a row g of G.
    fn spread(&self, fitted: usize) -> Vec<f64> {
        let count = self.parameters.len();
        (0..count)
            .map(|a| {
                (0..count)
                    .map(|b| self.covariance[(a, b)] * self.sensitivity[(fitted, b)])
                    .sum()
            })
            .collect()
    }

    /// Covariance of the errors of the fitted parameters and then the considered ones.
    pub(crate) fn whole(&self, noise: &Matrix) -> Matrix {
        let fitted = noise.rows();
        let count = fitted + self.parameters.len();
        let spreads: Vec<Vec<f64>> = (0..fitted).map(|row| self.spread(row)).collect();
        Matrix::from_fn(count, count, |a, b| {
            match (a.checked_sub(fitted), b.checked_sub(fitted)) {
                (None, None) => {
                    let terms = spreads[a].iter().enumerate();
                    let leaked = terms.map(|(k, spread)| spread * self.sensitivity[(b, k)]);
                    noise[(a, b)] + leaked.sum::<f64>()
                }
                (None, Some(b)) => spreads[a][b],
                (Some(a), None) => spreads[b][a],
                (Some(a), Some(b)) => self.covariance[(a, b)],
            }
        })
    }

    /// Widens the intervals of the fitted parameters, positions within the candidates given.
    pub(crate) fn widen(
        &self,
        estimates: &mut [Estimate],
        fitted: &[usize],
        uncertainty: &Uncertainty,
        noise: NoiseScale,
    ) {
        let half_width = uncertainty.half_width_95(noise);
        for (row, &index) in fitted.iter().enumerate() {
            let spread = self.spread(row);
            let terms = spread.iter().enumerate();
            let leaked: f64 = terms
                .map(|(k, spread)| spread * self.sensitivity[(row, k)])
                .sum();
            let estimate = &mut estimates[index];
            if let (Some(value), Some(sd)) = (estimate.value, &mut estimate.standard_deviation) {
                *sd = (uncertainty.covariance[(row, row)] + leaked.max(0.0)).sqrt();
                estimate.ci95 = Some([value - half_width * *sd, value + half_width * *sd]);
            }
        }
    }
}

/// G for the columns `held`, and what the columns `fitted` cannot make up of each of them.
pub(crate) fn sensitivity(
    reduction: &Reduction,
    fitted: &[usize],
    held: &[usize],
) -> Result<(Matrix, Vec<Vec<f64>>), IdentificationError> {
    let norms = reduction.column_norms();
    let of = |columns: &[usize]| {
        let own: Vec<f64> = columns.iter().map(|&column| norms[column]).collect();
        reduction.scaled_factor(columns, &own)
    };
    let free = of(fitted)?;
    let others = of(held)?;
    let columns: Vec<usize> = (0..fitted.len()).collect();
    let mut sensitivity = Matrix::zeros(fitted.len(), held.len());
    let mut rests = Vec::with_capacity(held.len());
    for column in 0..held.len() {
        let whole = others.column(column);
        let step = Reduction::new(&free, whole)?.solve(&columns, 0.0, SMALLEST_PIVOT)?;
        let made_up = free.times(&step.values)?;
        rests.push(
            whole
                .iter()
                .zip(made_up)
                .map(|(have, made)| have - made)
                .collect(),
        );
        for (row, change) in step.values.iter().enumerate() {
            sensitivity[(row, column)] = -change;
        }
    }
    Ok((sensitivity, rests))
}

/// Relative pivot below which a direction of the fitted parameters is rounding.
const SMALLEST_PIVOT: f64 = 1e-13;
