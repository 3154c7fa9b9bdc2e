//! One joint's rows fitted with terms, beside a noise with a memory.

use haptical_linalg::{MOST_LEVERAGE, Matrix, NormalEquations, dot};

use super::rows::JointRows;
use super::terms::Term;
use crate::thresholds::between::{FIT_ROUNDS, LEAST_FALL, LEAST_SQUARE, MOST_CORRELATED, RIDGE};

/// A fit of one joint.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) terms: Vec<Term>,
    /// Coefficients of the terms, one after the other, and of the pieces' offsets behind them.
    pub(super) coefficients: Vec<f64>,
    pub(super) covariance: Matrix,
    /// Logarithm of the likelihood, up to a constant of the rows.
    pub(super) log_likelihood: f64,
    /// Readings less the fit \[rad\].
    pub(super) rest: Vec<f64>,
    /// Weight of each row: 1 but for those in which the law does not say where in its play the link is.
    pub(super) weights: Vec<f64>,
    /// Standard deviation of a row's rest \[rad\].
    pub(super) sd: f64,
    /// Correlation of neighbouring rows of the rest.
    pub(super) correlation: f64,
    /// Whether a further round would change the likelihood by less than `LEAST_FALL`.
    pub(super) has_converged: bool,
}

impl Fitted {
    /// Coefficients of a term.
    pub(super) fn of(&self, kind: Term) -> Option<(usize, Term)> {
        let mut at = 0;
        for own in &self.terms {
            if own.is_like(kind) {
                return Some((at, *own));
            }
            at += own.columns_count();
        }
        None
    }

    /// The spring that hardens.
    pub(super) fn hardening(&self) -> Option<(usize, Term)> {
        self.of(Term::Hardening {
            share: 0.0,
            load_nm: 0.0,
        })
    }

    /// The delay with its standard deviation.
    pub(super) fn delay_s(&self) -> Option<(f64, f64)> {
        let (at, _) = self.of(Term::Delay)?;
        Some((
            self.coefficients[at],
            self.covariance[(at, at)].max(0.0).sqrt(),
        ))
    }

    /// Mean of the pieces' offsets.
    pub(super) fn offset_rad(&self) -> f64 {
        let effects: usize = self.terms.iter().map(|own| own.columns_count()).sum();
        let offsets = &self.coefficients[effects..];
        offsets.iter().sum::<f64>() / offsets.len().max(1) as f64
    }

    /// Whether nature allows it; a fit that has not converged is of nothing.
    pub(super) fn is_possible(&self, rows: &JointRows) -> bool {
        let mut at = 0;
        self.has_converged
            && self.terms.iter().all(|own| {
                let from = at;
                at += own.columns_count();
                own.is_possible(rows, &self.coefficients[from..at])
            })
    }
}

/// Prediction of terms with their coefficients, offsets left out.
pub(super) fn predicted(rows: &JointRows, terms: &[Term], coefficients: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; rows.count()];
    let mut at = 0;
    for term in terms {
        for column in term.columns(rows) {
            let value = coefficients[at];
            at += 1;
            (sum.iter_mut().zip(&column)).for_each(|(sum, own)| *sum += value * own);
        }
        if *term == Term::Delay {
            let second = 0.5 * coefficients[at - 1].powi(2);
            let pairs = sum.iter_mut().zip(&rows.acceleration);
            pairs.for_each(|(sum, own)| *sum += second * own);
        }
    }
    sum
}

