//! Covariance of a fit whose noise has memory along the rows, drifts, or is larger in a part of a range.
//!
//! Source: docs/equations.md, Noise with memory. Every step has a condition in docs/evidence that fails without it.

mod bands;
mod cosines;
mod fitted;
mod group;
mod held;
mod least_squares;
mod nnls;
mod partition;
mod problem;
mod rows;
mod sizes;
mod unmixed;

use std::ops::Range;

use haptical_linalg::Matrix;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::NoiseScale;
use crate::component::{Component, pooled, quantile};
use bands::SignalBands;
use fitted::Fitted;
pub use held::HeldEffect;
pub use problem::{OrderedProblem, Signal, Uneven};
use rows::{Rows, as_matrix};
use sizes::Sizes;
use unmixed::Unmixed;

/// Noise that is not independent and of one size, and the fit as it follows from that.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelatedNoise {
    /// Change of the parameters: where the noise is uneven rows are weighted, where it drifts a line in time is
    /// fitted for every signal. Zero otherwise.
    pub step: Vec<f64>,
    /// The covariance of the parameters is the sum of these.
    pub components: Vec<Component>,
    /// Groups whose noise has memory.
    pub correlated: Vec<usize>,
    /// Where the noise is uneven.
    pub uneven: Vec<Uneven>,
    /// Local size of the noise at every row, with geometric mean 1 over a group.
    pub sizes: Vec<f64>,
    /// Change of every signal over the log by the fitted line \[stated standard deviations\]; empty without lines.
    pub drift: Vec<f64>,
    /// Chance of lines as steep as these without a drift.
    pub drift_p_value: f64,
    /// Of the held parameters, if there are any.
    pub held: Option<HeldEffect>,
}

/// Fewest rows of a signal in which memory is looked for.
pub const FEWEST_ROWS: usize = 24;
/// Level of the test for a drift: high, as a drift that the parameters can imitate costs more than a needless line.
const DRIFT_LEVEL: f64 = 0.25;
/// Mean size of the logarithm of heteroscedastic over homoscedastic variances from which on the noise is uneven, at
/// [`UNEVEN_AT`] rows; it scatters with one over the root of their number.
const UNEVEN: f64 = 0.25;
const UNEVEN_AT: f64 = 300.0;

