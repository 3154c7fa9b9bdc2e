//! Parameters that a fit took as given although they are uncertain, and what that does to the fitted ones.

use haptical_identification::{
    Added, Component, Estimate, HeldEffect, Identifiability, IdentificationError, Matrix,
    NoiseScale, Reduction, Status, Uncertainty,
};
use haptical_linalg::{OrthonormalBasis, SparseColumns};
use haptical_model::{Device, ParameterId};

/// Parameters that a fit held and that are not known exactly: "consider" parameters.
///
/// With d their errors of second moment S, the fitted ones err by G d besides the noise, G = -(J^T J)^-1 J^T J_d, so
/// the mean square of their errors is C + G S G^T (Tapley, Schutz & Born, *Statistical Orbit Determination*, 2004,
/// section 6.4). What a fit holds is known to its plausible size P, and to what the residuals say of it: with
/// A = J_d - J (J^T J)^-1 J^T J_d, M = (P^-2 + A^T A)^-1 and m = -M A^T r, S = M + m m^T. A dependent parameter has
/// A = 0 and so S = P^2. In two steps the transmissions are held too, with the errors of step 1.
/// Source: docs/equations.md, Covariance and intervals.
#[derive(Debug, Clone)]
pub struct Considered {
    /// The parameters.
    pub parameters: Vec<ParameterId>,
    /// Why each is held.
    pub held: Vec<Held>,
    /// S, in their units.
    pub covariance: Matrix,
    /// G: change of each fitted parameter (row) with a unit error of each considered one (column).
    pub sensitivity: Matrix,
    /// Mean square of each fitted parameter's error beyond the first order in those of the held ones; empty until
    /// [`crate::with_curvature`] has looked.
    pub beyond_first_order: Vec<f64>,
    /// Variance of each fitted parameter by the scale of logged torques, to which compliances are in proportion; empty where
    /// there is none.
    pub by_torque_scale: Vec<f64>,
    /// Parts of the covariance of what an earlier step fitted, with their degrees of freedom; empty where they are many.
    pub known_parts: Vec<Component>,
    /// Fall of the sum of squared weighted residuals that the linearised problem promises if the weak parameters
    /// were fitted too: large where one of them deviates by far more than is plausible.
    pub promised_fall: f64,
}

/// The reason for which a fit holds a parameter that is not known exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The data fix it no better than it is plausibly large.
    Weak,
    /// Its effect is that of others, which are fitted in its place.
    Dependent,
    /// The samples support a form without it.
    Unsupported,
    /// It was judged fit to be free only after the last search.
    Late,
    /// An earlier step fitted it.
    Fitted,
    /// It is the scale of an instrument, which no residual shows.
    Scale,
    /// It is a length that stands for the device's size, which touches do not show.
    Size,
}

impl Considered {
    /// None at all.
    pub(crate) fn none(fitted: usize) -> Self {
        Self {
            parameters: Vec::new(),
            held: Vec::new(),
            covariance: Matrix::zeros(0, 0),
            sensitivity: Matrix::zeros(fitted, 0),
            beyond_first_order: Vec::new(),
            by_torque_scale: Vec::new(),
            known_parts: Vec::new(),
            promised_fall: 0.0,
        }
    }

    /// What a fit held of its candidates, those that no reading sees excepted. `unsupported` are positions within
    /// the candidates, `noise_factor` the noise over the stated one.
    pub(crate) fn of_fit(
        (device, parameters): (&Device, &[ParameterId]),
        judged: &Identifiability,
        reduction: &Reduction,
        (fitted, unsupported): (&[usize], &[usize]),
        noise_factor: f64,
    ) -> Result<Self, IdentificationError> {
        let reason = |index: usize| match &judged.statuses[index] {
            Status::Invisible => None,
            _ if fitted.contains(&index) => None,
            _ if unsupported.contains(&index) => Some((index, Held::Unsupported)),
            Status::Dependent { .. } => Some((index, Held::Dependent)),
            Status::Weak { .. } => Some((index, Held::Weak)),
            Status::Identifiable { .. } => Some((index, Held::Late)),
        };
        let (columns, held): (Vec<usize>, Vec<Held>) =
            (0..parameters.len()).filter_map(reason).unzip();
        if columns.is_empty() {
            return Ok(Self::none(fitted.len()));
        }
        let sizes: Vec<f64> = columns
            .iter()
            .map(|&index| parameters[index].plausible_size(device))
            .collect();
        if let Some(sensitivity) = by_combinations(judged, fitted, &columns) {
            let count = columns.len();
            return Ok(Self {
                parameters: columns.iter().map(|&index| parameters[index]).collect(),
                held,
                covariance: Matrix::from_fn(count, count, |a, b| {
                    if a == b { sizes[a].powi(2) } else { 0.0 }
                }),
                sensitivity,
                beyond_first_order: Vec::new(),
                by_torque_scale: Vec::new(),
                known_parts: Vec::new(),
                promised_fall: 0.0,
            });
        }
        let (sensitivity, rests) = sensitivity(reduction, fitted, &columns)?;
        let of_weak = columns.iter().zip(&held);
        let weak = of_weak.filter_map(|(&index, held)| (*held == Held::Weak).then_some(index));
        let both: Vec<usize> = fitted.iter().copied().chain(weak).collect();
        let promised_fall = match both.len() > fitted.len() {
            true => {
                reduction
                    .solve(&both, 0.0, SMALLEST_PIVOT)?
                    .explained_square
            }
            false => 0.0,
        };
        Ok(Self {
            parameters: columns.iter().map(|&index| parameters[index]).collect(),
            covariance: second_moment(&rests, reduction.projected(), &sizes, noise_factor)?,
            held,
            sensitivity,
            beyond_first_order: Vec::new(),
            by_torque_scale: Vec::new(),
            known_parts: Vec::new(),
            promised_fall,
        })
    }

