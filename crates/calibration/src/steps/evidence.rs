//! Evidence for the terms of a transmission: few samples support few terms.

use haptical_identification::Triangle;
use haptical_linalg::{LinalgError, RANK_TOLERANCE};
use haptical_model::{Joint, TransmissionError, TransmissionKind};
use serde::Serialize;

use crate::CalibrationError;
use crate::checks::sufficiency::extremes;
use crate::error::wrap;

/// A form of the transmission error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "form", content = "degree")]
pub enum TransmissionTerms {
    /// No error.
    None,
    /// Constant offset.
    Offset,
    /// Offset and ratio.
    OffsetRatio,
    /// Offset and output drum (or encoder) eccentricity.
    OffsetEccentricity,
    /// Offset, ratio and output eccentricity.
    OffsetRatioEccentricity,
    /// All of equation (1).
    Capstan,
    /// Equation (1) with the offset c held at zero: the encoder was zeroed at home.
    ZeroedCapstan,
    /// Polynomial of a degree.
    Polynomial(usize),
}

/// One form with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvidenceEntry {
    /// Form.
    pub terms: TransmissionTerms,
    /// Number of parameters, noise size not counted.
    pub parameters: usize,
    /// Root mean square of the residuals.
    pub rms: f64,
    /// Root mean square of leave-one-out residuals.
    pub leave_one_out_rms: f64,
    /// Corrected Akaike criterion, n ln(RSS/n) + 2 k n / (n - k - 1); lower is better.
    pub aicc: f64,
    /// Bayes criterion, n ln(RSS/n) + k ln n; lower is better.
    pub bic: f64,
}

impl TransmissionTerms {
    /// Parameters of equation (1) that the form frees, in the order of the transmission crate.
    pub fn free_parameters(self) -> Vec<usize> {
        match self {
            Self::None => vec![],
            Self::Offset => vec![0],
            Self::OffsetRatio => vec![0, 1],
            Self::OffsetEccentricity => vec![0, 2, 3],
            Self::OffsetRatioEccentricity => vec![0, 1, 2, 3],
            Self::Capstan => vec![0, 1, 2, 3, 4, 5],
            Self::ZeroedCapstan => vec![1, 2, 3, 4, 5],
            Self::Polynomial(degree) => (0..=degree).collect(),
        }
    }

    /// Parameters that a transmission of this kind may have besides those that the form frees: the samples do not
    /// support them. An encoder that was zeroed at home has no offset.
    pub fn unsupported_parameters(self, kind: TransmissionKind) -> Vec<usize> {
        let all = match (self, kind) {
            (Self::ZeroedCapstan | Self::Polynomial(_), _) => 0..0,
            (_, TransmissionKind::Capstan) => 0..6,
            (_, TransmissionKind::Direct) => 0..4,
            (_, TransmissionKind::Parallelogram) => 0..0,
        };
        let free = self.free_parameters();
        all.filter(|index| !free.contains(index)).collect()
    }
}

/// The evidence for each form, from its linearisation about zero error (exact for polynomials;
/// eccentricities are linear to (r / D)^2). `readings` and `differences` (output minus reading) are
/// one joint's samples, of which at most [`MOST_SAMPLES`] are asked; forms with too many parameters for the samples are left out.
///
/// # Errors
/// Refusals of the linear algebra.
pub(crate) fn weigh(
    what: &str,
    joint: &Joint,
    forms: &[TransmissionTerms],
    readings: &[f64],
    differences: &[f64],
) -> Result<Vec<EvidenceEntry>, CalibrationError> {
    let range = range_of(readings);
    let every = readings.len().div_ceil(MOST_SAMPLES).max(1);
    let thinned = |all: &[f64]| -> Vec<f64> { all.iter().step_by(every).copied().collect() };
    let (readings, differences) = (&thinned(readings)[..], &thinned(differences)[..]);
    let rows = readings.len();
    let mut entries = Vec::new();
    for &terms in forms {
        let columns = terms.free_parameters();
        // One more for the noise size; AICc needs n > k + 1.
        let k = columns.len() + 1;
        if rows <= k + 1 {
            continue;
        }
        let (sum, leave_one_out) = if columns.is_empty() {
            let sum: f64 = differences.iter().map(|value| value * value).sum();
            (sum, sum)
        } else {
            let mut model = joint.clone();
            model.transmission_error = form(terms, range);
            let parts = Parts {
                model: &model,
                columns: &columns,
                readings,
                differences,
            };
            match parts.residual_sums(what)? {
                Some(sums) => sums,
                None => continue,
            }
        };
        // An exact fit has no noise to weigh: rounding takes its place.
        let n = rows as f64;
        let logarithm = n * (sum / n).max(1e-30).ln();
        let count = k as f64;
        entries.push(EvidenceEntry {
            terms,
            parameters: columns.len(),
            rms: (sum / n).sqrt(),
            leave_one_out_rms: (leave_one_out / n).sqrt(),
            aicc: logarithm + 2.0 * count * n / (n - count - 1.0),
            bic: logarithm + count * n.ln(),
        });
    }
    Ok(entries)
}