/// Looks for memory, drift and uneven size in the residuals of a fit. None where there is none of it, and the usual
/// covariance holds; none too where the problem is too small to look, or is not of full rank.
///
/// The steps: sizes of the noise as a step function of at most two covariates; the residuals' spectrum in a few bands
/// of the discrete cosine transform of each signal, with what the fit takes out of every band put back (MINQUE, Rao
/// 1971), falling with frequency; a line in time for every signal where a drift shows or the noise has memory; a
/// sandwich of this spectrum with Satterthwaite's degrees of freedom for every parameter, and one that allows rows of
/// any size (HC2, MacKinnon & White 1985) as the floor where sizes differ.
#[must_use]
pub fn correlated_noise(problem: &OrderedProblem<'_>) -> Option<CorrelatedNoise> {
    let is_long = |signal: &Signal| signal.rows.len() >= FEWEST_ROWS;
    if !problem.signals.iter().any(is_long) {
        return None;
    }
    let rows = Rows::new(problem)?;
    let sizes = Sizes::find(problem, &rows)?;
    let of_signal = |(signal, places): (&Signal, &Range<usize>)| {
        let (group, sizes) = (&rows.groups[signal.group], &sizes.of_group[signal.group]);
        SignalBands::new(signal, (group, places), sizes, is_long(signal))
    };
    let signals = problem.signals.iter().zip(&rows.places);
    let bands: Vec<SignalBands> = signals.map(of_signal).collect();
    let plain = Fitted::new(&bands, &rows, false)?;
    let lined = Fitted::new(&bands, &rows, true);
    let drift_p_value = lined
        .as_ref()
        .map_or(1.0, |lined| p_value_of_lines(&plain, lined));
    let has_memory = Unmixed::new(&plain, &bands, &rows).memory;
    let (fitted, has_lines) = match lined {
        Some(lined) if has_memory || drift_p_value < DRIFT_LEVEL => (lined, true),
        _ => (plain, false),
    };
    let unmixed = Unmixed::new(&fitted, &bands, &rows);
    let (usual, heteroscedastic) = fitted.variances(&rows, problem, &sizes.of_group)?;
    let usual = match problem.noise {
        NoiseScale::Estimated => usual,
        NoiseScale::Stated if sizes.uneven.is_empty() && !unmixed.memory => {
            let factor = 1.0 / fitted.variance();
            usual.map(|variance| variance * factor)
        }
        NoiseScale::Stated => usual,
    };
    let count = usual.len();
    let apart: f64 = (0..count)
        .map(|k| (heteroscedastic[k] / usual[k]).ln().abs())
        .sum();
    let limit = UNEVEN * (UNEVEN_AT / problem.residuals.len() as f64).sqrt().max(1.0);
    let is_uneven = !sizes.uneven.is_empty() || apart / count as f64 > limit;
    if !(has_lines || unmixed.memory || is_uneven) {
        return None;
    }
    let floor = match is_uneven {
        true => usual.zip_map(&heteroscedastic, f64::max),
        false => usual.clone(),
    };
    let rest = fitted.degrees_of_freedom();
    let components = if unmixed.memory {
        let floor = is_uneven.then(|| floor.map(|variance| quantile(rest) * variance.sqrt()));
        scaled_to(unmixed.components(&fitted, &rows), floor.as_ref())
    } else {
        let factors = floor.zip_map(&usual, |floor, usual| (floor / usual).sqrt());
        let covariance = fitted.covariance(&rows);
        let scale: f64 = usual[0] / covariance[(0, 0)];
        let entry = |a: usize, b: usize| covariance[(a, b)] * scale * factors[a] * factors[b];
        vec![Component {
            covariance: Matrix::from_fn(count, count, entry),
            degrees_of_freedom: rest,
        }]
    };
    let held = (rows.held() > 0).then(|| {
        let [plain, scattered] = unmixed.of_held(fitted.variance());
        let count = rows.held();
        let of_held =
            |sum: &DMatrix<f64>| as_matrix(&sum.view((1, 1), (count, count)).into_owned());
        HeldEffect {
            sensitivity: as_matrix(&fitted.follows(&rows)),
            information: of_held(&plain),
            scatter: of_held(&scattered),
            // the residuals are the other way round than what the readings leave
            gradient: (0..count).map(|column| -plain[(0, 1 + column)]).collect(),
        }
    });
    Some(CorrelatedNoise {
        held,
        step: fitted.step(&rows).iter().copied().collect(),
        components: (components.into_iter())
            .map(|component| component.scaled(sizes.inflation))
            .collect(),
        correlated: unmixed.correlated(problem.signals),
        drift: fitted.lines(),
        sizes: sizes.by_row(&rows),
        uneven: sizes.uneven,
        drift_p_value,
    })
}

/// Chance of lines that fall the sum of squares as far (F test).
fn p_value_of_lines(plain: &Fitted, lined: &Fitted) -> f64 {
    let lines = plain.degrees_of_freedom() - lined.degrees_of_freedom();
    let rest = lined.degrees_of_freedom();
    if lines < 1.0 || rest < 1.0 || lined.rest <= 0.0 {
        return 1.0;
    }
    let ratio = (plain.rest - lined.rest).max(0.0) / lines / (lined.rest / rest);
    FisherSnedecor::new(lines, rest).map_or(1.0, |spread| spread.sf(ratio))
}

/// Components times factors of each parameter, by which no half width is below its floor.
fn scaled_to(components: Vec<Component>, floor: Option<&DVector<f64>>) -> Vec<Component> {
    let Some(floor) = floor else {
        return components;
    };
    let factor = |k: usize| {
        let (variance, freedom) = pooled(&components, &|part| part[(k, k)]);
        let own = quantile(freedom) * variance.sqrt();
        if own > 0.0 {
            (floor[k] / own).max(1.0)
        } else {
            1.0
        }
    };
    let factors: Vec<f64> = (0..floor.len()).map(factor).collect();
    let scale = |component: &Component| Component {
        covariance: Matrix::from_fn(floor.len(), floor.len(), |a, b| {
            component.covariance[(a, b)] * factors[a] * factors[b]
        }),
        ..*component
    };
    components.iter().map(scale).collect()
}