    /// The same for a fit whose rows are weighted otherwise, or whose noise has memory.
    pub(crate) fn reweighed(&self, device: &Device, effect: &HeldEffect) -> Self {
        let count = self.parameters.len();
        let open: Vec<usize> = (0..count)
            .filter(|&k| !matches!(self.held[k], Held::Fitted | Held::Size))
            .collect();
        let sizes: Vec<f64> = open
            .iter()
            .map(|&k| match self.held[k] {
                Held::Scale => scale_sd(device, self.parameters[k]),
                _ => self.parameters[k].plausible_size(device),
            })
            .collect();
        let mut covariance = self.covariance.clone();
        if let Some(moment) = effect.second_moment(&open, &sizes) {
            for (row, &a) in open.iter().enumerate() {
                for (column, &b) in open.iter().enumerate() {
                    covariance[(a, b)] = moment[(row, column)];
                }
            }
        }
        Self {
            covariance,
            sensitivity: effect.sensitivity.clone(),
            ..self.clone()
        }
    }

    /// Covariance of what an earlier step fitted; zero for the others.
    pub(crate) fn known(&self) -> Matrix {
        let count = self.parameters.len();
        let is_known = |k: usize| self.held[k] == Held::Fitted;
        Matrix::from_fn(count, count, |a, b| match is_known(a) && is_known(b) {
            true => self.covariance[(a, b)],
            false => 0.0,
        })
    }

    /// The reason for which a parameter is held; none for one that is not.
    pub fn reason(&self, parameter: ParameterId) -> Option<Held> {
        let own = self.parameters.iter().position(|held| *held == parameter)?;
        self.held.get(own).copied()
    }

    /// The held weak parameters.
    pub fn weak(&self) -> impl Iterator<Item = ParameterId> {
        let each = self.parameters.iter().zip(&self.held);
        each.filter_map(|(parameter, held)| (*held == Held::Weak).then_some(*parameter))
    }