/// Whether a fit determines its predictions of rows, its own recording's with the pieces' offsets, or another's about theirs (A245).
pub(super) fn determined(fitted: &Fitted, rows: &JointRows, with_offsets: bool) -> Vec<bool> {
    let effects = fitted.terms.iter().flat_map(|own| own.columns(rows));
    let mut columns: Vec<Vec<f64>> = effects.collect();
    match with_offsets {
        true => columns.extend(offsets(rows)),
        // another recording is looked at about its own offsets
        false => columns.iter_mut().for_each(|own| about_means(rows, own)),
    }
    // a fit that has no solution, or has not converged, determines nothing
    let has_solution = fitted.has_converged && fitted.covariance.columns() >= columns.len();
    let leverage = |row: usize| {
        let entry = |a: usize| columns[a][row];
        let along = |a: usize| -> f64 {
            (0..columns.len())
                .map(|b| fitted.covariance[(a, b)] * entry(b))
                .sum()
        };
        let variance: f64 = (0..columns.len()).map(|a| entry(a) * along(a)).sum();
        variance / fitted.sd.powi(2)
    };
    (0..rows.count())
        .map(|row| has_solution && leverage(row) <= MOST_LEVERAGE)
        .collect()
}

/// A column without each piece's mean.
fn about_means(rows: &JointRows, column: &mut [f64]) {
    for piece in rows.pieces.windows(2) {
        let own = &mut column[piece[0]..piece[1]];
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        own.iter_mut().for_each(|value| *value -= mean);
    }
}

/// A column of ones for each piece.
fn offsets(rows: &JointRows) -> impl Iterator<Item = Vec<f64>> {
    rows.pieces.windows(2).map(|own| {
        let piece = own[0]..own[1];
        (0..rows.count())
            .map(|k| f64::from(u8::from(piece.contains(&k))))
            .collect()
    })
}

/// Fits terms to the rows of which `is_kept`; the others take no part.
///
/// Generalised least squares with a first-order autoregression, its correlation and size settled in turn with the coefficients
/// (Cochrane and Orcutt 1949; Prais and Winsten 1954).
pub(super) fn fit(rows: &JointRows, terms: &[Term], is_kept: &dyn Fn(usize) -> bool) -> Fitted {
    let kept: Vec<usize> = (0..rows.count()).filter(|k| is_kept(*k)).collect();
    let pieces = rows.pieces.len() - 1;
    let mut columns: Vec<Vec<f64>> = terms.iter().flat_map(|own| own.columns(rows)).collect();
    let effects = columns.len();
    columns.extend(offsets(rows));
    let flight = terms.iter().find_map(|own| own.flight(rows));
    let probe = Fitted {
        terms: terms.to_vec(),
        coefficients: Vec::new(),
        covariance: Matrix::zeros(0, 0),
        log_likelihood: f64::NEG_INFINITY,
        rest: Vec::new(),
        weights: Vec::new(),
        sd: 0.0,
        correlation: 0.0,
        has_converged: false,
    };
    let delay = probe.of(Term::Delay).map(|own| own.0);
    let play = probe.of(Term::PLAY).map(|own| own.0);
    let starts: Vec<bool> = (kept.iter().enumerate())
        .map(|(at, k)| at == 0 || kept[at - 1] + 1 != *k || rows.pieces.contains(k))
        .collect();
    let (mut sd, mut correlation) = (1e3 * rows.noise, 0.0_f64);
    let mut coefficients: Vec<f64> = vec![0.0; columns.len()];
    let mut found = probe;
    for _ in 0..FIT_ROUNDS {
        let half_play = play.map_or(0.0, |at| coefficients[at].abs());
        let second = delay.map_or(0.0, |at| 0.5 * coefficients[at] * coefficients[at]);
        let sds: Vec<f64> = (0..rows.count())
            .map(|k| sd.hypot(flight.as_ref().map_or(0.0, |own| own[k] * half_play)))
            .collect();
        let target = |k: usize| rows.beside[k] - second * rows.acceleration[k];
        // whitened rows
        let fresh = (1.0 - correlation * correlation).sqrt();
        let whitened = |own: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let values = kept.iter().enumerate().map(|(at, &k)| match starts[at] {
                true => own(k) / sds[k],
                false => (own(k) / sds[k] - correlation * own(k - 1) / sds[k - 1]) / fresh,
            });
            values.collect()
        };
        let wide: Vec<Vec<f64>> = columns.iter().map(|own| whitened(&|k| own[k])).collect();
        let wide: Vec<&[f64]> = wide.iter().map(Vec::as_slice).collect();
        let sums = NormalEquations::from_columns(&wide, &whitened(&target));
        let all: Vec<usize> = (0..wide.len()).collect();
        if !all.iter().all(|&a| sums.product(a, a).is_finite()) {
            return found;
        }
        // of a column of nothing the variance is large
        let solved = sums.solve(&all, |a| RIDGE * sums.product(a, a).max(LEAST_SQUARE));
        coefficients = solved.coefficients().to_vec();
        let rest = |k: usize| {
            let fitted: f64 = (columns.iter().zip(&coefficients))
                .map(|(own, c)| c * own[k])
                .sum();
            target(k) - fitted
        };
        let z: Vec<f64> = kept.iter().map(|&k| rest(k) / sds[k]).collect();
        let u = whitened(&rest);
        let freedom = (kept.len() as f64 - columns.len() as f64).max(1.0);
        let square = dot(&u, &u);
        let logs: f64 = kept.iter().map(|&k| sds[k].ln()).sum();
        let chained = starts.iter().filter(|own| !**own).count() as f64;
        let before = found.log_likelihood;
        found.log_likelihood = -logs - chained * fresh.ln() - 0.5 * square;
        found.covariance = solved.inverse();
        found.rest = (0..rows.count()).map(rest).collect();
        found.weights = sds.iter().map(|own| (sd / own).powi(2)).collect();
        found.coefficients.clone_from(&coefficients);
        found.sd = sd;
        found.correlation = correlation;
        found.has_converged = (found.log_likelihood - before).abs() < 0.5 * LEAST_FALL;
        if found.has_converged {
            break;
        }
        let (mut own, mut next) = (0.0, 0.0);
        for at in 1..z.len() {
            if !starts[at] {
                own += 0.5 * (z[at] * z[at] + z[at - 1] * z[at - 1]);
                next += z[at] * z[at - 1];
            }
        }
        correlation = (next / own.max(1e-300)).clamp(0.0, MOST_CORRELATED);
        sd = (sd * (square / freedom).sqrt()).max(rows.noise);
    }
    debug_assert!(found.coefficients.len() == effects + pieces);
    found
}