/// Samples that are asked, evenly spread: a form that so many do not support is worth less than the digits of the others.
const MOST_SAMPLES: usize = 20_000;
/// Samples that one thread works out at a time.
const SAMPLES_AT_ONCE: usize = 1024;

/// The samples of a form, some at a time: derivatives of the error by its terms at zero error.
struct Parts<'a> {
    model: &'a Joint,
    columns: &'a [usize],
    readings: &'a [f64],
    differences: &'a [f64],
}

impl Parts<'_> {
    /// Sum of squared residuals, plain and leave-one-out (residual over 1 - leverage); none where the columns are
    /// dependent.
    fn residual_sums(&self, what: &str) -> Result<Option<(f64, f64)>, CalibrationError> {
        let wrap = |error: LinalgError| wrap(what, error.into());
        let count = self.columns.len();
        let folded = self.each(|design, target| {
            let mut triangle = Triangle::new(count);
            triangle.fold_rows(&slices(design), target)?;
            Ok::<Triangle, LinalgError>(triangle)
        });
        let mut whole = Triangle::new(count);
        for part in folded {
            whole.merge(&part.map_err(wrap)?).map_err(wrap)?;
        }
        let reduction = whole.reduction(self.readings.len()).map_err(wrap)?;
        let all: Vec<usize> = (0..count).collect();
        let tolerance = RANK_TOLERANCE;
        let solution = reduction.solve(&all, 0.0, tolerance).map_err(wrap)?;
        if solution.rank < count {
            return Ok(None);
        }
        let covariance = reduction.covariance(&all, tolerance).map_err(wrap)?;
        let sums = self.each(|design, target| {
            let (mut plain, mut without) = (0.0, 0.0);
            for (sample, target) in target.iter().enumerate() {
                let (mut leverage, mut fitted) = (0.0, 0.0);
                for (a, left) in design.iter().enumerate() {
                    let row = design.iter().zip(covariance.column(a));
                    let along: f64 = row.map(|(right, entry)| right[sample] * entry).sum();
                    leverage += left[sample] * along;
                    fitted += left[sample] * solution.values[a];
                }
                let residual = target - fitted;
                plain += residual * residual;
                without += (residual / (1.0 - leverage).max(1e-9)).powi(2);
            }
            (plain, without)
        });
        let add = |(a, b): (f64, f64), (c, d): (f64, f64)| (a + c, b + d);
        Ok(Some(sums.into_iter().fold((0.0, 0.0), add)))
    }

    /// What `look` makes of the derivatives, column by column, and differences of each part, in the parts' order.
    fn each<T: Send>(&self, look: impl Fn(&[Vec<f64>], &[f64]) -> T + Sync) -> Vec<T> {
        let readings = self.readings.chunks(SAMPLES_AT_ONCE);
        let parts = readings.zip(self.differences.chunks(SAMPLES_AT_ONCE));
        haptical_parallel::map(parts, |(readings, differences)| {
            look(&self.design(readings), differences)
        })
    }

    /// Zero at a reading that the law refuses.
    fn design(&self, readings: &[f64]) -> Vec<Vec<f64>> {
        let mut design = vec![vec![0.0; readings.len()]; self.columns.len()];
        let mut derivatives = vec![0.0; self.model.error_parameter_count()];
        for (sample, &reading) in readings.iter().enumerate() {
            let evaluated = self.model.evaluate_error(reading, &mut derivatives);
            if evaluated.is_ok() {
                for (column, &index) in design.iter_mut().zip(self.columns) {
                    column[sample] = derivatives[index];
                }
            }
        }
        design
    }
}

fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

/// The zero error in the given form.
pub(crate) fn form(terms: TransmissionTerms, range_rad: [f64; 2]) -> TransmissionError {
    match terms {
        TransmissionTerms::Polynomial(degree) => TransmissionError::Chebyshev {
            range_rad,
            coefficients: vec![0.0; degree + 1],
        },
        _ => TransmissionError::default(),
    }
}

/// Smallest and largest reading, a little apart even where they are equal.
pub(crate) fn range_of(readings: &[f64]) -> [f64; 2] {
    let [low, high] = extremes(readings);
    if high > low {
        [low, high]
    } else {
        [low - 1e-6, low + 1e-6]
    }
}