    /// Some of them.
    pub(crate) fn select(&self, kept: &[usize]) -> Self {
        let count = kept.len();
        Self {
            parameters: kept.iter().map(|&k| self.parameters[k]).collect(),
            held: kept.iter().map(|&k| self.held[k]).collect(),
            covariance: Matrix::from_fn(count, count, |a, b| self.covariance[(kept[a], kept[b])]),
            sensitivity: Matrix::from_fn(self.sensitivity.rows(), count, |row, column| {
                self.sensitivity[(row, kept[column])]
            }),
            beyond_first_order: Vec::new(),
            by_torque_scale: Vec::new(),
            known_parts: Vec::new(),
            promised_fall: self.promised_fall,
        }
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
            held: [self.held.clone(), other.held.clone()].concat(),
            covariance,
            sensitivity,
            beyond_first_order: self.beyond_first_order.clone(),
            by_torque_scale: self.by_torque_scale.clone(),
            known_parts: [(0, &self.known_parts), (first, &other.known_parts)]
                .into_iter()
                .flat_map(|(place, parts)| parts.iter().map(move |part| (place, part)))
                .map(|(place, part)| part.placed(place, first + second))
                .collect(),
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

    /// Mean square of a fitted parameter's error by those of some considered ones.
    pub(crate) fn leaked(&self, fitted: usize, of: &[bool]) -> f64 {
        let some: Vec<usize> = (0..self.parameters.len()).filter(|&k| of[k]).collect();
        let moved = |k: usize| self.sensitivity[(fitted, k)];
        let each = some.iter().map(|&a| {
            let row = some.iter().map(|&b| self.covariance[(a, b)] * moved(b));
            moved(a) * row.sum::<f64>()
        });
        each.sum::<f64>().max(0.0)
    }

    /// Some variance beyond the noise of a fitted parameter, with the scatter that what an earlier step fitted has in it.
    pub(crate) fn added(&self, fitted: usize, variance: f64) -> Added {
        let along: Vec<f64> = (0..self.parameters.len())
            .map(|k| self.sensitivity[(fitted, k)])
            .collect();
        Added {
            variance,
            scatter: self.scatter(&along),
        }
    }

    /// Scatter of the variance of a linear function of the held parameters, as far as an earlier step fitted them.
    pub(crate) fn scatter(&self, along: &[f64]) -> f64 {
        let of_part = |part: &Component| {
            square_form(along, &part.covariance).powi(2) / part.degrees_of_freedom
        };
        self.known_parts.iter().map(of_part).sum()
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
        let half_widths = uncertainty.half_widths(noise);
        for (row, &index) in fitted.iter().enumerate() {
            let by_torques = self.by_torque_scale.get(row).copied().unwrap_or(0.0);
            let leaked = by_torques + self.leaked(row, &vec![true; self.parameters.len()]);
            let half_width = half_widths.of_parameter(row, self.added(row, leaked));
            let variance = uncertainty.covariance[(row, row)] + leaked;
            set_variance(&mut estimates[index], variance, half_width);
        }
    }
}

/// Standard deviation of the scale of an instrument.
fn scale_sd(device: &Device, parameter: ParameterId) -> f64 {
    let mut scales = device.length_scales().into_iter();
    let own = scales.find(|scale| ParameterId::Surrounding(scale.parameter) == parameter);
    own.map_or(0.0, |own| own.sd)
}

/// x^T A x, of a matrix as large as x or larger.
pub(crate) fn square_form(x: &[f64], matrix: &Matrix) -> f64 {
    let row = |(a, left): (usize, &f64)| {
        let each = x.iter().enumerate();
        left * each.map(|(b, right)| matrix[(a, b)] * right).sum::<f64>()
    };
    x.iter().enumerate().map(row).sum()
}

/// Gives an estimate a variance, with the half width of its interval in standard deviations.
pub(crate) fn set_variance(estimate: &mut Estimate, variance: f64, half_width: f64) {
    if let (Some(value), Some(sd)) = (estimate.value, &mut estimate.standard_deviation) {
        *sd = variance.sqrt();
        estimate.ci95 = Some([value - half_width * *sd, value + half_width * *sd]);
    }
}

/// G where all that is held depends on what is fitted: the judgement of the data has it already.
fn by_combinations(judged: &Identifiability, fitted: &[usize], held: &[usize]) -> Option<Matrix> {
    let mut sensitivity = Matrix::zeros(fitted.len(), held.len());
    for (column, &index) in held.iter().enumerate() {
        let Status::Dependent { combination } = &judged.statuses[index] else {
            return None;
        };
        for term in combination {
            let row = fitted.iter().position(|own| *own == term.parameter)?;
            sensitivity[(row, column)] = -term.coefficient;
        }
    }
    Some(sensitivity)
}

/// G for the columns `held`, and what the columns `fitted` cannot make up of each of them.
pub(crate) fn sensitivity(
    reduction: &Reduction,
    fitted: &[usize],
    held: &[usize],
) -> Result<(Matrix, Vec<Vec<f64>>), IdentificationError> {
    let norms = reduction.column_norms();
    if fitted.is_empty() {
        let own: Vec<f64> = held.iter().map(|&column| norms[column]).collect();
        let factor = reduction.scaled_factor(held, &own)?;
        let rests = (0..held.len()).map(|column| factor.column(column).to_vec());
        return Ok((Matrix::zeros(0, held.len()), rests.collect()));
    }
    let of = |columns: &[usize]| {
        let own: Vec<f64> = columns.iter().map(|&column| norms[column]).collect();
        reduction.scaled_factor(columns, &own)
    };
    let free = of(fitted)?;
    let others = of(held)?;
    let basis = OrthonormalBasis::new(&SparseColumns::from(&free), SMALLEST_PIVOT)?;
    let mut sensitivity = Matrix::zeros(fitted.len(), held.len());
    let mut rests = Vec::with_capacity(held.len());
    for column in 0..held.len() {
        let whole = others.column(column);
        let step = basis.solve(whole)?;
        let made_up = free.times(&step)?;
        rests.push(
            whole
                .iter()
                .zip(made_up)
                .map(|(have, made)| have - made)
                .collect(),
        );
        for (row, change) in step.iter().enumerate() {
            sensitivity[(row, column)] = -change;
        }
    }
    Ok((sensitivity, rests))
}

/// Variance that plausible errors of held parameters give the fitted ones: `fitted` and `held` are columns of a reduction of
/// weighted derivatives, `sizes` the standard deviations of the held ones before any reading.
///
/// What the readings would tell of the held ones is taken off (docs/equations.md, Covariance and intervals).
///
/// # Errors
/// Refusals of the linear algebra.
pub fn variance_by_held(
    reduction: &Reduction,
    fitted: &[usize],
    held: &[usize],
    sizes: &[f64],
) -> Result<Vec<f64>, IdentificationError> {
    if held.is_empty() || fitted.is_empty() {
        return Ok(vec![0.0; fitted.len()]);
    }
    let (sensitivity, rests) = sensitivity(reduction, fitted, held)?;
    let exact = vec![0.0; rests.first().map_or(0, Vec::len)];
    let moment = second_moment(&rests, &exact, sizes, 1.0)?;
    let of_row = |row: usize| {
        let along: Vec<f64> = (0..held.len()).map(|k| sensitivity[(row, k)]).collect();
        square_form(&along, &moment)
    };
    Ok((0..fitted.len()).map(of_row).collect())
}

/// S of held parameters, `sizes` their deviations before the recording: what their plausible sizes and the residuals say of their errors.
pub(crate) fn second_moment(
    rests: &[Vec<f64>],
    residuals: &[f64],
    sizes: &[f64],
    noise_factor: f64,
) -> Result<Matrix, IdentificationError> {
    let (rows, count) = (residuals.len(), sizes.len());
    // in plausible sizes and standard deviations of the noise
    let noise = noise_factor.max(LEAST_NOISE);
    let stacked = Matrix::from_fn(rows + count, count, |row, column| {
        match row.checked_sub(rows) {
            None => rests[column][row] * sizes[column] / noise,
            Some(own) => f64::from(u8::from(own == column)),
        }
    });
    let zeros = std::iter::repeat_n(0.0, count);
    let residuals: Vec<f64> = residuals.iter().map(|r| r / noise).chain(zeros).collect();
    let reduction = Reduction::new(&stacked, &residuals)?;
    let all: Vec<usize> = (0..count).collect();
    let moment = reduction.covariance(&all, SMALLEST_PIVOT)?;
    let mean = reduction.solve(&all, 0.0, SMALLEST_PIVOT)?.values;
    Ok(Matrix::from_fn(count, count, |a, b| {
        sizes[a] * sizes[b] * (moment[(a, b)] + mean[a] * mean[b])
    }))
}

/// Least noise over the stated one that a fit's residuals can show: a fit that is exact is so by chance.
const LEAST_NOISE: f64 = 1e-3;
/// Relative pivot below which a direction of the fitted parameters is rounding.
const SMALLEST_PIVOT: f64 = 1e-13;

#[cfg(test)]
mod tests {
    use haptical_identification::{Matrix, Reduction};