#[cfg(test)]
mod tests {
    use haptical_model::Recording;

    use super::super::LoadSource;
    use super::super::rows::Rows;
    use super::*;

    /// A motor that swings, and an encoder on its link that is late.
    fn rows() -> Rows {
        let time_s: Vec<f64> = (0..2000).map(|k| 0.004 * f64::from(k)).collect();
        let at = |late_s: f64| -> Vec<f64> {
            let angle = |t: &f64| (1.3 * (t - late_s)).sin() + 0.4 * (4.1 * (t - late_s)).sin();
            time_s.iter().map(angle).collect()
        };
        let recording = Recording {
            line: (2..).take(2000).collect(),
            joint: vec![at(0.0)],
            output: vec![Some(at(0.01))],
            torque_nm: vec![Some(at(0.3))],
            time_s: Some(time_s),
            ..Recording::default()
        };
        Rows::of(&recording, LoadSource::Links).unwrap()
    }

    #[test]
    fn a_fit_that_has_not_converged_names_nothing_and_predicts_nothing() {
        let rows = &rows().joints[0];
        let fitted = fit(rows, &[Term::Delay], &|_| true);
        assert!(fitted.has_converged && fitted.is_possible(rows));
        let predicts = |own: &Fitted| determined(own, rows, true).contains(&true);
        assert!(predicts(&fitted));
        let unfinished = Fitted {
            has_converged: false,
            ..fitted
        };
        assert!(!unfinished.is_possible(rows) && !predicts(&unfinished));
    }

    /// Readings that no number can hold are of no fit.
    #[test]
    fn a_fit_without_a_solution_has_not_converged() {
        let mut all = rows();
        all.joints[0].beside[100] = f64::INFINITY;
        assert!(!fit(&all.joints[0], &[Term::Delay], &|_| true).has_converged);
    }
}