    use super::{Considered, sensitivity};

    #[test]
    fn a_fitted_column_gives_way_to_what_a_held_one_adds() {
        // ones, and a slope of 0 to 3: what the slope adds to the mean is taken off again
        let columns = Matrix::from_fn(
            4,
            2,
            |row, column| if column == 0 { 1.0 } else { row as f64 },
        );
        let reduction = Reduction::new(&columns, &[0.0; 4]).unwrap();
        let (found, rests) = sensitivity(&reduction, &[0], &[1]).unwrap();
        assert!((found[(0, 0)] + 1.5).abs() < 1e-12, "{}", found[(0, 0)]);
        let left: f64 = rests[0].iter().map(|rest| rest * rest).sum();
        assert!((left - 5.0).abs() < 1e-12, "{left}");
    }

    #[test]
    fn fitted_and_held_scatter_together() {
        let considered = Considered {
            covariance: Matrix::from_fn(1, 1, |_, _| 4.0),
            sensitivity: Matrix::from_fn(2, 1, |row, _| [-0.5, 0.25][row]),
            parameters: vec![haptical_model::ParameterId::Compliance { joint: 0 }],
            ..Considered::none(2)
        };
        let noise = Matrix::from_fn(2, 2, |a, b| if a == b { 0.1 } else { 0.02 });
        let whole = considered.whole(&noise);
        let wanted = [[1.1, -0.48, -2.0], [-0.48, 0.35, 1.0], [-2.0, 1.0, 4.0]];
        for (a, row) in wanted.iter().enumerate() {
            for (b, wanted) in row.iter().enumerate() {
                assert!((whole[(a, b)] - wanted).abs() < 1e-12, "{a}, {b}");
            }
        }
    }
}
